#pragma once
/* The small picture of the presenter that a member has beside own views: when it is sent. A viewer of the room's main
 * view that never makes anybody else's picture slower or worse: nothing is requested for it while others take pictures
 * of that view, its acknowledgements pace nothing, and the member's own views go first. Its size chooses a class of the
 * shared picture (size_class.h), as that of a pane does. Internal to server/room. */
#include "server/room/state/room_state.h"
#include "server/wire/message.h"

enum {
    WATCH_EVERY_US = 200000, /* between two pictures */
    WATCH_SHARE = 16,        /* while own views have unacknowledged pictures, watch gets at most 1/16 of their bytes */
    WATCH_LATE_US = 1000000
};

/* True if a picture of n_bytes may be sent to a view of watch now. */
bool watch_has_turn(const struct room *room, const struct member_view *view, size_t n_bytes);
/* A picture of n_bytes was sent to a view, of watch or not. */
void watch_count(const struct room *room, struct member_view *view, size_t n_bytes);
/* The picture that was sent is of the stream's newest state. */
bool watch_is_newest(const struct member_view *view);
/* True if a picture may be requested for those who watch the stream: nobody else takes pictures. n_coming: requests of
 * the stream outstanding. */
bool watches_have_credit(const struct stream *stream, uint32_t n_coming, int64_t now_us);
/* When the next picture may be sent, as far as time decides that. */
int64_t watch_next_us(const struct member_view *view);

/* The handler of the message watch. */
bool watch_set(struct room *room, struct member *member, const struct message *message, struct problem *problem);
/* After whatever may have changed who presents, or the main view: those who watch go over to it, or see none.
 * Returns INT64_MAX. */
int64_t watches_follow(struct room *room);
/* After stream_send_watch: tells the member whether the small picture is late; returns when it is due again. */
int64_t watch_settle(struct room *room, struct member *member);
/* Like watch_settle, for all members. */
int64_t watches_settle(struct room *room);
