#pragma once
/* Public part of who a room is for. Included by room.h. */
#include "server/room/state/room_types.h"

/* Sets whose room it is: the user who made it. Before its first member. */
void room_set_owner(struct room *room, const char *user);
const char *room_owner(const struct room *room); /* "": nobody */
/* Whether a room with this in store_room is listed to this user: it is theirs, they were asked in by name or group, for
 * either of which they need a role on its plan; or they have a seat in it by a link. people NULL: nobody was asked. */
bool room_people_name(const char *owner, const char *people, const struct identity *who, bool has_role);
