/* Finds members and lists them as JSON. */
#include "server/room/state/member_list.h"

#include <stdio.h>
#include <string.h>

#include "server/room/state/roles.h"

struct member *member_of_connection(const struct room *room, const void *connection)
{
    for (int i = 0; i < room->members.n; i++)
        if (connection && room->members.list[i]->connection == connection)
            return room->members.list[i];
    return NULL;
}

struct member *member_who_speaks(struct room *room, const void *connection)
{
    for (int i = 0, at = room->members.spoke; connection && i < room->members.n; i++) {
        at = at + 1 < room->members.n ? at + 1 : 0;
        if (room->members.list[at]->connection != connection)
            continue;
        room->members.spoke = at;
        return room->members.list[at];
    }
    return NULL;
}

bool member_presents(const struct room *room, const struct member *member)
{
    return room->presenter == member;
}

bool member_follows(const struct room *room, const struct member *member)
{
    for (int i = 0; i < ROOM_MAX_VIEWS && !member_presents(room, member); i++)
        if (member->views[i].is_following)
            return true;
    return false;
}

bool refuse_not_presenter(const struct room *room, struct problem *problem, const char *what)
{
    if (room->presenter)
        return problem_set(problem, PROBLEM_NOT_PRESENTER, "", "", "only the presenter, %s, may %s",
                           room->presenter->id, what);
    return problem_set(problem, PROBLEM_NOT_PRESENTER, "", "", "only a presenter may %s, and nobody presents now",
                       what);
}

static bool is_blank(const char *text)
{
    return text[strspn(text, " ")] == 0;
}

/* Connected members with the same person, this one included. */
static int n_tabs(const struct room *room, const struct member *member)
{
    int n = 1;
    for (int i = 0; i < room->members.n && member->person[0]; i++) {
        const struct member *other = room->members.list[i];
        n += other != member && other->connection && strcmp(other->person, member->person) == 0;
    }
    return n;
}

void member_say_who(const struct member *member, cJSON *row)
{
    if (member->user[0])
        cJSON_AddStringToObject(row, "user", member->user);
    if (member->is_guest)
        cJSON_AddTrueToObject(row, "is_guest");
}

cJSON *room_members(const struct room *room)
{
    cJSON *list = cJSON_CreateArray();
    for (int i = 0; i < room->members.n; i++) {
        const struct member *member = room->members.list[i];
        cJSON *item = cJSON_CreateObject();
        char color[8];
        cJSON_AddStringToObject(item, "id", member->id);
        cJSON_AddStringToObject(item, "name", is_blank(member->name) ? member->id : member->name);
        (void)snprintf(color, sizeof color, "#%06x", color_rgb(member->color));
        cJSON_AddStringToObject(item, "color", color);
        cJSON_AddStringToObject(item, "role", wire_member_role_words.words[member->role]);
        cJSON_AddBoolToObject(item, "connected", member->connection != NULL);
        cJSON_AddBoolToObject(item, "following", member_follows(room, member));
        cJSON_AddBoolToObject(item, "presenting", member_presents(room, member));
        cJSON_AddStringToObject(item, "lag", wire_member_lag_words.words[member->lag]);
        cJSON_AddNumberToObject(item, "tabs", n_tabs(room, member));
        member_say_who(member, item);
        if (member->is_naming)
            cJSON_AddTrueToObject(item, "is_naming");
        json_append(list, item);
    }
    return list;
}

size_t room_n_connected(const struct room *room)
{
    size_t n = 0;
    for (int i = 0; i < room->members.n; i++)
        n += room->members.list[i]->connection && room->members.list[i]->role != WIRE_MEMBER_ROLE_WALL;
    return n;
}
