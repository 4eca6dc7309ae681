#pragma once
/* People who may come in without a link, as a list of users and groups with the role of each: of a room and of a
 * meeting. Plain data; any thread. */
#include "server/wire/identity.h"
#include "server/wire/json.h"
#include "wire_gen.h"

struct named {
    char who[IDENTITY_MAX_USER + 2]; /* a user's id, or @ and a group's */
    bool has_role;                   /* else the highest that they may have */
    enum wire_member_role role;
};

/* Orders roles: who has a higher one has all rights of a lower one. */
int role_rank(enum wire_member_role role);
/* True of text (NULL: false) that can be such an id. */
bool named_is_id(const char *text);
/* True if `who` names this user or one of their groups. */
bool named_is(const char *who, const struct identity *identity);
/* The entry that gives this person most: the one of their own, else the highest of their groups. NULL: none. */
const struct named *named_find(const struct named *list, size_t n, const struct identity *identity);
/* [{who, role}] */
NODISCARD cJSON *named_list(const struct named *list, size_t n);
