#pragma once
/* The net thread's state, shared by the files of server/net: connections, rooms, outstanding picture requests. Internal
 * to server/net; everything on the net thread, but for the two atomics. */
#include <stdatomic.h>

#include <pthread.h>

#include "core/base/queue.h"
#include "server/fleet/fleet.h"
#include "server/room/room.h"
#include "server/ws/ws.h"

struct net;

struct visitor { /* one WebSocket connection, from its opening on */
    struct visitor *next;
    struct ws_connection *connection;
    struct net_room *room; /* NULL: its room was closed */
    bool holds_plan;       /* fleet_hold, on the room's plan */
};

struct picture_request { /* sent to the fleet and not yet answered */
    struct picture_request *next;
    struct net_room *room;
    uint64_t fleet_request, room_request;
    uint32_t scene_revision;
    uint8_t flags, quality, scale_percent; /* for the frame's header */
    bool is_override;                      /* the packet carries a scene of its own */
};

struct net_room { /* a room and what the net thread keeps beside it */
    struct net *net;
    struct room *room;
    struct picture_request *requests;
    bool renderer_has_scene; /* the renderer was sent the room's present scene */
    /* the plan as last reported to the room */
    uint32_t generation; /* 0: never ready */
    enum fleet_state state;
    char phase[200];
    double percent;
    int64_t wake_us;        /* when room_tick is due */
    int64_t empty_since_us; /* 0: a member is connected */
};

struct net {
    pthread_t thread;
    struct ws *ws;
    struct fleet *fleet;
    struct queue *tasks;
    struct visitor *visitors;
    struct net_room **rooms; /* room for max_rooms */
    size_t n_rooms;
    int max_rooms, room_idle_close_s;
    struct room_limits limits;
    int64_t fleet_tick_us;              /* when fleet_tick is due */
    struct room_counters closed;        /* sum over the rooms that were closed */
    atomic_bool is_listed, is_stopping; /* read by any thread */
};
