#pragma once
/* Where members point: passed on to all others, the newest place of each member only, at a bounded rate. Not part of
 * the scene. Internal to server/room. */
#include "server/room/state/room_state.h"
#include "server/wire/message.h"

enum {
    POINTER_EVERY_MS = 30,   /* between two places of a member that are passed on */
    POINTER_FULL_RATE = 512, /* members who point times members of the room; with more, each is passed on less often */
    POINTER_KEPT_MS = 8000,  /* a pointer that does not move is taken away after this */
};

bool pointer_move(struct room *room, struct member *member, const struct message *message, struct problem *problem);
/* The member points no more: the connection is gone, or the right to point. */
void pointer_end(struct room *room, struct member *member);
/* Sends all pointers to a member who has just come. */
void pointers_show(struct room *room, struct member *member);
/* Passes on what is due and ends what does not move. Returns when it is due again. */
int64_t pointers_settle(struct room *room);
