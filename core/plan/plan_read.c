#include "core/base/mem.h"
#include "core/formats/nifti.h"
#include "core/plan/plan_loading.h"
#include "core/plan/plan_nrrd.h"

static bool read_grid(const struct folder *folder, struct job *job, enum raw_use use)
{
    struct bytes bytes;
    if (job->format == PART_NRRD) {
        job->volume = plan_nrrd_read(folder, job->path, use, &job->report, &job->err);
        return job->volume != NULL;
    }
    if (!folder_read(folder, job->path, DATA_FILE_MAX_BYTES, UINT64_MAX, &bytes, &job->err))
        return false;
    job->volume = nifti_read(&bytes, job->path, use, &job->report, &job->err);
    bytes_free(&bytes);
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
    return is_read;
}

bool plan_read_part(const struct loading *loading, struct job *job)
{
    const struct plan_file_region *region = &loading->file->regions[job->index];
    switch (job->kind) {
    case JOB_IMAGE:
        if (job->format == PART_QSH)
            return plan_read_qsh(&loading->folder, job->path, loading->file->images[job->index].header,
                                 loading->file->images[job->index].mm, &job->volume, job->modality, &job->is_grid_doubtful,
                                  &job->report, &job->err);
        return read_grid(&loading->folder, job, RAW_IMAGE);
    case JOB_DOSE:
        if (job->format == PART_SERA_DOSE)
            return plan_read_chd(&loading->folder, job->path, &job->doses, &job->report, &job->err);
        if (job->format == PART_SERA_RST)
            return plan_read_rst(&loading->folder, job->path, &job->doses, &job->report, &job->err);
        return read_grid(&loading->folder, job, RAW_IMAGE);
    case JOB_DOSE_MASK: return read_grid(&loading->folder, job, RAW_MASK);
    case JOB_REGION:
        if (job->format == PART_UVH)
            return plan_read_univels(&loading->folder, job->path, region->mm, &job->uvh, &job->volume, &job->report, &job->err);
        if (job->format == PART_NRRD && !region->name[0])
            return read_names(&loading->folder, region->names, job) && read_layers(&loading->folder, job);
        return read_names(&loading->folder, region->names, job) &&
               read_grid(&loading->folder, job, region->name[0] ? RAW_MASK : RAW_LABELS);
    }
    return false;
}
