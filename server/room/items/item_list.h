#pragma once
/* The list of a room's items, oldest first, with its limits; room_items is here. Who may change them and what they
 * hold: items.h. Internal to server/room. */
#include "server/room/state/room_state.h"

/* NULL: there is none with this id. */
struct item *items_find(const struct room *room, const char *id);
bool items_has(const struct room *room, enum wire_item_kind kind);
/* Whether the room has the place for a row of n bytes in the stead of `before` (NULL: a new one). False with problem.
 */
NODISCARD bool items_have_place(const struct room *room, const struct item *before, size_t n, struct problem *problem);
/* Gives the item this row (taken). An item that is not in the list becomes the last one. */
void items_keep(struct room *room, struct item *item, char *row);
void items_drop(struct room *room, struct item *item); /* frees it */
void items_free(struct room *room);
/* [row], of all kinds, oldest first. NULL: no memory. */
NODISCARD cJSON *items_rows(const struct room *room);
