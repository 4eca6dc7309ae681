#pragma once
/* The identity behind a connection or a call, as the room's owner tells it. Internal to server/room. */
#include "server/room/state/room_state.h"

enum { WHO_KEY = 257 }; /* bytes of who_key */

/* True of one who has signed in, so has a user's id. */
static inline bool who_is_user(const struct identity *who)
{
    return who->user[0] != 0;
}

/* True without sign-in: whoever reaches the server is its one person. */
static inline bool who_is_machine(const struct identity *who)
{
    return who->source == IDENTITY_MACHINE;
}

/* Never NULL; good as long as the connection. NULL: that of nobody's connection. */
const struct identity *who_connects(const struct room *room, void *connection);
/* The identity of the member who acts now: by a call over HTTP, else at its connection. */
const struct identity *who_acts(const struct room *room, const struct member *member);
/* The word by which tabs of one person are found, and a link for one person is held to its first user. person: as in
 * hello. */
void who_key(const struct identity *who, const char *person, char key[WHO_KEY]);
void who_key_of_user(const char *user, char key[WHO_KEY]); /* user "": "" */
/* The part of this role that the identity holds: a token that may only read is an observer. */
enum wire_member_role who_holds(const struct identity *who, enum wire_member_role role);
/* Whether the seat of a member is this identity's: without sign-in each, else that of the same user, or of a guest or
 * wall who has not signed in. */
bool who_has_seat(const struct identity *who, const char *user, bool is_guest, enum wire_member_role role);
/* Whether the caller's own items and seats include what this user wrote. */
bool who_is_same_user(const char *user, const char *other);
