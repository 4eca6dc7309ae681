#pragma once
/* Tells the disk and the recording that a part of the room has changed: the one way to both. Internal to server/room.
 */
#include "server/room/state/room_state.h"

/* Parts beside those of enum room_part, which are kept on disk: these are recorded alone. */
enum {
    ROOM_POINTERS = 64,
    ROOM_ITEMS = 128, /* items are kept by room_callbacks.item_changed and item_first */
    ROOM_PLAN = 256,  /* another plan document: every part of the room may look different */
    ROOM_ALL_RECORDED = ROOM_ALL_PARTS | ROOM_POINTERS | ROOM_ITEMS
};

/* These parts have changed. id: the item's, with ROOM_ITEMS; else NULL. */
void room_event(struct room *room, unsigned parts, const char *id);
/* The recording has looked at everything, or (parts) is to look at these again. */
void unrecorded_reset(struct room *room, unsigned parts);
