/* Looks for frames and requests that are late. */
#include "server/room/streams/lag.h"

static enum wire_member_lag later(int64_t since_us, enum wire_member_lag lag, const struct room *room, int64_t *next_us)
{
    int64_t due_us = since_us + LAG_AFTER_US;
    if (room->now_us >= due_us)
        return lag;
    *next_us = due_us < *next_us ? due_us : *next_us;
    return WIRE_MEMBER_LAG_NONE;
}

static enum wire_member_lag lag_of_view(const struct room *room, const struct member_view *view, int64_t *next_us)
{
    enum wire_member_lag lag = WIRE_MEMBER_LAG_NONE;
    if (view->sent_sequence != view->shown_sequence)
        lag = later(view->sent[(view->shown_sequence + 1) % ROOM_MAX_UNSHOWN].sent_us, WIRE_MEMBER_LAG_LINK, room,
                    next_us);
    for (int i = 0; i < 2 && lag == WIRE_MEMBER_LAG_NONE; i++) {
        const struct request *request = &view->stream->requests[i];
        if (request->number && !request->is_still) /* a still takes its time */
            lag = later(request->requested_us, WIRE_MEMBER_LAG_RENDERER, room, next_us);
    }
    return lag;
}

static enum wire_member_lag lag_of(const struct room *room, const struct member *member, int64_t *next_us)
{
    enum wire_member_lag lag = WIRE_MEMBER_LAG_NONE;
    for (int i = 0; member->connection && i < ROOM_MAX_VIEWS && lag != WIRE_MEMBER_LAG_LINK; i++) {
        enum wire_member_lag of_view =
            member->views[i].stream ? lag_of_view(room, &member->views[i], next_us) : WIRE_MEMBER_LAG_NONE;
        lag = of_view != WIRE_MEMBER_LAG_NONE ? of_view : lag;
    }
    return lag;
}

int64_t lags_settle(struct room *room, bool *has_changed)
{
    int64_t next_us = INT64_MAX;
    for (int i = 0; i < room->members.n; i++) {
        struct member *member = room->members.list[i];
        enum wire_member_lag lag = lag_of(room, member, &next_us);
        if (lag != WIRE_MEMBER_LAG_NONE) {
            member->lag_until_us = room->now_us + LAG_KEPT_US;
        } else if (room->now_us < member->lag_until_us && member->connection) {
            next_us = member->lag_until_us < next_us ? member->lag_until_us : next_us;
            lag = member->lag;
        }
        *has_changed |= lag != member->lag;
        member->lag = lag;
    }
    return next_us;
}
