#pragma once
/* Counts WebSockets, in all and by the client's address, from when the front hands them on until they are gone. */
#include <stdatomic.h>

#include "server/front/front.h"

struct websocket_place {
    atomic_bool is_used;    /* set by the front's thread, cleared by any */
    struct address counted; /* front's thread */
};

struct websocket_count {
    struct websocket_place places[FRONT_MAX_WEBSOCKETS];
};

void websocket_count_init(struct websocket_count *count);
/* Counts one more of this client. NULL with problem at a limit. The front's thread. */
struct websocket_place *websocket_count_add(struct websocket_count *count, const struct address *client,
                                            struct problem *problem);
void websocket_count_ended(void *place); /* a struct websocket_place: this one is gone. Any thread. */
