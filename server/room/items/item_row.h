#pragma once
/* The row of an item as text: what the body of each kind may be, writing a row, and reading one that was kept
 * (room_restore_item of room.h). Knows nothing of who may change items: items.h. Internal to server/room. */
#include "server/room/items/item_list.h"

const char *item_word(enum wire_item_kind kind);
/* The body, checked and complete, as text for free(). NULL with problem. */
NODISCARD char *item_body_text(const struct room *room, enum wire_item_kind kind, const cJSON *body,
                               const struct item *before, bool is_restored, struct problem *problem);
/* The text of the row of an item with this body, for free(). NULL: no memory. */
NODISCARD char *item_row_text(const struct item *item, const char *body);
