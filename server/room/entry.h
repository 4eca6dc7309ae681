#pragma once
/* How a call comes into a room and leaves it. Internal to server/room; the folders below know nothing of it. */
#include "server/room/room.h"
#include "server/room/state/room_state.h"

/* Each entry begins with room_enter, the one place that sets the room's time, and ends with room_leave, which does what
 * follows: room_settle. Only what comes before the first member, or at the end of a room, has no room_leave. */
void room_enter(struct room *room, int64_t now_us);
void room_leave(struct room *room);

/* Applies a member's message: role, replay, the handler. False with problem: nothing of it was applied. */
NODISCARD bool room_apply(struct room *room, struct member *member, const struct message *message,
                          struct problem *problem);
/* Records that a message was refused, if it is of the kind that is recorded. what: the name of the message. */
void room_audit_refused(struct room *room, const struct member *member, const char *what,
                        const struct problem *problem);
/* The member who makes a call: member as in room_call_may. NULL: nobody of the room. */
struct member *room_caller(const struct room *room, const char *member);
