#pragma once
/* Items of a room: notes with their replies, bookmarks, checks, decisions, signatures and acceptances. Puts, changes
 * and deletes them with their limits and versions, and tells the members. What a body holds is the business of its
 * kind's reader alone (note_body.h). Internal to server/room; what others use (room_items, room_restore_item,
 * item_changed) stands in room.h. */
#include "server/room/state/room_state.h"
#include "server/wire/message.h"

/* The handlers of item.put and item.delete. */
bool items_put(struct room *room, struct member *member, const struct message *message, struct problem *problem);
void items_written(struct room *room, uint64_t number, const struct problem *problem); /* room_item_written */
void items_forget_keeping(struct room *room);                                          /* with the room */
bool items_hide(struct room *room, struct member *member, const struct message *message, struct problem *problem);
bool items_delete(struct room *room, struct member *member, const struct message *message, struct problem *problem);
