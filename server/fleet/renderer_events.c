/* Turns packets, memory figures and ends of renderers into changes of their plans. */
#include "server/fleet/renderer_events.h"

#include <stdio.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/fleet/gl_probe.h"
#include "server/fleet/renderers.h"
#include "server/fleet/requests.h"
#include "server/fleet/restarts.h"
#include "server/fleet/watch.h"
#include "server/wire/document.h"

enum {
    MAX_IMAGES = 64,  /* in the plan document of a renderer */
    MAX_MEMBERS = 64, /* of that document, which has some 16 */
    LEAST_MEMORY_SLACK = 256 << 20
};

void renderer_started(struct fleet *fleet, const struct watch_event *event)
{
    struct plan_entry *plan = plan_entry_of_process(fleet, event->number);
    if (plan) {
        plan->pid = event->pid;
        plan->has_changed = true;
    }
}

/* The kernel's limit (RLIMIT_DATA) does not count shared memory, so the daemon measures it too. The slack is for
 * drivers of graphics cards, whose buffers are shared memory. */
void renderer_memory(struct fleet *fleet, const struct watch_event *event)
{
    struct plan_entry *plan = plan_entry_of_process(fleet, event->number);
    const uint64_t most = fleet->options.max_renderer_bytes,
                   slack = most / 4 > LEAST_MEMORY_SLACK ? most / 4 : LEAST_MEMORY_SLACK;
    char how[160];
    if (!plan)
        return;
    plan->memory_bytes = event->memory_bytes;
    if (most == 0 || event->own_bytes <= most + slack)
        return;
    (void)snprintf(how, sizeof how,
                   "was ended because it took %llu MiB of memory, more than the %llu MiB it may and %llu MiB beyond",
                   (unsigned long long)(event->own_bytes >> 20), (unsigned long long)(most >> 20),
                   (unsigned long long)(slack >> 20));
    plan_entry_kill(fleet, plan, how);
}

/* ---- packets: their fields are checked; false when the packet does not fit the plan ------------------------------- */

static bool progress_packet(struct fleet *fleet, struct plan_entry *plan, const struct packet_progress *progress)
{
    char phase[sizeof plan->phase];
    mem_put_text(phase, sizeof phase, progress->phase);
    if (plan->state == FLEET_READY)
        return false;
    if (progress->percent != plan->percent || strcmp(phase, plan->phase) != 0)
        plan->progressed_us = fleet_now_us(fleet);
    memcpy(plan->phase, phase, sizeof plan->phase);
    plan->percent = progress->percent;
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

/* Keeps whom a person has stated the plan to be of: the list of plans names the patient after it is closed, too. */
static void keep_stated(struct plan_entry *plan)
{
    const cJSON *statement = cJSON_GetObjectItemCaseSensitive(plan->document, "statement"),
                *patients = cJSON_GetObjectItemCaseSensitive(plan->document, "patients");
    const char *kind = json_text(statement, "kind"), *state = json_text(statement, "state");
    plan->stated.masked[0] = 0;
    if (!kind || !state || strcmp(kind, "identity") != 0 || strcmp(state, "used") != 0)
        return;
    json_put_text(plan->stated.masked, sizeof plan->stated.masked, cJSON_GetArrayItem(patients, 0), "masked");
    plan->stated.time_ms = (int64_t)json_number(statement, "time_ms", 0);
    plan->stated.fingerprint = plan->fingerprint;
}

static bool ready_packet(struct fleet *fleet, struct plan_entry *plan, struct packet *packet)
{
    const struct packet_ready *ready = &packet->ready;
    const char *id = json_text(ready->plan, "id");
    struct problem problem;
    struct scene scene;
    if (plan->state == FLEET_READY || !id || strcmp(id, plan->id) != 0 || !scene_read(ready->scene, &scene, &problem))
        return false;
    scene_finish(&scene);
    if (!images_are_valid(ready->plan) || cJSON_GetArraySize(ready->plan) > MAX_MEMBERS)
        return false;
    plan_entry_forget_documents(plan);
    plan->document = packet_take_document(packet, ready->plan);
    plan->default_scene = packet_take_document(packet, ready->scene);
    keep_stated(plan);
    mem_put_text(plan->confined, sizeof plan->confined, ready->confined);
    mem_put_text(plan->seen, sizeof plan->seen, ready->patients);
    plan->load_ms = ready->load_ms;
    plan->was_ready = true;
    plan->percent = 100;
    plan->phase[0] = 0;
    plan->used_us = plan->ready_us = fleet_now_us(fleet);
    plan->ready_opening = plan->opening;
    plan_entry_change(fleet, plan, FLEET_READY);
    log_info("plan %s: ready after %lld ms (read in %lld ms); confined: %s", plan->id,
             (long long)(clock_now_us() - plan->started_us) / 1000, (long long)plan->load_ms, plan->confined);
    return true;
}

/* True for problems that do not lie in the plan's files: memory, threads, disk or graphics were missing, and the next
 * start may find them. */
static bool is_temporary(enum problem_type type)
{
    return type == PROBLEM_INTERNAL || type == PROBLEM_MEMORY || type == PROBLEM_BUSY ||
           type == PROBLEM_GL_UNAVAILABLE || type == PROBLEM_RENDERER || type == PROBLEM_STORAGE ||
           type == PROBLEM_TIMEOUT || type == PROBLEM_CANCELLED;
}

static void failed_packet(struct fleet *fleet, struct plan_entry *plan, const struct problem *reported)
{
    struct problem problem;
    if (plan->was_ready && plan->n_holds > 0 && is_temporary(reported->type)) { /* the files were readable before */
        char how[200];
        (void)snprintf(how, sizeof how, "could not read the plan again (%.150s)", reported->detail);
        plan_entry_kill(fleet, plan, how);
        return;
    }
    problem_set(&problem, PROBLEM_PLAN_UNREADABLE, "", "", "%s", reported->detail);
    renderer_fail(fleet, plan, &problem);
    plan->is_failure_final = !is_temporary(reported->type);
}

void renderer_packet(struct fleet *fleet, struct watch_event *event)
{
    struct plan_entry *plan = plan_entry_of_process(fleet, event->number);
    if (!plan || plan->is_killed)
        return;
    struct packet *packet = &event->packet;
    bool is_good = true;
    switch (packet->type) {
    case PACKET_FRAME:
    case PACKET_ANSWER:
    case PACKET_PROBLEM: is_good = requests_answer(fleet, plan, packet); break;
    case PACKET_PROGRESS: is_good = progress_packet(fleet, plan, &packet->progress); break;
    case PACKET_READY: is_good = ready_packet(fleet, plan, packet); break;
    case PACKET_FAILED: failed_packet(fleet, plan, &packet->failed.problem); break;
    case PACKET_GL: is_good = gl_facts_received(fleet, &packet->gl); break;
    default: is_good = false; /* the reader lets no other through */
    }
    if (!is_good) {
        char reason[120];
        (void)snprintf(reason, sizeof reason, "was ended because it sent a wrong \"%.40s\"",
                       packet_descriptions[packet->type].name);
        plan_entry_kill(fleet, plan, reason);
    }
}

/* ---- ends ------------------------------------------------------------------------------------------------------- */

void renderer_ended(struct fleet *fleet, const struct watch_event *event)
{
    struct plan_entry *plan = plan_entry_of_process(fleet, event->number);
    char how[240];
    struct problem problem;
    if (!plan)
        return;
    watch_event_describe_end(event, how, sizeof how);
    plan_entry_lose(plan);
    if (plan->was_ready || plan->n_holds > 0) {
        restart_after_end(fleet, plan, how);
        return;
    }
    if (event->signal && !event->reason[0])
        problem_set(&problem, PROBLEM_RENDERER, "", "", "the renderer stopped while reading the plan (signal %d)",
                    event->signal);
    else
        problem_set(&problem, PROBLEM_RENDERER, "", "", "while reading the plan the renderer %.200s", how);
    renderer_fail(fleet, plan, &problem);
}

void renderer_check_stall(struct fleet *fleet, struct plan_entry *plan, int64_t now_us)
{
    struct problem problem;
    bool is_loading = plan->process && plan->state != FLEET_READY;
    if (!is_loading || now_us - plan->progressed_us <= fleet->times.stall * 1000LL)
        return;
    problem_set(&problem, PROBLEM_RENDERER, "", "", "reading the plan got no further for %d s (%.120s)",
                fleet->times.stall / 1000, plan->phase);
    if (plan->n_holds > 0) { /* the end of the process plans the next start */
        char how[200];
        (void)snprintf(how, sizeof how, "was ended because %.180s", problem.detail);
        plan_entry_kill(fleet, plan, how);
    } else {
        plan_entry_kill(fleet, plan, "got no further");
        renderer_fail(fleet, plan, &problem);
    }
}
