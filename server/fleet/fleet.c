#include "server/fleet/fleet.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/fleet/news.h"
#include "server/fleet/restarts.h"

enum {
    EVENTS_A_TURN = 256,
    LONGEST_STEP_US = 1000000, /* between two ticks; what is more, the thread did not run */
    LEAST_MEMORY_SLACK = 256 << 20,
    PLACE_EVERY_US = 2000000 /* a plan that is held and closed for lack of a place tries again after this */
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

int64_t fleet_now_us(const struct fleet *fleet)
{
    return run_clock_us(&fleet->clock);
}

bool fleet_no_plan(const struct fleet *fleet, const char *plan_id, struct problem *problem)
{
    if (fleet->is_listed)
        return problem_set(problem, PROBLEM_NOT_FOUND, "", "", "there is no plan \"%.64s\"", plan_id);
    problem_set(problem, PROBLEM_BUSY, "", "", "the plan folders are still being listed");
    if (problem)
        problem->retry_after_ms = 500;
    return false;
}

uint64_t fleet_number(struct fleet *fleet)
{
    return ++fleet->last_number;
}

char **fleet_arguments(const char *const *words)
{
    size_t n = 0;
    while (words[n])
        n++;
    char **arguments = mem_new((n + 1) * sizeof *arguments);
    for (size_t i = 0; i < n; i++)
        arguments[i] = mem_copy_text(words[i]);
    return arguments;
}

void plan_entry_change(struct fleet *fleet, struct plan_entry *plan, enum fleet_state state)
{
    plan->state = state;
    plan->has_changed = true;
    fleet->options.wake(fleet->options.context);
}

void plan_entry_kill(struct fleet *fleet, struct plan_entry *plan, const char *reason)
{
    if (plan->process && !plan->is_dying)
        watch_stop(fleet->watch, plan->process, true, reason);
    plan->is_dying = plan->process != 0;
}

/* ---- start and stop --------------------------------------------------------------------------------------------- */

void plan_entry_start(struct fleet *fleet, struct plan_entry *plan)
{
    char cache[PATH_MAX], limit[32], file_limit[32];
    (void)snprintf(cache, sizeof cache, "%s/cache/%s", fleet->data_folder, plan->id);
    (void)snprintf(limit, sizeof limit, "%llu", (unsigned long long)fleet->options.max_renderer_bytes);
    (void)mkdir(cache, 0700); /* without it the renderer does without a cache */
    (void)snprintf(file_limit, sizeof file_limit, "%llu", (unsigned long long)cache_max_file(fleet->cache));
    const char *words[20] = { fleet->renderer_path, "--socket-fd", "3",           "--plan-folder", plan->folder,
                              "--plan-id",          plan->id,      "--cache",     cache,           "--max-file-bytes",
                              file_limit,           "--gl",        fleet->gl_word };
    size_t n = 13;
    if (fleet->options.max_renderer_bytes > 0) {
        words[n++] = "--max-bytes";
        words[n++] = limit;
    }
    if (fleet->options.stub_renderer)
        words[n++] = "--stub";
    plan->process = fleet_number(fleet);
    plan->restart_at_us = 0;
    plan->problem = (struct problem){ 0 };
    plan->is_dying = false;
    plan->generation++;
    plan->percent = 0;
    plan->has_drawn = plan->is_awaited = false;
    plan->ready_us = 0;
    plan->asked_us = clock_now_us();
    plan->moved_us = fleet_now_us(fleet);
    cache_begin(fleet->cache, plan->id, plan->process);
    if (!watch_start_renderer(fleet->watch, plan->process, fleet_arguments(words))) {
        struct problem problem;
        cache_end(fleet->cache, plan->process);
        plan->process = 0;
        if (plan->n_holds > 0) {
            restart_not_begun(fleet, plan, "could not be started: too much is waiting to be told to renderers");
            return;
        }
        problem_set(&problem, PROBLEM_BUSY, "", "", "too much is waiting to be told to renderers");
        plan_entry_fail(fleet, plan, &problem);
    }
}

static bool has_renderer(const struct plan_entry *plan)
{
    return plan->process != 0 || plan->restart_at_us != 0;
}

static bool is_unused(const struct fleet *fleet, const struct plan_entry *plan)
{
    bool is_at_rest = plan->state == FLEET_READY || (plan->restart_at_us && !plan->process);
    return is_at_rest && plan->n_holds == 0 && !asks_has_any(fleet, plan);
}

static void forget_documents(struct plan_entry *plan)
{
    cJSON_Delete(plan->document);
    cJSON_Delete(plan->default_scene);
    plan->document = plan->default_scene = NULL;
}

void plan_entry_close(struct fleet *fleet, struct plan_entry *plan, const char *why)
{
    struct problem problem;
    problem_set(&problem, PROBLEM_CANCELLED, "", "", "the plan was closed: %s", why);
    asks_fail(fleet, plan, false, &problem);
    if (plan->process)
        watch_stop(fleet->watch, plan->process, false, "is no longer wanted");
    plan_entry_lose(plan);
    plan->restart_at_us = 0;
    plan->wants_place = false;
    plan->was_ready = false;
    plan->phase[0] = 0;
    plan->percent = 0;
    forget_documents(plan);
    plan_entry_change(fleet, plan, FLEET_CLOSED);
    log_info("plan %s: closed: %s", plan->id, why);
}

/* Makes room for one more renderer by closing the longest unused plan. */
static bool make_room(struct fleet *fleet)
{
    struct plan_entry *oldest = NULL;
    int n_running = 0;
    for (size_t i = 0; i < fleet->n_plans; i++) {
        struct plan_entry *plan = fleet->plans[i];
        n_running += has_renderer(plan);
        if (is_unused(fleet, plan) && (!oldest || plan->used_us < oldest->used_us))
            oldest = plan;
    }
    if (fleet->options.max_renderers <= 0 || n_running < fleet->options.max_renderers)
        return true;
    if (!oldest)
        return false;
    plan_entry_close(fleet, oldest, "another plan needs its place");
    return true;
}

bool fleet_open(struct fleet *fleet, const char *plan_id, struct problem *problem)
{
    struct plan_entry *plan = plan_entry_find(fleet, plan_id);
    if (!plan)
        return fleet_no_plan(fleet, plan_id, problem);
    if (plan->state == FLEET_UNREADABLE) {
        if (problem)
            *problem = plan->problem;
        return false;
    }
    plan->used_us = fleet_now_us(fleet);
    if (plan->state != FLEET_CLOSED && plan->state != FLEET_FAILED)
        return true;
    if (!make_room(fleet)) {
        problem_set(problem, PROBLEM_BUSY, "", "", "%d plans are open and in use, which is as many as may be",
                    fleet->options.max_renderers);
        if (problem)
            problem->retry_after_ms = 5000;
        return false;
    }
    plan->problem = (struct problem){ 0 };
    plan->was_ready = false;
    forget_documents(plan);
    plan->n_barren = 0;
    plan->is_for_good = plan->wants_place = false;
    plan->opening++;
    (void)snprintf(plan->phase, sizeof plan->phase, "starting the renderer");
    plan_entry_change(fleet, plan, FLEET_STARTING);
    plan_entry_start(fleet, plan);
    return true;
}

void fleet_close(struct fleet *fleet, const char *plan_id)
{
    struct plan_entry *plan = plan_entry_find(fleet, plan_id);
    if (plan && has_renderer(plan))
        plan_entry_close(fleet, plan, "somebody asked for it");
}

void plan_entry_open_held(struct fleet *fleet, struct plan_entry *plan)
{
    struct problem problem;
    if (fleet_open(fleet, plan->id, &problem) || problem.type != PROBLEM_BUSY)
        return;
    plan->place_at_us = fleet_now_us(fleet) + PLACE_EVERY_US;
    if (plan->wants_place)
        return;
    plan->wants_place = true;
    problem_set(&plan->problem, PROBLEM_BUSY, "", "", "%.200s; this one is opened as soon as there is a place",
                problem.detail);
    plan_entry_change(fleet, plan, FLEET_FAILED);
}

bool fleet_hold(struct fleet *fleet, const char *plan_id)
{
    struct plan_entry *plan = plan_entry_find(fleet, plan_id);
    if (!plan)
        return false;
    plan->n_holds++;
    if (plan->state == FLEET_CLOSED || (plan->state == FLEET_FAILED && !plan->is_for_good && !plan->wants_place))
        plan_entry_open_held(fleet, plan);
    return true;
}

void fleet_release(struct fleet *fleet, const char *plan_id)
{
    struct plan_entry *plan = plan_entry_find(fleet, plan_id);
    if (plan && plan->n_holds > 0) {
        plan->n_holds--;
        plan->used_us = fleet_now_us(fleet);
    }
    if (plan && plan->n_holds == 0 && plan->wants_place)
        plan_entry_close(fleet, plan, "nobody is there any more");
}

/* ---- events and time -------------------------------------------------------------------------------------------- */

void fleet_rescan(struct fleet *fleet)
{
    lister_ask(fleet->lister);
    fleet->is_listing = true;
}

static void take_list(struct fleet *fleet)
{
    struct folder_list found;
    if (!lister_take(fleet->lister, &found))
        return;
    fleet->is_listing = false;
    fleet->list_has_changed |= !fleet->is_listed;
    fleet->is_listed = true;
    plans_take_folders(fleet, &found);
    folder_list_finish(&found);
}

/* The kernel's limit does not count memory that is shared, with others or by nobody; so what it has is looked at from
 * outside. The slack is for drivers of graphics cards, whose buffers are such memory. */
static void take_memory(struct fleet *fleet, struct plan_entry *plan, const struct watch_event *event)
{
    const uint64_t most = fleet->options.max_renderer_bytes,
                   slack = most / 4 > LEAST_MEMORY_SLACK ? most / 4 : LEAST_MEMORY_SLACK;
    char how[160];
    plan->memory_bytes = event->memory_bytes;
    if (most == 0 || event->own_bytes <= most + slack)
        return;
    (void)snprintf(how, sizeof how,
                   "was ended because it took %llu MiB of memory, more than the %llu MiB it may and %llu MiB beyond",
                   (unsigned long long)(event->own_bytes >> 20), (unsigned long long)(most >> 20),
                   (unsigned long long)(slack >> 20));
    plan_entry_kill(fleet, plan, how);
}

static void take_event(struct fleet *fleet, struct watch_event *event)
{
    struct plan_entry *plan = NULL;
    switch (event->type) {
    case WATCH_STARTED:
        plan = plan_entry_of_process(fleet, event->number);
        if (plan) {
            plan->pid = event->pid;
            plan->has_changed = true;
        }
        break;
    case WATCH_MEMORY:
        plan = plan_entry_of_process(fleet, event->number);
        if (plan)
            take_memory(fleet, plan, event);
        break;
    case WATCH_PACKET: news_packet(fleet, event); break;
    case WATCH_LINE: (void)uploads_take_event(fleet, event); break;
    case WATCH_ENDED:
        if (!uploads_take_event(fleet, event))
            news_ended(fleet, event);
        break;
    }
}

/* Callbacks may call anything here but fleet_destroy; plans come and go only in take_event. */
static void tell_news(struct fleet *fleet)
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
            asks_send_waiting(fleet, plan);
    }
    owed_send(fleet);
    asks_deliver_failed(fleet);
}

void fleet_handle_events(struct fleet *fleet)
{
    plans_drop_removed(fleet);
    struct watch_event *event;
    int n = 0;
    for (; n < EVENTS_A_TURN && (event = watch_take(fleet->watch)); n++) {
        take_event(fleet, event);
        watch_event_destroy(event);
    }
    if (n == EVENTS_A_TURN) /* a process that talks without end shares the thread with everyone */
        fleet->options.wake(fleet->options.context);
    take_list(fleet);
    plans_start_scans(fleet);
    uploads_go_on(fleet);
    tell_news(fleet);
}

static void tick_plan(struct fleet *fleet, struct plan_entry *plan, int64_t now_us)
{
    restart_tick(fleet, plan, now_us);
    if (plan->wants_place && now_us >= plan->place_at_us)
        plan_entry_open_held(fleet, plan);
    bool is_awaited = plan->process && plan->state == FLEET_READY && asks_has_sent(fleet, plan);
    if (is_awaited != plan->is_awaited && plan->process && watch_await(fleet->watch, plan->process, is_awaited))
        plan->is_awaited = is_awaited;
    bool is_coming_up = plan->process && plan->state != FLEET_READY;
    if (is_coming_up && now_us - plan->moved_us > fleet->times.stall * 1000LL) {
        struct problem problem;
        problem_set(&problem, PROBLEM_RENDERER, "", "", "reading the plan got no further for %d s (%.120s)",
                    fleet->times.stall / 1000, plan->phase);
        if (plan->n_holds > 0) { /* its end plans the next start */
            char how[200];
            (void)snprintf(how, sizeof how, "was ended because %.180s", problem.detail);
            plan_entry_kill(fleet, plan, how);
        } else {
            plan_entry_kill(fleet, plan, "got no further");
            plan_entry_fail(fleet, plan, &problem);
        }
    }
    if (fleet->options.idle_close_s > 0 && is_unused(fleet, plan) &&
        now_us - plan->used_us > fleet->options.idle_close_s * 1000000LL)
        plan_entry_close(fleet, plan, "nobody used it");
}

void fleet_tick(struct fleet *fleet)
{
    run_clock_step(&fleet->clock, LONGEST_STEP_US);
    int64_t now_us = fleet_now_us(fleet);
    plans_drop_removed(fleet);
    for (size_t i = 0; i < fleet->n_plans; i++)
        tick_plan(fleet, fleet->plans[i], now_us);
    asks_keep_time(fleet, now_us);
    plans_start_scans(fleet);
    uploads_go_on(fleet);
    tell_news(fleet);
}

/* ---- looking at it ---------------------------------------------------------------------------------------------- */

bool fleet_is_listed(const struct fleet *fleet)
{
    return fleet->is_listed;
}

size_t fleet_n_plans(const struct fleet *fleet)
{
    return fleet->n_plans;
}

static void describe(const struct fleet *fleet, const struct plan_entry *plan, struct fleet_plan *out)
{
    bool has_problem =
        plan->state == FLEET_FAILED || plan->state == FLEET_UNREADABLE || plan->state == FLEET_RESTARTING;
    *out = (struct fleet_plan){
        .id = plan->id,
        .folder = plan->folder,
        .name = plan->name,
        .note = plan->note,
        .is_phantom = plan->is_phantom,
        .is_uploaded = uploads_owns(fleet, plan->folder),
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
        .confined = plan->confined,
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

const cJSON *fleet_gl(const struct fleet *fleet, const struct problem **problem)
{
    if (problem)
        *problem = fleet->gl_problem.type != PROBLEM_NONE ? &fleet->gl_problem : NULL;
    return fleet->gl;
}

/* ---- beginning and end ------------------------------------------------------------------------------------------ */

static char *beside_ourselves(struct error *err)
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

static bool make_cache_folder(const char *data, struct error *err)
{
    char path[PATH_MAX];
    int n = snprintf(path, sizeof path, "%s/cache", data);
    if (n < 0 || (size_t)n >= sizeof path - PLAN_ID_SIZE - 1)
        return error_set(err, ERROR_LIMIT, "the data folder's path is too long");
    if (mkdir(path, 0700) != 0 && errno != EEXIST)
        return error_set(err, ERROR_IO, "%s cannot be made: %s", path, strerror(errno));
    return true;
}

static void set_times(struct fleet *fleet)
{
    const struct fleet_times *asked = &fleet->options.times;
    fleet->times = default_times;
    if (asked->ping > 0)
        fleet->times.ping = asked->ping;
    if (asked->silent > 0)
        fleet->times.silent = asked->silent;
    if (asked->awaited_ping > 0)
        fleet->times.awaited_ping = asked->awaited_ping;
    if (asked->awaited_silent > 0)
        fleet->times.awaited_silent = asked->awaited_silent;
    if (asked->stall > 0)
        fleet->times.stall = asked->stall;
    if (asked->request > 0)
        fleet->times.request = asked->request;
    if (asked->scan > 0)
        fleet->times.scan = asked->scan;
    if (asked->unpack > 0)
        fleet->times.unpack = asked->unpack;
}

static void fleet_free(struct fleet *fleet)
{
    lister_destroy(fleet->lister);
    cache_destroy(fleet->cache); /* its thread gives orders to the watch */
    watch_destroy(fleet->watch);
    uploads_end(fleet);
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

static void end_for_its_cache(void *context, uint64_t process, const char *reason)
{
    struct fleet *fleet = context;
    watch_stop(fleet->watch, process, true, reason);
}

static struct cache *make_cache(struct fleet *fleet, struct error *err)
{
    char path[PATH_MAX];
    (void)snprintf(path, sizeof path, "%s/cache", fleet->data_folder); /* make_cache_folder saw to its length */
    const struct cache_options options = { .folder = path,
                                           .max_bytes = fleet->options.max_cache_bytes,
                                           .reserve_bytes = fleet->options.disk_reserve_bytes,
                                           .end = end_for_its_cache,
                                           .context = fleet };
    return cache_create(&options, err);
}

static void start_probe(struct fleet *fleet)
{
    const char *words[] = {
        fleet->renderer_path, "--probe-gl", "--gl", fleet->gl_word, fleet->options.stub_renderer ? "--stub" : NULL, NULL
    };
    fleet->probe = fleet_number(fleet);
    if (!watch_start_program(fleet->watch, fleet->probe, fleet_arguments(words), fleet->times.scan))
        fleet->probe = 0;
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
    fleet->renderer_path = options->renderer_path ? mem_copy_text(options->renderer_path) : beside_ourselves(err);
    if (!fleet->renderer_path)
        goto fail;
    if (access(fleet->renderer_path, X_OK) != 0) {
        error_set(err, ERROR_NOT_FOUND, "the renderer %s cannot be run: %s", fleet->renderer_path, strerror(errno));
        goto fail;
    }
    if (!make_cache_folder(fleet->data_folder, err) || !uploads_begin(fleet, err))
        goto fail;
    fleet->plan_folders[options->n_plan_folders] =
        mem_copy_text(fleet->plans_home); /* last: a plan that was here before keeps its id */
    struct watch_options watching = { fleet->times.ping,         fleet->times.silent,
                                      fleet->times.awaited_ping, fleet->times.awaited_silent,
                                      options->max_orders,       options->wake,
                                      options->context };
    fleet->watch = watch_create(&watching, err);
    fleet->cache = fleet->watch ? make_cache(fleet, err) : NULL;
    if (!fleet->cache)
        goto fail;
    fleet->lister = lister_create((const char *const *)fleet->plan_folders, options->n_plan_folders + 1,
                                  options->list_folders ? options->list_folders : folders_list, options->wake,
                                  options->context, err);
    if (!fleet->lister)
        goto fail;
    start_probe(fleet);
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
    /* a reply may ask once more; whoever goes on asking is not answered */
    for (int round = 0; round < 3 && fleet->asks; round++) {
        asks_fail(fleet, NULL, false, &problem);
        asks_deliver_failed(fleet);
    }
    while (fleet->asks) {
        struct fleet_ask *next = fleet->asks->next;
        free(fleet->asks->bytes);
        free(fleet->asks);
        fleet->asks = next;
    }
    fleet_free(fleet);
}
