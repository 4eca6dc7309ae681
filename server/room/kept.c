/* Reports what is to be kept. */
#include "server/room/kept.h"

void kept_changed(struct room *room, unsigned parts)
{
    if (room->callbacks.kept_changed)
        room->callbacks.kept_changed(room->callbacks.context, room, parts);
}

bool room_was_used(const struct room *room)
{
    return room->n_named > 0 || room->has_links || room->is_changed;
}
