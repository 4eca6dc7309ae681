/* People go on to the room of a meeting's next case: room_moving.h. */
#include "server/room/people/moving.h"

#include <stdio.h>
#include <string.h>

#include "server/room/items/item_list.h"
#include "server/room/out/send.h"
#include "server/room/people/control.h"
#include "server/room/people/member.h"
#include "server/room/people/removal.h"
#include "server/room/people/room_moving.h"
#include "server/room/state/event.h"
#include "server/room/state/member_list.h"
#include "server/room/state/presence.h"
#include "server/room/state/roles.h"

/* ---- who is here ------------------------------------------------------------------------------------------------ */

/* True if every view that the member has open is its own. */
static bool looks_alone(const struct room *room, const struct member *member)
{
    bool has_view = false;
    for (int i = 0; i < ROOM_MAX_VIEWS; i++)
        has_view = has_view || member->views[i].stream;
    return has_view && !member_follows(room, member) && !member_presents(room, member);
}

static void describe(const struct room *room, const struct member *member, struct room_present *present)
{
    *present = (struct room_present){ .connection = member->connection,
                                      .id = member->id,
                                      .name = member->name,
                                      .user = member->user,
                                      .link = member->link,
                                      .person = member->person,
                                      .color = member->color,
                                      .role = member->role,
                                      .is_guest = member->is_guest,
                                      .presents = member_presents(room, member),
                                      .looks_alone = looks_alone(room, member),
                                      .waits_outside = member->waits_outside };
}

bool room_present_at(const struct room *room, size_t index, struct room_present *present)
{
    if (index >= (size_t)room->members.n)
        return false;
    describe(room, room->members.list[index], present);
    return true;
}

bool room_present_of(const struct room *room, void *connection, struct room_present *present)
{
    const struct member *member = member_of_connection(room, connection);
    if (member)
        describe(room, member, present);
    return member != NULL;
}

void room_set_waiting(struct room *room, void *connection, bool waits)
{
    struct member *member = member_of_connection(room, connection);
    if (!member || member->waits_outside == waits)
        return;
    member->waits_outside = waits;
    room_event(room, ROOM_MEMBERS, NULL); /* it is kept */
}

void room_tell_meeting(struct room *room, void *connection, const struct message_meeting *told)
{
    struct member *member = member_of_connection(room, connection);
    struct message message = { .type = MESSAGE_MEETING, .meeting = *told };
    if (member)
        send_to_member(room, member, &message);
}

void room_tell_case(struct room *room, void *connection, const struct message_meeting_case *told)
{
    struct member *member = member_of_connection(room, connection);
    struct message message = { .type = MESSAGE_MEETING_CASE, .meeting_case = *told };
    if (member)
        send_to_member(room, member, &message);
}

void room_refuse_next(struct room *room, const char *member, const struct problem *problem)
{
    for (int i = 0; i < room->members.n; i++) {
        void *connection = room->members.list[i]->connection;
        if (connection && strcmp(room->members.list[i]->id, member) == 0)
            (void)send_problem(room, connection, "meeting.next", 0, 0, problem);
    }
}

size_t room_remove_of_link(struct room *room, const char *digits, int64_t now_us)
{
    const int n_before = room->members.n;
    room->now_us = now_us;
    members_remove_of_link(room, digits, NULL);
    return (size_t)(n_before > room->members.n ? n_before - room->members.n : 0);
}

cJSON *room_stays(const struct room *room)
{
    return presence_list(room);
}

/* ---- seats ------------------------------------------------------------------------------------------------------ */

/* A seat of the same person on which nobody sits and nobody is expected. */
static struct member *find_free_seat(const struct room *room, const struct room_seat *seat)
{
    for (int i = 0; i < room->members.n; i++) {
        struct member *member = room->members.list[i];
        const bool is_same = seat->person[0] && strcmp(member->person, seat->person) == 0 &&
                             strcmp(member->name, seat->name) == 0 && strcmp(member->link, seat->link) == 0;
        if (is_same && !member->connection && !member->is_expected)
            return member;
    }
    return NULL;
}

bool room_seat_make(struct room *room, const struct room_seat *seat, int64_t now_us, char id[64], char secret[33],
                    struct problem *problem)
{
    room->now_us = now_us;
    struct member *member = find_free_seat(room, seat);
    if (!member)
        member = member_seat(room, seat->name, seat->role);
    if (!member)
        return problem_set(problem, PROBLEM_LIMIT, "", "", "the room is full");
    secret_make(member->secret);
    secret_hash(member->secret, member->secret_hash);
    member->role = seat->role;
    member->color = seat->color;
    member->is_guest = seat->is_guest;
    member->is_expected = true;
    member->away_us = now_us;
    (void)snprintf(member->user, sizeof member->user, "%s", seat->user);
    (void)snprintf(member->link, sizeof member->link, "%s", seat->link);
    (void)snprintf(member->person, sizeof member->person, "%s", seat->person);
    if (seat->presents && member_has_right(member, WIRE_RIGHT_SCENE))
        control_pass(room, member);
    (void)snprintf(id, 64, "%s", member->id);
    (void)snprintf(secret, 33, "%s", member->secret);
    send_members(room);
    return true;
}

/* ---- the record ------------------------------------------------------------------------------------------------- */

bool room_decision(const struct room *room, int64_t since_ms, char decision[24], char by[164], int64_t *decided_ms)
{
    bool has_any = false;
    for (const struct item *item = room->items->first; item; item = item->next) {
        if (item->kind != WIRE_ITEM_KIND_DECISION || item->created_ms < since_ms)
            continue;
        cJSON *row = json_read(item->row, strlen(item->row), NULL);
        const char *word = json_text(cJSON_GetObjectItemCaseSensitive(row, "body"), "decision");
        if (word) { /* the newest is the last; a correction is newer than what it corrects */
            (void)snprintf(decision, 24, "%s", word);
            (void)snprintf(by, 164, "%s", item->author_name);
            *decided_ms = item->created_ms;
            has_any = true;
        }
        cJSON_Delete(row);
    }
    return has_any;
}

/* ---- messages --------------------------------------------------------------------------------------------------- */

static bool no_meeting(struct problem *problem)
{
    return problem_set(problem, PROBLEM_CONFLICT, "", "meeting", "this room is in no meeting that runs");
}

bool meeting_next_case(struct room *room, struct member *member, const struct message *message, struct problem *problem)
{
    const struct room_meeting_callbacks *meeting = room->callbacks.meeting;
    if (!member_presents(room, member) && !member_has_right(member, WIRE_RIGHT_CONTROL))
        return refuse_not_presenter(room, problem, "go on to another case");
    return meeting ? meeting->next(room->callbacks.context, room, member->connection, message->meeting_next.to,
                                   message->meeting_next.from, problem)
                   : no_meeting(problem);
}

bool meeting_go_along(struct room *room, struct member *member, const struct message *message, struct problem *problem)
{
    const struct room_meeting_callbacks *meeting = room->callbacks.meeting;
    (void)message;
    return meeting ? meeting->go(room->callbacks.context, room, member->connection, problem) : no_meeting(problem);
}

void meeting_show(struct room *room, struct member *member)
{
    const struct room_meeting_callbacks *meeting = room->callbacks.meeting;
    if (meeting && member->connection)
        meeting->entered(room->callbacks.context, room, member->connection);
}
