/* The top of the fleet: creating and destroying it, one turn of events, the tick, and the description of plans. */
#include "server/fleet/fleet.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/fleet/cache_quota.h"
#include "server/fleet/data_folders.h"
#include "server/fleet/gl_probe.h"
#include "server/fleet/lister.h"
#include "server/fleet/openings.h"
#include "server/fleet/plan_entry.h"
#include "server/fleet/plan_list.h"
#include "server/fleet/plan_revision.h"
#include "server/fleet/plan_scan.h"
#include "server/fleet/renderer_events.h"
#include "server/fleet/requests.h"
#include "server/fleet/restarts.h"
#include "server/fleet/upload_root.h"
#include "server/fleet/uploads.h"
#include "server/fleet/watch.h"

enum {
    EVENTS_A_TURN = 256,
    LONGEST_STEP_US = 2000000 /* longest time counted between two ticks: beyond it the thread did not run */
};

static const struct fleet_times default_times = { .ping = 2000,
                                                  .silent = 6000,
                                                  .awaited_ping = 250,
                                                  .awaited_silent = 600,
                                                  .stall = 120000,
                                                  .request = 30000,
                                                  .scan = 30000,
                                                  .unpack = 120000 };

const char *fleet_state_word(enum fleet_state state)
{
    switch (state) {
    case FLEET_UNREADABLE: return "unreadable";
    case FLEET_CLOSED: return "not-loaded";
    case FLEET_STARTING: return "starting";
    case FLEET_LOADING: return "loading";
    case FLEET_READY: return "ready";
    case FLEET_RESTARTING: return "restarting";
    case FLEET_FAILED: return "failed";
    }
    return "unknown";
}

/* ---- events and time -------------------------------------------------------------------------------------------- */

static void update_list(struct fleet *fleet)
{
    struct folder_list found;
    if (!lister_take(fleet->lister, &found, &fleet->n_lists))
        return;
    fleet->is_listing = fleet->n_lists < fleet->n_list_requests;
    fleet->list_has_changed |= !fleet->is_listed;
    fleet->is_listed = true;
    plan_list_update(fleet, &found);
    folder_list_finish(&found);
}

static void handle_event(struct fleet *fleet, struct watch_event *event)
{
    switch (event->type) {
    case WATCH_STARTED: renderer_started(fleet, event); break;
    case WATCH_MEMORY: renderer_memory(fleet, event); break;
    case WATCH_PACKET: renderer_packet(fleet, event); break;
    case WATCH_LINE: (void)uploads_event(fleet, event); break;
    case WATCH_ENDED:
        if (uploads_event(fleet, event))
            break;
        cache_quota_end(fleet->cache_quota, event->number);
        if (!gl_probe_ended(fleet, event) && !plan_scan_ended(fleet, event) && !plan_revision_ended(fleet, event))
            renderer_ended(fleet, event);
        break;
    }
}

/* Calls options.changed for every change. The callbacks may call any function of the fleet but fleet_destroy and
 * fleet_handle_events; so no plan is added or freed here. */
static void report_changes(struct fleet *fleet)
{
    if (fleet->list_has_changed) {
        fleet->list_has_changed = false;
        fleet->options.changed(fleet->options.context, NULL);
    }
    for (size_t i = 0; i < fleet->n_plans; i++) {
        struct plan_entry *plan = fleet->plans[i];
        if (!plan->has_changed)
            continue;
        plan->has_changed = false;
        fleet->options.changed(fleet->options.context, plan->id);
        if (plan->state == FLEET_READY)
            requests_send_waiting(fleet, plan);
    }
    requests_send_room_updates(fleet);
    requests_deliver_failed(fleet);
}

void fleet_handle_events(struct fleet *fleet)
{
    plan_list_drop_removed(fleet);
    struct watch_event *event;
    int n = 0;
    for (; n < EVENTS_A_TURN && (event = watch_take(fleet->watch)); n++) {
        handle_event(fleet, event);
        watch_event_destroy(event);
    }
    if (n == EVENTS_A_TURN) /* so that a process that sends without pause leaves time for the rest of the thread */
        fleet->options.wake(fleet->options.context);
    update_list(fleet);
    plan_scans_start(fleet);
    plan_revisions_start(fleet);
    uploads_tick(fleet);
    report_changes(fleet);
}

static void tick_plan(struct fleet *fleet, struct plan_entry *plan, int64_t now_us)
{
    restart_tick(fleet, plan, now_us);
    opening_tick(fleet, plan, now_us);
    bool is_awaited = plan->process && plan->state == FLEET_READY && requests_has_sent(fleet, plan);
    if (is_awaited != plan->is_awaited && plan->process && watch_await(fleet->watch, plan->process, is_awaited))
        plan->is_awaited = is_awaited;
    renderer_check_stall(fleet, plan, now_us);
}

void fleet_tick(struct fleet *fleet)
{
    run_clock_step(&fleet->clock, fleet->rest_us + LONGEST_STEP_US);
    fleet->rest_us = 0;
    int64_t now_us = fleet_now_us(fleet);
    plan_list_drop_removed(fleet);
    for (size_t i = 0; i < fleet->n_plans; i++)
        tick_plan(fleet, fleet->plans[i], now_us);
    requests_check_time(fleet, now_us);
    plan_scans_start(fleet);
    uploads_tick(fleet);
    report_changes(fleet);
}

static bool rests(const struct plan_entry *plan)
{
    const bool is_steady = plan->state == FLEET_READY || plan->state == FLEET_CLOSED || plan->state == FLEET_FAILED ||
                           plan->state == FLEET_UNREADABLE;
    return is_steady && !plan->wants_scan && !plan->scan && !plan->revision.program && !plan->revision.is_wanted &&
           !plan->restart_at_us && !plan->is_removed && !plan->is_awaited && !plan->has_changed && !plan->room_updates;
}

int64_t fleet_rest_us(struct fleet *fleet, int64_t longest_us)
{
    const int64_t now_us = fleet_now_us(fleet);
    bool is_at_rest =
        !fleet->requests && fleet->is_listed && !fleet->is_listing && !fleet->list_has_changed && uploads_rest(fleet);
    for (size_t i = 0; is_at_rest && i < fleet->n_plans; i++) {
        int64_t left_us = opening_left_us(fleet, fleet->plans[i], now_us);
        longest_us = left_us < longest_us ? left_us : longest_us;
        is_at_rest = rests(fleet->plans[i]) && longest_us > 0;
    }
    fleet->rest_us = is_at_rest ? longest_us : 0;
    return fleet->rest_us;
}

/* ---- descriptions ----------------------------------------------------------------------------------------------- */

bool fleet_is_listed(const struct fleet *fleet)
{
    return fleet->is_listed;
}

size_t fleet_n_plans(const struct fleet *fleet)
{
    return fleet->n_plans;
}

/* The person's statement that names the plan's patient: the one that was used, of the same files, and not withdrawn
 * since. NULL: there is none. */
static const cJSON *stated_on(const struct fleet *fleet, const struct plan_entry *plan)
{
    const bool is_of_files = plan->document || plan->stated.fingerprint == plan->fingerprint;
    if (!plan->stated.masked[0] || plan->shown.masked[0] || plan->is_phantom || !is_of_files ||
        !fleet->options.statement)
        return NULL;
    const cJSON *said = fleet->options.statement(fleet->options.context, plan->id);
    const bool counts =
        json_number(said, "withdrawn_ms", 0) <= 0 && (int64_t)json_number(said, "time_ms", -1) == plan->stated.time_ms;
    return counts && json_text(said, "by") ? said : NULL;
}

static void describe(const struct fleet *fleet, const struct plan_entry *plan, struct fleet_plan *out)
{
    const cJSON *said = stated_on(fleet, plan);
    bool has_problem =
        plan->state == FLEET_FAILED || plan->state == FLEET_UNREADABLE || plan->state == FLEET_RESTARTING;
    *out = (struct fleet_plan){
        .id = plan->id,
        .folder = plan->folder,
        .name = plan->name,
        .note = plan->note,
        .is_phantom = plan->is_phantom,
        .patient = plan->shown.masked,
        .patient_id = plan->shown.id,
        .stated_patient = said ? plan->stated.masked : "",
        .stated_by = said ? json_text(said, "by") : "",
        .stated_ms = said ? plan->stated.time_ms : 0,
        .label = plan->shown.label,
        .date = plan->shown.date,
        .approval = plan->shown.approval,
        .n_patients = plan->shown.n_patients,
        .n_treatment_plans = plan->shown.n_treatment_plans,
        .has_plan_file = plan->has_plan_file,
        .is_uploaded = fleet_owns_folder(fleet, plan->folder),
        .state = plan->state,
        .phase = plan->phase,
        .percent = plan->percent,
        .problem = has_problem && plan->problem.type != PROBLEM_NONE ? &plan->problem : NULL,
        .parts = plan->parts,
        .n_bytes = plan->n_bytes,
        .document = plan->document,
        .default_scene = plan->default_scene,
        .generation = plan->generation,
        .opening = plan->opening,
        .ready_opening = plan->ready_opening,
        .failed_opening = plan->failed_opening,
        .failure = &plan->failure,
        .memory_bytes = plan->memory_bytes,
        .load_ms = plan->load_ms,
        .pid = plan->pid,
        .revision = plan->revision.digest,
        .files_read_ms = plan->revision.loaded_ms,
        .files_changed_ms = plan->revision.loaded_generation == plan->generation ? plan->revision.changed_ms : 0,
        .files_are_looked_at = plan->revision.program || plan->revision.is_wanted,
        .confined = plan->confined,
        .patients_seen = plan->seen,
    };
}

bool fleet_plan_at(const struct fleet *fleet, size_t index, struct fleet_plan *plan)
{
    if (index >= fleet->n_plans || fleet->plans[index]->is_removed)
        return false;
    describe(fleet, fleet->plans[index], plan);
    return true;
}

bool fleet_plan_find(const struct fleet *fleet, const char *id, struct fleet_plan *plan)
{
    const struct plan_entry *entry = plan_entry_find(fleet, id);
    if (entry)
        describe(fleet, entry, plan);
    return entry != NULL;
}

/* ---- beginning and end ------------------------------------------------------------------------------------------ */

static char *path_of_renderer(struct error *err)
{
    char path[PATH_MAX];
    ssize_t n = readlink("/proc/self/exe", path, sizeof path - sizeof "beamroom-render");
    char *slash = NULL;
    if (n > 0) {
        path[n] = 0;
        slash = strrchr(path, '/');
    }
    if (!slash) {
        error_set(err, ERROR_IO, "where this program lies cannot be found out: %s", strerror(errno));
        return NULL;
    }
    memcpy(slash + 1, "beamroom-render", sizeof "beamroom-render");
    return mem_copy_text(path);
}

static void set_times(struct fleet *fleet)
{
    const struct fleet_times *given = &fleet->options.times;
    fleet->times = default_times;
    if (given->ping > 0)
        fleet->times.ping = given->ping;
    if (given->silent > 0)
        fleet->times.silent = given->silent;
    if (given->awaited_ping > 0)
        fleet->times.awaited_ping = given->awaited_ping;
    if (given->awaited_silent > 0)
        fleet->times.awaited_silent = given->awaited_silent;
    if (given->stall > 0)
        fleet->times.stall = given->stall;
    if (given->request > 0)
        fleet->times.request = given->request;
    if (given->scan > 0)
        fleet->times.scan = given->scan;
    if (given->unpack > 0)
        fleet->times.unpack = given->unpack;
}

static void fleet_free(struct fleet *fleet)
{
    lister_destroy(fleet->lister);
    root_finder_destroy(fleet->root_finder);
    cache_quota_destroy(fleet->cache_quota); /* its thread gives orders to the watch */
    watch_destroy(fleet->watch);
    data_folders_destroy(fleet);
    uploads_destroy(fleet);
    for (size_t i = 0; i < fleet->n_plans; i++)
        plan_entry_destroy(fleet->plans[i]);
    free(fleet->plans);
    for (size_t i = 0; fleet->plan_folders && fleet->plan_folders[i]; i++)
        free(fleet->plan_folders[i]);
    free(fleet->plan_folders);
    free(fleet->data_folder);
    free(fleet->renderer_path);
    free(fleet->gl_word);
    cJSON_Delete(fleet->gl);
    free(fleet);
}

static void end_renderer(void *context, uint64_t process, const char *reason)
{
    struct fleet *fleet = context;
    watch_stop(fleet->watch, process, true, reason);
}

static struct cache_quota *make_cache(struct fleet *fleet, struct error *err)
{
    char path[PATH_MAX];
    (void)snprintf(path, sizeof path, "%s/cache", fleet->data_folder); /* data_folders_create checked its length */
    const struct cache_quota_options options = { .folder = path,
                                                 .max_bytes = fleet->options.max_cache_bytes,
                                                 .reserve_bytes = fleet->options.disk_reserve_bytes,
                                                 .end = end_renderer,
                                                 .context = fleet };
    return cache_quota_create(&options, err);
}

struct fleet *fleet_create(const struct fleet_options *options, struct error *err)
{
    struct fleet *fleet = mem_new(sizeof *fleet);
    fleet->options = *options;
    set_times(fleet);
    fleet->plans = mem_new(FLEET_MAX_PLANS * sizeof *fleet->plans);
    fleet->plan_folders = mem_new((options->n_plan_folders + 2) * sizeof *fleet->plan_folders);
    for (size_t i = 0; i < options->n_plan_folders; i++)
        fleet->plan_folders[i] = mem_copy_text(options->plan_folders[i]);
    fleet->data_folder = mem_copy_text(options->data_folder);
    fleet->gl_word = mem_copy_text(options->gl ? options->gl : "auto");
    fleet->renderer_path = options->renderer_path ? mem_copy_text(options->renderer_path) : path_of_renderer(err);
    if (!fleet->renderer_path)
        goto fail;
    if (access(fleet->renderer_path, X_OK) != 0) {
        error_set(err, ERROR_NOT_FOUND, "the renderer %s cannot be run: %s", fleet->renderer_path, strerror(errno));
        goto fail;
    }
    if (!data_folders_create(fleet, err))
        goto fail;
    fleet->plan_folders[options->n_plan_folders] =
        mem_copy_text(fleet->plans_home); /* last: an uploaded plan never takes the id of a plan in another folder */
    const struct watch_options watching = { .silence = { .ping_ms = fleet->times.ping,
                                                         .silent_ms = fleet->times.silent,
                                                         .awaited_ping_ms = fleet->times.awaited_ping,
                                                         .awaited_silent_ms = fleet->times.awaited_silent },
                                            .max_orders = options->max_orders,
                                            .wake = options->wake,
                                            .context = options->context };
    fleet->watch = watch_create(&watching, err);
    fleet->cache_quota = fleet->watch ? make_cache(fleet, err) : NULL;
    fleet->root_finder = fleet->cache_quota ? root_finder_create(options->wake, options->context, err) : NULL;
    if (!fleet->root_finder)
        goto fail;
    fleet->lister = lister_create((const char *const *)fleet->plan_folders, options->n_plan_folders + 1,
                                  options->list_folders ? options->list_folders : folders_list, options->wake,
                                  options->context, err);
    if (!fleet->lister)
        goto fail;
    gl_probe_start(fleet);
    fleet_rescan(fleet);
    return fleet;
fail:
    fleet_free(fleet);
    return NULL;
}

void fleet_destroy(struct fleet *fleet)
{
    if (!fleet)
        return;
    struct problem problem;
    problem_set(&problem, PROBLEM_CANCELLED, "", "", "the server is stopping");
    /* a reply may make a new request; after three rounds such requests are freed without a reply */
    for (int round = 0; round < 3 && fleet->requests; round++) {
        requests_fail(fleet, NULL, false, &problem);
        requests_deliver_failed(fleet);
    }
    requests_destroy(fleet);
    fleet_free(fleet);
}
