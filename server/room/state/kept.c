/* Reports what is to be kept. */
#include "server/room/state/kept.h"

void kept_changed(struct room *room, unsigned parts)
{
    room->unrecorded |= parts;
    if (room->callbacks.kept_changed && !room->replay) /* a replay is on disk already */
        room->callbacks.kept_changed(room->callbacks.context, room, parts);
}

bool room_was_used(const struct room *room)
{
    return !room->replay && (room->n_named > 0 || room->has_links || room->is_changed);
}
