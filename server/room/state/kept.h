#pragma once
/* What of a room is to be kept. Internal to server/room. */
#include "server/room/state/room_state.h"

/* Something that is kept has changed. parts: of enum room_part */
void kept_changed(struct room *room, unsigned parts);
