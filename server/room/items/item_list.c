/* Keeps a room's items as the texts of their rows. */
#include "server/room/items/item_list.h"
#include "server/room/items/room_items.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

void items_init(struct room *room)
{
    room->items = mem_new(sizeof *room->items);
}

struct item *items_find(const struct room *room, const char *id)
{
    for (struct item *item = room->items->first; item; item = item->next)
        if (strcmp(item->id, id) == 0)
            return item;
    return NULL;
}

bool items_has(const struct room *room, enum wire_item_kind kind)
{
    const struct item *item = room->items->first;
    while (item && item->kind != kind)
        item = item->next;
    return item != NULL;
}

void items_keep(struct room *room, struct item *item, char *row)
{
    struct item **last = &room->items->first;
    while (*last && *last != item)
        last = &(*last)->next;
    if (!*last) {
        *last = item;
        room->items->n++;
    }
    room->items->n_bytes -= item->row ? strlen(item->row) : 0;
    free(item->row);
    item->row = row;
    room->items->n_bytes += strlen(row);
}

bool items_have_place(const struct room *room, const struct item *before, size_t n, struct problem *problem)
{
    size_t others = room->items->n_bytes - (before ? strlen(before->row) : 0), n_items = room->items->n;
    for (const struct keeping *keeping = room->items->keeping; keeping; keeping = keeping->next) {
        others += strlen(keeping->item.row);
        n_items += !keeping->is_change;
    }
    if (!before && n_items >= ROOM_MAX_ITEMS)
        return problem_set(problem, PROBLEM_LIMIT, "", "",
                           "the room has %zu notes, replies and bookmarks, at most %d are allowed; delete some",
                           room->items->n, ROOM_MAX_ITEMS);
    if (others > ROOM_MAX_ITEMS_BYTES || n > ROOM_MAX_ITEMS_BYTES - others)
        return problem_set(problem, PROBLEM_LIMIT, "", "",
                           "notes, replies and bookmarks of the room have %zu bytes and this one %zu, at most %d are "
                           "allowed together; delete some",
                           others, n, ROOM_MAX_ITEMS_BYTES);
    return true;
}

void items_drop(struct room *room, struct item *item)
{
    struct item **at = &room->items->first;
    while (*at != item)
        at = &(*at)->next;
    *at = item->next;
    room->items->n--;
    room->items->n_bytes -= strlen(item->row);
    free(item->row);
    free(item);
}

struct item *items_take_all(struct room *room)
{
    struct item *all = room->items->first;
    room->items->first = NULL;
    room->items->n = room->items->n_bytes = 0;
    return all;
}

void items_free(struct room *room)
{
    while (room->items->first)
        items_drop(room, room->items->first);
    free(room->items);
}

/* [row] of one kind, or of all; NULL: no memory. */
static cJSON *rows(const struct room *room, const enum wire_item_kind *kind)
{
    cJSON *list = cJSON_CreateArray();
    for (const struct item *item = room->items->first; list && item; item = item->next) {
        if (kind && item->kind != *kind)
            continue;
        json_append(list, cJSON_CreateRaw(item->row));
    }
    return list;
}

cJSON *items_rows(const struct room *room)
{
    return rows(room, NULL);
}

cJSON *room_items(const struct room *room, enum wire_item_kind kind)
{
    return rows(room, &kind);
}

bool room_item_is(const struct room *room, const char *id, enum wire_item_kind kind)
{
    const struct item *item = items_find(room, id);
    return item && item->kind == kind;
}
