#pragma once
/* The list of rooms as people see it: those that are awake, then those that sleep, the last used first. Net thread. */
#include "server/net/net.h"

struct net_listed {
    const char *name; /* borrowed; "": none was given */
    bool is_mine;     /* the user's own, one they were in or were asked to; true of all for the machine's person */
    int64_t used_ms;  /* when somebody was last in it, since 1970 */
    char names[ROOM_NAMES_BYTES]; /* of those who were in it, each ended by '\n' */
};

size_t net_n_listed(const struct net *net);
/* The id of the plan of the room at index, perhaps that of a time when people signed in, or when they did not. */
const char *net_listed_plan(const struct net *net, size_t index);
/* False: it is not listed to this user, or nobody changed anything in it and nobody is there. */
bool net_listed_at(const struct net *net, size_t index, const struct identity *who, struct net_listed *row);
/* room_document, of a sleeping room without members, with is_mine and used_ms. */
NODISCARD cJSON *net_listed_document(const struct net *net, size_t index, const struct net_listed *row);
/* The name that a room was given, also of one that sleeps; borrowed. "": none; NULL: there is no such room. */
const char *net_room_name(const struct net *net, const char *room_id);
