#pragma once
/* The name of a room, and who has been in it, for lists of rooms. Internal to server/room. */
#include "server/room/state/room_state.h"

void name_show(struct room *room, struct member *member); /* to a newcomer */
/* Tells all members. by: who gave it, NULL: nobody of the room. */
void name_set(struct room *room, const char *name, const struct identity *who, const struct member *by,
              const char *address);
