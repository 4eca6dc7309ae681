/* Archives that are received and unpacked, plans that are written and kept, while a call of the system fails. */
#define _GNU_SOURCE
#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/mem.h"
#include "core/load/load.h"
#include "core/load/write_plan.h"
#include "core/phantom/phantom.h"
#include "server/http/intake.h"
#include "server/renderer/unpack.h"
#include "tests/check.h"
#include "tests/faults/walk.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/oracle.h"

/* Files below a folder, by name and content; in any order. */
static uint64_t digest_of(const char *folder)
{
    uint64_t all = 1;
    DIR *names = opendir(folder);
    if (!names)
        abort();
    for (struct dirent *entry; (entry = readdir(names));) {
        char path[1024];
        struct outcome one = { 0 };
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0)
            continue;
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        outcome_add_text(&one, entry->d_name);
        if (entry->d_type == DT_DIR) {
            one.digest += 3 * digest_of(path);
        } else {
            size_t n;
            uint8_t *bytes = file_bytes(path, &n);
            outcome_add(&one, bytes, n);
            free(bytes);
        }
        all += one.digest;
    }
    closedir(names);
    return all;
}

/* ---- unpacking ---------------------------------------------------------------------------------------------------- */

static void unpack_one(void *context, struct outcome *outcome)
{
    static const struct unpack_options plenty = { .max_bytes = UINT64_C(1) << 40 };
    char into[256];
    struct unpack_result result;
    faults_pause();
    folder_make(into);
    int archive = open(context, O_RDONLY | O_CLOEXEC), folder = open(into, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    uint64_t empty = digest_of(into);
    faults_go_on();
    outcome->is_done = unpack(archive, folder, &plenty, &result, &outcome->problem);
    faults_pause();
    close(archive);
    close(folder);
    uint64_t digest = digest_of(into);
    if (!outcome->is_done && digest != empty) { /* half of it stayed: a finding */
        outcome->is_done = true;
        outcome_note(outcome, "something stayed in the folder of a refused archive");
    }
    outcome_add(outcome, &digest, sizeof digest);
    folder_remove(into);
    faults_go_on();
}

/* libarchive uses a null pointer or ends its process (Fatal Internal Error) where some of its allocations fail. Only
 * one call fails here: where all later ones did, what is in the folder could not be listed either, to be removed. Both
 * are the end of the process that unpacks, and beamroomd removes what it leaves. */
static void walk_archives(void)
{
    static const char *const names[] = { "good.zip",     "pax.tar",     "good.tar.gz",
                                         "good.tar.bz2", "good.tar.xz", "good.tar.zst" };
    char folder[256], script[] = "tests/oracle/archives.py", out[256];
    folder_make(folder);
    if (oracle_run((char *[]){ oracle_python(), script, folder, NULL }, out, sizeof out) != 0)
        printf("[  SKIPPED ] archives are unpacked: no Python makes them\n");
    else
        for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
            char path[512], sentence[64];
            snprintf(path, sizeof path, "%s/%s", folder, names[i]);
            snprintf(sentence, sizeof sentence, "%s is unpacked", names[i]);
            const struct walk walk = { .name = sentence,
                                       .run = unpack_one,
                                       .context = path,
                                       .is_short = true,
                                       .may_die_in = "libarchive",
                                       .kinds = { true, true, true, true, true, true } };
            walk_run(&walk);
        }
    folder_remove(folder);
}

/* ---- receiving ---------------------------------------------------------------------------------------------------- */

static void nothing(void *context)
{
    (void)context;
}

static void receive_one(void *context, struct outcome *outcome)
{
    struct intake *intake = intake_create(context, 1 << 20, 0, &outcome->err);
    struct call *call = call_create();
    uint64_t n_bytes;
    size_t n_taken;
    char *path = NULL;
    call->method = CALL_POST;
    call_set_path(call, "/api/v1/plans");
    call->content_type = mem_copy_text("application/zip");
    struct intake_file *file = intake ? intake_begin(intake, call, 20, nothing, NULL, &outcome->problem) : NULL;
    if (file && intake_add(file, "0123456789", 10, &n_taken, &outcome->problem) &&
        intake_add(file, "0123456789", 10, &n_taken, &outcome->problem)) {
        while (!intake_end(file))
            intake_wait(intake);
        path = intake_finish(file, &n_bytes, &outcome->problem);
    } else {
        intake_drop(file);
    }
    if (path) {
        outcome->is_done = true;
        faults_pause();
        uint64_t digest = digest_of(context);
        unlink(path);
        faults_go_on();
        outcome_add(outcome, &digest, sizeof digest);
    }
    free(path);
    call_destroy(call);
    intake_destroy(intake);
}

static void walk_intake(void)
{
    char folder[256];
    folder_make(folder);
    const struct walk walk = { .name = "an archive is received",
                               .run = receive_one,
                               .context = folder,
                               .folder = folder,
                               .kinds = { true, true, true, true, true, true } };
    walk_run(&walk);
    folder_remove(folder);
}

/* ---- writing ------------------------------------------------------------------------------------------------------ */

static const struct phantom_options small = { { 20, 20, 16 }, 1 };

static void write_phantom(void *context, struct outcome *outcome)
{
    char folder[300];
    snprintf(folder, sizeof folder, "%s/phantom", (const char *)context);
    outcome->is_done = phantom_write(folder, &small, false, &outcome->err);
    if (outcome->is_done) {
        faults_pause();
        uint64_t digest = digest_of(folder);
        folder_remove(folder);
        faults_go_on();
        outcome_add(outcome, &digest, sizeof digest);
    }
}

struct kept {
    char root[256], from[300], to[300];
    struct plan *plan;
    struct plan_sources *sources;
};

static void write_plan(void *context, struct outcome *outcome)
{
    const struct kept *kept = context;
    outcome->is_done = plan_write(kept->plan, kept->to, NULL, &outcome->err);
    if (outcome->is_done) {
        faults_pause();
        uint64_t digest = digest_of(kept->to);
        folder_remove(kept->to);
        faults_go_on();
        outcome_add(outcome, &digest, sizeof digest);
    }
}

static void store_plan(void *context, struct outcome *outcome)
{
    const struct kept *kept = context;
    outcome->is_done = plan_cache_store(kept->plan, kept->sources, kept->to, &outcome->err);
    if (outcome->is_done) {
        char path[400];
        snprintf(path, sizeof path, "%s/" PLAN_CACHE_NAME, kept->to);
        faults_pause();
        uint64_t digest = digest_of(kept->to);
        unlink(path);
        faults_go_on();
        outcome_add(outcome, &digest, sizeof digest);
    }
}

/* Opens the plan from the cache or, where that fails, from the folder: it is the same. */
static void open_kept(void *context, struct outcome *outcome)
{
    const struct kept *kept = context;
    const struct plan_load_options options = { .cache_folder = kept->to };
    struct plan *plan = plan_load(kept->from, "p", &options, &outcome->err);
    if (!plan)
        return;
    outcome->is_done = true;
    for (size_t i = 0; i < plan->n_images; i++)
        outcome_add(outcome, plan->images[i].volume->voxels,
                    grid_n_voxels(&plan->images[i].volume->grid) * voxel_size(plan->images[i].volume->type));
    for (size_t i = 0; i < plan->regions.n_regions; i++)
        outcome_add_text(outcome, plan->regions.regions[i].id);
    outcome_add_number(outcome, (double)plan->tracks.n_segments);
    outcome_add_number(outcome, (double)plan->report.n_lines);
    plan_destroy(plan);
}

static void walk_writing(void)
{
    struct kept kept = { 0 };
    struct error err = { 0 };
    folder_make(kept.root);
    snprintf(kept.from, sizeof kept.from, "%s/plan", kept.root);
    snprintf(kept.to, sizeof kept.to, "%s/written", kept.root);
    const struct walk phantom = { .name = "the demo plan is written",
                                  .run = write_phantom,
                                  .context = kept.root,
                                  .folder = kept.root,
                                  .kinds = { true, true, true, true, true, true } };
    walk_run(&phantom);
    snprintf(kept.to, sizeof kept.to, "%s/cache", kept.root);
    mkdir(kept.to, 0700);
    const struct plan_load_options options = { .cache_folder = kept.to, .sources = &kept.sources };
    if (!phantom_write(kept.from, &small, false, &err) || !(kept.plan = plan_load(kept.from, "p", &options, &err)))
        abort();
    const struct walk store = { .name = "an opened plan is kept",
                                .run = store_plan,
                                .context = &kept,
                                .folder = kept.root,
                                .kinds = { true, true, true, true, true, true } };
    walk_run(&store);
    if (!plan_cache_store(kept.plan, kept.sources, kept.to, &err))
        abort();
    const struct walk reopen = { .name = "a plan that was kept opens",
                                 .run = open_kept,
                                 .context = &kept,
                                 .folder = kept.root,
                                 .kinds = { true, true, true, true, true, true } };
    walk_run(&reopen);
    snprintf(kept.to, sizeof kept.to, "%s/written", kept.root);
    const struct walk write = { .name = "a plan is written",
                                .run = write_plan,
                                .context = &kept,
                                .is_short = true, /* clearing what was begun takes memory and descriptors itself */
                                .folder = kept.root,
                                .kinds = { true, true, true, true, true, true } };
    walk_run(&write);
    plan_sources_destroy(kept.sources);
    plan_destroy(kept.plan);
    folder_remove(kept.root);
}

int main(void)
{
    walk_archives();
    walk_intake();
    walk_writing();
    return walks_end();
}
