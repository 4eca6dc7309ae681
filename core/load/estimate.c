/* Estimates the memory that loading a plan will take, from headers alone. */
#include "core/load/estimate.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/parallel.h"
#include "core/formats/dicom/dicom_seg.h"
#include "core/formats/gzip.h"
#include "core/formats/sera/sera_chd.h"
#include "core/formats/sera/sera_rst.h"
#include "core/load/dicom_parts.h"
#include "core/load/nifti_parts.h"
#include "core/load/nrrd_parts.h"

/* Bytes for one file: kept stays with the plan, work is freed once the file is read. */
struct need {
    uint64_t kept, work;
};

/* Bytes per voxel in memory, as raw_read chooses the type; a signed byte becomes 16 bits. */
static uint64_t bytes_kept(enum raw_type type, enum raw_use use)
{
    switch (use) {
    case RAW_MASK: return 1;
    case RAW_LABELS: return type == RAW_U8 || type == RAW_I8 ? 1 : 2;
    case RAW_IMAGE: break;
    }
    switch (type) {
    case RAW_U8: return 1;
    case RAW_I8:
    case RAW_I16:
    case RAW_U16: return 2;
    default: return 4;
    }
}

static struct need need_of_voxels(uint64_t n_voxels, enum raw_type type, enum raw_use use, uint64_t file_bytes,
                                  bool is_copied, bool is_taken)
{
    uint64_t raw = n_voxels * raw_type_bytes(type);
    if (use == RAW_IMAGE && is_taken && bytes_kept(type, use) == raw_type_bytes(type))
        is_copied = false; /* the unpacked bytes become the volume's voxels */
    uint64_t wide =
        use == RAW_LABELS && type != RAW_U8 ? n_voxels : 0; /* labels are read as 16 bits, then narrowed to 8 */
    return (struct need){ n_voxels * bytes_kept(type, use), file_bytes + (is_copied ? raw : 0) + wide };
}

static struct need need_of_nifti(const struct folder *folder, const struct part_reading *reading, enum raw_use use)
{
    struct bytes head;
    struct nifti_header header;
    char voxels[FOLDER_NAME_SIZE];
    struct need need = { reading->bytes, 0 };
    plan_nifti_voxels(folder, reading->path, voxels);
    if (!plan_nifti_peek(folder, reading->path, &header, NULL) ||
        !folder_read(folder, voxels, UINT64_MAX, 2, &head, NULL))
        return need;
    bool is_packed = gzip_is(head.data, head.size);
    bytes_free(&head);
    return need_of_voxels(grid_n_voxels(&header.grid), header.type, use, reading->bytes,
                          is_packed || header.is_swapped || header.data_at % 8 != 0, is_packed);
}

static struct need need_of_nrrd(const struct folder *folder, const struct part_reading *reading, enum raw_use use)
{
    struct nrrd_header header;
    struct need need = { reading->bytes, 0 };
    uint64_t file_bytes = reading->bytes;
    if (plan_nrrd_peek(folder, reading->path, &header, NULL)) {
        if (header.data_file[0])
            folder_look(folder, header.data_file, &file_bytes);
        need = need_of_voxels(grid_n_voxels(&header.grid) * header.n_layers, header.type, use, file_bytes, true, false);
    }
    nrrd_header_finish(&header);
    return need;
}

static struct need need_of_univels(const struct folder *folder, const struct part_reading *reading)
{
    struct bytes header;
    struct uvh uvh = { 0 };
    struct need need = { reading->bytes, 0 };
    if (!folder_read(folder, reading->path, UVH_MAX_BYTES, UINT64_MAX, &header, NULL))
        return need;
    if (uvh_parse(header.data, header.size, reading->path, &uvh, NULL, NULL)) {
        uint64_t n = grid_n_voxels(&uvh.grid);
        need = (struct need){ n, 2 * n };
        uvh_finish(&uvh);
    }
    bytes_free(&header);
    return need;
}

static struct need need_of_rst(const struct folder *folder, const struct part_reading *reading)
{
    enum { COLUMNS = 14, COLUMN_BYTES = 15 };
    struct bytes head;
    struct rst_header header;
    uint8_t *text = malloc(RST_HEAD_BYTES);
    struct need need = { reading->bytes, reading->bytes };
    if (text && folder_read(folder, reading->path, UINT64_MAX, RST_HEAD_BYTES, &head, NULL)) {
        bool is_packed = gzip_is(head.data, head.size);
        size_t n = is_packed ? gzip_head(head.data, head.size, text, RST_HEAD_BYTES) : head.size;
        if (rst_parse_header(is_packed ? text : head.data, n, reading->path, &header, NULL)) {
            uint64_t cells = (uint64_t)header.n_cells * header.n_cells * header.n_cells;
            need = (struct need){ cells * RST_N_DOSES * sizeof(float),
                                  reading->bytes + (is_packed ? cells * COLUMNS * COLUMN_BYTES : 0) };
        }
        bytes_free(&head);
    }
    free(text);
    return need;
}

static struct need need_of_chd(const struct folder *folder, const struct part_reading *reading)
{
    struct bytes header;
    struct chd chd = { 0 };
    struct need need = { reading->bytes, reading->bytes };
    if (!folder_read(folder, reading->path, CHD_MAX_BYTES, UINT64_MAX, &header, NULL))
        return need;
    if (chd_parse(header.data, header.size, reading->path, &chd, NULL, NULL))
        need = (struct need){ chd_table_bytes(&chd) / 2, chd_table_bytes(&chd) + chd_mask_bytes(&chd) };
    chd_finish(&chd);
    bytes_free(&header);
    return need;
}

/* A structure set becomes label layers on the largest image; nested and overlapping regions mostly need three. */
static struct need need_of_structs(const struct loading *loading, const struct part_reading *reading)
{
    enum { USUAL_LAYERS = 3 };
    const struct dicom_index *index = loading->parts.dicom;
    uint64_t voxels = 0;
    for (size_t s = 0; s < index->n_stacks; s++) {
        uint64_t n = (uint64_t)index->stacks[s].rows * index->stacks[s].columns * index->stacks[s].n_slices;
        voxels = n > voxels ? n : voxels;
    }
    return (struct need){ USUAL_LAYERS * voxels + 2 * reading->bytes, reading->bytes };
}

/* Segments that overlap need layers of their own; a plane without a frame takes as much as any other. */
static struct need need_of_segments(const struct folder *folder, const struct part_reading *reading)
{
    enum { USUAL_LAYERS = 3 };
    struct plan_dicom_file opened;
    struct need need = { 8 * reading->bytes, 2 * reading->bytes }; /* frames are packed 8 voxels a byte */
    uint64_t n_voxels;
    size_t n_segments;
    if (!plan_dicom_open(folder, reading->path, &opened, NULL))
        return need;
    if (dicom_seg_measure(opened.file, &n_voxels,
                          &n_segments)) /* work: the file, its elements, a mask of one segment */
        need = (struct need){ n_voxels * (n_segments < USUAL_LAYERS ? n_segments : USUAL_LAYERS),
                              2 * reading->bytes + n_voxels / 8 };
    plan_dicom_close(&opened);
    return need;
}

static struct need need_of(const struct loading *loading, const struct part_reading *reading)
{
    const struct folder *folder = &loading->folder;
    enum raw_use use = reading->kind == PART_KIND_DOSE_MASK ? RAW_MASK : RAW_IMAGE;
    if (reading->kind == PART_KIND_REGION && reading->index < loading->file->n_regions)
        use = loading->file->regions[reading->index].name[0] ? RAW_MASK : RAW_LABELS;
    switch (reading->format) {
    case PART_NIFTI: return need_of_nifti(folder, reading, use);
    case PART_NRRD: return need_of_nrrd(folder, reading, use);
    case PART_UVH: return need_of_univels(folder, reading);
    case PART_SERA_RST: return need_of_rst(folder, reading);
    case PART_SERA_DOSE: return need_of_chd(folder, reading);
    case PART_DICOM: break;
    default: return (struct need){ 4 * reading->bytes, reading->bytes }; /* a compressed image of 8 bits */
    }
    if (reading->kind == PART_KIND_IMAGE)
        return (struct need){ loading->parts.dicom->stacks[reading->stack].n_bytes, 0 };
    if (reading->kind == PART_KIND_REGION &&
        plan_dicom_object(loading->parts.dicom, DICOM_KIND_SEGMENTATION, reading->path, 0))
        return need_of_segments(folder, reading);
    if (reading->kind == PART_KIND_REGION)
        return need_of_structs(loading, reading);
    return (struct need){ reading->bytes, reading->bytes };
}

uint64_t plan_estimate(const struct loading *loading, const struct part_reading **largest)
{
    uint64_t kept = 0, most = 0, *work = calloc(loading->n_readings + 1, sizeof *work);
    size_t n_threads = (size_t)parallel_cores(), n_work = 0;
    *largest = NULL;
    for (size_t i = 0; work && i < loading->n_readings; i++) {
        struct need need = need_of(loading, &loading->readings[i]);
        size_t at = n_work++; /* sorted, largest first */
        for (; at > 0 && work[at - 1] < need.work; at--)
            work[at] = work[at - 1];
        work[at] = need.work;
        kept += need.kept;
        if (need.kept + need.work >= most) {
            most = need.kept + need.work;
            *largest = &loading->readings[i];
        }
    }
    for (size_t i = 0; work && i < n_work && i < n_threads; i++)
        kept += work[i];
    free(work);
    return kept;
}

bool plan_check_estimate(const struct loading *loading, struct error *err)
{
    const struct part_reading *largest;
    if (loading->max_bytes == 0)
        return true;
    uint64_t bytes = plan_estimate(loading, &largest);
    if (bytes <= loading->max_bytes || !largest)
        return true;
    struct need need = need_of(loading, largest);
    return error_set(
        err, ERROR_LIMIT,
        "reading the plan would take about %.0f MiB of memory, and %.0f MiB are allowed; the largest part is %s with %.0f "
        "MiB",
        (double)bytes / 1048576, (double)loading->max_bytes / 1048576, largest->path,
        (double)(need.kept + need.work) / 1048576);
}
