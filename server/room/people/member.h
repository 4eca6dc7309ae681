#pragma once
/* Members: entering with hello, coming back with the secret, leaving. Internal to server/room. */
#include "server/room/state/room_state.h"
#include "server/wire/message.h"

/* Makes the connection a member; returns false when it was refused with bye. */
struct member *member_hello(struct room *room, void *connection, const struct message_hello *hello);
/* A new member, away; NULL: the room is full. */
struct member *member_seat(struct room *room, const char *name, enum wire_member_role role);
/* Says bye to a connection that has said something else than hello and could not enter by what it is: nothing tells it
 * whether there is the room. False: it could. */
bool member_refuse_stranger(struct room *room, void *connection);
/* Sends the list of members and the presenter, to a newcomer and to the others. */
void members_show(struct room *room, struct member *member);
void member_disconnected(struct room *room, struct member *member, int64_t heard_us); /* away since heard_us */
/* The member is none any more, and cannot come back; nobody is told, as more may follow. */
void member_drop(struct room *room, struct member *member);
/* Drops members that have been away for ROOM_MEMBER_KEPT_S. Returns when the next one is due. */
int64_t members_settle_away(struct room *room);
void members_free(struct room *room);
/* Closes the views of members whose connection was closed for want of memory. Returns INT64_MAX. */
int64_t members_settle_lost(struct room *room);
/* Settles presenter and lags; sends all members the list if one of them changed. Returns when a lag may change next. */
int64_t members_settle(struct room *room);
