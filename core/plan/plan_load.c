#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/formats/hierarchy.h"
#include "core/formats/nifti.h"
#include "core/formats/text.h"
#include "core/plan/plan_bounds.h"
#include "core/plan/plan_meshes.h"
#include "core/plan/plan_nrrd.h"
#include "core/plan/plan_parts.h"
#include "core/plan/plan_regions.h"
#include "core/plan/plan_sera.h"
#include "core/plan/plan_tracks.h"
#include "core/plan/plan_window.h"

enum { TEXT_FILE_MAX_BYTES = 16 << 20 };
#define DATA_FILE_MAX_BYTES (VOLUME_MAX_BYTES + (1 << 20))

/* One file to read, by any thread; what it gave waits here until all are read. */
enum job_kind { JOB_IMAGE, JOB_REGION, JOB_DOSE, JOB_DOSE_MASK };
struct job {
    enum job_kind kind;
    size_t index, component; /* into the plan file */
    const char *path;
    uint64_t bytes; /* of the file, for order and progress */
    enum part_format format;
    struct volume *volume;
    struct nrrd_layers *layers; /* of a NRRD label map, instead of volume */
    struct volume *doses[RST_N_DOSES]; /* of a SERA dose, instead of volume */
    struct uvh uvh;
    struct label_names names;
    char modality[16];     /* as a .qhd says it */
    bool is_grid_doubtful; /* a .qhd that describes another image */
    struct report report;
    struct error err;
    bool is_failed;
};

struct loading {
    struct plan *plan;
    struct folder folder;
    struct plan_file *file;
    struct job *jobs; /* in the plan's order */
    size_t *order;    /* largest first */
    size_t n_jobs;
    uint64_t n_bytes;
    atomic_size_t next, first_failed;
    atomic_uint_fast64_t bytes_done;
    const struct plan_progress *progress;
};

static bool is_cancelled(const struct loading *loading)
{
    return loading->progress && loading->progress->cancel && atomic_load(loading->progress->cancel);
}

static void tell(const struct loading *loading, const char *what, const char *name, double percent)
{
    if (!loading->progress || !loading->progress->step)
        return;
    char phase[96];
    snprintf(phase, sizeof phase, "%s%s%.80s", what, name[0] ? " " : "", name);
    loading->progress->step(loading->progress->context, phase, percent);
}

/* ---- what is to be read --------------------------------------------------------------------------------------------- */

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
        if (format == PART_NIFTI || format == PART_NRRD || format == PART_SERA_RST)
            continue;
        report_add(&loading->plan->report, REPORT_WARNING, "dose.unsupported", path,
                   "The dose \"%s\" is in a format (%s) that this version does not read; the plan is shown without it.", dose->id,
                   part_format_word(format));
        *is_readable = false;
        return true;
    }
    return true;
}

static bool make_jobs(struct loading *loading, struct error *err)
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

/* ---- reading, in several threads ------------------------------------------------------------------------------------ */

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

static bool run_job(const struct loading *loading, struct job *job)
{
    const struct plan_file_region *region = &loading->file->regions[job->index];
    switch (job->kind) {
    case JOB_IMAGE:
        if (job->format == PART_QSH)
            return plan_read_qsh(&loading->folder, job->path, loading->file->images[job->index].header, &job->volume, job->modality,
                                 &job->is_grid_doubtful, &job->report, &job->err);
        return read_grid(&loading->folder, job, RAW_IMAGE);
    case JOB_DOSE:
        if (job->format == PART_SERA_RST)
            return plan_read_rst(&loading->folder, job->path, job->doses, &job->report, &job->err);
        return read_grid(&loading->folder, job, RAW_IMAGE);
    case JOB_DOSE_MASK: return read_grid(&loading->folder, job, RAW_MASK);
    case JOB_REGION:
        if (job->format == PART_UVH)
            return plan_read_univels(&loading->folder, job->path, &job->uvh, &job->volume, &job->report, &job->err);
        if (job->format == PART_NRRD && !region->name[0])
            return read_names(&loading->folder, region->names, job) && read_layers(&loading->folder, job);
        return read_names(&loading->folder, region->names, job) &&
               read_grid(&loading->folder, job, region->name[0] ? RAW_MASK : RAW_LABELS);
    }
    return false;
}

static void work(void *context, int part, int n_parts)
{
    (void)n_parts;
    struct loading *loading = context;
    for (;;) {
        size_t turn = atomic_fetch_add(&loading->next, 1);
        if (turn >= loading->n_jobs || is_cancelled(loading))
            return;
        size_t at = loading->order[turn];
        struct job *job = &loading->jobs[at];
        /* Once a part has failed only those before it matter: the first in the plan's order is the one reported. */
        if (at > atomic_load(&loading->first_failed))
            continue;
        if (part == 0)
            tell(loading, "reading", job->path,
                 80.0 * (double)atomic_load(&loading->bytes_done) / (double)(loading->n_bytes + 1));
        if (!run_job(loading, job)) {
            job->is_failed = true;
            size_t before = atomic_load(&loading->first_failed);
            while (at < before && !atomic_compare_exchange_weak(&loading->first_failed, &before, at)) {
            }
        }
        atomic_fetch_add(&loading->bytes_done, job->bytes);
    }
}

static bool read_parts(struct loading *loading, struct error *err)
{
    order_jobs(loading);
    atomic_init(&loading->next, 0);
    atomic_init(&loading->first_failed, SIZE_MAX);
    atomic_init(&loading->bytes_done, 0);
    int n_threads = parallel_cores();
    if ((size_t)n_threads > loading->n_jobs)
        n_threads = (int)loading->n_jobs;
    parallel_run(n_threads, work, loading);
    if (is_cancelled(loading))
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

/* ---- putting it together ---------------------------------------------------------------------------------------------- */

static struct volume *take_volume(struct job *job)
{
    struct volume *volume = job->volume;
    job->volume = NULL;
    return volume;
}

/* An id that may stand in a URL: from what the plan gives, else from the file's name; unique among those before. */
static void make_id(char id[64], const char *given, const char *path, const char *const *others, size_t n_others)
{
    const struct region_set none = { 0 };
    const char *slash = strrchr(path, '/');
    const char *base = slash ? slash + 1 : path;
    char stem[128];
    size_t length = strcspn(base, ".");
    snprintf(stem, sizeof stem, "%.*s", (int)(length < 100 ? length : 100), base);
    region_make_id(&none, given[0] ? given : stem, id);
    size_t n = strlen(id);
    bool is_taken = true;
    for (int number = 1; is_taken; number++) {
        if (number > 1)
            snprintf(id + n, 64 - n, "-%d", number);
        is_taken = false;
        for (size_t i = 0; i < n_others; i++)
            is_taken |= strcmp(others[i], id) == 0;
    }
}

static void add_image(struct loading *loading, struct job *job)
{
    struct plan *plan = loading->plan;
    const struct plan_file_image *entry = &loading->file->images[job->index];
    struct plan_image *image = &plan->images[plan->n_images];
    const char *others[PLAN_MAX_IMAGES];
    for (size_t i = 0; i < plan->n_images; i++)
        others[i] = plan->images[i].id;
    make_id(image->id, entry->id, entry->path, others, plan->n_images);
    plan->n_images++;
    snprintf(image->modality, sizeof image->modality, "%s", entry->modality[0] ? entry->modality : job->modality);
    image->volume = take_volume(job);
    if (text_equal(image->modality, "CT")) {
        snprintf(image->unit, sizeof image->unit, "HU");
        if (image->volume->low >= 0 && image->volume->high > 0)
            report_add(&plan->report, REPORT_WARNING, "image.hu-doubtful", entry->path,
                       "The CT's values run from %g to %g; HU of a patient begin below 0.", image->volume->low, image->volume->high);
    }
    plan_image_window(image);
}

/* An image whose header described another one: univels with exactly as many voxels along each axis are the same scan. */
static void borrow_grid(struct loading *loading, const struct job *job)
{
    struct plan *plan = loading->plan;
    struct volume *volume = plan->images[job->index].volume;
    for (size_t i = 0; job->is_grid_doubtful && i < loading->n_jobs; i++) {
        const struct job *other = &loading->jobs[i];
        if (!other->uvh.bodies || memcmp(other->uvh.grid.size, volume->grid.size, sizeof volume->grid.size) != 0)
            continue;
        volume->grid = other->uvh.grid;
        report_add(&plan->report, REPORT_WARNING, "geometry.borrowed", job->path,
                   "The image's header describes another image; %s has as many univels as this has pixels, and its grid was taken.",
                   other->path);
        return;
    }
}

static bool add_regions(struct loading *loading, struct region_builder *builder, struct job *job, struct error *err)
{
    const struct plan_file_region *entry = &loading->file->regions[job->index];
    for (size_t i = 0; job->layers && i < job->layers->n; i++) {
        struct volume *layer = job->layers->volumes[i];
        job->layers->volumes[i] = NULL;
        if (!region_builder_add_labels(builder, layer, job->names.n > 0 ? &job->names : &job->layers->names[i], job->path, err))
            return false;
    }
    if (job->layers)
        return true;
    struct volume *volume = take_volume(job);
    if (job->uvh.bodies)
        return region_builder_add_univels(builder, volume, &job->uvh, job->path, err);
    if (entry->name[0])
        return region_builder_add_mask(builder, volume, entry, err);
    return region_builder_add_labels(builder, volume, &job->names, job->path, err);
}

static struct dose *find_dose(struct loading *loading, size_t index, bool is_sera)
{
    struct plan *plan = loading->plan;
    const struct plan_file_dose *entry = &loading->file->doses[index];
    const char *others[PLAN_MAX_DOSES];
    char id[64];
    for (size_t i = 0; i < plan->n_doses; i++)
        others[i] = plan->doses[i].id;
    make_id(id, entry->id, entry->components[0].path, others, plan->n_doses);
    struct dose *dose = &plan->doses[plan->n_doses++];
    memcpy(dose->id, id, sizeof dose->id);
    plan_dose_units(dose, entry, is_sera, &plan->report);
    return dose;
}

static void add_component(struct loading *loading, struct dose *dose, struct job *job)
{
    const struct plan_file_dose *entry = &loading->file->doses[job->index];
    if (job->format == PART_SERA_RST)
        plan_add_rst(dose, entry, job->component, job->doses, &loading->plan->report);
    else
        plan_add_component(dose, entry, job->component, take_volume(job), &loading->plan->report);
}

static void add_doses(struct loading *loading)
{
    struct dose *dose = NULL;
    size_t current = SIZE_MAX;
    for (size_t i = 0; i < loading->n_jobs; i++) {
        struct job *job = &loading->jobs[i];
        if (job->kind != JOB_DOSE && job->kind != JOB_DOSE_MASK)
            continue;
        if (job->index != current)
            dose = find_dose(loading, job->index, job->format == PART_SERA_RST);
        current = job->index;
        if (job->kind == JOB_DOSE) {
            add_component(loading, dose, job);
            continue;
        }
        dose->mask = take_volume(job);
        if (memcmp(dose->mask->grid.size, dose->components[0].values->grid.size, sizeof dose->mask->grid.size) != 0)
            report_add(&loading->plan->report, REPORT_NOTE, "dose.mask-grid", job->path,
                       "The mask of the dose \"%s\" lies on another grid; it is looked up by position.", dose->id);
    }
}

static bool apply_hierarchy(struct loading *loading, const struct region_builder *builder, struct error *err)
{
    struct plan *plan = loading->plan;
    const struct plan_file *file = loading->file;
    if (file->hierarchy[0]) {
        struct bytes bytes;
        if (!folder_read(&loading->folder, file->hierarchy, TEXT_FILE_MAX_BYTES, UINT64_MAX, &bytes, err))
            return false;
        struct plan_file_pair *pairs = mem_new(PLAN_FILE_MAX_PAIRS * sizeof *pairs);
        size_t n = hierarchy_parse(bytes.data, bytes.size, file->hierarchy, pairs, PLAN_FILE_MAX_PAIRS, &plan->report);
        bytes_free(&bytes);
        region_set_apply_pairs(&plan->regions, pairs, n, false, file->hierarchy, &plan->report);
        free(pairs);
    } else if (file->n_pairs > 0) {
        region_set_apply_pairs(&plan->regions, file->pairs, file->n_pairs, true, "plan.json", &plan->report);
    } else if (builder->n_pairs > 0) {
        region_set_apply_pairs(&plan->regions, builder->pairs, builder->n_pairs, true, "", &plan->report);
    }
    if (plan->regions.hierarchy == HIERARCHY_NONE) {
        region_set_derive_hierarchy(&plan->regions);
        if (plan->regions.hierarchy == HIERARCHY_DERIVED)
            report_add(&plan->report, REPORT_NOTE, "hierarchy.derived", "",
                       "No file says what lies inside what; the tree was derived from which region encloses which.");
    }
    return true;
}

static void note_empty_regions(struct plan *plan)
{
    for (size_t i = 0; i < plan->regions.n_regions; i++)
        if (plan->regions.regions[i].n_voxels == 0)
            report_add(&plan->report, REPORT_WARNING, "region.empty", "", "The region \"%s\" has no voxel.", plan->regions.regions[i].name);
}

static void add_beams(struct loading *loading)
{
    struct plan *plan = loading->plan;
    for (size_t i = 0; i < loading->file->n_beams; i++) {
        const char *others[PLAN_MAX_BEAMS];
        for (size_t b = 0; b < plan->n_beams; b++)
            others[b] = plan->beams[b].id;
        plan->beams[i] = loading->file->beams[i];
        make_id(plan->beams[i].id, loading->file->beams[i].id, "beam", others, plan->n_beams);
        plan->n_beams++;
    }
}

static bool assemble(struct loading *loading, struct error *err)
{
    struct plan *plan = loading->plan;
    struct region_builder builder;
    bool is_whole = true;
    tell(loading, "measuring regions", "", 80);
    region_builder_init(&builder, &plan->regions, &plan->report);
    for (size_t i = 0; is_whole && i < loading->n_jobs; i++) {
        struct job *job = &loading->jobs[i];
        if (job->kind == JOB_IMAGE)
            add_image(loading, job);
        else if (job->kind == JOB_REGION)
            is_whole = add_regions(loading, &builder, job, err);
    }
    for (size_t i = 0; i < loading->n_jobs; i++)
        if (is_whole && loading->jobs[i].kind == JOB_IMAGE)
            borrow_grid(loading, &loading->jobs[i]);
    if (is_whole) {
        region_set_measure(&plan->regions);
        note_empty_regions(plan);
        is_whole = apply_hierarchy(loading, &builder, err);
    }
    region_builder_finish(&builder);
    if (!is_whole)
        return false;
    add_doses(loading);
    plan_measure_bounds(plan);
    add_beams(loading);
    return plan_add_tracks(plan, &loading->folder, loading->file, err);
}

static void finish_loading(struct loading *loading)
{
    for (size_t i = 0; i < loading->n_jobs; i++) {
        volume_unref(loading->jobs[i].volume);
        for (size_t d = 0; d < RST_N_DOSES; d++)
            volume_unref(loading->jobs[i].doses[d]);
        if (loading->jobs[i].layers)
            nrrd_layers_finish(loading->jobs[i].layers);
        free(loading->jobs[i].layers);
        uvh_finish(&loading->jobs[i].uvh);
        label_names_finish(&loading->jobs[i].names);
        report_finish(&loading->jobs[i].report);
    }
    free(loading->jobs);
    free(loading->order);
    plan_file_destroy(loading->file);
    folder_close(&loading->folder);
}

struct plan *plan_load(const char *folder, const char *id, const struct plan_progress *progress, struct error *err)
{
    int64_t started_us = clock_now_us();
    struct loading loading = { .folder.fd = -1, .progress = progress };
    if (!folder_open(&loading.folder, folder, err))
        return NULL;
    struct plan *plan = mem_new(sizeof *plan);
    loading.plan = plan;
    snprintf(plan->id, sizeof plan->id, "%s", id);
    tell(&loading, "looking at the folder", "", 0);
    loading.file = plan_describe(&loading.folder, &plan->report, err);
    bool is_loaded = loading.file && make_jobs(&loading, err) && read_parts(&loading, err) && assemble(&loading, err);
    if (is_loaded) {
        memcpy(plan->name, loading.file->name, sizeof plan->name);
        memcpy(plan->note, loading.file->note, sizeof plan->note);
        plan->is_phantom = loading.file->is_phantom;
        plan->meshes = plan_meshes_create(plan->regions.n_regions);
        plan->load_us = clock_now_us() - started_us;
        tell(&loading, "loaded", "", 100);
    }
    finish_loading(&loading);
    if (!is_loaded) {
        plan_destroy(plan);
        return NULL;
    }
    return plan;
}

void plan_destroy(struct plan *plan)
{
    if (!plan)
        return;
    plan_meshes_destroy(plan->meshes);
    for (size_t i = 0; i < plan->n_images; i++)
        volume_unref(plan->images[i].volume);
    region_set_finish(&plan->regions);
    for (size_t i = 0; i < plan->n_doses; i++)
        dose_finish(&plan->doses[i]);
    track_set_finish(&plan->tracks);
    report_finish(&plan->report);
    free(plan);
}
