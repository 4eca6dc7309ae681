/* Answers of the meeting to its rooms: meeting_doors.h. */
#include "server/net/meeting_doors.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "server/net/meeting_list.h"
#include "server/net/meeting_moves.h"
#include "server/net/rooms.h"

static const struct identity *identity_at(void *connection)
{
    const struct visitor *visitor = ws_owner(connection);
    return &visitor->identity;
}

static enum wire_member_role lower(enum wire_member_role a, enum wire_member_role b)
{
    return a == WIRE_MEMBER_ROLE_WALL || a < b ? a : b; /* a wall is nothing else */
}

static bool find_link(void *context, const struct room *room, const struct identity *who, const char *token,
                      struct room_meeting_link *found)
{
    struct meeting_case *one;
    const struct meeting *meeting = meetings_of_room(context, room_id(room), &one);
    if (!meeting || strcmp(meeting->now, one->id) != 0 || meeting_is_barred(meeting, who->user))
        return false;
    const struct meeting_link *link = meeting_link_of(meeting, token, clock_wall_ms());
    if (!link)
        return false;
    *found = (struct room_meeting_link){ .role = lower(link->role, one->cap), .allows_guests = link->allows_guests };
    memcpy(found->token_hash, link->token_hash, sizeof found->token_hash);
    (void)snprintf(found->maker, sizeof found->maker, "%s", link->maker);
    (void)snprintf(found->name, sizeof found->name, "%s", link->name);
    return true;
}

static bool link_is_over(void *context, const struct room *room, const char *digits)
{
    struct meeting_case *one;
    struct meeting *meeting = meetings_of_room(context, room_id(room), &one);
    const struct meeting_link *link = meeting ? meeting_link_find(meeting, digits) : NULL;
    return link && link->is_ended;
}

static bool role_of(void *context, const struct room *room, const struct identity *who, enum wire_member_role *role)
{
    struct meeting_case *one;
    const struct meeting *meeting = meetings_of_room(context, room_id(room), &one);
    return meeting && meeting_allows(meeting, who, role);
}

static void barred(void *context, const struct room *room, const char *user, const char *link)
{
    struct meeting_case *one;
    const struct meeting *meeting = meetings_of_room(context, room_id(room), &one);
    if (meeting)
        meetings_bar(context, meeting, user, link);
}

static bool is_open_now(const struct net *net, const struct meeting *meeting, void *connection,
                        const struct room_present *present)
{
    const struct meeting_case *now = meeting_find(meeting, meeting->now);
    enum wire_member_role role;
    return now && meeting_moves_may(net, meeting, now, identity_at(connection), present, &role);
}

static void entered(void *context, struct room *room, void *connection)
{
    struct meeting_case *one;
    struct room_present present;
    const struct meeting *meeting = meetings_of_room(context, room_id(room), &one);
    if (!meeting)
        return;
    const bool is_elsewhere = meeting->now[0] && strcmp(meeting->now, one->id) != 0;
    if (!is_elsewhere)
        room_set_waiting(room, connection, false);
    if (!room_present_of(room, connection, &present))
        return;
    if (present.link[0] && present.user[0] && meeting_link_find((struct meeting *)meeting, present.link))
        meetings_came(context, meeting, present.user);
    (void)net_meeting_find(context, meeting->id); /* looks at its plans: their words may be told */
    meeting_moves_tell(context, meeting, one, room, connection);
    /* a wall that was started anew begins at the address that it was given, whatever case is now; who waits outside
     * was away, perhaps, when the meeting came to a case that is open to them */
    const bool waited = present.waits_outside && is_open_now(context, meeting, connection, &present);
    if (is_elsewhere && (present.role == WIRE_MEMBER_ROLE_WALL || waited))
        meeting_moves_send(context, meeting, room, connection, false, "");
}

struct asking { /* of a member who has the meeting go on */
    struct net *net;
    char room[64], member[64];
};

static void has_gone(void *context, const struct meeting *meeting, const struct problem *problem)
{
    struct asking *asking = context;
    const struct net_room *room = rooms_find(asking->net, asking->room);
    (void)meeting;
    if (problem && room)
        room_refuse_next(room->room, asking->member, problem);
    free(asking);
}

static bool next(void *context, struct room *room, void *connection, const char *to, const char *from,
                 struct problem *problem)
{
    struct meeting_case *one;
    struct room_present present;
    const struct meeting *meeting = meetings_of_room(context, room_id(room), &one);
    if (!meeting || meeting->ended_ms || !room_present_of(room, connection, &present))
        return problem_set(problem, PROBLEM_CONFLICT, "", "meeting", "this room is in no meeting that runs");
    struct asking *asking = mem_new(sizeof *asking);
    asking->net = context;
    (void)snprintf(asking->room, sizeof asking->room, "%s", room_id(room));
    (void)snprintf(asking->member, sizeof asking->member, "%s", present.id);
    const struct net_meeting_go go = { .meeting = meeting->id,
                                       .to = to[0] ? to : "next",
                                       .from = from,
                                       .who = identity_at(connection),
                                       .address = ws_client(connection),
                                       .name = present.name,
                                       .room = asking->room,
                                       .member = asking->member };
    if (net_meeting_go(context, &go, has_gone, asking, problem))
        return true;
    free(asking);
    return false;
}

static bool go_along(void *context, struct room *room, void *connection, struct problem *problem)
{
    struct meeting_case *one;
    const struct meeting *meeting = meetings_of_room(context, room_id(room), &one);
    if (!meeting || !meeting->now[0])
        return problem_set(problem, PROBLEM_CONFLICT, "", "meeting", "this room is in no meeting that runs");
    if (strcmp(meeting->now, one->id) == 0)
        return problem_set(problem, PROBLEM_CONFLICT, "", "here", "the meeting is in this room");
    meeting_moves_send(context, meeting, room, connection, false, "");
    return true;
}

static bool about_case(void *context, const struct room *room, struct room_meeting_case *about)
{
    struct meeting_case *one;
    const struct meeting *meeting = meetings_of_room(context, room_id(room), &one);
    if (!meeting || !meeting_was_entered(meeting, one))
        return false;
    *about = (struct room_meeting_case){ .n = meeting_place(meeting, one) + 1,
                                         .of = meeting->n_cases,
                                         .is_over = meeting->ended_ms != 0 };
    (void)snprintf(about->meeting, sizeof about->meeting, "%s", meeting->id);
    (void)snprintf(about->name, sizeof about->name, "%s", meeting->name);
    return true;
}

/* Whether this user presents in the room, and somebody else is there. A wall is nobody. */
static bool presents_to_others(const struct room *room, const char *user)
{
    struct room_present present;
    bool presents = false;
    size_t n_others = 0;
    for (size_t i = 0; room_present_at(room, i, &present); i++) {
        if (!present.connection || present.role == WIRE_MEMBER_ROLE_WALL)
            continue;
        const bool is_same = strcmp(present.user, user) == 0;
        presents = presents || (is_same && present.presents);
        n_others += !is_same;
    }
    return presents && n_others > 0;
}

static size_t presents_case(void *context, const struct room *room, void *connection)
{
    struct meeting_case *one;
    struct room_present present;
    const struct meeting *meeting = meetings_of_room(context, room_id(room), &one);
    if (!meeting || meeting->ended_ms || !room_present_of(room, connection, &present) || !present.user[0])
        return 0;
    for (size_t i = 0; i < meeting->n_cases; i++) {
        const struct net_room *other = rooms_find(context, meeting->cases[i]->room);
        if (other && other->room != room && presents_to_others(other->room, present.user))
            return i + 1;
    }
    return 0;
}

const struct room_meeting_callbacks meeting_doors = { .link = find_link,
                                                      .link_is_over = link_is_over,
                                                      .role = role_of,
                                                      .barred = barred,
                                                      .entered = entered,
                                                      .next = next,
                                                      .go = go_along,
                                                      .about = about_case,
                                                      .presents_case = presents_case };
