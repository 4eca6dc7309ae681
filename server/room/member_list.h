#pragma once
/* The members of a room: finding one, and the list of members as JSON (room_members). Internal to server/room. */
#include "server/room/room_state.h"

/* The member that uses this connection; NULL: it has not said hello. */
struct member *member_of_connection(const struct room *room, const void *connection);
/* True if one of the member's views follows a shared view. */
bool member_follows(const struct member *member);
