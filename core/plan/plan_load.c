#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "core/plan/plan_loading.h"
#include "core/plan/plan_meshes.h"

bool loading_is_cancelled(const struct loading *loading)
{
    atomic_bool *cancel = loading->options.progress.cancel;
    return cancel && atomic_load(cancel);
}

void loading_tell(const struct loading *loading, const char *what, const char *name, double percent)
{
    const struct plan_progress *progress = &loading->options.progress;
    if (!progress->step)
        return;
    char phase[96];
    snprintf(phase, sizeof phase, "%s%s%.80s", what, name[0] ? " " : "", name);
    progress->step(progress->context, phase, percent);
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

struct plan *plan_load(const char *folder, const char *id, const struct plan_load_options *options, struct error *err)
{
    int64_t started_us = clock_now_us();
    struct loading loading = { .folder.fd = -1 };
    if (options)
        loading.options = *options;
    if (!folder_open(&loading.folder, folder, err))
        return NULL;
    struct plan *plan = mem_new(sizeof *plan);
    loading.plan = plan;
    snprintf(plan->id, sizeof plan->id, "%s", id);
    loading_tell(&loading, "looking at the folder", "", 0);
    loading.file = plan_describe(&loading.folder, &plan->report, err);
    bool is_loaded = loading.file && plan_make_jobs(&loading, err) && plan_run_jobs(&loading, err) && plan_assemble(&loading, err);
    if (is_loaded) {
        memcpy(plan->name, loading.file->name, sizeof plan->name);
        memcpy(plan->note, loading.file->note, sizeof plan->note);
        plan->is_phantom = loading.file->is_phantom;
        plan->meshes = plan_meshes_create(plan->regions.n_regions);
        plan->load_us = clock_now_us() - started_us;
        loading_tell(&loading, "loaded", "", 100);
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
