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

struct unrecorded { /* has changed since the recording looked */
    unsigned parts;
    char (*items)[16]; /* ids, while a recording runs */
    size_t n_items;
};

void events_init(struct room *room); /* with the room */
void events_free(struct room *room);

/* These parts have changed. id: the item's, with ROOM_ITEMS; else NULL. */
void room_event(struct room *room, unsigned parts, const char *id);
const struct unrecorded *events_unrecorded(const struct room *room);
/* Changes of items since the room was made. */
uint64_t events_n_item_changes(const struct room *room);
/* The recording has looked at everything, or (parts) is to look at these again. */
void unrecorded_reset(struct room *room, unsigned parts);
