/* Asks what is on disk, and tells it when that is news and due. */
#include "server/room/out/saved.h"

#include <stdlib.h>

#include "core/base/mem.h"
#include "server/room/out/send.h"
#include "server/room/state/event.h"
#include "server/wire/message.h"

static const int64_t every_us = SAVED_EVERY_MS * INT64_C(1000);

struct saved {
    struct room_saved told; /* as all were told last */
    int64_t told_us;
    int64_t news_us; /* since when it is another; 0: it is not */
    uint64_t n_items_told;
    bool is_owed; /* somebody who has come was told something else than all */
};

void saved_init(struct room *room)
{
    room->saved = mem_new(sizeof *room->saved);
}

void saved_free(struct room *room)
{
    free(room->saved);
}

static struct room_saved now_saved(const struct room *room)
{
    struct room_saved saved = { .state = WIRE_SAVED_STATE_UNKEPT };
    if (room->callbacks.is_saved)
        room->callbacks.is_saved(room->callbacks.context, room, &saved);
    return saved;
}

/* To be finished. */
static void fill(const struct room_saved *saved, struct message *message)
{
    struct problem problem;
    *message = (struct message){ .type = MESSAGE_SAVED };
    message->saved.state = saved->state;
    message->saved.revision = saved->revision;
    if (saved->state != WIRE_SAVED_STATE_FAILING)
        return;
    if (saved->is_full)
        problem_set(&problem, PROBLEM_STORAGE, "", "full",
                    "the server's disk is full; what is changed now is not kept");
    else
        problem_set(&problem, PROBLEM_STORAGE, "", "write",
                    "the server cannot write to its disk, its log says why; what is changed now is not kept");
    message->saved.problem = problem_to_json(&problem);
}

void saved_show(struct room *room, struct member *member)
{
    const struct room_saved saved = now_saved(room);
    struct message message;
    room->saved->is_owed = room->saved->is_owed || saved.state != WIRE_SAVED_STATE_SAVED;
    fill(&saved, &message);
    send_to_member(room, member, &message);
    message_finish(&message);
}

/* Writing is no news: a page that has heard of a change knows that it is not yet told saved. */
static bool is_news(const struct room *room, const struct room_saved *saved)
{
    const struct room_saved *told = &room->saved->told;
    if (room->saved->is_owed || saved->state != told->state || saved->revision != told->revision ||
        saved->is_full != told->is_full)
        return true;
    return saved->state == WIRE_SAVED_STATE_SAVED && room->saved->n_items_told != events_n_item_changes(room);
}

int64_t saved_settle(struct room *room)
{
    const struct room_saved saved = now_saved(room);
    if (saved.state == WIRE_SAVED_STATE_UNKEPT || !is_news(room, &saved)) {
        room->saved->news_us = 0;
        return INT64_MAX;
    }
    if (!room->saved->news_us)
        room->saved->news_us = room->now_us;
    const bool is_urgent =
        (saved.state == WIRE_SAVED_STATE_FAILING) != (room->saved->told.state == WIRE_SAVED_STATE_FAILING);
    int64_t due_us = room->saved->told_us + every_us;
    if (saved.state == WIRE_SAVED_STATE_SAVING && room->saved->news_us + every_us > due_us)
        due_us = room->saved->news_us + every_us; /* most writes have ended by then */
    if (room->now_us < due_us && !is_urgent)
        return due_us;
    struct message message;
    fill(&saved, &message);
    send_to_all(room, &message);
    message_finish(&message);
    room->saved->told = saved;
    if (room_n_connected(room)) /* else who comes next would wait for the answer to the first change */
        room->saved->told_us = room->now_us;
    room->saved->news_us = 0;
    room->saved->is_owed = false;
    room->saved->n_items_told = events_n_item_changes(room);
    return INT64_MAX;
}
