#pragma once
/* Public part of a link that lets new members in. Included by room.h. */
#include "server/room/state/room_types.h"

/* The eight digits that name the link of this token in the audit. */
void room_link_digits(const char *token, char digits[9]);
