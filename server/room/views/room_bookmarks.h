#pragma once
/* Bookmarks of a room, and rooms that begin with one. Included by room.h. */
#include "server/room/state/room_types.h"

/* Bookmarks. The body of one by its id or by the token of its permalink, the caller's; NULL: there is none. */
NODISCARD cJSON *room_bookmark(const struct room *room, const char *id, uint32_t *version);
NODISCARD cJSON *room_bookmark_of_token(const struct room *room, const char *token);
/* The state of the room's plan that a bookmark shows: bookmark_open of server/wire/bookmark.h. NULL with problem: the
 * plan is not loaded, or there is no memory. */
NODISCARD cJSON *room_bookmark_open(const struct room *room, const cJSON *body, struct problem *problem);
/* The room begins with what a bookmark of its plan shows, instead of with the plan's own scene and home cameras. Before
 * its first member. False with problem: no memory. */
NODISCARD bool room_begin_with(struct room *room, const cJSON *body, struct problem *problem);
/* {name, layout, views: [{view, document}], report, n_report} of the bookmark that the room began with; the report only
 * once the plan was loaded. NULL: it began with none. */
NODISCARD cJSON *room_beginning(const struct room *room);
