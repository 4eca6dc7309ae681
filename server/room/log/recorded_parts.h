#pragma once
/* The parts of a room as documents of a meeting log (meeting_log.h), and such a state as a document for clients.
 * Internal to server/room. */
#include "server/room/state/room_state.h"

/* Each an object of documents, the caller's. */
NODISCARD cJSON *recorded_members(const struct room *room);
NODISCARD cJSON *recorded_views(const struct room *room);
NODISCARD cJSON *recorded_pointers(const struct room *room);
NODISCARD cJSON *recorded_items(const struct room *room);
/* The one document of its part. */
NODISCARD cJSON *recorded_scene(const struct room *room);
/* The whole state of the room; presenter and all. */
NODISCARD cJSON *recorded_state(const struct room *room);
/* Items of a state, [row], the oldest first; borrowed rows in a new list, to be freed with cJSON_Delete. */
NODISCARD cJSON *recorded_item_list(const cJSON *state);
