/* Begins rooms with what a bookmark shows, and finds bookmarks: beginning.h, room.h. */
#include "server/room/views/beginning.h"

#include <string.h>

#include "server/room/items/bookmark_body.h"
#include "server/room/views/room_bookmarks.h"

/* ---- bookmarks of a room ---------------------------------------------------------------------------------------- */

cJSON *room_bookmark(const struct room *room, const char *id, uint32_t *version)
{
    for (const struct item *item = room->items->first; item; item = item->next)
        if (item->kind == WIRE_ITEM_KIND_BOOKMARK && strcmp(item->id, id) == 0) {
            *version = item->version;
            return bookmark_body_of(item);
        }
    return NULL;
}

cJSON *room_bookmark_of_token(const struct room *room, const char *token)
{
    for (const struct item *item = room->items->first; item; item = item->next) {
        if (item->kind != WIRE_ITEM_KIND_BOOKMARK || !strstr(item->row, token))
            continue; /* before the row is parsed: there may be many */
        cJSON *body = bookmark_body_of(item);
        if (bookmark_has_token(body, token))
            return body;
        cJSON_Delete(body);
    }
    return NULL;
}

cJSON *room_bookmark_open(const struct room *room, const cJSON *body, struct problem *problem)
{
    if (room->shared.plan)
        return bookmark_open(body, room->shared.plan, room->shared.defaults, problem);
    problem_set(problem, PROBLEM_BUSY, "", "", "the plan of this room is not loaded yet");
    problem->retry_after_ms = 500;
    return NULL;
}

/* ---- a room that begins with one -------------------------------------------------------------------------------- */

bool room_begin_with(struct room *room, const cJSON *body, struct problem *problem)
{
    cJSON *copy = cJSON_Duplicate(body, true), *views = copy ? bookmark_views(copy) : NULL;
    if (!views) {
        cJSON_Delete(copy);
        return json_no_memory(problem, "a bookmark");
    }
    beginning_free(room);
    room->beginning.bookmark = copy;
    room->beginning.views = views;
    return true;
}

void beginning_free(struct room *room)
{
    cJSON_Delete(room->beginning.bookmark);
    cJSON_Delete(room->beginning.views);
    cJSON_Delete(room->beginning.opened);
    room->beginning.bookmark = room->beginning.views = room->beginning.opened = NULL;
}

cJSON *beginning_scene(struct room *room, const cJSON *plan, const cJSON *defaults)
{
    if (!room->beginning.bookmark)
        return cJSON_Duplicate(defaults, true);
    cJSON *begun = bookmark_open(room->beginning.bookmark, plan, defaults, NULL);
    if (!begun)
        return NULL;
    cJSON_Delete(room->beginning.opened);
    room->beginning.opened = begun;
    return cJSON_DetachItemFromObjectCaseSensitive(begun, "scene");
}

cJSON *room_beginning(const struct room *room)
{
    static const char *const shown[] = { "name", "layout", "views", "report", "n_report" };
    if (!room->beginning.bookmark)
        return NULL;
    cJSON *answer = cJSON_CreateObject();
    for (size_t i = 0; i < sizeof shown / sizeof shown[0]; i++) {
        const cJSON *item =
            cJSON_GetObjectItemCaseSensitive(room->beginning.opened ? room->beginning.opened : room->beginning.bookmark,
                                             shown[i]);
        if (item)
            json_add(answer, shown[i], cJSON_Duplicate(item, true));
    }
    return answer;
}
