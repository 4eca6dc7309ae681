/* Keeps the one request to look at a point, and tells everybody about it. */
#include "server/room/people/look.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/room/out/send.h"

static const int64_t kept_us = LOOK_KEPT_S * INT64_C(1000000), every_us = LOOK_EVERY_MS * INT64_C(1000);

enum { LOOK_KEY = 0 }; /* of send_latest; members' numbers begin with 1 */

struct look {        /* the request to look at a point */
    uint32_t number; /* of the newest; 0: there was none yet */
    bool is_on, is_due;
    char by[64];
    struct vec3 point_mm;
    int64_t since_us, told_us;
};

void look_init(struct room *room)
{
    room->look = mem_new(sizeof *room->look);
}

void look_free(struct room *room)
{
    free(room->look);
}

/* To be finished: owns the list of those who came. */
static void fill_in(const struct room *room, struct message *message)
{
    const struct look *look = room->look;
    *message = (struct message){ .type = MESSAGE_LOOK };
    message->look.number = look->number;
    (void)snprintf(message->look.by, sizeof message->look.by, "%s", look->by);
    message->look.has_point_mm = look->is_on;
    message->look.point_mm = look->point_mm;
    message->look.came = cJSON_CreateArray();
    for (int i = 0; i < room->members.n && look->is_on; i++)
        if (room->members.list[i]->came_to == look->number)
            json_append(message->look.came, cJSON_CreateString(room->members.list[i]->id));
}

static void tell(struct room *room)
{
    struct message message;
    fill_in(room, &message);
    room->look->is_due = false;
    room->look->told_us = room->now_us;
    send_latest_to_others(room, NULL, LOOK_KEY, &message);
    message_finish(&message);
}

bool look_here(struct room *room, struct member *member, const struct message *message, struct problem *problem)
{
    struct look *look = room->look;
    (void)problem;
    if (!message->look_here.has_point_mm) {
        look_end(room, member);
        return true;
    }
    look->number++;
    (void)snprintf(look->by, sizeof look->by, "%s", member->id);
    look->point_mm = message->look_here.point_mm;
    look->since_us = room->now_us;
    look->is_on = look->is_due = true;
    (void)look_settle(room);
    return true;
}

bool look_come(struct room *room, struct member *member, const struct message *message, struct problem *problem)
{
    struct look *look = room->look;
    (void)problem;
    bool is_old = !look->is_on || message->look_come.number != look->number;
    if (is_old || strcmp(look->by, member->id) == 0 || member->came_to == look->number)
        return true;
    member->came_to = look->number;
    look->is_due = true;
    (void)look_settle(room);
    return true;
}

void look_end(struct room *room, const struct member *member)
{
    struct look *look = room->look;
    if (!look->is_on || (member && strcmp(look->by, member->id) != 0))
        return;
    look->is_on = false;
    tell(room);
}

void look_show(struct room *room, struct member *member)
{
    struct message message;
    if (!room->look->is_on)
        return;
    fill_in(room, &message);
    send_latest(room, member, LOOK_KEY, &message);
    message_finish(&message);
}

int64_t look_settle(struct room *room)
{
    struct look *look = room->look;
    if (look->is_on && room->now_us >= look->since_us + kept_us)
        look_end(room, NULL);
    if (look->is_due && room->now_us >= look->told_us + every_us)
        tell(room);
    if (look->is_due)
        return look->told_us + every_us;
    return look->is_on ? look->since_us + kept_us : INT64_MAX;
}
