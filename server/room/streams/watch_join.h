#pragma once
/* Which stream the small pictures of the presenter show, and what their members are told. Internal to server/room. */
#include "server/room/state/room_state.h"
#include "server/wire/message.h"

/* The handler of the message watch. */
bool watch_set(struct room *room, struct member *member, const struct message *message, struct problem *problem);
/* After whatever may have changed who presents, or the main view: those who watch go over to it, or see none.
 * Returns INT64_MAX. */
int64_t watches_follow(struct room *room);
/* Sends the member the picture whose turn has come, and tells whether it is late; returns when it is due again. */
int64_t watch_settle(struct room *room, struct member *member);
/* Like watch_settle, for all members. */
int64_t watches_settle(struct room *room);
