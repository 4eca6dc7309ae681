#include "server/daemon/net.h"

#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "core/base/queue.h"
#include "server/ws/ws.h"

enum {
    MAX_TASKS = 4096,          /* waiting; who posts more waits */
    FLEET_TICK_US = 250000,
    FAREWELL_US = 1000000,     /* at the end: for byes to get out */
    MAX_SIDE_PX = 16384,
};

struct task {
    void (*run)(struct net *net, void *argument);
    void *argument;
};

struct visitor { /* a connection, from its opening on */
    struct visitor *next;
    struct ws_connection *connection;
    struct place *place; /* NULL: its room is gone */
};

struct asked { /* a picture asked for */
    struct asked *next;
    struct place *place;
    uint64_t fleet_request, room_request;
    uint32_t scene_revision;
    uint8_t flags, quality, scale_percent;
    bool is_override;
};

struct place { /* a room and what belongs to it here */
    struct net *net;
    struct room *room;
    struct asked *asked;
    uint32_t generation;     /* of the renderer that knows the scene; 0 none */
    enum fleet_state state;  /* as last told to the room */
    char phase[128];
    double percent;
    int64_t wake_us;         /* when the room wants to be called */
    int64_t empty_since_us;  /* 0: somebody is here */
};

struct net {
    pthread_t thread;
    struct ws *ws;
    struct fleet *fleet;
    struct queue *tasks;
    struct visitor *visitors;
    struct place **places;
    size_t n_places;
    int max_rooms, room_idle_close_s;
    struct room_limits limits;
    int64_t fleet_tick_us;
    struct room_counters closed; /* of rooms that are gone */
    atomic_bool is_stopping;
};

/* ---- time ----------------------------------------------------------------------------------------------------------- */

static void plan_next_call(struct net *net)
{
    int64_t next_us = net->fleet_tick_us;
    for (size_t i = 0; i < net->n_places; i++)
        if (net->places[i]->wake_us < next_us)
            next_us = net->places[i]->wake_us;
    ws_wake_at(net->ws, next_us);
}

/* After anything that may have changed when the room wants to be called. */
static void touch(struct place *place)
{
    int64_t now_us = clock_now_us();
    place->wake_us = room_tick(place->room, now_us);
    if (room_n_connected(place->room))
        place->empty_since_us = 0;
    else if (place->empty_since_us == 0)
        place->empty_since_us = now_us;
}

static void touch_all(struct net *net)
{
    for (size_t i = 0; i < net->n_places; i++)
        touch(net->places[i]);
    plan_next_call(net);
}

static void close_idle_rooms(struct net *net)
{
    int64_t now_us = clock_now_us(), after_us = net->room_idle_close_s * INT64_C(1000000);
    for (size_t i = net->n_places; net->room_idle_close_s > 0 && i-- > 0;) {
        const struct place *place = net->places[i];
        if (place->empty_since_us && now_us - place->empty_since_us >= after_us) {
            log_info("room closed: nobody there for %d s", net->room_idle_close_s);
            net_room_delete(net, room_id(place->room));
        }
    }
}

static void time_came(void *context)
{
    struct net *net = context;
    int64_t now_us = clock_now_us();
    if (now_us >= net->fleet_tick_us) {
        net->fleet_tick_us = now_us + FLEET_TICK_US;
        fleet_tick(net->fleet);
        close_idle_rooms(net);
    }
    for (size_t i = 0; i < net->n_places; i++)
        if (net->places[i]->wake_us <= now_us)
            touch(net->places[i]);
    plan_next_call(net);
}

/* ---- rooms to the fleet --------------------------------------------------------------------------------------------- */

static struct place *place_of(struct net *net, const char *id)
{
    for (size_t i = 0; i < net->n_places; i++)
        if (strcmp(room_id(net->places[i]->room), id) == 0)
            return net->places[i];
    return NULL;
}

static void unlink_asked(struct asked *asked)
{
    struct asked **at = &asked->place->asked;
    while (*at != asked)
        at = &(*at)->next;
    *at = asked->next;
}

/* The renderer may be in the hands of a hostile file: what it says is checked as if it came from outside. */
static bool whole(const cJSON *json, const char *name, double least, double most, double *value)
{
    *value = json_number(json, name, NAN);
    return *value >= least && *value <= most;
}

static bool read_frame(const struct asked *asked, const struct packet *answer, struct frame_header *header)
{
    double width, height, render_us, encode_us, pixels_per_mm, revision;
    const cJSON *json = answer->json, *matrix = cJSON_GetObjectItemCaseSensitive(json, "clip_from_lps_mm");
    const char *type = json_text(json, "type");
    if (!type || strcmp(type, "frame") != 0 || answer->n_blob == 0 || answer->n_blob > UINT32_MAX)
        return false;
    if (!whole(json, "width_px", 1, MAX_SIDE_PX, &width) || !whole(json, "height_px", 1, MAX_SIDE_PX, &height) ||
        !whole(json, "render_us", 0, UINT32_MAX, &render_us) || !whole(json, "encode_us", 0, UINT32_MAX, &encode_us) ||
        !whole(json, "pixels_per_mm", 0, 4e6, &pixels_per_mm) || !whole(json, "scene_revision", 0, UINT32_MAX, &revision) ||
        cJSON_GetArraySize(matrix) != 16)
        return false;
    *header = (struct frame_header){ .codec = 1,
                                     .flags = asked->flags,
                                     .quality = asked->quality,
                                     .scale_percent = asked->scale_percent,
                                     .scene_revision = asked->is_override ? asked->scene_revision : (uint32_t)revision,
                                     .width_px = (uint16_t)width,
                                     .height_px = (uint16_t)height,
                                     .render_us = (uint32_t)render_us,
                                     .encode_us = (uint32_t)encode_us,
                                     .payload_bytes = (uint32_t)answer->n_blob,
                                     .pixels_per_mm_1000 = (uint32_t)lround(pixels_per_mm * 1000) };
    int i = 0;
    const cJSON *number;
    cJSON_ArrayForEach(number, matrix)
    {
        if (!cJSON_IsNumber(number) || !isfinite((float)number->valuedouble))
            return false;
        header->clip_from_lps_mm[i++] = (float)number->valuedouble;
    }
    if (json_flag(json, "is_light", false))
        header->flags |= FRAME_LIGHT; /* the renderer knows whether it really drew the lighter meshes */
    return true;
}

static void picture_came(void *context, struct packet *answer, const struct problem *problem)
{
    struct asked *asked = context;
    struct place *place = asked->place;
    struct problem broken;
    struct frame_header header;
    unlink_asked(asked);
    if (answer && !read_frame(asked, answer, &header)) {
        problem_set(&broken, PROBLEM_RENDERER, "", "", "the renderer's answer is not a frame");
        answer = NULL;
        problem = &broken;
    }
    if (answer) {
        struct room_picture *picture = mem_new(sizeof *picture);
        *picture = (struct room_picture){ .header = header, .bytes = answer->blob, .n_bytes = answer->n_blob, .references = 1 };
        answer->blob = NULL; /* taken */
        room_picture_came(place->room, asked->room_request, picture, clock_now_us());
    } else {
        room_picture_failed(place->room, asked->room_request, problem, clock_now_us());
    }
    free(asked);
    touch(place);
    plan_next_call(place->net);
}

static struct place *place_with(struct net *net, const struct room *room)
{
    for (size_t i = 0; i < net->n_places; i++)
        if (net->places[i]->room == room)
            return net->places[i];
    return NULL;
}

static void render(void *context, struct room *room, const struct room_render *request)
{
    struct net *net = context;
    struct place *place = place_with(net, room);
    cJSON *packet = cJSON_CreateObject();
    cJSON_AddStringToObject(packet, "type", "render");
    if (request->scene)
        cJSON_AddItemReferenceToObject(packet, "scene", (cJSON *)(uintptr_t)request->scene);
    else
        cJSON_AddStringToObject(packet, "room", room_id(room));
    cJSON_AddItemReferenceToObject(packet, "view", (cJSON *)(uintptr_t)request->view);
    cJSON_AddNumberToObject(packet, "scale_percent", request->scale_percent);
    cJSON_AddNumberToObject(packet, "quality", request->quality);
    cJSON_AddStringToObject(packet, "codec", "jpeg");
    cJSON_AddBoolToObject(packet, "full_color", request->full_color);
    cJSON_AddStringToObject(packet, "detail", request->light ? "light" : "full");
    cJSON_AddBoolToObject(packet, "still", request->is_still);

    struct asked *asked = mem_new(sizeof *asked);
    *asked = (struct asked){ .next = place->asked,
                             .place = place,
                             .room_request = request->request,
                             .scene_revision = request->scene_revision,
                             .flags = (uint8_t)((request->is_still ? FRAME_STILL : 0) | (request->full_color ? FRAME_FULL_COLOR : 0)),
                             .quality = (uint8_t)request->quality,
                             .scale_percent = (uint8_t)request->scale_percent,
                             .is_override = request->scene != NULL };
    place->asked = asked;
    asked->fleet_request = fleet_request(net->fleet, room_plan_id(room), packet, picture_came, asked);
    cJSON_Delete(packet);
}

static void scene_changed(void *context, struct room *room, const cJSON *scene, uint32_t revision)
{
    struct net *net = context;
    cJSON *packet = cJSON_CreateObject();
    cJSON_AddStringToObject(packet, "type", "scene");
    cJSON_AddStringToObject(packet, "room", room_id(room));
    cJSON_AddNumberToObject(packet, "revision", revision);
    cJSON_AddItemReferenceToObject(packet, "scene", (cJSON *)(uintptr_t)scene);
    (void)fleet_tell(net->fleet, room_plan_id(room), packet); /* not ready: it is told when it is */
    cJSON_Delete(packet);
}

/* ---- the fleet to rooms --------------------------------------------------------------------------------------------- */

static void tell_ready(struct place *place, const struct fleet_plan *plan)
{
    const cJSON *gl = fleet_gl(place->net->fleet, NULL);
    const char *back_end = json_text(gl, "back_end"), *renderer = json_text(gl, "renderer");
    char words[200];
    (void)snprintf(words, sizeof words, "%s%s%s", back_end ? back_end : "", back_end && renderer ? ", " : "", renderer ? renderer : "");
    place->generation = plan->generation;
    room_plan_ready(place->room, plan->document, plan->default_scene, plan->image_ids, words, json_flag(gl, "is_software", true),
                    clock_now_us());
}

static void tell_state(struct place *place, const struct fleet_plan *plan)
{
    enum wire_renderer_state state = WIRE_RENDERER_STATE_STARTING;
    struct problem closed;
    const struct problem *problem = NULL;
    switch (plan->state) {
    case FLEET_STARTING: state = WIRE_RENDERER_STATE_STARTING; break;
    case FLEET_LOADING: state = WIRE_RENDERER_STATE_LOADING; break;
    case FLEET_READY: state = WIRE_RENDERER_STATE_READY; break;
    case FLEET_RESTARTING: state = WIRE_RENDERER_STATE_RESTARTING; break;
    case FLEET_UNREADABLE:
    case FLEET_FAILED:
        state = WIRE_RENDERER_STATE_FAILED;
        problem = plan->problem;
        break;
    case FLEET_CLOSED: /* somebody closed it while we look: only opening it again helps */
        state = WIRE_RENDERER_STATE_FAILED;
        problem_set(&closed, PROBLEM_CANCELLED, "", "", "the plan was closed");
        problem = &closed;
        break;
    }
    room_renderer_state(place->room, state, plan->phase, plan->percent, problem);
}

static void tell_plan(struct place *place)
{
    struct fleet_plan plan;
    if (!fleet_plan_find(place->net->fleet, room_plan_id(place->room), &plan))
        return;
    const char *phase = plan.phase ? plan.phase : "";
    bool is_same = plan.state == place->state && strcmp(phase, place->phase) == 0 && plan.percent == place->percent;
    if (plan.state == FLEET_READY ? place->state == FLEET_READY && place->generation == plan.generation : is_same)
        return;
    place->state = plan.state;
    place->percent = plan.percent;
    (void)snprintf(place->phase, sizeof place->phase, "%s", phase);
    if (plan.state == FLEET_READY && plan.document && plan.default_scene)
        tell_ready(place, &plan);
    else
        tell_state(place, &plan);
    touch(place);
}

static void fleet_changed(void *context, const char *plan_id)
{
    struct net *net = context;
    char id[64];
    if (!plan_id)
        return; /* rooms live on plans, not on the list */
    (void)snprintf(id, sizeof id, "%s", plan_id); /* borrowed until the next call into the fleet */
    for (size_t i = 0; i < net->n_places; i++)
        if (strcmp(room_plan_id(net->places[i]->room), id) == 0)
            tell_plan(net->places[i]);
    plan_next_call(net);
}

/* ---- connections ---------------------------------------------------------------------------------------------------- */

static void send_text(void *context, void *connection, const char *text)
{
    (void)context;
    ws_send_text(connection, text);
}

static void send_frame(void *context, void *connection, const struct frame_header *header, struct room_picture *picture)
{
    (void)context;
    ws_send_frame(connection, header, picture);
}

static void close_connection(void *context, void *connection)
{
    (void)context;
    ws_close(connection);
}

static bool has_room(void *context, const char *id)
{
    return place_of(context, id) != NULL;
}

static void opened(void *context, struct ws_connection *connection, const char *id)
{
    struct net *net = context;
    struct visitor *visitor = mem_new(sizeof *visitor);
    *visitor = (struct visitor){ .next = net->visitors, .connection = connection, .place = place_of(net, id) };
    net->visitors = visitor;
    ws_set_owner(connection, visitor);
    if (!visitor->place)
        ws_bye(connection, "the room is closed", -1);
}

static void text_came(void *context, struct ws_connection *connection, const char *text, size_t n)
{
    struct place *place = ((struct visitor *)ws_owner(connection))->place;
    if (!place)
        return;
    room_text_came(place->room, connection, text, n, clock_now_us());
    touch(place);
    plan_next_call(context);
}

static bool is_greeted(void *context, struct ws_connection *connection)
{
    const struct visitor *visitor = ws_owner(connection);
    (void)context;
    return visitor->place && room_has_member(visitor->place->room, connection);
}

static void connection_closed(void *context, struct ws_connection *connection)
{
    struct net *net = context;
    struct visitor *visitor = ws_owner(connection), **at = &net->visitors;
    while (*at != visitor)
        at = &(*at)->next;
    *at = visitor->next;
    if (visitor->place) {
        room_connection_closed(visitor->place->room, connection, clock_now_us());
        touch(visitor->place);
        plan_next_call(net);
    }
    free(visitor);
}

/* ---- rooms ---------------------------------------------------------------------------------------------------------- */

/* 40 random bits as "7q4k-m2wz", without letters that are taken for another. */
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

struct room *net_room_create(struct net *net, const char *plan_id, struct problem *problem)
{
    char id[16];
    if (net_is_stopping(net)) {
        problem_set(problem, PROBLEM_BUSY, "", "", "the server is stopping");
        return NULL;
    }
    if (net->n_places >= (size_t)net->max_rooms) {
        problem_set(problem, PROBLEM_LIMIT, "", "", "there are %zu rooms already, at most %d are allowed", net->n_places, net->max_rooms);
        return NULL;
    }
    if (!id_is_valid(plan_id)) {
        problem_set(problem, PROBLEM_VALIDATION, "/plan", "pattern", "/plan is \"%.40s\", expected 1 to 63 of a-z, 0-9 and -", plan_id);
        return NULL;
    }
    do
        if (!make_id(id)) {
            problem_set(problem, PROBLEM_INTERNAL, "", "", "the system gave no random numbers");
            return NULL;
        }
    while (place_of(net, id));
    if (!fleet_open(net->fleet, plan_id, problem))
        return NULL;
    fleet_hold(net->fleet, plan_id);
    const struct room_callbacks callbacks = { render, scene_changed, send_text, send_frame, close_connection, net };
    struct place *place = mem_new(sizeof *place);
    *place = (struct place){ .net = net, .room = room_create(id, plan_id, &callbacks, &net->limits), .state = FLEET_CLOSED };
    net->places[net->n_places++] = place;
    tell_plan(place);
    touch(place);
    plan_next_call(net);
    return place->room;
}

struct room *net_room_find(struct net *net, const char *id)
{
    struct place *place = place_of(net, id);
    return place ? place->room : NULL;
}

void net_room_delete(struct net *net, const char *id)
{
    size_t index = 0;
    while (index < net->n_places && strcmp(room_id(net->places[index]->room), id) != 0)
        index++;
    if (index == net->n_places)
        return;
    struct place *place = net->places[index];
    net->places[index] = net->places[--net->n_places];
    while (place->asked) {
        struct asked *asked = place->asked;
        place->asked = asked->next;
        fleet_forget_request(net->fleet, asked->fleet_request);
        free(asked);
    }
    cJSON *packet = cJSON_CreateObject();
    cJSON_AddStringToObject(packet, "type", "forget");
    cJSON_AddStringToObject(packet, "room", room_id(place->room));
    (void)fleet_tell(net->fleet, room_plan_id(place->room), packet);
    cJSON_Delete(packet);
    fleet_release(net->fleet, room_plan_id(place->room));
    for (struct visitor *visitor = net->visitors; visitor; visitor = visitor->next)
        if (visitor->place == place) {
            if (!room_has_member(place->room, visitor->connection)) /* members hear it from the room */
                ws_bye(visitor->connection, "the room is closed", -1);
            visitor->place = NULL;
        }
    room_count(place->room, &net->closed);
    room_destroy(place->room);
    free(place);
    plan_next_call(net);
}

size_t net_n_rooms(const struct net *net)
{
    return net->n_places;
}

struct room *net_room_at(const struct net *net, size_t index)
{
    return index < net->n_places ? net->places[index]->room : NULL;
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
    for (size_t i = 0; i < net->n_places; i++)
        room_count(net->places[i]->room, &counters->rooms);
}

/* ---- tasks and the thread ------------------------------------------------------------------------------------------- */

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
        touch_all(net); /* a task may have changed any room */
}

void net_post(struct net *net, void (*run)(struct net *net, void *argument), void *argument)
{
    struct task *task = mem_new(sizeof *task);
    *task = (struct task){ run, argument };
    bool is_us = pthread_equal(pthread_self(), net->thread);
    while (!queue_try_put(net->tasks, task)) { /* thousands wait: so does who adds to them, but for the thread that works them off */
        if (is_us)
            run_tasks(net);
        else
            sched_yield();
    }
    ws_wake(net->ws);
}

bool net_is_stopping(const struct net *net)
{
    return atomic_load(&net->is_stopping);
}

static void adopt(struct net *net, void *argument)
{
    int socket = (int)(intptr_t)argument;
    if (net_is_stopping(net))
        (void)close(socket);
    else
        ws_adopt(net->ws, socket);
}

void net_adopt(struct net *net, int socket)
{
    net_post(net, adopt, (void *)(intptr_t)socket);
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
    plan_next_call(net);
    while (!net_is_stopping(net))
        ws_serve(net->ws);
    run_tasks(net);
    while (net->n_places)
        net_room_delete(net, room_id(net->places[0]->room));
    int64_t end_us = clock_now_us() + FAREWELL_US;
    while (n_connections(net) && clock_now_us() < end_us)
        ws_serve(net->ws); /* the fleet's time wakes it four times a second */
    fleet_destroy(net->fleet); /* every reply that is owed comes now, and may post */
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
    net->places = mem_array((size_t)net->max_rooms, sizeof net->places[0], 1 << 20, err);
    net->tasks = queue_create(MAX_TASKS, free);
    const struct ws_callbacks callbacks = { has_room, opened, text_came, is_greeted, connection_closed, woken, time_came, net };
    net->ws = net->places ? ws_create(&callbacks, options->allowed_origin, err) : NULL;
    if (!net->ws)
        goto fail;
    struct fleet_options fleet = options->fleet;
    fleet.wake = wake;
    fleet.changed = fleet_changed;
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
    free(net->places);
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
    free(net->places);
    free(net);
}
