#pragma once
/* Items of a room for its owner: notes with their replies, bookmarks, acceptances, and the record of a review. Included
 * by room.h. */
#include "server/room/state/room_types.h"

/* Items: notes with their replies, and bookmarks. [row] of one kind, oldest first, as in the message welcome; NULL: no
 * memory. */
NODISCARD cJSON *room_items(const struct room *room, enum wire_item_kind kind);
/* Whether the room has an item with this id, of this kind. */
bool room_item_is(const struct room *room, const char *id, enum wire_item_kind kind);
/* Gives a room an item that was kept: the row of item_changed. All rows of a room before its first member, in the order
 * of created_ms; neither item_changed nor a message follows. False with problem when the row is damaged, there already
 * or beyond a limit: the others can still be restored. */
NODISCARD bool room_restore_item(struct room *room, const char *row, size_t n, struct problem *problem);

/* Items whose writing was asked for and is not answered. */
size_t room_n_items_written(const struct room *room);

/* [{thing, with, by, words}], borrowed until the next call: the acceptances of this room that count for the files of
 * its plan, which the renderer is sent with every scene of the room. NULL: there are none. */
const cJSON *room_acceptances(const struct room *room);

/* The record of the review: {format, version, room, plan, plan_revision, revision, made_ms, present, n_present_dropped,
 * checklist, decisions, signatures, notes, saved_views, saved}; proto/record.json describes it. NULL: no memory. */
NODISCARD cJSON *room_record(const struct room *room);
/* The files of the open plan have changed on the disk since they were read: members are told, and nothing is decided or
 * signed until they are read anew. Times since 1970; changed_ms 0: they are as they were read. */
void room_files(struct room *room, int64_t changed_ms, int64_t read_ms);
