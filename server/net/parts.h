#pragma once
/* What the files of this folder share; nobody else includes it.
 *   net.c      the thread, its tasks and clock; connections; life of rooms
 *   bridge.c   rooms and the fleet: pictures asked for and come, scenes made known, states told */
#include <stdatomic.h>

#include <pthread.h>

#include "core/base/queue.h"
#include "server/net/net.h"
#include "server/ws/ws.h"

struct visitor { /* a connection, from its opening on */
    struct visitor *next;
    struct ws_connection *connection;
    struct place *place; /* NULL: its room is gone */
    bool is_holding;     /* the plan of the place */
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
    bool is_scene_told;     /* the renderer has the scene as it is */
    uint32_t generation;    /* of the renderer, as last told to the room; 0 none */
    enum fleet_state state; /* as last told to the room */
    char phase[200];
    double percent;
    int64_t wake_us;        /* when the room wants to be called */
    int64_t empty_since_us; /* 0: somebody is here */
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
    atomic_bool is_listed, is_stopping;
};

/* bridge.c: callbacks of rooms and of the fleet; context is the net */
void bridge_render(void *context, struct room *room, const struct room_render *request);
void bridge_forget(void *context, struct room *room, uint64_t request);
void bridge_scene_changed(void *context, struct room *room, const cJSON *scene, uint32_t revision);
void bridge_fleet_changed(void *context, const char *plan_id);
/* What the room has not been told yet of its plan's state. */
void bridge_tell_plan(struct place *place);
/* Somebody entered: the plan is opened if it is not, and stays open while somebody is there. */
void bridge_enter(struct visitor *visitor);
void bridge_leave(struct visitor *visitor);

/* net.c: after anything that may have changed when the room, or any room, wants to be called */
void net_touch(struct place *place);
void net_plan_next_call(struct net *net);
