#include <stdio.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/load/loading.h"
#include "core/load/nifti_parts.h"
#include "core/load/nrrd_parts.h"

static bool read_grid(const struct folder *folder, struct job *job, enum raw_use use)
{
    job->volume = job->format == PART_NRRD ? plan_nrrd_read(folder, job->path, use, &job->report, &job->err)
                                           : plan_nifti_read(folder, job->path, use, &job->report, &job->err);
    return job->volume != NULL;
}

static bool read_layers(const struct folder *folder, struct job *job)
{
    job->layers = mem_new(sizeof *job->layers);
    return plan_nrrd_read_layers(folder, job->path, job->layers, &job->report, &job->err);
}

static bool read_names(const struct folder *folder, const char *path, struct job *job)
{
    struct bytes bytes;
    if (!path[0])
        return true;
    if (!folder_read(folder, path, TEXT_FILE_MAX_BYTES, UINT64_MAX, &bytes, &job->err))
        return false;
    bool is_read = label_names_parse(bytes.data, bytes.size, path, &job->names, &job->err);
    bytes_free(&bytes);
    if (is_read && job->names.file[0] && strcmp(part_base_name(job->names.file), part_base_name(job->path)) != 0)
        report_add(&job->report, REPORT_WARNING, "region.names-elsewhere", job->path,
                   "The list of names, %.120s, says that it belongs to %.120s; "
                   "it was used as the plan says.",
                   path, job->names.file);
    return is_read;
}

/* A reader of DICOM tells how far it is; one call at a time. */
static void slices_done(void *context, size_t n_done, size_t n_all)
{
    struct job *job = context;
    uint64_t told = n_all ? (uint64_t)((double)job->bytes * (double)n_done / (double)n_all) : 0;
    if (told <= job->bytes_told || told > job->bytes)
        return;
    loading_work(job->loading, told - job->bytes_told);
    job->bytes_told = told;
}

static bool read_series(struct loading *loading, struct job *job)
{
    const struct dicom_progress progress = { slices_done, job, &loading->is_given_up, 0 };
    const struct dicom_index *index = loading->parts.dicom;
    job->volume =
        dicom_series_read(&loading->folder, index, (size_t)job->stack, &progress, &job->facts, &job->report, &job->err);
    snprintf(job->modality, sizeof job->modality, "%.15s", index->stacks[job->stack].modality);
    return job->volume != NULL;
}

/* A structure set, a segmentation, a dose or a treatment plan. */
static bool read_rt_object(const struct loading *loading, struct job *job)
{
    struct plan_dicom_file opened;
    if (!plan_dicom_open(&loading->folder, job->path, &opened, &job->err))
        return false;
    bool is_read = false;
    const struct dicom_object *object = plan_dicom_object(loading->parts.dicom, DICOM_KIND_SEGMENTATION, job->path, 0);
    if (job->kind == JOB_REGION && object) {
        job->layers = mem_new(sizeof *job->layers);
        is_read = dicom_seg_read(opened.file, job->path, loading->file->regions[job->index].name, job->layers,
                                 &job->report, &job->err);
    } else if (job->kind == JOB_REGION)
        is_read = (job->structs = rtstruct_read(opened.file, job->path, &job->report, &job->err)) != NULL;
    else if (job->kind == JOB_DOSE)
        is_read = rtdose_read(opened.file, job->path, &job->rtdose, &job->report, &job->err);
    else
        is_read = (job->rtplan = rtplan_read(opened.file, job->path, &job->report, &job->err)) != NULL;
    plan_dicom_close(&opened);
    return is_read;
}

static bool read_region(const struct loading *loading, struct job *job)
{
    const struct plan_file_region *region = &loading->file->regions[job->index];
    if (job->format == PART_UVH)
        return plan_read_univels(&loading->folder, job->path, region->mm, &job->uvh, &job->volume, &job->report,
                                 &job->err);
    if (!read_names(&loading->folder, region->names, job))
        return false;
    if (job->format == PART_NRRD && !region->name[0])
        return read_layers(&loading->folder, job);
    return read_grid(&loading->folder, job, region->name[0] ? RAW_MASK : RAW_LABELS);
}

bool plan_read_part(struct loading *loading, struct job *job)
{
    const struct folder *folder = &loading->folder;
    if (job->format == PART_DICOM && job->kind != JOB_DOSE_MASK)
        return job->kind == JOB_IMAGE ? read_series(loading, job) : read_rt_object(loading, job);
    switch (job->kind) {
    case JOB_IMAGE:
        if (job->format == PART_QSH)
            return plan_read_qsh(folder, job->path, loading->file->images[job->index].header,
                                 loading->file->images[job->index].mm, &job->volume, job->modality,
                                 &job->is_grid_doubtful, &job->report, &job->err);
        return read_grid(folder, job, RAW_IMAGE);
    case JOB_DOSE:
        if (job->format == PART_SERA_DOSE)
            return plan_read_chd(&loading->folder, job->path, &job->doses, &job->report, &job->err);
        if (job->format == PART_SERA_RST)
            return plan_read_rst(folder, job->path, &job->doses, &job->report, &job->err);
        return read_grid(folder, job, RAW_IMAGE);
    case JOB_DOSE_MASK: return read_grid(folder, job, RAW_MASK);
    case JOB_REGION: return read_region(loading, job);
    case JOB_BEAMS: break;
    }
    return error_set(&job->err, ERROR_UNSUPPORTED, "%s: not a DICOM treatment plan", job->path);
}
