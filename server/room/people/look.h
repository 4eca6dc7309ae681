#pragma once
/* "Look here": one member asks all others to look at a point, and sees who came. One request stands in a room at a
 * time. Internal to server/room. */
#include "server/room/state/room_state.h"
#include "server/wire/message.h"

enum {
    LOOK_KEPT_S = 60,    /* how long a request stands */
    LOOK_EVERY_MS = 250, /* between two messages about it */
};

bool look_here(struct room *room, struct member *member, const struct message *message, struct problem *problem);
bool look_come(struct room *room, struct member *member, const struct message *message, struct problem *problem);
/* The member has gone: the own request is over. */
void look_end(struct room *room, const struct member *member);
/* Sends the request that stands, if any, to a member who has just come. */
void look_show(struct room *room, struct member *member);
/* Sends what is due, and ends the request after its time. Returns when it is due again. */
int64_t look_settle(struct room *room);
void look_init(struct room *room); /* with the room */
void look_free(struct room *room);
