#pragma once
/* Roles of members and what they may do, by the table of proto/messages.json; the colours by which members are told
 * apart. Internal to server/room, but for server/http, which asks for the rights of a call. */
#include "server/room/state/room_state.h"
#include "server/wire/message.h"
#include "server/wire/named.h"

enum { ROLES_N_COLORS = 12 };

bool role_has_right(enum wire_member_role role, enum wire_right right);
enum wire_member_role role_lower(enum wire_member_role a, enum wire_member_role b);
/* The role of this word; false: it is none's. */
bool role_of_word(const char *word, enum wire_member_role *role);
/* The rights of a guest are fewer than those of the role: looks and points, and writes notes if the role does. */
bool member_has_right(const struct member *member, enum wire_right right);
bool member_check(const struct member *member, enum wire_right right, struct problem *problem);
/* True if the role has the right; else fills problem, forbidden with the code "role". */
bool role_check(enum wire_member_role role, enum wire_right right, struct problem *problem);
/* The colour that the fewest members of the room have, the first of these: a number below ROLES_N_COLORS. */
int color_of_newcomer(const struct room *room);
uint32_t color_rgb(int color); /* 0xrrggbb */
