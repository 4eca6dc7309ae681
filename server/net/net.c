/* Creates and destroys the net thread; its tasks, its clock, its connections, and the life of rooms. */
#include "server/net/net.h"

#include <errno.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/auth/auth.h"
#include "server/net/asleep.h"
#include "server/net/bridge.h"
#include "server/net/erase.h"
#include "server/net/keep.h"
#include "server/net/keep_audit.h"
#include "server/net/keep_audit_read.h"
#include "server/net/keep_recordings.h"
#include "server/net/keep_records.h"
#include "server/net/meeting_doors.h"
#include "server/net/meeting_list.h"
#include "server/net/net_state.h"
#include "server/net/often.h"
#include "server/net/rooms.h"
#include "server/net/schedule.h"
#include "server/net/sign_ins.h"
#include "server/net/statements.h"
#include "server/net/strangers.h"

enum {
    MAX_TASKS = 4096, /* tasks that may wait; one more makes net_post wait */
    FLEET_TICK_US = 250000,
    CALM_AFTER_US = 5000000, /* without a call and a message */
    CALM_TICK_US = 1000000,
    REST_TICK_US = 60000000,    /* while nothing is under way that depends on time */
    FAREWELL_US = 1000000,      /* at the end, for the byes to be sent */
    RESTART_RETRY_MS = 2000,    /* when pages reconnect after a stop: about the time of a restart */
    MAX_EARLY_BYTES = 256 << 10 /* what a connection may say while its room is being read from the disk */
};

struct task {
    void (*run)(struct net *net, void *argument);
    void *argument;
};

/* ---- the list of plans ------------------------------------------------------------------------------------------ */

/* The list with this number is there. */
static void tell_listed(struct net *net, uint64_t number)
{
    for (struct list_waiter **at = &net->list_waiters; *at;) {
        struct list_waiter *waiter = *at;
        if (waiter->number > number) {
            at = &waiter->next;
            continue;
        }
        *at = waiter->next;
        waiter->done(waiter->context);
        free(waiter);
        at = &net->list_waiters; /* done may have added one */
    }
}

void net_list_plans(struct net *net, void (*done)(void *context), void *context)
{
    struct list_waiter *waiter = mem_new(sizeof *waiter);
    *waiter = (struct list_waiter){ net->list_waiters, fleet_list_again(net->fleet), done, context };
    net->list_waiters = waiter;
}

/* ---- time ------------------------------------------------------------------------------------------------------- */

static void settle_all(struct net *net)
{
    for (size_t i = 0; i < net->n_rooms; i++)
        schedule_settle(net->rooms[i]);
}

/* Handles what is due in rooms, and writes what is to be kept of them. */
static void handle_due(struct net *net)
{
    if (!schedule_is_due(net))
        return;
    schedule_due_rooms(net);
    keep_write_due(net, false);
}

/* Time until the next tick while nobody does anything. */
static int64_t calm_tick_us(struct net *net, int64_t now_us)
{
    const int64_t room_us = rooms_idle_left_us(net, now_us),
                  rest_us = fleet_rest_us(net->fleet, room_us < REST_TICK_US ? room_us : REST_TICK_US);
    return rest_us > CALM_TICK_US ? rest_us : CALM_TICK_US;
}

/* Brings the fleet's next tick forward, as an event may have started a timer. */
static void tick_within(struct net *net, int64_t within_us)
{
    const int64_t at_us = clock_now_us() + within_us;
    if (net->fleet_tick_us > at_us)
        net->fleet_tick_us = at_us;
}

static void timer_fired(void *context)
{
    struct net *net = context;
    int64_t now_us = clock_now_us();
    if (now_us >= net->fleet_tick_us) {
        fleet_tick(net->fleet);
        erase_tick(net);
        often_tick(net);
        bridge_look_at_files(net, now_us);
        rooms_close_idle(net);
        keep_write_due(net, false);
        net->fleet_tick_us = now_us + (now_us < net->calm_from_us ? FLEET_TICK_US : calm_tick_us(net, now_us));
    }
    handle_due(net);
    sign_ins_check(net, now_us);
}

/* ---- connections ------------------------------------------------------------------------------------------------ */

static bool has_room(void *context, const struct handshake *handshake)
{
    const char *id = handshake->room_id;
    struct problem problem;
    if (handshake->identity.source !=
        IDENTITY_MACHINE) /* a room that is not there is like one that is closed to them */
        return id[0] != 0;
    return rooms_find(context, id) || asleep_find(context, id) || !net_rooms_are_known(context, &problem);
}

/* A plan is loaded for members, not for whoever knows the address of a room. */
static void enter_if_member(struct visitor *visitor)
{
    if (!visitor->waits || !visitor->room || !room_has_member(visitor->room->room, visitor->connection))
        return;
    visitor->waits = false;
    bridge_enter(visitor);
}

static void free_early(struct visitor *visitor)
{
    while (visitor->early) {
        struct early_text *text = visitor->early;
        visitor->early = text->next;
        free(text);
    }
    visitor->n_early_bytes = 0;
}

/* The room that connections wait for is awake, or cannot be. */
static void let_in(void *context, const char *id, const struct problem *problem)
{
    struct net *net = context;
    struct net_room *room = problem ? NULL : rooms_find(net, id);
    for (struct visitor *visitor = net->visitors; visitor; visitor = visitor->next) {
        if (visitor->is_outside || strcmp(visitor->asleep, id) != 0)
            continue;
        visitor->asleep[0] = 0;
        visitor->room = room;
        if (!room) {
            free_early(visitor);
            ws_bye(visitor->connection, WS_CLOSE_NORMAL, problem ? problem->detail : "the room is closed",
                   problem && problem->type != PROBLEM_NOT_FOUND ? WS_RETRY_MS : -1);
            continue;
        }
        if (!visitor->waits)
            bridge_enter(visitor);
        for (const struct early_text *text = visitor->early; text && visitor->room; text = text->next)
            room_text_came(room->room, visitor->connection, text->text, text->n, clock_now_us());
        enter_if_member(visitor);
        free_early(visitor);
        schedule_settle(room);
    }
}

static void keep_early(struct visitor *visitor, const char *text, size_t n)
{
    struct early_text **at = &visitor->early;
    struct early_text *early = visitor->n_early_bytes + n <= MAX_EARLY_BYTES ? malloc(sizeof *early + n) : NULL;
    if (!early) {
        visitor->asleep[0] = 0;
        free_early(visitor);
        ws_bye(visitor->connection, WS_CLOSE_NORMAL, "too much was said before the room was awake", WS_RETRY_MS);
        return;
    }
    *early = (struct early_text){ .n = n };
    memcpy(early->text, text, n);
    while (*at)
        at = &(*at)->next;
    *at = early;
    visitor->n_early_bytes += n + sizeof *early;
}

/* The first text of one to whom its room, which slept, is not listed: only a key wakes it. */
static void knock(struct net *net, struct visitor *visitor, const char *text, size_t n)
{
    char id[sizeof visitor->asleep];
    memcpy(id, visitor->asleep, sizeof id);
    visitor->is_outside = false;
    visitor->room = rooms_find(net, id);
    if (!visitor->room && asleep_find(net, id) &&
        (net_asleep_is_seen_by(net, id, &visitor->identity) || stranger_has_key(text, n))) {
        keep_early(visitor, text, n);
        if (visitor->asleep[0])
            asleep_wake(net, id, let_in, net);
        return;
    }
    visitor->asleep[0] = 0;
    if (!visitor->room)
        stranger_refuse(visitor, text, n);
}

static void connection_opened(void *context, struct ws_connection *connection, const struct handshake *handshake)
{
    struct net *net = context;
    const char *id = handshake->room_id;
    struct problem problem;
    struct visitor *visitor = mem_new(sizeof *visitor);
    *visitor = (struct visitor){
        .next = net->visitors, .connection = connection, .room = rooms_find(net, id), .identity = handshake->identity
    };
    visitor->waits = handshake->identity.source != IDENTITY_MACHINE;
    net->visitors = visitor;
    ws_set_owner(connection, visitor);
    if (!visitor->room && asleep_find(net, id)) {
        (void)snprintf(visitor->asleep, sizeof visitor->asleep, "%s", id);
        visitor->is_outside = !net_asleep_is_seen_by(net, id, &visitor->identity);
        if (!visitor->is_outside)
            asleep_wake(net, id, let_in, net);
    } else if (visitor->room && !visitor->waits)
        bridge_enter(visitor);
    else if (visitor->room || (visitor->waits && net_rooms_are_known(net, &problem)))
        return; /* what comes of it depends on the hello */
    else if (net_rooms_are_known(net, &problem))
        ws_bye(connection, WS_CLOSE_NORMAL, ROOM_IS_CLOSED, -1);
    else
        ws_bye(connection, WS_CLOSE_NORMAL, problem.detail, problem.retry_after_ms);
}

static void message_received(void *context, struct ws_connection *connection, enum ws_opcode kind, const char *text,
                             size_t n)
{
    struct visitor *visitor = ws_owner(connection);
    (void)kind; /* always a text: ws refuses binary messages */
    if (visitor->is_outside)
        knock(context, visitor, text, n);
    else if (visitor->asleep[0])
        keep_early(visitor, text, n);
    else if (!visitor->room && visitor->waits && !visitor->is_refused)
        stranger_refuse(visitor, text, n);
    struct net_room *room = visitor->room;
    if (!room)
        return;
    schedule_room_at(room, room_text_came(room->room, connection, text, n, clock_now_us()));
    enter_if_member(visitor);
    room->net->is_spoken_to = true;
}

/* Somebody does something: what depends on time is looked at often again. */
static void leave_calm(struct net *net)
{
    net->calm_from_us = clock_now_us() + CALM_AFTER_US;
    tick_within(net, FLEET_TICK_US);
}

/* Once for all messages that have come together: two hundred members acknowledge each picture. */
static void settle_messages(struct net *net)
{
    if (!net->is_spoken_to)
        return;
    net->is_spoken_to = false;
    leave_calm(net);
    handle_due(net);
}

static bool is_greeted(void *context, struct ws_connection *connection)
{
    const struct visitor *visitor = ws_owner(connection);
    (void)context;
    if (visitor->asleep[0]) /* it has said something, and the disk is slow to give the room */
        return visitor->early != NULL;
    return visitor->room && room_has_member(visitor->room->room, connection);
}

static void connection_closed(void *context, struct ws_connection *connection)
{
    struct net *net = context;
    struct visitor *visitor = ws_owner(connection), **at = &net->visitors;
    while (*at != visitor)
        at = &(*at)->next;
    *at = visitor->next;
    if (visitor->room) {
        bridge_leave(visitor);
        room_connection_lost(visitor->room->room, connection, ws_heard_us(connection), clock_now_us());
        schedule_room(visitor->room);
    }
    free_early(visitor);
    free(visitor);
}

const struct plan_rights *net_plan_rights(const struct net *net)
{
    return &net->plan_rights;
}

struct fleet *net_fleet(struct net *net)
{
    return net->fleet;
}

void net_count(const struct net *net, struct net_counters *counters)
{
    struct ws_counters ws;
    ws_count(net->ws, &ws);
    *counters = (struct net_counters){ .rooms = net->closed,
                                       .connections = ws.opened,
                                       .connections_refused = ws.refused,
                                       .n_connections = ws.n_connections };
    for (size_t i = 0; i < net->n_rooms; i++)
        room_count(net->rooms[i]->room, &counters->rooms);
}

/* ---- the store ------------------------------------------------------------------------------------------------------ */

static void handle_answer(struct net *net, void *argument)
{
    struct store_answer *answer = argument;
    switch (answer->event) {
    case STORE_OPENED:
        net->store_was_open = true;
        keep_audit_written(net, answer);
        asleep_add_all(net, answer->rooms, answer->n_rooms);
        meetings_add_all(net, answer);
        statements_add_all(net, answer);
        if (answer->is_new)
            keep_all_again(net);
        break;
    case STORE_WRITTEN:
        keep_written(net, answer);
        keep_write_due(net, false);
        break;
    case STORE_READ: rooms_was_read(net, answer); break;
    case STORE_PART: keep_part_was_read(net, answer); break;
    case STORE_RECORDS: keep_records_were_read(net, answer); break;
    case STORE_ERASE: erase_answered(net, answer); break;
    case STORE_AUDIT: keep_audit_was_read(net, answer); break;
    case STORE_FAILING:
    case STORE_FINE:
        net->store_fails = answer->event == STORE_FAILING;
        net->store_is_full = net->store_fails && answer->error.code == ERROR_LIMIT;
        if (net->auth)
            auth_store_fails(net->auth, net->store_fails);
        break;
    }
    store_answer_free(answer);
}

/* On the store's thread, or the caller's of store_create: nobody is served before accounts were read. */
static void store_answered(void *context, struct store_answer *answer)
{
    struct net *net = context;
    if (answer->event == STORE_OPENED && net->auth)
        auth_load(net->auth, answer->accounts, answer->is_new);
    struct task *task = mem_new(sizeof *task);
    *task = (struct task){ handle_answer, answer };
    while (!net_is_stopping(net)) { /* when it stops it waits for this thread, and no answer is needed */
        if (queue_try_put(net->tasks, task)) {
            ws_wake(net->ws);
            return;
        }
        sched_yield();
    }
    store_answer_free(answer);
    free(task);
}

/* ---- tasks and the thread --------------------------------------------------------------------------------------- */

static bool run_tasks(struct net *net)
{
    bool has_run = false;
    for (struct task *task; (task = queue_try_take(net->tasks)); has_run = true) {
        task->run(net, task->argument);
        free(task);
    }
    return has_run;
}

static void woken(void *context)
{
    struct net *net = context;
    fleet_handle_events(net->fleet);
    tell_listed(net, fleet_n_lists(net->fleet));
    tick_within(net, CALM_TICK_US);
    if (run_tasks(net)) { /* a task may have changed any room */
        leave_calm(net);
        keep_write_due(net, false);
        settle_all(net);
    }
}

void net_post(struct net *net, void (*run)(struct net *net, void *argument), void *argument)
{
    struct task *task = mem_new(sizeof *task);
    *task = (struct task){ run, argument };
    bool is_net_thread = pthread_equal(pthread_self(), net->thread);
    while (!queue_try_put(net->tasks, task)) { /* full: wait; the net thread itself makes room instead */
        if (is_net_thread)
            run_tasks(net);
        else
            sched_yield();
    }
    ws_wake(net->ws);
}

bool net_plans_are_listed(const struct net *net)
{
    return atomic_load(&net->is_listed);
}

bool net_is_stopping(const struct net *net)
{
    return atomic_load(&net->is_stopping);
}

struct adoption {
    int socket;
    struct handshake handshake;
    struct ws_count count;
};

static void adopt(struct net *net, void *argument)
{
    struct adoption *adoption = argument;
    if (net_is_stopping(net)) {
        ws_refuse_as_stopping(net->ws, adoption->socket);
        adoption->count.ended(adoption->count.context);
    } else {
        ws_adopt(net->ws, adoption->socket, &adoption->handshake, &adoption->count);
    }
    free(adoption);
}

void net_adopt(struct net *net, int socket, const struct handshake *handshake, void (*ended)(void *context),
               void *context)
{
    struct adoption *adoption = mem_new(sizeof *adoption);
    *adoption = (struct adoption){ socket, *handshake, { ended, context } };
    net_post(net, adopt, adoption);
}

static void wake(void *context)
{
    struct net *net = context;
    ws_wake(net->ws);
}

static size_t n_connections(const struct net *net)
{
    struct ws_counters counters;
    ws_count(net->ws, &counters);
    return counters.n_connections;
}

static void *work(void *context)
{
    struct net *net = context;
    struct problem stops;
    (void)prctl(PR_SET_NAME, "net");
    run_tasks(net); /* the rooms that are on disk */
    while (!net_is_stopping(net)) {
        schedule_wake(net);
        ws_serve(net->ws);
        settle_messages(net);
    }
    run_tasks(net);
    for (size_t i = 0; i < net->n_rooms; i++) {
        room_recording_cut(net->rooms[i]->room, clock_now_us());
        room_audit_flush(net->rooms[i]->room, clock_now_us());
    }
    often_finish(net);
    keep_write_due(net, true);
    for (struct visitor *visitor = net->visitors; visitor;
         visitor = visitor->next) /* before room_destroy says bye with another reason */
        ws_bye(visitor->connection, WS_CLOSE_GOING_AWAY, "the server is being stopped", RESTART_RETRY_MS);
    problem_set(&stops, PROBLEM_BUSY, "", "", "the server is stopping");
    asleep_tell(net, NULL, &stops);
    keep_readers_finish(net);
    keep_record_readers_finish(net);
    keep_audit_readers_finish(net);
    erase_end(net);
    meetings_end(net);
    statements_end(net);
    tell_listed(net, UINT64_MAX);
    while (net->n_rooms) {
        room_end_because(net->rooms[0]->room, "the server is being stopped");
        rooms_close(net, 0);
    }
    keep_write_due(net, true); /* what was recorded while rooms were closed */
    if (net->auth)
        auth_attach(net->auth, NULL);
    store_destroy(net->store); /* writes what it was handed over */
    net->store = NULL;
    int64_t end_us = clock_now_us() + FAREWELL_US;
    while (n_connections(net) && clock_now_us() < end_us) {
        ws_wake_at(net->ws, end_us);
        ws_serve(net->ws);
    }
    fleet_destroy(net->fleet); /* calls every outstanding reply, which may post tasks */
    net->fleet = NULL;
    run_tasks(net);
    return NULL;
}

struct net *net_create(const struct net_options *options, struct error *err)
{
    struct net *net = mem_new(sizeof *net);
    net->files_looked = keep_files_looked;
    net->meeting_doors = &meeting_doors;
    net->max_rooms = options->max_rooms > 0 ? options->max_rooms : 200;
    net->room_idle_close_s = options->room_idle_close_s;
    net->limits = options->room;
    net->plan_rights = (struct plan_rights){ .access = options->access, .auth = options->auth };
    net->is_alone = options->is_alone;
    net->is_still = options->is_still;
    net->rights = options->rights;
    net->auth = options->auth;
    net->rooms = mem_array((size_t)net->max_rooms, sizeof net->rooms[0], 1 << 20, err);
    net->tasks = queue_create(MAX_TASKS, free);
    const struct ws_callbacks callbacks = {
        has_room, connection_opened, message_received, is_greeted, connection_closed, woken, timer_fired, net
    };
    net->ws = net->rooms ? ws_create(&callbacks, &ws_limits_default, options->allowed_origin, err) : NULL;
    if (!net->ws)
        goto fail;
    struct fleet_options fleet = options->fleet;
    fleet.wake = wake;
    fleet.changed = bridge_fleet_changed;
    fleet.statement = statements_find;
    fleet.context = net;
    if (options->database)
        store_erase_resume(options->database); /* before the plans are listed */
    net->fleet = fleet_create(&fleet, err);
    if (!net->fleet)
        goto fail;
    const struct store_options store = { options->database, store_answered, net };
    if (options->database && !(net->store = store_create(&store, err)))
        goto fail;
    if (net->auth)
        auth_attach(net->auth, net->store);
    if (pthread_create(&net->thread, NULL, work, net) != 0) {
        error_set(err, ERROR_IO, "no thread could be started");
        goto fail;
    }
    return net;
fail:
    if (net->auth)
        auth_attach(net->auth, NULL);
    atomic_store(&net->is_stopping, true);
    store_destroy(net->store);
    fleet_destroy(net->fleet);
    ws_destroy(net->ws);
    queue_destroy(net->tasks);
    free(net->rooms);
    free(net);
    return NULL;
}

void net_destroy(struct net *net)
{
    if (!net)
        return;
    atomic_store(&net->is_stopping, true);
    ws_wake(net->ws);
    (void)pthread_join(net->thread, NULL);
    ws_destroy(net->ws);
    queue_destroy(net->tasks);
    asleep_finish(net);
    meetings_finish(net);
    statements_finish(net);
    for (size_t i = 0; i < net->n_audit; i++)
        free(net->audit[i]);
    free(net->audit);
    free(net->undeleted);
    free(net->rooms);
    free(net);
}
