#include <stdlib.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/plan/plan_loading.h"

static bool refuse_format(const char *path, enum part_format format, struct error *err)
{
    if (format == PART_ABSENT)
        return error_set(err, ERROR_NOT_FOUND, "%s: there is no such file in the plan's folder", path);
    if (format == PART_UNKNOWN)
        return error_set(err, ERROR_UNSUPPORTED, "%s: the format is not one that this version reads", path);
    return error_set(err, ERROR_UNSUPPORTED, "%s: %s is not read here by this version", path, part_format_word(format));
}

static void add_job(struct loading *loading, enum job_kind kind, size_t index, size_t component, const char *path)
{
    struct job *job = &loading->jobs[loading->n_jobs++];
    job->kind = kind;
    job->index = index;
    job->component = component;
    job->path = path;
    job->format = part_format_of(&loading->folder, path);
    folder_look(&loading->folder, path, &job->bytes);
    loading->n_bytes += job->bytes;
}

/* A dose this version cannot read is left out, and said; images and regions are not. */
static bool dose_is_readable(struct loading *loading, const struct plan_file_dose *dose, bool *is_readable, struct error *err)
{
    *is_readable = true;
    for (size_t c = 0; c < dose->n_components; c++) {
        const char *path = dose->components[c].path;
        enum part_format format = part_format_of(&loading->folder, path);
        if (format == PART_ABSENT)
            return refuse_format(path, format, err);
        if (format == PART_NIFTI || format == PART_NRRD || part_is_sera_dose(format))
            continue;
        report_add(&loading->plan->report, REPORT_WARNING, "dose.unsupported", path,
                   "The dose \"%s\" is in a format (%s) that this version does not read; the plan is shown without it.", dose->id,
                   part_format_word(format));
        *is_readable = false;
        return true;
    }
    return true;
}

bool plan_make_jobs(struct loading *loading, struct error *err)
{
    const struct plan_file *file = loading->file;
    size_t most = file->n_images + file->n_regions + file->n_doses * (DOSE_N_QUANTITIES + 1);
    loading->jobs = mem_new((most + 1) * sizeof *loading->jobs);
    for (size_t i = 0; i < file->n_images; i++) {
        enum part_format format = part_format_of(&loading->folder, file->images[i].path);
        if (format != PART_NIFTI && format != PART_NRRD && format != PART_QSH)
            return refuse_format(file->images[i].path, format, err);
        add_job(loading, JOB_IMAGE, i, 0, file->images[i].path);
    }
    for (size_t i = 0; i < file->n_regions; i++) {
        enum part_format format = part_format_of(&loading->folder, file->regions[i].path);
        if (format != PART_NIFTI && format != PART_NRRD && format != PART_UVH)
            return refuse_format(file->regions[i].path, format, err);
        add_job(loading, JOB_REGION, i, 0, file->regions[i].path);
    }
    for (size_t i = 0; i < file->n_doses; i++) {
        bool is_readable;
        if (!dose_is_readable(loading, &file->doses[i], &is_readable, err))
            return false;
        for (size_t c = 0; is_readable && c < file->doses[i].n_components; c++)
            add_job(loading, JOB_DOSE, i, c, file->doses[i].components[c].path);
        if (is_readable && file->doses[i].mask[0])
            add_job(loading, JOB_DOSE_MASK, i, 0, file->doses[i].mask);
    }
    return true;
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
            loading_phase(loading, "reading", job->path, 5, 80);
        if (!plan_read_part(loading, job)) {
            job->is_failed = true;
            size_t before = atomic_load(&loading->first_failed);
            while (at < before && !atomic_compare_exchange_weak(&loading->first_failed, &before, at)) {
            }
        }
        loading_work(loading, job->bytes);
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
    for (size_t i = 0; i < loading->n_jobs; i++)
        report_move(&loading->plan->report, &loading->jobs[i].report);
    return true;
}
