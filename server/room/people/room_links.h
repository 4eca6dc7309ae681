#pragma once
/* Links that let new members in. Included by room.h. */
#include "server/room/state/room_types.h"

/* Makes a link; token gets 32 digits and a final zero. False with problem limit. */
NODISCARD bool room_link_create(struct room *room, enum wire_member_role role, int64_t expires_s, bool is_one_use,
                                int64_t now_us, char token[33], struct problem *problem);
/* The eight digits that name the link of this token in the audit. */
void room_link_mark(const char *token, char mark[9]);
