#pragma once
/* How a call comes into a room and leaves it. Internal to server/room; the folders below know nothing of it. */
#include "server/room/room.h"
#include "server/room/state/room_state.h"

/* Each entry begins with room_enter, the one place that sets the room's time, and ends with room_leave, which does what
 * follows: room_settle. Only what comes before the first member, or at the end of a room, has no room_leave. */
void room_enter(struct room *room, int64_t now_us);
void room_leave(struct room *room);
