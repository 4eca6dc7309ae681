#pragma once
/* Public part of links that let new members in. Included by room.h. */
#include "server/room/state/room_types.h"

struct room_link { /* one that is to be made */
    enum wire_member_role role;
    int64_t expires_s; /* ROOM_LINK_MIN_S to ROOM_LINK_MAX_S */
    bool is_one_use, allows_guests;
    const char *maker, *name; /* the user who makes it; what it is for. "": not known */
};

/* Makes a link; token gets 32 digits and a final zero. False with problem limit. */
NODISCARD bool room_link_make(struct room *room, const struct room_link *wanted, int64_t now_us, char token[33],
                              struct problem *problem);
/* The eight digits that name the link of this token in the audit. */
void room_link_digits(const char *token, char digits[9]);
