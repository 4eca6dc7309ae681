/* Passes pointers on. A place that comes before its member's turn waits in the member, where a newer one replaces it;
 * for a receiver who reads slowly it waits in the connection, in the same way (send_latest). */
#include "server/room/people/pointers.h"

#include <stdio.h>

#include "server/room/out/send.h"
#include "server/room/state/event.h"

static const int64_t kept_us = POINTER_KEPT_MS * INT64_C(1000);

static int64_t every_us(const struct room *room)
{
    int n = 0;
    for (int i = 0; i < room->members.n; i++)
        n += room->members.list[i]->pointing.is_on;
    int64_t load = (int64_t)n * room->members.n;
    return POINTER_EVERY_MS * INT64_C(1000) * (load > POINTER_FULL_RATE ? load : POINTER_FULL_RATE) / POINTER_FULL_RATE;
}

static void fill_in(const struct member *member, struct message *message)
{
    const struct pointing *pointing = &member->pointing;
    *message = (struct message){ .type = MESSAGE_POINTER_AT };
    (void)snprintf(message->pointer_at.member, sizeof message->pointer_at.member, "%s", member->id);
    message->pointer_at.view = pointing->view;
    message->pointer_at.has_point_mm = pointing->is_on;
    message->pointer_at.point_mm = pointing->point_mm;
}

static void pass_on(struct room *room, struct member *member)
{
    struct message message;
    fill_in(member, &message);
    member->pointing.is_due = false;
    member->pointing.passed_us = room->now_us;
    send_latest_to_others(room, member, member->number, &message);
}

static bool is_same(struct vec3 a, struct vec3 b)
{
    return !(a.x < b.x || a.x > b.x || a.y < b.y || a.y > b.y || a.z < b.z || a.z > b.z);
}

bool pointer_move(struct room *room, struct member *member, const struct message *message, struct problem *problem)
{
    const struct message_pointer *to = &message->pointer;
    struct pointing *pointing = &member->pointing;
    (void)problem;
    if (to->has_point_mm ? pointing->is_on && is_same(to->point_mm, pointing->point_mm) : !pointing->is_on)
        return true;
    pointing->is_on = to->has_point_mm;
    pointing->point_mm = to->point_mm;
    pointing->view = to->has_point_mm ? (int)to->view : 0;
    pointing->moved_us = room->now_us;
    pointing->is_due = true;
    room_event(room, ROOM_POINTERS, NULL);
    (void)pointers_settle(room);
    return true;
}

void pointer_end(struct room *room, struct member *member)
{
    if (!member->pointing.is_on && !member->pointing.is_due)
        return;
    member->pointing.is_on = false;
    member->pointing.view = 0;
    room_event(room, ROOM_POINTERS, NULL);
    pass_on(room, member);
}

void pointers_show(struct room *room, struct member *member)
{
    for (int i = 0; i < room->members.n; i++) {
        const struct member *other = room->members.list[i];
        struct message message;
        if (other == member || !other->pointing.is_on)
            continue;
        fill_in(other, &message);
        send_latest(room, member, other->number, &message);
    }
}

int64_t pointers_settle(struct room *room)
{
    const int64_t pause_us = every_us(room);
    int64_t again_us = INT64_MAX;
    for (int i = 0; i < room->members.n; i++) {
        struct member *member = room->members.list[i];
        struct pointing *pointing = &member->pointing;
        if (pointing->is_on && room->now_us >= pointing->moved_us + kept_us)
            pointer_end(room, member);
        if (pointing->is_due && room->now_us >= pointing->passed_us + pause_us)
            pass_on(room, member);
        int64_t due_us = pointing->is_due  ? pointing->passed_us + pause_us
                         : pointing->is_on ? pointing->moved_us + kept_us
                                           : INT64_MAX;
        if (due_us < again_us)
            again_us = due_us;
    }
    return again_us;
}
