/* Creates and destroys the net thread; its tasks, its clock, its connections, and the life of rooms. */
#include "server/net/net.h"

#include <errno.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/net/bridge.h"
#include "server/net/net_state.h"
#include "server/net/schedule.h"

enum {
    MAX_TASKS = 4096, /* tasks that may wait; one more makes net_post wait */
    FLEET_TICK_US = 250000,
    FAREWELL_US = 1000000,   /* at the end, for the byes to be sent */
    RESTART_RETRY_MS = 2000, /* when pages reconnect after a stop: about the time of a restart */
};

struct task {
    void (*run)(struct net *net, void *argument);
    void *argument;
};

/* ---- time ------------------------------------------------------------------------------------------------------- */

static void schedule_all(struct net *net)
{
    for (size_t i = 0; i < net->n_rooms; i++)
        schedule_room(net->rooms[i]);
    schedule_wake(net);
}

static void close_idle_rooms(struct net *net)
{
    int64_t now_us = clock_now_us(), after_us = net->room_idle_close_s * INT64_C(1000000);
    for (size_t i = net->n_rooms; net->room_idle_close_s > 0 && i-- > 0;) {
        const struct net_room *room = net->rooms[i];
        if (room->empty_since_us && now_us - room->empty_since_us >= after_us) {
            log_info("room closed: nobody there for %d s", net->room_idle_close_s);
            net_room_delete(net, room_id(room->room));
        }
    }
}

static void timer_fired(void *context)
{
    struct net *net = context;
    int64_t now_us = clock_now_us();
    if (now_us >= net->fleet_tick_us) {
        net->fleet_tick_us = now_us + FLEET_TICK_US;
        fleet_tick(net->fleet);
        close_idle_rooms(net);
    }
    for (size_t i = 0; i < net->n_rooms; i++)
        if (net->rooms[i]->wake_us <= now_us)
            schedule_room(net->rooms[i]);
    schedule_wake(net);
}

/* ---- connections ------------------------------------------------------------------------------------------------ */

static struct net_room *find_room(struct net *net, const char *id)
{
    for (size_t i = 0; i < net->n_rooms; i++)
        if (strcmp(room_id(net->rooms[i]->room), id) == 0)
            return net->rooms[i];
    return NULL;
}

static void send_text(void *context, void *connection, const char *text)
{
    (void)context;
    ws_send_text(connection, text);
}

static void send_latest(void *context, void *connection, uint32_t key, const char *text)
{
    (void)context;
    ws_send_latest(connection, key, text);
}

static void send_frame(void *context, void *connection, const struct frame_header *header, struct room_picture *picture)
{
    (void)context;
    ws_send_frame(connection, header, picture);
}

static void close_connection(void *context, void *connection)
{
    (void)context;
    ws_close(connection, WS_CLOSE_NORMAL);
}

static bool has_room(void *context, const char *id)
{
    return find_room(context, id) != NULL;
}

static void connection_opened(void *context, struct ws_connection *connection, const char *id)
{
    struct net *net = context;
    struct visitor *visitor = mem_new(sizeof *visitor);
    *visitor = (struct visitor){ .next = net->visitors, .connection = connection, .room = find_room(net, id) };
    net->visitors = visitor;
    ws_set_owner(connection, visitor);
    if (visitor->room)
        bridge_enter(visitor);
    else
        ws_bye(connection, WS_CLOSE_NORMAL, "the room is closed", -1);
}

static void message_received(void *context, struct ws_connection *connection, enum ws_opcode kind, const char *text,
                             size_t n)
{
    (void)kind; /* always a text: ws refuses binary messages */
    struct net_room *room = ((struct visitor *)ws_owner(connection))->room;
    if (!room)
        return;
    room_text_came(room->room, connection, text, n, clock_now_us());
    schedule_room(room);
    schedule_wake(context);
}

static bool is_greeted(void *context, struct ws_connection *connection)
{
    const struct visitor *visitor = ws_owner(connection);
    (void)context;
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
        room_connection_closed(visitor->room->room, connection, clock_now_us());
        schedule_room(visitor->room);
        schedule_wake(net);
    }
    free(visitor);
}

/* ---- rooms ------------------------------------------------------------------------------------------------------ */

/* 40 random bits as "7q4k-m2wz". The letters i, l and o and the digit 1 are left out: they are misread. */
static bool make_id(char id[16])
{
    static const char letters[] = "abcdefghjkmnpqrstuvwxyz023456789";
    uint8_t bytes[8];
    if (getrandom(bytes, sizeof bytes, 0) != (ssize_t)sizeof bytes)
        return false;
    char *at = id;
    for (int i = 0; i < 8; i++) {
        if (i == 4)
            *at++ = '-';
        *at++ = letters[bytes[i] % 32];
    }
    *at = 0;
    return true;
}

struct room *net_room_create(struct net *net, const char *plan_id, const cJSON *bookmark, struct problem *problem)
{
    char id[16];
    if (net_is_stopping(net)) {
        problem_set(problem, PROBLEM_BUSY, "", "", "the server is stopping");
        return NULL;
    }
    if (net->n_rooms >= (size_t)net->max_rooms) {
        problem_set(problem, PROBLEM_LIMIT, "", "", "there are %zu rooms already, at most %d are allowed", net->n_rooms,
                    net->max_rooms);
        return NULL;
    }
    if (!id_is_valid(plan_id)) {
        problem_set(problem, PROBLEM_VALIDATION, "/plan", "pattern",
                    "/plan is \"%.40s\", expected 1 to 63 of a-z, 0-9 and -", plan_id);
        return NULL;
    }
    do
        if (!make_id(id)) {
            problem_set(problem, PROBLEM_INTERNAL, "", "", "the system gave no random numbers");
            return NULL;
        }
    while (find_room(net, id));
    if (!fleet_open(net->fleet, plan_id, problem))
        return NULL;
    const struct room_callbacks callbacks = { bridge_render,    bridge_forget, bridge_scene_changed,
                                              send_text,        send_latest,   send_frame,
                                              close_connection, NULL,          net };
    struct net_room *room = mem_new(sizeof *room);
    *room = (struct net_room){ .net = net,
                               .room = room_create(id, plan_id, &callbacks, &net->limits),
                               .state = FLEET_CLOSED };
    if (bookmark && !room_begin_with(room->room, bookmark, problem)) {
        room_destroy(room->room);
        free(room);
        return NULL;
    }
    net->rooms[net->n_rooms++] = room;
    bridge_report_plan(room);
    schedule_room(room);
    schedule_wake(net);
    return room->room;
}

struct room *net_room_find(struct net *net, const char *id)
{
    struct net_room *room = find_room(net, id);
    return room ? room->room : NULL;
}

void net_room_delete(struct net *net, const char *id)
{
    size_t index = 0;
    while (index < net->n_rooms && strcmp(room_id(net->rooms[index]->room), id) != 0)
        index++;
    if (index == net->n_rooms)
        return;
    struct net_room *room = net->rooms[index];
    net->rooms[index] = net->rooms[--net->n_rooms];
    bridge_close_room(room);
    for (struct visitor *visitor = net->visitors; visitor; visitor = visitor->next)
        if (visitor->room == room) {
            if (!room_has_member(room->room, visitor->connection)) /* members get theirs from room_destroy */
                ws_bye(visitor->connection, WS_CLOSE_NORMAL, "the room is closed", -1);
            bridge_leave(visitor);
            visitor->room = NULL;
        }
    room_count(room->room, &net->closed);
    room_destroy(room->room);
    free(room);
    schedule_wake(net);
}

size_t net_n_rooms(const struct net *net)
{
    return net->n_rooms;
}

struct room *net_room_at(const struct net *net, size_t index)
{
    return index < net->n_rooms ? net->rooms[index]->room : NULL;
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
    if (run_tasks(net))
        schedule_all(net); /* a task may have changed any room */
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
    schedule_wake(net);
    while (!net_is_stopping(net))
        ws_serve(net->ws);
    run_tasks(net);
    for (struct visitor *visitor = net->visitors; visitor;
         visitor = visitor->next) /* before room_destroy says bye with another reason */
        ws_bye(visitor->connection, WS_CLOSE_GOING_AWAY, "the server is being stopped", RESTART_RETRY_MS);
    while (net->n_rooms)
        net_room_delete(net, room_id(net->rooms[0]->room));
    int64_t end_us = clock_now_us() + FAREWELL_US;
    while (n_connections(net) && clock_now_us() < end_us)
        ws_serve(net->ws);     /* fleet_tick wakes it four times a second */
    fleet_destroy(net->fleet); /* calls every outstanding reply, which may post tasks */
    net->fleet = NULL;
    run_tasks(net);
    return NULL;
}

struct net *net_create(const struct net_options *options, struct error *err)
{
    struct net *net = mem_new(sizeof *net);
    net->max_rooms = options->max_rooms > 0 ? options->max_rooms : 200;
    net->room_idle_close_s = options->room_idle_close_s;
    net->limits = options->room;
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
    fleet.context = net;
    net->fleet = fleet_create(&fleet, err);
    if (!net->fleet)
        goto fail;
    if (pthread_create(&net->thread, NULL, work, net) != 0) {
        error_set(err, ERROR_IO, "no thread could be started");
        goto fail;
    }
    return net;
fail:
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
    free(net->rooms);
    free(net);
}
