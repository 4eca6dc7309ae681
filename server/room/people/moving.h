#pragma once
/* Handlers of the messages by which people go on to a meeting's next case; what others ask is in room_moving.h.
 * Internal to server/room. */
#include "server/room/state/room_state.h"
#include "server/wire/message.h"

bool meeting_next_case(struct room *room, struct member *member, const struct message *message,
                       struct problem *problem);
bool meeting_go_along(struct room *room, struct member *member, const struct message *message, struct problem *problem);
/* Tells a member who has come in how the meeting stands. */
void meeting_show(struct room *room, struct member *member);
