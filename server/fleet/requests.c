/* Keeps the list of requests to renderers: sends them, and ends them by answer, failure or time-out. */
#include "server/fleet/requests.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/fleet/watch.h"

struct request {
    struct request *next;
    uint64_t number;
    struct plan_entry *plan; /* NULL when it failed */
    enum packet_type type;   /* of the packet; render: its answer shows that the renderer draws */
    bool is_sent, is_failed;
    struct problem problem; /* when failed */
    uint8_t *bytes;         /* the packet, until it is sent */
    size_t n_bytes;
    int64_t until_us; /* fleet_now_us; then it fails */
    fleet_reply reply;
    void *context;
};

static struct request *request_new(struct fleet *fleet, fleet_reply reply, void *context)
{
    struct request *request = mem_new(sizeof *request);
    request->number = fleet_next_number(fleet);
    request->reply = reply;
    request->context = context;
    request->until_us = fleet_now_us(fleet) + (int64_t)fleet->times.request * 1000;
    struct request **end = &fleet->requests;
    while (*end)
        end = &(*end)->next;
    *end = request;
    fleet->n_requests++;
    return request;
}

static void request_unlink(struct fleet *fleet, struct request *request)
{
    for (struct request **at = &fleet->requests; *at; at = &(*at)->next)
        if (*at == request) {
            *at = request->next;
            fleet->n_requests--;
            return;
        }
}

static void drop_bytes(struct fleet *fleet, struct request *request)
{
    if (request->bytes)
        fleet->n_waiting_bytes -= request->n_bytes;
    free(request->bytes);
    request->bytes = NULL;
}

static void request_destroy(struct fleet *fleet, struct request *request)
{
    drop_bytes(fleet, request);
    free(request);
}

static void request_fail(struct fleet *fleet, struct request *request, const struct problem *problem)
{
    if (request->is_failed)
        return;
    drop_bytes(fleet, request);
    request->is_failed = true;
    request->problem = *problem;
    request->plan = NULL;
}

static bool send_room_updates(struct fleet *fleet, struct plan_entry *plan)
{
    return room_updates_send(&plan->room_updates, fleet->watch, plan->process);
}

static void request_send(struct fleet *fleet, struct request *request)
{
    struct problem problem;
    request->is_sent = true;
    if (send_room_updates(fleet, request->plan)) { /* a picture never overtakes the scene it shows */
        uint8_t *bytes = request->bytes;
        request->bytes = NULL;
        fleet->n_waiting_bytes -= request->n_bytes;
        if (watch_send(fleet->watch, request->plan->process, bytes, request->n_bytes))
            return;
    }
    problem_set(&problem, PROBLEM_BUSY, "", "", "too much is waiting to be told to renderers");
    problem.retry_after_ms = 500;
    request_fail(fleet, request, &problem);
}

static bool may_wait(const struct plan_entry *plan, struct problem *problem)
{
    switch (plan->state) {
    case FLEET_READY:
    case FLEET_STARTING:
    case FLEET_LOADING:
    case FLEET_RESTARTING: return true;
    case FLEET_UNREADABLE:
    case FLEET_FAILED: *problem = plan->problem; return false;
    case FLEET_CLOSED: break;
    }
    problem_set(problem, PROBLEM_BUSY, "", "", "the plan is not open");
    problem->retry_after_ms = 500;
    return false;
}

uint64_t fleet_request(struct fleet *fleet, const char *plan_id, struct packet *packet, fleet_reply reply,
                       void *context)
{
    bool is_full = fleet->n_requests >= FLEET_MAX_REQUESTS;
    struct request *request = request_new(fleet, reply, context);
    struct plan_entry *plan = plan_entry_find(fleet, plan_id);
    struct problem problem = { 0 };
    uint64_t number = request->number;
    if (!plan) {
        (void)fleet_no_plan(fleet, plan_id, &problem);
    } else if (is_full) {
        problem_set(&problem, PROBLEM_BUSY, "", "", "%d requests wait for an answer already", FLEET_MAX_REQUESTS);
        problem.retry_after_ms = 1000;
    } else if (may_wait(plan, &problem)) {
        packet_set_id(packet, (int64_t)number);
        request->type = packet->type;
        request->bytes = packet_encode(packet, NULL, 0, &request->n_bytes, &problem);
        fleet->n_waiting_bytes += request->n_bytes;
        plan->used_us = fleet_now_us(fleet);
        if (request->bytes && plan->state != FLEET_READY && fleet->n_waiting_bytes > FLEET_MAX_WAITING_BYTES) {
            problem_set(&problem, PROBLEM_BUSY, "", "", "requests of more than %d MiB wait for plans to be read",
                        FLEET_MAX_WAITING_BYTES >> 20);
            problem.retry_after_ms = 1000;
        } else if (request->bytes) {
            request->plan = plan;
        }
        if (request->plan && plan->state == FLEET_READY)
            request_send(fleet, request);
    }
    if (!request->plan) {
        request_fail(fleet, request, &problem);
        fleet->options.wake(fleet->options.context);
    }
    return number;
}

void fleet_forget_request(struct fleet *fleet, uint64_t number)
{
    for (struct request *request = fleet->requests; request; request = request->next)
        if (request->number == number) {
            request_unlink(fleet, request);
            request_destroy(fleet, request);
            return;
        }
}

/* The room a packet is about; NULL: none. */
static const char *room_of(const struct packet *packet)
{
    return packet->type == PACKET_SCENE    ? packet->scene.room
           : packet->type == PACKET_FORGET ? packet->forget.room
                                           : NULL;
}

bool fleet_tell(struct fleet *fleet, const char *plan_id, const struct packet *packet)
{
    struct plan_entry *plan = plan_entry_find(fleet, plan_id);
    const char *room = room_of(packet);
    if (!plan || plan->state != FLEET_READY)
        return false;
    size_t n_bytes;
    struct problem problem = { 0 };
    uint8_t *bytes = packet_encode(packet, NULL, 0, &n_bytes, &problem);
    if (!bytes) {
        log_error("plan %s: its renderer is not told: %s", plan->id, problem.detail);
        return false;
    }
    if (!room) /* a "drop": when it is lost, one picture is drawn in vain */
        return watch_send(fleet->watch, plan->process, bytes, n_bytes);
    room_updates_put(&plan->room_updates, plan->process, room, bytes, n_bytes);
    (void)send_room_updates(fleet, plan); /* what finds no room is sent by requests_send_room_updates */
    return true;
}

void requests_send_room_updates(struct fleet *fleet)
{
    for (size_t i = 0; i < fleet->n_plans; i++)
        (void)send_room_updates(fleet, fleet->plans[i]);
}

void requests_send_waiting(struct fleet *fleet, struct plan_entry *plan)
{
    for (struct request *request = fleet->requests; request; request = request->next)
        if (request->plan == plan && !request->is_sent && !request->is_failed)
            request_send(fleet, request);
}

void requests_fail(struct fleet *fleet, const struct plan_entry *plan, bool only_sent, const struct problem *problem)
{
    for (struct request *request = fleet->requests; request; request = request->next)
        if ((!plan || request->plan == plan) && (request->is_sent || !only_sent))
            request_fail(fleet, request, problem);
}

void requests_deliver_failed(struct fleet *fleet)
{
    /* A reply may add or forget requests, so the search starts again after each; requests added meanwhile wait for the
     * next call. */
    uint64_t last = fleet->last_number;
    for (struct request *request = fleet->requests; request;) {
        if (!request->is_failed || request->number > last) {
            request = request->next;
            continue;
        }
        request_unlink(fleet, request);
        request->reply(request->context, NULL, &request->problem);
        request_destroy(fleet, request);
        request = fleet->requests;
    }
}

/* Time when the present process last drew a picture, or became ready if it has drawn none. */
static int64_t last_drew_us(const struct plan_entry *plan)
{
    return plan->last_picture_us > plan->ready_us ? plan->last_picture_us : plan->ready_us;
}

void requests_check_time(struct fleet *fleet, int64_t now_us)
{
    struct problem problem;
    problem_set(&problem, PROBLEM_TIMEOUT, "", "", "no answer within %d s", fleet->times.request / 1000);
    for (struct request *request = fleet->requests; request; request = request->next) {
        if (request->is_failed || now_us < request->until_us)
            continue;
        /* The renderer's main thread answers pings even when its render thread is stuck, so only a late picture shows a
         * stuck thread. A renderer that finishes other pictures meanwhile is overloaded but not stuck; nor is a
         * renderer that has been ready for less than the time of a request. */
        if (request->type == PACKET_RENDER && request->is_sent &&
            now_us - last_drew_us(request->plan) >= (int64_t)fleet->times.request * 1000)
            plan_entry_kill(fleet, request->plan, "did not finish a picture in time");
        request_fail(fleet, request, &problem);
    }
}

bool requests_has_any(const struct fleet *fleet, const struct plan_entry *plan)
{
    for (const struct request *request = fleet->requests; request; request = request->next)
        if (request->plan == plan)
            return true;
    return false;
}

bool requests_has_sent(const struct fleet *fleet, const struct plan_entry *plan)
{
    for (const struct request *request = fleet->requests; request; request = request->next)
        if (request->plan == plan && request->is_sent)
            return true;
    return false;
}

static void picture_came(struct fleet *fleet, struct plan_entry *plan)
{
    plan->has_drawn = true;
    plan->last_picture_us = fleet_now_us(fleet);
}

bool requests_answer(struct fleet *fleet, struct plan_entry *plan, struct packet *packet)
{
    int64_t id = packet_id(packet);
    bool is_problem = packet->type == PACKET_PROBLEM;
    struct request *request = fleet->requests;
    while (request &&
           !(request->plan == plan && request->is_sent && !request->is_failed && request->number == (uint64_t)id))
        request = request->next;
    if (!request) { /* the request was forgotten since it was sent */
        if (packet->type == PACKET_FRAME)
            picture_came(fleet, plan);
        return true;
    }
    if (!is_problem && packet->type != packet_descriptions[request->type].answer)
        return false;
    bool is_render = request->type == PACKET_RENDER;
    request_unlink(fleet, request);
    plan->used_us = fleet_now_us(fleet);
    if (is_render && !is_problem)
        picture_came(fleet, plan);
    else if (is_render)
        plan->last_picture_us = plan->used_us; /* it refused the picture, so it is not stuck */
    request->reply(request->context, is_problem ? NULL : packet, is_problem ? &packet->problem.problem : NULL);
    request_destroy(fleet, request);
    return true;
}

void requests_destroy(struct fleet *fleet)
{
    while (fleet->requests) {
        struct request *next = fleet->requests->next;
        free(fleet->requests->bytes);
        free(fleet->requests);
        fleet->requests = next;
    }
}
