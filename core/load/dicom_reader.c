/* Reads DICOM files of a plan: series of images, structure sets, segmentations, doses, treatment plans. */
#include <stdio.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/formats/dicom/dicom_seg.h"
#include "core/load/dicom_parts.h"
#include "core/load/loading.h"
#include "core/load/reader_table.h"

static bool is_dicom_file(const struct folder *folder, const char *name, struct error *err)
{
    uint8_t head[140];
    struct folder_part part;
    if (!folder_open_part(folder, name, &part, err))
        return false;
    size_t n = part.n_bytes < sizeof head ? (size_t)part.n_bytes : sizeof head;
    bool is_read = folder_read_part(&part, name, 0, head, n, err);
    folder_close_part(&part);
    return !is_read || dicom_looks_like(head, n); /* the scan reports a file that the disk does not give */
}

static void recognise(struct recognition *all, char *name)
{
    all->dicom[all->n_dicom++] = name;
}

/* A structure set becomes label layers on the largest image; nested and overlapping regions mostly need three. */
static struct part_need need_of_structs(const struct loading *loading, const struct part_reading *reading)
{
    enum { USUAL_LAYERS = 3 };
    const struct dicom_index *index = loading->parts.dicom;
    uint64_t voxels = 0;
    for (size_t s = 0; s < index->n_stacks; s++) {
        uint64_t n = (uint64_t)index->stacks[s].rows * index->stacks[s].columns * index->stacks[s].n_slices;
        voxels = n > voxels ? n : voxels;
    }
    return (struct part_need){ USUAL_LAYERS * voxels + 2 * reading->bytes, reading->bytes };
}

/* Segments that overlap need layers of their own; a plane without a frame takes as much as any other. */
static struct part_need need_of_segments(const struct folder *folder, const struct part_reading *reading)
{
    enum { USUAL_LAYERS = 3 };
    struct plan_dicom_file opened;
    struct part_need need = { 8 * reading->bytes, 2 * reading->bytes }; /* frames are packed 8 voxels a byte */
    uint64_t n_voxels;
    size_t n_segments;
    if (!plan_dicom_open(folder, reading->path, &opened, NULL))
        return need;
    if (dicom_seg_measure(opened.file, &n_voxels,
                          &n_segments)) /* work: the file, its elements, a mask of one segment */
        need = (struct part_need){ n_voxels * (n_segments < USUAL_LAYERS ? n_segments : USUAL_LAYERS),
                                   2 * reading->bytes + n_voxels / 8 };
    plan_dicom_close(&opened);
    return need;
}

static struct part_need estimate(const struct loading *loading, const struct part_reading *reading, enum raw_use use)
{
    (void)use;
    const struct dicom_index *index = loading->parts.dicom;
    if (reading->kind == PART_KIND_IMAGE)
        return (struct part_need){ index->stacks[reading->stack].n_bytes, 0 };
    if (reading->kind == PART_KIND_REGION && plan_dicom_object(index, DICOM_KIND_SEGMENTATION, reading->path, 0))
        return need_of_segments(&loading->folder, reading);
    if (reading->kind == PART_KIND_REGION)
        return need_of_structs(loading, reading);
    return (struct part_need){ reading->bytes, reading->bytes };
}

/* Progress of dicom_series_read, which makes one call at a time. */
static void series_progress(void *context, size_t n_done, size_t n_all)
{
    struct part_reading *reading = context;
    uint64_t counted = n_all ? (uint64_t)((double)reading->bytes * (double)n_done / (double)n_all) : 0;
    if (counted <= reading->bytes_counted || counted > reading->bytes)
        return;
    loading_work(reading->loading, counted - reading->bytes_counted);
    reading->bytes_counted = counted;
}

static bool read_series(struct loading *loading, struct part_reading *reading)
{
    const struct dicom_progress progress = { series_progress, reading, &loading->is_given_up, 0 };
    const struct dicom_index *index = loading->parts.dicom;
    reading->volume = dicom_series_read(&loading->folder, index, (size_t)reading->stack, &progress, &reading->facts,
                                        &reading->report, &reading->err);
    snprintf(reading->modality, sizeof reading->modality, "%.15s", index->stacks[reading->stack].modality);
    return reading->volume != NULL;
}

/* Reads a structure set, a segmentation, a dose or a treatment plan. */
static bool read_object(struct loading *loading, struct part_reading *reading)
{
    struct plan_dicom_file opened;
    if (!plan_dicom_open(&loading->folder, reading->path, &opened, &reading->err))
        return false;
    bool is_read = false;
    const struct dicom_object *object =
        plan_dicom_object(loading->parts.dicom, DICOM_KIND_SEGMENTATION, reading->path, 0);
    if (reading->kind == PART_KIND_REGION && object) {
        reading->layers = mem_new(sizeof *reading->layers);
        is_read = dicom_seg_read(opened.file, reading->path, loading->file->regions[reading->index].name,
                                 reading->layers, &reading->report, &reading->err);
    } else if (reading->kind == PART_KIND_REGION)
        is_read =
            (reading->structs = rtstruct_read(opened.file, reading->path, &reading->report, &reading->err)) != NULL;
    else if (reading->kind == PART_KIND_DOSE)
        is_read = rtdose_read(opened.file, reading->path, &reading->rtdose, &reading->report, &reading->err);
    else
        is_read = (reading->rtplan = rtplan_read(opened.file, reading->path, &reading->report, &reading->err)) != NULL;
    if (dicom_text_is_broken(opened.file))
        report_add(&reading->report, REPORT_WARNING, "dicom.text", reading->path,
                   "Names hold bytes without a meaning in the file's character set (0008,0005); these are shown as "
                   "<0x8E> and the like.");
    plan_dicom_close(&opened);
    return is_read;
}

static bool read(struct loading *loading, struct part_reading *reading)
{
    return reading->kind == PART_KIND_IMAGE ? read_series(loading, reading) : read_object(loading, reading);
}

static const char *const names[] = { ".dcm", NULL };
const struct part_reader part_dicom = { .word = "DICOM",
                                        .names = names,
                                        .looks_like = is_dicom_file,
                                        .reads = PART_READS_GRIDS | 1 << PART_KIND_BEAMS,
                                        .recognise = recognise,
                                        .estimate = estimate,
                                        .read = read };
