/* Opens a plan folder: runs the steps of loading on a thread of its own while the caller waits. */
#include "core/load/load.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "core/load/assemble.h"
#include "core/load/estimate.h"
#include "core/load/file_notes.h"
#include "core/load/find_parts.h"
#include "core/load/loading.h"
#include "core/load/part_list.h"
#include "core/load/read_all.h"
#include "core/load/settle_parts.h"

/* The caller waits and looks at the cancel flag every LOOK_EVERY_MS, so a cancelled plan_load returns that soon
 * whatever the thread is doing. The thread goes on to the end of its file or slice, finds is_given_up set, and frees
 * the rest. */
enum { LOOK_EVERY_MS = 20 };

static void index_progress(void *context, size_t n_done, size_t n_all)
{
    struct loading *loading = context;
    atomic_store(&loading->work, n_all);
    atomic_store(&loading->work_done, n_done);
}

static void cache_begin(void *context, uint64_t n_bytes)
{
    struct loading *loading = context;
    loading_phase(loading, "reading the opened plan", "", 5, 95);
    loading_begin(loading, n_bytes);
}

static void cache_read(void *context, uint64_t n_bytes)
{
    loading_work(context, n_bytes);
}

/* Reads the plan from the cache if no file of the folder has changed since it was kept. */
static bool load_from_cache(struct loading *loading)
{
    struct folder_tree tree;
    if (!loading->cache_folder)
        return false;
    if (!folder_walk(&loading->folder, "", NULL, &tree, NULL)) {
        folder_tree_finish(&tree);
        return false;
    }
    struct plan_sources *sources = plan_sources_create(&tree);
    const struct plan_cache_reading reading = { loading->max_bytes, cache_begin, cache_read, loading,
                                                &loading->is_given_up };
    bool is_read = sources && plan_cache_read(loading->cache_folder, sources, &reading, loading->plan);
    loading->plan->is_from_cache = is_read;
    loading->sources = sources;
    return is_read;
}

/* False when every part was left out; the first of them, else the gravest line of the report, becomes the reason. */
static bool has_anything(const struct loading *loading, struct error *err)
{
    const struct plan *plan = loading->plan;
    const struct report_line *gravest = NULL;
    size_t n_errors = 0;
    if (plan->n_images + plan->regions.n_regions + plan->n_doses + plan->n_beams > 0)
        return true;
    for (size_t i = 0; i < plan->report.n_lines; i++) {
        n_errors += plan->report.lines[i].severity == REPORT_ERROR;
        if (!gravest || plan->report.lines[i].severity > gravest->severity)
            gravest = &plan->report.lines[i];
    }
    if (loading->n_left_out > 0) {
        *err = loading->first_left_out;
        if (n_errors > 1)
            error_prefix(err, "nothing is left to show");
        return false;
    }
    return error_set(err, ERROR_UNSUPPORTED, "nothing is left to show%s%s%s%s", gravest ? "; " : "",
                     gravest ? gravest->where : "", gravest && gravest->where[0] ? ": " : "",
                     gravest ? gravest->sentence : "");
}

static bool settle_and_assemble(struct loading *loading, struct error *err)
{
    plan_settle_parts(loading);
    return plan_assemble(loading, err);
}

/* Says of a folder without plan.json what was found; the line was added before the parts were read. */
static void count_found(struct plan *plan)
{
    for (size_t i = 0; i < plan->report.n_lines; i++) {
        struct report_line *line = &plan->report.lines[i];
        if (strcmp(line->code, "plan.recognised") == 0)
            report_line_say(
                line,
                "The folder has no plan.json; its parts were found by names and contents: %zu %s, %zu %s, %zu %s, %zu %s.",
                plan->n_images, plan->n_images == 1 ? "image" : "images", plan->regions.n_regions,
                plan->regions.n_regions == 1 ? "region" : "regions", plan->n_doses,
                plan->n_doses == 1 ? "dose" : "doses", plan->n_beams, plan->n_beams == 1 ? "beam" : "beams");
    }
}

static bool load(struct loading *loading)
{
    struct error *err = &loading->err;
    struct plan *plan = loading->plan;
    if (load_from_cache(loading))
        return true;
    loading_phase(loading, "looking at the folder", "", 0, 5);
    const struct dicom_progress looking = { index_progress, loading, &loading->is_given_up, 0 };
    size_t n_lacked = error_n_memory();
    bool is_found = plan_find_parts(&loading->folder, &looking, &loading->parts, &plan->report, err);
    loading->file = loading->parts.file;
    if (!is_found || !plan_list_parts(loading, err) || !plan_check_estimate(loading, err) ||
        !plan_read_parts(loading, err) || !settle_and_assemble(loading, err) || !has_anything(loading, err) ||
        !plan_note_files(loading, err)) {
        if (error_n_memory() != n_lacked && err->code != ERROR_MEMORY)
            error_set(err, ERROR_MEMORY, "no memory, or too many open files, to read the plan");
        return false;
    }
    if (error_n_memory() != n_lacked) /* a dose, curves or preferences may be left out: not to be shown, nor cached */
        return error_set(err, ERROR_MEMORY, "no memory, or too many open files, to read all of the plan");
    count_found(plan);
    memcpy(plan->name, loading->file->name, sizeof plan->name);
    memcpy(plan->note, loading->file->note, sizeof plan->note);
    plan->is_phantom = loading->file->is_phantom;
    return true;
}

static void *load_main(void *argument)
{
    struct loading *loading = argument;
    loading->is_whole = load(loading);
    (void)queue_try_put(loading->ended, loading); /* wakes the caller; the letter holds no reference */
    loading_unref(loading);
    return NULL;
}

/* Starts the thread. When no thread can be created the work is done here, without progress. */
static void start(struct loading *loading)
{
    pthread_t thread;
    if (pthread_create(&thread, NULL, load_main, loading) == 0)
        pthread_detach(thread);
    else
        load_main(loading);
}

static void report_progress(struct loading *loading, const struct plan_progress *progress, struct loading_phase *now,
                            double *percent)
{
    struct loading_phase *newest = mailbox_take(loading->phases);
    if (newest)
        *now = *newest;
    free(newest);
    double work = (double)atomic_load(&loading->work), done = (double)atomic_load(&loading->work_done);
    double reached = now->low + (now->high - now->low) * (work > 0 && done < work ? done / work : work > 0);
    *percent = reached > *percent ? reached : *percent; /* never falls, also when a phase begins */
    if (progress->step)
        progress->step(progress->context, now->words, *percent);
}

static bool wait(struct loading *loading, const struct plan_progress *progress, struct error *err)
{
    const atomic_bool *cancel = progress->cancel;
    struct loading_phase phase = { .words = "starting" };
    double percent = 0;
    while (!queue_take(loading->ended, LOOK_EVERY_MS)) {
        report_progress(loading, progress, &phase, &percent);
        if (cancel && atomic_load(cancel)) {
            atomic_store(&loading->is_given_up, true);
            return error_set(err, ERROR_CANCELLED, "loading was cancelled");
        }
    }
    if (!loading->is_whole && err)
        *err = loading->err;
    if (loading->is_whole && progress->step)
        progress->step(progress->context, "loaded", 100);
    return loading->is_whole;
}

struct plan *plan_load(const char *folder, const char *id, const struct plan_load_options *options, struct error *err)
{
    static const struct plan_load_options none = { 0 };
    int64_t started_us = clock_now_us();
    options = options ? options : &none;
    if (options->sources)
        *options->sources = NULL;
    if (options->progress.cancel && atomic_load(options->progress.cancel)) {
        error_set(err, ERROR_CANCELLED, "loading was cancelled");
        return NULL;
    }
    struct loading *loading = loading_create(folder, id, err);
    struct plan *plan = NULL;
    if (!loading)
        return NULL;
    loading->max_bytes = options->max_bytes;
    loading->cache_folder =
        options->cache_folder ? mem_copy_text(options->cache_folder) : NULL; /* the thread may outlive it */
    start(loading);
    if (wait(loading, &options->progress, err)) {
        plan = loading->plan;
        loading->plan = NULL;
        if (options->sources) {
            *options->sources = loading->sources;
            loading->sources = NULL;
        }
        plan->load_us = clock_now_us() - started_us;
    }
    loading_unref(loading);
    return plan;
}
