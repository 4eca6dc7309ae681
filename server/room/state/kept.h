#pragma once
/* Notes which parts of a room are to be written to disk. Internal to server/room. */
#include "server/room/state/room_state.h"

/* Something that is kept has changed. parts: of enum room_part */
void kept_changed(struct room *room, unsigned parts);
