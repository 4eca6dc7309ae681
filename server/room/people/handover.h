#pragma once
/* Control passes from one member to another: the handlers of requests, giving, taking and the lock. Internal to
 * server/room. */
#include "server/room/state/room_state.h"
#include "server/wire/message.h"

/* Handlers; each returns false with a problem when it applied nothing. */
bool control_request(struct room *room, struct member *member, const struct message *message, struct problem *problem);
bool control_give(struct room *room, struct member *member, const struct message *message, struct problem *problem);
bool control_refuse(struct room *room, struct member *member, const struct message *message, struct problem *problem);
bool control_take(struct room *room, struct member *member, const struct message *message, struct problem *problem);
bool control_lock(struct room *room, struct member *member, const struct message *message, struct problem *problem);
