/* Reads one listed file of a plan. */
#include "core/load/read_part.h"

#include <stdio.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/formats/dicom/dicom_seg.h"
#include "core/formats/plan/plan_json.h"
#include "core/load/dicom_parts.h"
#include "core/load/nifti_parts.h"
#include "core/load/nrrd_parts.h"
#include "core/load/part_names.h"
#include "core/load/sera_parts.h"

static bool read_grid(const struct folder *folder, struct part_reading *reading, enum raw_use use)
{
    reading->volume = reading->format == PART_NRRD
                          ? plan_nrrd_read(folder, reading->path, use, &reading->report, &reading->err)
                          : plan_nifti_read(folder, reading->path, use, &reading->report, &reading->err);
    return reading->volume != NULL;
}

static bool read_layers(const struct folder *folder, struct part_reading *reading)
{
    reading->layers = mem_new(sizeof *reading->layers);
    return plan_nrrd_read_layers(folder, reading->path, reading->layers, &reading->report, &reading->err);
}

/* Reads the list of names of a label map. A list that cannot be read is reported, and the map stays without names. */
static bool read_names(const struct folder *folder, const char *path, struct part_reading *reading)
{
    struct bytes bytes = { 0 };
    struct error why = { 0 };
    if (!path[0])
        return true;
    bool is_read = folder_read(folder, path, TEXT_FILE_MAX_BYTES, UINT64_MAX, &bytes, &why) &&
                   label_names_parse(bytes.data, bytes.size, path, &reading->names, &why);
    bytes_free(&bytes);
    if (!is_read && loading_may_leave_out(&why)) {
        label_names_finish(&reading->names);
        report_add(&reading->report, REPORT_ERROR, "part.unreadable", path,
                   "Left out: %s. The labels of %.120s go by their numbers.", why.text, reading->path);
        return true;
    }
    if (!is_read)
        reading->err = why;
    if (is_read && reading->names.file[0] &&
        strcmp(part_base_name(reading->names.file), part_base_name(reading->path)) != 0)
        report_add(&reading->report, REPORT_WARNING, "region.names-elsewhere", reading->path,
                   "The list of names, %.120s, says that it belongs to %.120s; "
                   "it was used as the plan says.",
                   path, reading->names.file);
    return is_read;
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
static bool read_rt_object(const struct loading *loading, struct part_reading *reading)
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

/* True if the file of a label map says itself that it is one: by segments, or by layers. */
static bool says_labels(const struct folder *folder, const struct part_reading *reading)
{
    struct nrrd_header header;
    if (reading->format != PART_NRRD)
        return false;
    bool is_said =
        !plan_nrrd_peek(folder, reading->path, &header, NULL) || header.n_segments > 0 || header.n_layers > 1;
    nrrd_header_finish(&header);
    return is_said;
}

/* Reads a file that is called like a label map; when its values are no labels, as an image. */
static bool read_by_content(const struct folder *folder, struct part_reading *reading)
{
    bool is_read = read_grid(folder, reading, RAW_LABELS);
    if (!is_read && reading->err.code == ERROR_RANGE) {
        report_finish(&reading->report);
        reading->err = (struct error){ 0 };
        reading->is_no_labels = true;
        return read_grid(folder, reading, RAW_IMAGE);
    }
    if (!is_read)
        return false;
    grid_content_measure(reading->volume, true, &reading->content);
    reading->is_no_labels = !grid_content_is_labels(&reading->content, true);
    return true;
}

static bool read_image(const struct loading *loading, struct part_reading *reading)
{
    if (!read_grid(&loading->folder, reading, RAW_IMAGE))
        return false;
    if (loading->parts.is_recognised) {
        grid_content_measure(reading->volume, false, &reading->content);
        reading->is_label_like = grid_content_is_labels(&reading->content, false);
    }
    return true;
}

static bool read_region(const struct loading *loading, struct part_reading *reading)
{
    const struct plan_file_region *region = &loading->file->regions[reading->index];
    if (reading->format == PART_UVH)
        return plan_read_univels(&loading->folder, reading->path, region->mm, &reading->uvh, &reading->volume,
                                 &reading->report, &reading->err);
    if (loading->parts.is_recognised && !says_labels(&loading->folder, reading))
        return read_by_content(&loading->folder, reading) &&
               (reading->is_no_labels || read_names(&loading->folder, region->names, reading));
    if (!read_names(&loading->folder, region->names, reading))
        return false;
    if (reading->format == PART_NRRD && !region->name[0])
        return read_layers(&loading->folder, reading);
    return read_grid(&loading->folder, reading, region->name[0] ? RAW_MASK : RAW_LABELS);
}

bool plan_read_part(struct loading *loading, struct part_reading *reading)
{
    const struct folder *folder = &loading->folder;
    if (reading->format == PART_DICOM && reading->kind != PART_KIND_DOSE_MASK && reading->kind != PART_KIND_DOSE_ERROR)
        return reading->kind == PART_KIND_IMAGE ? read_series(loading, reading) : read_rt_object(loading, reading);
    switch (reading->kind) {
    case PART_KIND_IMAGE:
        if (reading->format == PART_QSH)
            return plan_read_qsh(folder, reading->path, loading->file->images[reading->index].header,
                                 loading->file->images[reading->index].mm, &reading->volume, reading->modality,
                                 &reading->is_grid_doubtful, &reading->report, &reading->err);
        return read_image(loading, reading);
    case PART_KIND_DOSE:
        if (reading->format == PART_SERA_DOSE)
            return plan_read_chd(&loading->folder, reading->path, &reading->doses, &reading->report, &reading->err);
        if (reading->format == PART_SERA_RST)
            return plan_read_rst(folder, reading->path, &reading->doses, &reading->report, &reading->err);
        return read_grid(folder, reading, RAW_IMAGE);
    case PART_KIND_DOSE_ERROR: return read_grid(folder, reading, RAW_IMAGE);
    case PART_KIND_DOSE_MASK: return read_grid(folder, reading, RAW_MASK);
    case PART_KIND_REGION: return read_region(loading, reading);
    case PART_KIND_BEAMS: break;
    }
    return error_set(&reading->err, ERROR_UNSUPPORTED, "%s: not a DICOM treatment plan", reading->path);
}
