#pragma once
/* Beginning of a room that was made from a bookmark: its scene, once the plan is loaded, and the cameras of its
 * shared views (stream_first_view). Internal to server/room; what others use (room_begin_with, room_beginning) stands
 * in room.h. */
#include "server/room/state/room_state.h"

/* The first scene of the room, the caller's: defaults where it began with nothing. NULL: no memory. */
NODISCARD cJSON *beginning_scene(struct room *room, const cJSON *plan, const cJSON *defaults);
void beginning_free(struct room *room);
