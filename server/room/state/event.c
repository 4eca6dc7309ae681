/* Passes on which parts of a room have changed. */
#include "server/room/state/event.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

struct events {
    struct unrecorded unrecorded;
    uint64_t n_item_changes;
};

void events_init(struct room *room)
{
    room->events = mem_new(sizeof *room->events);
}

void events_free(struct room *room)
{
    free(room->events->unrecorded.items);
    free(room->events);
}

uint64_t events_n_item_changes(const struct room *room)
{
    return room->events->n_item_changes;
}

const struct unrecorded *events_unrecorded(const struct room *room)
{
    return &room->events->unrecorded;
}

void unrecorded_reset(struct room *room, unsigned parts)
{
    free(room->events->unrecorded.items);
    room->events->unrecorded = (struct unrecorded){ .parts = parts };
}

/* An item is recorded by its id; without memory for that all are compared. */
static void add_item(struct room *room, const char *id)
{
    struct unrecorded *unrecorded = &room->events->unrecorded;
    if (!room->recorder || (unrecorded->parts & ROOM_ITEMS))
        return;
    for (size_t i = 0; i < unrecorded->n_items; i++)
        if (strcmp(unrecorded->items[i], id) == 0)
            return;
    void *more = realloc(unrecorded->items, (unrecorded->n_items + 1) * sizeof unrecorded->items[0]);
    if (!more) {
        unrecorded->parts |= ROOM_ITEMS;
        return;
    }
    unrecorded->items = more;
    (void)snprintf(unrecorded->items[unrecorded->n_items++], sizeof unrecorded->items[0], "%s", id);
}

void room_event(struct room *room, unsigned parts, const char *id)
{
    const unsigned kept = parts & ROOM_ALL_PARTS;
    room->events->unrecorded.parts |= parts & ROOM_PLAN ? ROOM_ALL_PARTS : parts & ~(unsigned)ROOM_ITEMS;
    if (parts & ROOM_ITEMS) {
        room->events->n_item_changes++;
        add_item(room, id);
    }
    if (kept && room->callbacks.kept_changed && !room->replay) /* a replay is on disk already */
        room->callbacks.kept_changed(room->callbacks.context, room, kept);
}
