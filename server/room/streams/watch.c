/* Joins those who watch to the room's main view, and decides when they are sent its small picture. */
#include "server/room/streams/watch.h"

#include "server/room/out/send.h"
#include "server/room/state/member_list.h"
#include "server/room/streams/display.h"
#include "server/room/streams/stream.h"

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

/* ---- what they show, and are told ------------------------------------------------------------------------------- */

static struct member_view *view_of(struct member *member)
{
    return &member->views[ROOM_WATCH - 1];
}

bool watch_set(struct room *room, struct member *member, const struct message *message, struct problem *problem)
{
    const struct message_watch *watch = &message->watch;
    (void)room; /* watches_follow does the rest */
    (void)problem;
    member->watch.is_wanted = watch->has_size_px;
    for (int i = 0; i < 2 && watch->has_size_px; i++)
        view_of(member)->size_px[i] = watch->size_px[i];
    return true;
}

static struct stream *to_show(const struct room *room, const struct member *member)
{
    const bool is_shown = member->watch.is_wanted && member->connection && !member_presents(room, member);
    return is_shown && (room->presenter || room->replay) ? room->streams.main : NULL;
}

static void tell(struct room *room, struct member *member)
{
    struct member_view *view = view_of(member);
    view->has_moved = false;
    send_view(room, member, ROOM_WATCH - 1, view->stream->mover);
}

static void show(struct room *room, struct member *member, struct stream *stream)
{
    struct member_view *view = view_of(member);
    if (view->stream)
        stream_remove_viewer(room, view);
    view->is_following = view->has_moved = false;
    view->sent_number = 0;
    member->watch.behind_us = 0;
    member->watch.is_late = false;
    if (!stream)
        return;
    view->member = member;
    view->is_following = view->was_open = true;
    stream_add_viewer(stream, view);
    tell(room, member);
}

int64_t watches_follow(struct room *room)
{
    for (int i = 0; i < room->members.n; i++) {
        struct member *member = room->members.list[i];
        struct stream *stream = to_show(room, member);
        if (view_of(member)->stream != stream)
            show(room, member, stream);
    }
    return INT64_MAX;
}

/* When something is due for it that no event brings. */
static int64_t due_us(const struct room *room, const struct member *member, const struct member_view *view)
{
    int64_t due = INT64_MAX;
    if (!member->watch.behind_us)
        return due;
    if (!member->watch.is_late)
        due = member->watch.behind_us + WATCH_LATE_US;
    const int64_t next_us = watch_next_us(view), alone_us = display_alone_us(view->stream);
    if (next_us > room->now_us && next_us < due)
        due = next_us;
    if (alone_us > room->now_us && alone_us < due) /* from then on pictures are requested for it */
        due = alone_us;
    return due;
}

int64_t watch_settle(struct room *room, struct member *member)
{
    struct member_view *view = view_of(member);
    if (!view->stream)
        return INT64_MAX;
    if (watch_is_newest(view))
        member->watch.behind_us = 0;
    else if (!member->watch.behind_us)
        member->watch.behind_us = room->now_us;
    const bool is_late = member->watch.behind_us && room->now_us - member->watch.behind_us >= WATCH_LATE_US;
    if (is_late != member->watch.is_late) {
        member->watch.is_late = is_late;
        tell(room, member);
    }
    return due_us(room, member, view);
}

int64_t watches_settle(struct room *room)
{
    int64_t again_us = INT64_MAX;
    for (int i = 0; i < room->members.n; i++) {
        const int64_t member_us = watch_settle(room, room->members.list[i]);
        again_us = member_us < again_us ? member_us : again_us;
    }
    return again_us;
}
