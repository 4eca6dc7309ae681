#pragma once
/* Tells the members what of the room is on disk: the message saved. Internal to server/room. */
#include "server/room/state/room_state.h"

enum { SAVED_EVERY_MS = 1000 }; /* between two messages; a disk that fails, or works again, is told at once */

void saved_init(struct room *room); /* with the room */
void saved_free(struct room *room);

/* Tells a member who has just come. */
void saved_show(struct room *room, struct member *member);
/* Tells all what is due. Returns when it is due again. */
int64_t saved_settle(struct room *room);
