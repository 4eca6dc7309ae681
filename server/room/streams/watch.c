/* Decides when the small picture of the presenter is sent. */
#include "server/room/streams/watch.h"

#include "server/room/streams/display.h"

static bool own_views_wait(const struct member *member)
{
    for (int i = 0; i < ROOM_MAX_VIEWS; i++)
        if (member->views[i].stream && member->views[i].sent_sequence != member->views[i].shown_sequence)
            return true;
    return false;
}

int64_t watch_next_us(const struct member_view *view)
{
    return view->sent_sequence ? view->sent[view->sent_sequence % ROOM_MAX_UNSHOWN].sent_us + WATCH_EVERY_US : 0;
}

bool watch_has_turn(const struct room *room, const struct member_view *view, size_t n_bytes)
{
    const struct member *member = view->member;
    if (view->sent_sequence != view->shown_sequence || room->now_us < watch_next_us(view))
        return false;
    return !own_views_wait(member) || member->n_bytes - member->watch.n_bytes >= WATCH_SHARE * (uint64_t)n_bytes;
}

bool watch_is_newest(const struct member_view *view)
{
    const struct stream *stream = view->stream;
    return stream->latest && view->sent_number == stream->latest_number && stream->latest_version == stream->version;
}

void watch_count(const struct room *room, struct member_view *view, size_t n_bytes)
{
    struct member *member = view->member;
    if (!view_is_watch(view)) {
        member->n_bytes += n_bytes;
        return;
    }
    member->watch.n_bytes = member->n_bytes;
    member->watch.behind_us = watch_is_newest(view) ? 0 : room->now_us;
}

bool watches_have_credit(const struct stream *stream, uint32_t n_coming, int64_t now_us)
{
    if (n_coming > 0 || now_us < display_alone_us(stream))
        return false;
    for (const struct member_view *view = stream->viewers; view; view = view->next_viewer)
        if (view_is_watch(view) && view->sent_sequence == view->shown_sequence && now_us >= watch_next_us(view))
            return true;
    return false;
}
