/* Removes members: removal.h. */
#include "server/room/people/removal.h"

#include <stdio.h>
#include <string.h>

#include "server/room/out/audit.h"
#include "server/room/out/send.h"
#include "server/room/people/admission.h"
#include "server/room/people/known.h"
#include "server/room/people/links.h"
#include "server/room/people/member.h"
#include "server/room/state/member_list.h"
#include "server/room/state/roles.h"
#include "server/room/state/who.h"
#include "server/room/streams/wall.h"

/* Tabs of one person, and seats of one user, are removed together. */
static bool is_same_person(const struct member *a, const struct member *b)
{
    return a == b || who_is_same_user(a->user, b->user) || (a->person[0] && strcmp(a->person, b->person) == 0);
}

/* The seat of a guest who is away can be one that the removed guest left under another name; their link is ended. */
static bool is_left_by_guest(const struct member *removed, const struct member *seat)
{
    return removed->is_guest && seat->is_guest && !seat->connection && removed->link[0] &&
           strcmp(removed->link, seat->link) == 0;
}

static void audit_removed(struct room *room, const struct member *member, const struct member *by, const char *reason)
{
    const struct audit_act row = {
        .by = by, .action = "removed", .detail = cJSON_CreateObject(), .before = -1, .after = -1
    };
    cJSON_AddStringToObject(row.detail, "member", member->id);
    cJSON_AddStringToObject(row.detail, "name", member->name);
    member_say_who(member, row.detail);
    if (reason[0])
        cJSON_AddStringToObject(row.detail, "reason", reason);
    audit_tell(room, &row);
}

static void say_bye(struct room *room, struct member *member, const char *by_name, const char *reason)
{
    char text[900];
    if (!member->connection)
        return;
    (void)snprintf(text, sizeof text, "%.160s removed you from this room%s%.480s", by_name[0] ? by_name : "the server",
                   reason[0] ? ": " : "", reason);
    send_bye_for(room, member->connection, "removed", -1, text);
}

/* Removes the member with the other seats of its person. */
static void remove_person(struct room *room, const struct member *member, const struct member *by, const char *reason)
{
    const struct member person = *member; /* who is removed is freed on the way */
    admission_ban(room, member);
    for (int i = 0; i < room->members.n;) {
        struct member *other = room->members.list[i];
        if (other != member && !is_same_person(&person, other) && !is_left_by_guest(&person, other)) {
            i++;
            continue;
        }
        audit_removed(room, other, by, reason);
        say_bye(room, other, by ? by->name : "", reason);
        member_drop(room, other); /* another one may stand in its place now */
        i = 0;
    }
    known_forget(room, &person);
    send_members(room);
}

static struct member *find(const struct room *room, const char *id)
{
    for (int i = 0; i < room->members.n; i++)
        if (strcmp(room->members.list[i]->id, id) == 0)
            return room->members.list[i];
    return NULL;
}

/* Whether no other person of the room has the role planner. */
static bool is_last_planner(const struct room *room, const struct member *member)
{
    for (int i = 0; i < room->members.n; i++)
        if (room->members.list[i]->role == WIRE_MEMBER_ROLE_PLANNER && !is_same_person(room->members.list[i], member))
            return false;
    return member->role == WIRE_MEMBER_ROLE_PLANNER;
}

/* A wall alone: nobody's other seats, and nobody stays out but by its link. */
static void remove_wall(struct room *room, struct member *wall, const struct member *by, const char *reason)
{
    if (wall->link[0])
        (void)link_end(room, wall->link);
    audit_removed(room, wall, by, reason);
    say_bye(room, wall, by ? by->name : "", reason);
    member_drop(room, wall);
    send_members(room);
}

bool member_remove(struct room *room, struct member *by, const struct message *message, struct problem *problem)
{
    struct member *member = find(room, message->member_remove.member);
    if (!member)
        return problem_set(problem, PROBLEM_NOT_FOUND, "/member", "", "there is no member \"%.63s\" in this room",
                           message->member_remove.member);
    if (member_is_wall(member)) {
        remove_wall(room, member, by, message->member_remove.reason);
        return true;
    }
    if (is_same_person(by, member))
        return problem_set(problem, PROBLEM_CONFLICT, "/member", "own", "nobody removes themself: leave the room");
    if (is_last_planner(room, member))
        return problem_set(problem, PROBLEM_CONFLICT, "/member", "last-planner",
                           "%s is the last planner of the room, and stays", member->id);
    remove_person(room, member, by, message->member_remove.reason);
    return true;
}

void members_remove_of_link(struct room *room, const char *digits, const struct member *by)
{
    for (int i = 0; i < room->members.n;) {
        struct member *member = room->members.list[i];
        if (strcmp(member->link, digits) != 0 || member == by || is_last_planner(room, member)) {
            i++;
            continue;
        }
        audit_removed(room, member, by, "");
        say_bye(room, member, by ? by->name : "", "");
        member_drop(room, member);
        i = 0;
    }
    known_forget_link(room, digits);
    send_members(room);
}
