/* What renderers say and how they end: the plans' states. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "server/fleet/news.h"
#include "server/fleet/restarts.h"
#include "server/wire/document.h"

static void copy_text(char *to, size_t n, const char *text)
{
    (void)snprintf(to, n, "%s", text ? text : "");
}

void plan_entry_lose(struct plan_entry *plan)
{
    plan->process = 0;
    plan->pid = 0;
    plan->memory_bytes = 0;
}

void plan_entry_fail(struct fleet *fleet, struct plan_entry *plan, const struct problem *problem)
{
    if (plan->process)
        watch_stop(fleet->watch, plan->process, false, "is no longer wanted");
    plan_entry_lose(plan);
    plan->restart_at_us = 0;
    plan->failed_number = fleet->last_number;
    plan->failed_opening = plan->opening;
    plan->problem = plan->failure = *problem;
    asks_fail(fleet, plan, false, problem);
    plan_entry_change(fleet, plan, FLEET_FAILED);
    log_warn("plan %s: %s", plan->id, problem->detail);
}

/* Facts about GL in our own words and bounds; NULL when they are none. */
static cJSON *clean_gl(const cJSON *json)
{
    static const char *const texts[] = { "back_end", "vendor", "renderer", "version", "confined" };
    if (!json_text(json, "back_end"))
        return NULL;
    cJSON *clean = cJSON_CreateObject();
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        char text[200];
        copy_text(text, sizeof text, json_text(json, texts[i]));
        cJSON_AddStringToObject(clean, texts[i], text);
    }
    cJSON_AddBoolToObject(clean, "is_software", json_flag(json, "is_software", false));
    return clean;
}

bool fleet_take_gl(struct fleet *fleet, const cJSON *json)
{
    const cJSON *said = cJSON_GetObjectItemCaseSensitive(json, "problem");
    if (said) {
        struct problem problem;
        if (!problem_from_json(said, &problem))
            return false;
        fleet->gl_problem = problem;
        cJSON_Delete(fleet->gl);
        fleet->gl = NULL;
        return true;
    }
    cJSON *clean = clean_gl(json);
    if (!clean)
        return false;
    cJSON_Delete(fleet->gl);
    fleet->gl = clean;
    fleet->gl_problem = (struct problem){ 0 };
    return true;
}

static bool take_progress(struct fleet *fleet, struct plan_entry *plan, const cJSON *json)
{
    double percent = json_number(json, "percent", NAN);
    const char *phase = json_text(json, "phase");
    if (!phase || !(percent >= 0 && percent <= 100) || plan->state == FLEET_READY)
        return false;
    if (percent != plan->percent || strcmp(phase, plan->phase) != 0)
        plan->moved_us = fleet_now_us(fleet);
    copy_text(plan->phase, sizeof plan->phase, phase);
    plan->percent = percent;
    plan_entry_change(fleet, plan, plan->state == FLEET_STARTING ? FLEET_LOADING : plan->state);
    return true;
}

/* True if the document has at most MAX_IMAGES images and each has a valid id. */
static bool images_are_valid(const cJSON *document)
{
    const cJSON *images = cJSON_GetObjectItemCaseSensitive(document, "images");
    size_t n = 0;
    for (const cJSON *image = images ? images->child : NULL; image; image = image->next) {
        const char *id = json_text(image, "id");
        if (!id || !id_is_valid(id) || n++ == MAX_IMAGES)
            return false;
    }
    return true;
}

static bool take_ready(struct fleet *fleet, struct plan_entry *plan, cJSON *json)
{
    const cJSON *document = cJSON_GetObjectItemCaseSensitive(json, "plan");
    const cJSON *defaults = cJSON_GetObjectItemCaseSensitive(json, "scene");
    const char *id = json_text(document, "id");
    struct problem problem;
    struct scene scene;
    if (plan->state == FLEET_READY || !cJSON_IsObject(document) || !id || strcmp(id, plan->id) != 0 ||
        !scene_read(defaults, &scene, &problem))
        return false;
    scene_finish(&scene);
    if (!images_are_valid(document))
        return false;
    cJSON_Delete(plan->document);
    cJSON_Delete(plan->default_scene);
    plan->document = cJSON_DetachItemFromObjectCaseSensitive(json, "plan");
    plan->default_scene = cJSON_DetachItemFromObjectCaseSensitive(json, "scene");
    copy_text(plan->confined, sizeof plan->confined, json_text(json, "confined"));
    double load_ms = json_number(json, "load_ms", 0);
    plan->load_ms = load_ms >= 0 && load_ms < 1e9 ? (int64_t)load_ms : 0;
    plan->was_ready = true;
    plan->percent = 100;
    plan->phase[0] = 0;
    plan->used_us = plan->ready_us = fleet_now_us(fleet);
    plan->ready_opening = plan->opening;
    plan_entry_change(fleet, plan, FLEET_READY);
    log_info("plan %s: ready after %lld ms (read in %lld ms); confined: %s", plan->id,
             (long long)(clock_now_us() - plan->asked_us) / 1000, (long long)plan->load_ms, plan->confined);
    return true;
}

/* Not about the plan's files: memory, threads, disk or graphics were missing, and the next start may find them. */
static bool is_of_the_moment(enum problem_type type)
{
    return type == PROBLEM_INTERNAL || type == PROBLEM_MEMORY || type == PROBLEM_BUSY ||
           type == PROBLEM_GL_UNAVAILABLE || type == PROBLEM_RENDERER || type == PROBLEM_STORAGE ||
           type == PROBLEM_TIMEOUT || type == PROBLEM_CANCELLED;
}

static bool take_failed(struct fleet *fleet, struct plan_entry *plan, const cJSON *json)
{
    struct problem said, problem;
    if (!problem_from_json(cJSON_GetObjectItemCaseSensitive(json, "problem"), &said))
        return false;
    if (plan->was_ready && plan->n_holds > 0 && is_of_the_moment(said.type)) { /* it was read before */
        char how[200];
        (void)snprintf(how, sizeof how, "could not read the plan again (%.150s)", said.detail);
        plan_entry_kill(fleet, plan, how);
        return true;
    }
    problem_set(&problem, PROBLEM_PLAN_UNREADABLE, "", "", "%s", said.detail);
    plan_entry_fail(fleet, plan, &problem);
    plan->is_for_good = !is_of_the_moment(said.type);
    return true;
}

void news_packet(struct fleet *fleet, struct watch_event *event)
{
    struct plan_entry *plan = plan_entry_of_process(fleet, event->number);
    if (!plan || plan->is_dying)
        return; /* of one we gave up */
    const char *type = json_text(event->packet.json, "type");
    bool is_good = false;
    if (strcmp(type, "frame") == 0 || strcmp(type, "answer") == 0 || strcmp(type, "problem") == 0)
        is_good = asks_take_answer(fleet, plan, &event->packet);
    else if (strcmp(type, "progress") == 0)
        is_good = take_progress(fleet, plan, event->packet.json);
    else if (strcmp(type, "ready") == 0)
        is_good = take_ready(fleet, plan, event->packet.json);
    else if (strcmp(type, "failed") == 0)
        is_good = take_failed(fleet, plan, event->packet.json);
    else if (strcmp(type, "gl") == 0)
        is_good = fleet_take_gl(fleet, event->packet.json);
    if (!is_good) {
        char reason[120];
        (void)snprintf(reason, sizeof reason, "was ended because it sent a wrong \"%.40s\"", type);
        plan_entry_kill(fleet, plan, reason);
    }
}

/* "stopped (signal 11)", "ended with status 1", or why we ended it. */
static void how_it_ended(const struct watch_event *event, char *text, size_t n)
{
    if (event->reason[0])
        (void)snprintf(text, n, "%s", event->reason);
    else if (event->signal)
        (void)snprintf(text, n, "stopped (signal %d)", event->signal);
    else
        (void)snprintf(text, n, "ended with status %d", event->status);
}

static void renderer_ended(struct fleet *fleet, struct plan_entry *plan, const struct watch_event *event)
{
    char how[240];
    struct problem problem;
    how_it_ended(event, how, sizeof how);
    plan_entry_lose(plan);
    if (!plan->was_ready && plan->n_holds == 0) {
        if (event->signal && !event->reason[0])
            problem_set(&problem, PROBLEM_RENDERER, "", "", "the renderer stopped while reading the plan (signal %d)",
                        event->signal);
        else
            problem_set(&problem, PROBLEM_RENDERER, "", "", "while reading the plan the renderer %.200s", how);
        plan_entry_fail(fleet, plan, &problem);
        return;
    }
    restart_after_end(fleet, plan, how);
}

static void probe_ended(struct fleet *fleet, const struct watch_event *event)
{
    struct problem problem;
    char how[240];
    fleet->probe = 0;
    if (fleet->gl)
        return; /* a renderer told meanwhile */
    cJSON *json = event->is_exit ? json_read(event->output ? event->output : "", event->n_output, &problem) : NULL;
    if (!json || !fleet_take_gl(fleet, json)) {
        how_it_ended(event, how, sizeof how);
        problem_set(&fleet->gl_problem, PROBLEM_GL_UNAVAILABLE, "", "",
                    "looking for a way to draw failed: the renderer %.180s", how);
    }
    cJSON_Delete(json);
    if (fleet->gl_problem.type != PROBLEM_NONE)
        log_warn("%s", fleet->gl_problem.detail);
    else
        log_info("drawing: %s, %s", json_text(fleet->gl, "back_end"), json_text(fleet->gl, "renderer"));
    fleet->list_has_changed = true;
}

void news_ended(struct fleet *fleet, const struct watch_event *event)
{
    cache_end(fleet->cache, event->number);
    if (event->number == fleet->probe) {
        probe_ended(fleet, event);
        return;
    }
    if (plans_scan_ended(fleet, event))
        return;
    struct plan_entry *plan = plan_entry_of_process(fleet, event->number);
    if (plan)
        renderer_ended(fleet, plan, event);
}
