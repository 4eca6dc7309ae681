#pragma once
/* The body of a bookmark as the room keeps it (server/wire/bookmark.h): the room adds the plan, the token and, when the
 * page sends none, the scene. Internal to server/room. */
#include "server/room/items/item_list.h"
#include "server/wire/bookmark.h"

/* The body, checked and complete, as a new document; pointers of problems begin with /body. Without scene (or with
 * null) the bookmark gets that of the room as it is now, with the patch `override`, which is not kept: the scene that a
 * member on their own sees. A token is given once, by the room, and stays; a page may repeat it. before: the bookmark
 * that is changed; NULL: a new one. is_restored: from the store: kept as it is. NULL with problem. */
NODISCARD cJSON *bookmark_body_read(const struct room *room, const cJSON *body, const struct item *before,
                                    bool is_restored, struct problem *problem);
/* The body of this bookmark, the caller's. NULL: no memory, or its row is damaged. */
NODISCARD cJSON *bookmark_body_of(const struct item *item);
