#include <stdlib.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/load/loading.h"
#include "core/load/nifti_parts.h"

static bool refuse_format(const char *path, enum part_format format, struct error *err)
{
    if (format == PART_ABSENT)
        return error_set(err, ERROR_NOT_FOUND, "%s: there is no such file in the plan's folder", path);
    if (format == PART_UNKNOWN)
        return error_set(err, ERROR_UNSUPPORTED, "%s: the format is not one that this version reads", path);
    return error_set(err, ERROR_UNSUPPORTED, "%s: %s is not read here by this version", path, part_format_word(format));
}

static struct job *add_job(struct loading *loading, enum job_kind kind, size_t index, size_t component,
                           const char *path, enum part_format format)
{
    struct job *job = &loading->jobs[loading->n_jobs++];
    job->kind = kind;
    job->index = index;
    job->component = component;
    job->path = path;
    job->loading = loading;
    job->format = format;
    char voxels[FOLDER_NAME_SIZE];
    plan_nifti_voxels(&loading->folder, path, voxels);
    folder_look(&loading->folder, voxels[0] ? voxels : path, &job->bytes);
    return job;
}

/* A job for each object of the kind at or below the path; returns how many. */
static size_t add_dicom_jobs(struct loading *loading, enum job_kind kind, enum dicom_kind of, size_t index,
                             size_t component, const char *path, size_t most)
{
    const struct dicom_object *object;
    size_t n = 0;
    for (; n < most && (object = plan_dicom_object(loading->parts.dicom, of, path, n)); n++)
        add_job(loading, kind, index, component, object->path, PART_DICOM); /* whatever the file is called */
    return n;
}

static bool refuse_dicom(const struct loading *loading, const char *path, const char *what, struct error *err)
{
    const struct dicom_object *other = plan_dicom_object(loading->parts.dicom, DICOM_KIND_OTHER, path, 0);
    return error_set(err, ERROR_UNSUPPORTED, "%s: no DICOM %s that can be used%s%s", path, what, other ? ": " : "",
                     other ? other->reason : "");
}

static bool add_image_job(struct loading *loading, size_t i, struct error *err)
{
    const char *path = loading->file->images[i].path;
    enum part_format format = part_format_of(&loading->folder, path);
    if (format != PART_NIFTI && format != PART_NRRD && format != PART_QSH && format != PART_DICOM)
        return refuse_format(path, format, err);
    struct job *job = add_job(loading, JOB_IMAGE, i, 0, path, format);
    if (format != PART_DICOM)
        return true;
    job->stack = plan_dicom_stack(loading->parts.dicom, path);
    if (job->stack < 0)
        return refuse_dicom(loading, path, "image series", err);
    const struct dicom_stack *stack = &loading->parts.dicom->stacks[job->stack];
    job->bytes = 0;
    for (size_t at = 0; at < stack->n_objects; at++)
        job->bytes += loading->parts.dicom->objects[stack->objects[at]].n_bytes;
    return true;
}

static bool add_region_jobs(struct loading *loading, size_t i, struct error *err)
{
    const char *path = loading->file->regions[i].path;
    enum part_format format = part_format_of(&loading->folder, path);
    if (format == PART_DICOM)
        return add_dicom_jobs(loading, JOB_REGION, DICOM_KIND_STRUCT, i, 0, path, PLAN_FILE_MAX_PARTS) +
                       add_dicom_jobs(loading, JOB_REGION, DICOM_KIND_SEGMENTATION, i, 0, path, PLAN_FILE_MAX_PARTS) >
                   0 ||
               refuse_dicom(loading, path, "structure set or segmentation", err);
    if (format != PART_NIFTI && format != PART_NRRD && format != PART_UVH)
        return refuse_format(path, format, err);
    add_job(loading, JOB_REGION, i, 0, path, format);
    return true;
}

/* A dose this version cannot read is left out, and said; images and regions are not. */
static bool dose_is_readable(struct loading *loading, const struct plan_file_dose *dose, bool *is_readable,
                             struct error *err)
{
    *is_readable = true;
    for (size_t c = 0; c < dose->n_components; c++) {
        const char *path = dose->components[c].path;
        enum part_format format = part_format_of(&loading->folder, path);
        if (format == PART_ABSENT)
            return refuse_format(path, format, err);
        if (format == PART_NIFTI || format == PART_NRRD || part_is_sera_dose(format) || format == PART_DICOM)
            continue;
        report_add(&loading->plan->report, REPORT_WARNING, "dose.unsupported", path,
                   "The dose \"%s\" is in a format (%s) that this version does not read; the plan is shown without it.",
                   dose->id, part_format_word(format));
        *is_readable = false;
        return true;
    }
    return true;
}

static bool add_dose_jobs(struct loading *loading, size_t i, struct error *err)
{
    const struct plan_file_dose *dose = &loading->file->doses[i];
    bool is_readable;
    if (!dose_is_readable(loading, dose, &is_readable, err))
        return false;
    for (size_t c = 0; is_readable && c < dose->n_components; c++) {
        const char *path = dose->components[c].path;
        size_t most = dose->n_components > 1 ? 1 : PLAN_DICOM_MAX_DOSES; /* a component is one object */
        enum part_format format = part_format_of(&loading->folder, path);
        if (format != PART_DICOM)
            add_job(loading, JOB_DOSE, i, c, path, format);
        else if (add_dicom_jobs(loading, JOB_DOSE, DICOM_KIND_DOSE, i, c, path, most) == 0)
            return refuse_dicom(loading, path, "dose", err);
    }
    if (is_readable && dose->mask[0])
        add_job(loading, JOB_DOSE_MASK, i, 0, dose->mask, part_format_of(&loading->folder, dose->mask));
    return true;
}

bool plan_make_jobs(struct loading *loading, struct error *err)
{
    const struct plan_file *file = loading->file;
    const struct plan_parts *parts = &loading->parts;
    size_t n_objects = parts->dicom ? parts->dicom->n_objects : 0;
    /* an entry of plan.json that names a folder may stand for many files, and two entries for the same */
    size_t most = file->n_images + file->n_regions * (2 + n_objects) +
                  file->n_doses * (DOSE_N_QUANTITIES + 1 + PLAN_DICOM_MAX_DOSES) + PLAN_DICOM_MAX_DOSES +
                  (file->n_beam_files + 1) * PLAN_DICOM_MAX_PLANS;
    bool is_made = true;
    loading->jobs = mem_array(most + 1, sizeof *loading->jobs, UINT32_MAX, err);
    if (!loading->jobs)
        return false;
    for (size_t i = 0; is_made && i < file->n_images; i++)
        is_made = add_image_job(loading, i, err);
    for (size_t i = 0; is_made && i < file->n_regions; i++)
        is_made = add_region_jobs(loading, i, err);
    for (size_t i = 0; is_made && i < file->n_doses; i++)
        is_made = add_dose_jobs(loading, i, err);
    for (size_t i = 0; is_made && i < file->n_beam_files; i++)
        is_made = add_dicom_jobs(loading, JOB_BEAMS, DICOM_KIND_PLAN, i, 0, file->beam_files[i].path,
                                 PLAN_DICOM_MAX_PLANS) > 0 ||
                  refuse_dicom(loading, file->beam_files[i].path, "treatment plan", err);
    if (is_made && parts->is_all_dicom) {
        add_dicom_jobs(loading, JOB_DOSE, DICOM_KIND_DOSE, JOB_OF_NO_ENTRY, 0, "", PLAN_DICOM_MAX_DOSES);
        add_dicom_jobs(loading, JOB_BEAMS, DICOM_KIND_PLAN, JOB_OF_NO_ENTRY, 0, "", PLAN_DICOM_MAX_PLANS);
    }
    for (size_t i = 0; i < loading->n_jobs; i++)
        loading->n_bytes += loading->jobs[i].bytes;
    return is_made;
}

static void order_jobs(struct loading *loading)
{
    loading->order = mem_new((loading->n_jobs + 1) * sizeof *loading->order);
    for (size_t i = 0; i < loading->n_jobs; i++) {
        size_t at = i;
        for (; at > 0 && loading->jobs[loading->order[at - 1]].bytes < loading->jobs[i].bytes; at--)
            loading->order[at] = loading->order[at - 1];
        loading->order[at] = i;
    }
}

/* Nobody said that this file belongs to the plan, so what is wrong with it need not keep the rest from being seen; it
 * is said. */
static bool may_be_left_out(const struct loading *loading, const struct job *job)
{
    return loading->parts.is_all_dicom && job->format == PART_DICOM &&
           (job->err.code == ERROR_FORMAT || job->err.code == ERROR_UNSUPPORTED || job->err.code == ERROR_RANGE);
}

/* Takes failed jobs out of the list. errors: the first one's, when nothing is left */
static bool leave_out_failed(struct loading *loading, struct error *err)
{
    const struct error *first = NULL;
    size_t n_read = 0;
    for (size_t i = 0; i < loading->n_jobs; i++) {
        struct job *job = &loading->jobs[i];
        n_read += !job->is_failed;
        if (!job->is_failed)
            continue;
        first = first ? first : &job->err;
        report_add(&loading->plan->report, REPORT_ERROR, "dicom.unreadable", job->path, "Left out: %s", job->err.text);
    }
    if (n_read == 0 && first && err)
        *err = *first;
    return n_read > 0 || !first;
}

/* A series is named as people know it, not by the first of its files. */
static const char *name_of(const struct loading *loading, const struct job *job)
{
    if (job->kind == JOB_IMAGE && job->format == PART_DICOM && loading->file->images[job->index].name[0])
        return loading->file->images[job->index].name;
    return job->path;
}

static void work(void *context, int part, int n_parts)
{
    (void)n_parts;
    struct loading *loading = context;
    for (;;) {
        size_t turn = atomic_fetch_add(&loading->next, 1);
        if (turn >= loading->n_jobs || loading_is_cancelled(loading))
            return;
        size_t at = loading->order[turn];
        struct job *job = &loading->jobs[at];
        /* Once a part has failed only those before it matter: the first in the plan's order is the one reported. */
        if (at > atomic_load(&loading->first_failed))
            continue;
        if (part == 0)
            loading_phase(loading, "reading", name_of(loading, job), 5, 80);
        if (!plan_read_part(loading, job))
            job->is_failed = true;
        if (job->is_failed && !may_be_left_out(loading, job)) {
            size_t before = atomic_load(&loading->first_failed);
            while (at < before && !atomic_compare_exchange_weak(&loading->first_failed, &before, at)) {
            }
        }
        loading_work(loading, job->bytes - job->bytes_told);
    }
}

bool plan_run_jobs(struct loading *loading, struct error *err)
{
    order_jobs(loading);
    atomic_init(&loading->next, 0);
    atomic_init(&loading->first_failed, SIZE_MAX);
    loading_begin(loading, loading->n_bytes);
    int n_threads = parallel_cores();
    if ((size_t)n_threads > loading->n_jobs)
        n_threads = (int)loading->n_jobs;
    parallel_run(n_threads, work, loading);
    if (loading_is_cancelled(loading))
        return error_set(err, ERROR_CANCELLED, "loading was cancelled");
    size_t failed = atomic_load(&loading->first_failed);
    if (failed != SIZE_MAX) {
        if (err)
            *err = loading->jobs[failed].err;
        return false;
    }
    if (!leave_out_failed(loading, err))
        return false;
    for (size_t i = 0; i < loading->n_jobs; i++)
        report_move(&loading->plan->report, &loading->jobs[i].report);
    return true;
}
