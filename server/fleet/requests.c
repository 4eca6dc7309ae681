#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/fleet/parts.h"

static bool is_render(const cJSON *packet)
{
    const char *type = json_text(packet, "type");
    return type && strcmp(type, "render") == 0;
}

/* The packet with our id in it. The document is not copied, only looked at. errors as packet_write */
static uint8_t *write_with_id(const cJSON *packet, uint64_t id, size_t *n_bytes, struct error *err)
{
    cJSON *whole = cJSON_CreateObject();
    cJSON_AddNumberToObject(whole, "id", (double)id);
    for (cJSON *item = packet->child; item; item = item->next)
        if (strcmp(item->string, "id") != 0)
            cJSON_AddItemReferenceToObject(whole, item->string, item);
    uint8_t *bytes = packet_write(whole, NULL, 0, n_bytes, err);
    cJSON_Delete(whole);
    return bytes;
}

static struct fleet_ask *ask_new(struct fleet *fleet, fleet_reply reply, void *context)
{
    struct fleet_ask *ask = mem_new(sizeof *ask);
    ask->number = fleet_number(fleet);
    ask->reply = reply;
    ask->context = context;
    ask->until_us = fleet_now_us(fleet) + (int64_t)fleet->times.request * 1000;
    struct fleet_ask **end = &fleet->asks;
    while (*end)
        end = &(*end)->next;
    *end = ask;
    fleet->n_asks++;
    return ask;
}

static void unlink_ask(struct fleet *fleet, struct fleet_ask *ask)
{
    for (struct fleet_ask **at = &fleet->asks; *at; at = &(*at)->next)
        if (*at == ask) {
            *at = ask->next;
            fleet->n_asks--;
            return;
        }
}

static void drop_bytes(struct fleet *fleet, struct fleet_ask *ask)
{
    if (ask->bytes)
        fleet->n_waiting_bytes -= ask->n_bytes;
    free(ask->bytes);
    ask->bytes = NULL;
}

static void free_ask(struct fleet *fleet, struct fleet_ask *ask)
{
    drop_bytes(fleet, ask);
    free(ask);
}

static void fail(struct fleet *fleet, struct fleet_ask *ask, const struct problem *problem)
{
    if (ask->is_failed)
        return;
    drop_bytes(fleet, ask);
    ask->is_failed = true;
    ask->problem = *problem;
    ask->plan = NULL;
}

/* ---- what a renderer is owed ------------------------------------------------------------------------------------ */

/* A scene, or that a room is gone, that found the orders to the watch full: sent before anything else is. */
struct fleet_owed {
    struct fleet_owed *next;
    uint64_t process; /* another one is told the room's scene anew */
    char room[64];
    uint8_t *bytes;
    size_t n_bytes;
};

static void free_owed(struct fleet_owed *owed)
{
    free(owed->bytes);
    free(owed);
}

void owed_forget(struct plan_entry *plan)
{
    while (plan->owed) {
        struct fleet_owed *next = plan->owed->next;
        free_owed(plan->owed);
        plan->owed = next;
    }
}

/* The last word on a room counts: it takes the place of an earlier one. Takes bytes. */
static void owe(struct plan_entry *plan, const char *room, uint8_t *bytes, size_t n_bytes)
{
    struct fleet_owed **at = &plan->owed;
    while (*at && strcmp((*at)->room, room) != 0)
        at = &(*at)->next;
    if (!*at)
        *at = mem_new(sizeof **at);
    struct fleet_owed *owed = *at;
    free(owed->bytes);
    (void)snprintf(owed->room, sizeof owed->room, "%s", room);
    owed->process = plan->process;
    owed->bytes = bytes;
    owed->n_bytes = n_bytes;
}

/* True: nothing is owed any more. */
static bool send_owed(struct fleet *fleet, struct plan_entry *plan)
{
    while (plan->owed) {
        struct fleet_owed *owed = plan->owed;
        if (owed->process == plan->process && plan->process) {
            uint8_t *copy = malloc(owed->n_bytes); /* the watch takes it, whether it can send or not */
            if (!copy)
                return false;
            memcpy(copy, owed->bytes, owed->n_bytes);
            if (!watch_send(fleet->watch, plan->process, copy, owed->n_bytes))
                return false;
        }
        plan->owed = owed->next;
        free_owed(owed);
    }
    return true;
}

void owed_send(struct fleet *fleet)
{
    for (size_t i = 0; i < fleet->n_plans; i++)
        (void)send_owed(fleet, fleet->plans[i]);
}

/* ---- requests --------------------------------------------------------------------------------------------------- */

static void send_ask(struct fleet *fleet, struct fleet_ask *ask)
{
    struct problem problem;
    ask->is_sent = true;
    if (send_owed(fleet, ask->plan)) { /* a picture never overtakes the scene it is of */
        uint8_t *bytes = ask->bytes;
        ask->bytes = NULL;
        fleet->n_waiting_bytes -= ask->n_bytes;
        if (watch_send(fleet->watch, ask->plan->process, bytes, ask->n_bytes))
            return;
    }
    problem_set(&problem, PROBLEM_BUSY, "", "", "too much is waiting to be told to renderers");
    problem.retry_after_ms = 500;
    fail(fleet, ask, &problem);
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

uint64_t fleet_request(struct fleet *fleet, const char *plan_id, const cJSON *packet, fleet_reply reply, void *context)
{
    bool is_full = fleet->n_asks >= FLEET_MAX_REQUESTS;
    struct fleet_ask *ask = ask_new(fleet, reply, context);
    struct plan_entry *plan = plan_entry_find(fleet, plan_id);
    struct problem problem = { 0 };
    uint64_t number = ask->number;
    if (!plan) {
        (void)fleet_no_plan(fleet, plan_id, &problem);
    } else if (is_full) {
        problem_set(&problem, PROBLEM_BUSY, "", "", "%d requests wait for an answer already", FLEET_MAX_REQUESTS);
        problem.retry_after_ms = 1000;
    } else if (may_wait(plan, &problem)) {
        struct error err = { 0 };
        ask->is_render = is_render(packet);
        ask->bytes = write_with_id(packet, number, &ask->n_bytes, &err);
        fleet->n_waiting_bytes += ask->n_bytes;
        plan->used_us = fleet_now_us(fleet);
        if (!ask->bytes)
            problem_from_error(&problem, &err);
        else if (plan->state != FLEET_READY && fleet->n_waiting_bytes > FLEET_MAX_WAITING_BYTES) {
            problem_set(&problem, PROBLEM_BUSY, "", "", "requests of more than %d MiB wait for plans to be read",
                        FLEET_MAX_WAITING_BYTES >> 20);
            problem.retry_after_ms = 1000;
        } else {
            ask->plan = plan;
        }
        if (ask->plan && plan->state == FLEET_READY)
            send_ask(fleet, ask);
    }
    if (!ask->plan) {
        fail(fleet, ask, &problem);
        fleet->options.wake(fleet->options.context);
    }
    return number;
}

void fleet_forget_request(struct fleet *fleet, uint64_t request)
{
    for (struct fleet_ask *ask = fleet->asks; ask; ask = ask->next)
        if (ask->number == request) {
            unlink_ask(fleet, ask);
            free_ask(fleet, ask);
            return;
        }
}

bool fleet_tell(struct fleet *fleet, const char *plan_id, const cJSON *packet)
{
    struct plan_entry *plan = plan_entry_find(fleet, plan_id);
    const char *room = json_text(packet, "room");
    if (!plan || plan->state != FLEET_READY)
        return false;
    size_t n_bytes;
    struct error err = { 0 };
    uint8_t *bytes = packet_write(packet, NULL, 0, &n_bytes, &err);
    if (!bytes) {
        log_error("plan %s: its renderer is not told: %s", plan->id, err.text);
        return false;
    }
    if (!room) /* only that a picture is no longer wanted: when that is lost, one is drawn in vain */
        return watch_send(fleet->watch, plan->process, bytes, n_bytes);
    owe(plan, room, bytes, n_bytes);
    (void)send_owed(fleet, plan); /* full: later */
    return true;
}

void asks_send_waiting(struct fleet *fleet, struct plan_entry *plan)
{
    for (struct fleet_ask *ask = fleet->asks; ask; ask = ask->next)
        if (ask->plan == plan && !ask->is_sent && !ask->is_failed)
            send_ask(fleet, ask);
}

void asks_fail(struct fleet *fleet, const struct plan_entry *plan, bool only_sent, const struct problem *problem)
{
    for (struct fleet_ask *ask = fleet->asks; ask; ask = ask->next)
        if ((!plan || ask->plan == plan) && (ask->is_sent || !only_sent))
            fail(fleet, ask, problem);
}

void asks_deliver_failed(struct fleet *fleet)
{
    /* a reply may ask anew or forget others: look from the start each time, and only at those that had failed by now */
    uint64_t last = fleet->last_number;
    for (struct fleet_ask *ask = fleet->asks; ask;) {
        if (!ask->is_failed || ask->number > last) {
            ask = ask->next;
            continue;
        }
        unlink_ask(fleet, ask);
        ask->reply(ask->context, NULL, &ask->problem);
        free_ask(fleet, ask);
        ask = fleet->asks;
    }
}

/* When the present process last drew a picture; when it became ready, if it has drawn none. */
static int64_t last_drew_us(const struct plan_entry *plan)
{
    return plan->drew_us > plan->ready_us ? plan->drew_us : plan->ready_us;
}

void asks_keep_time(struct fleet *fleet, int64_t now_us)
{
    struct problem problem;
    problem_set(&problem, PROBLEM_TIMEOUT, "", "", "no answer within %d s", fleet->times.request / 1000);
    for (struct fleet_ask *ask = fleet->asks; ask; ask = ask->next) {
        if (ask->is_failed || now_us < ask->until_us)
            continue;
        /* Its main thread answers pings, so only this shows that drawing is stuck. One that finishes other pictures
         * meanwhile is not stuck: too much was asked of it. Nor is one that has been ready for less than the time of a
         * request. */
        if (ask->is_render && ask->is_sent && now_us - last_drew_us(ask->plan) >= (int64_t)fleet->times.request * 1000)
            plan_entry_kill(fleet, ask->plan, "did not finish a picture in time");
        fail(fleet, ask, &problem);
    }
}

bool asks_has_any(const struct fleet *fleet, const struct plan_entry *plan)
{
    for (const struct fleet_ask *ask = fleet->asks; ask; ask = ask->next)
        if (ask->plan == plan)
            return true;
    return false;
}

bool asks_has_sent(const struct fleet *fleet, const struct plan_entry *plan)
{
    for (const struct fleet_ask *ask = fleet->asks; ask; ask = ask->next)
        if (ask->plan == plan && ask->is_sent)
            return true;
    return false;
}

static void plan_entry_drew(struct fleet *fleet, struct plan_entry *plan)
{
    plan->has_drawn = true;
    plan->drew_us = fleet_now_us(fleet);
}

bool asks_take_answer(struct fleet *fleet, struct plan_entry *plan, struct packet *packet)
{
    double id = json_number(packet->json, "id", -1);
    struct fleet_ask *ask = fleet->asks;
    while (ask && !(ask->plan == plan && ask->is_sent && !ask->is_failed && (double)ask->number == id))
        ask = ask->next;
    const char *type = json_text(packet->json, "type");
    if (!ask) { /* asked once, and forgotten since */
        if (id >= 0 && type && strcmp(type, "frame") == 0)
            plan_entry_drew(fleet, plan);
        return id >= 0;
    }
    struct problem problem = { 0 };
    struct packet_frame frame;
    bool is_problem = strcmp(type, "problem") == 0;
    if (is_problem) {
        if (!problem_from_json(cJSON_GetObjectItemCaseSensitive(packet->json, "problem"), &problem))
            return false;
    } else if (strcmp(type, ask->is_render ? "frame" : "answer") != 0 ||
               (ask->is_render && !packet_frame_read(packet, &frame)) ||
               (!ask->is_render && !cJSON_GetObjectItemCaseSensitive(packet->json, "body"))) {
        return false;
    }
    unlink_ask(fleet, ask);
    plan->used_us = fleet_now_us(fleet);
    if (ask->is_render && !is_problem)
        plan_entry_drew(fleet, plan);
    else if (ask->is_render)
        plan->drew_us = plan->used_us; /* it refused the picture: it is not stuck */
    ask->reply(ask->context, is_problem ? NULL : packet, is_problem ? &problem : NULL);
    free_ask(fleet, ask);
    return true;
}
