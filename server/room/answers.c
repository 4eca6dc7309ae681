/* Takes answers to what a room asked for, and calls that its folders carry out. */
#include "server/room/entry.h"
#include "server/room/items/items.h"
#include "server/room/log/recording.h"
#include "server/room/log/replay.h"
#include "server/room/people/links.h"
#include "server/room/streams/display.h"
#include "server/room/streams/pictures.h"
#include "server/room/streams/stream.h"

void room_picture_came(struct room *room, uint64_t request, struct frame *picture, int64_t now_us)
{
    room_enter(room, now_us);
    streams_picture_came(room, request, picture);
    room_leave(room);
}

void room_picture_failed(struct room *room, uint64_t request, const struct problem *problem, int64_t now_us)
{
    room_enter(room, now_us);
    streams_picture_failed(room, request, problem);
    room_leave(room);
}

struct room_display *room_display_add(struct room *room, const char *view,
                                      const struct room_display_callbacks *callbacks, int64_t now_us,
                                      struct problem *problem)
{
    room_enter(room, now_us);
    struct room_display *display = display_add(room, view, callbacks, problem);
    room_leave(room);
    return display;
}

void room_display_remove(struct room_display *display)
{
    room_leave(display_remove(display));
}

void room_item_written(struct room *room, uint64_t number, const struct problem *problem, int64_t now_us)
{
    room_enter(room, now_us);
    items_written(room, number, problem);
    room_leave(room);
}

bool room_link_create(struct room *room, enum wire_member_role role, int64_t expires_s, bool is_one_use, int64_t now_us,
                      char token[33], struct problem *problem)
{
    room_enter(room, now_us);
    const struct room_link wanted = {
        .role = role, .expires_s = expires_s, .is_one_use = is_one_use, .maker = "", .name = ""
    };
    const bool is_made = link_create(room, &wanted, token, problem);
    room_leave(room);
    return is_made;
}

bool room_link_make(struct room *room, const struct room_link *wanted, int64_t now_us, char token[33],
                    struct problem *problem)
{
    room_enter(room, now_us);
    const bool is_made = link_create(room, wanted, token, problem);
    room_leave(room);
    return is_made;
}

cJSON *room_recordings(struct room *room, int64_t now_us)
{
    room_enter(room, now_us);
    return recordings_list(room);
}

bool room_recording_delete(struct room *room, const char *id, int64_t now_us)
{
    room_enter(room, now_us);
    const bool is_there = recording_delete(room, id);
    room_leave(room);
    return is_there;
}

void room_recording_cut(struct room *room, int64_t now_us)
{
    room_enter(room, now_us);
    recording_cut(room);
}

void room_replay_begin(struct room *room, const char *of_room, uint32_t n_named, const struct room_recording *recording,
                       int64_t now_us)
{
    room_enter(room, now_us);
    replay_begin(room, of_room, n_named, recording);
}

void room_replay_came(struct room *room, const char *const *texts, size_t n, int64_t next_ms,
                      const struct problem *problem, int64_t now_us)
{
    room_enter(room, now_us);
    replay_came(room, texts, n, next_ms, problem);
    room_leave(room);
}
