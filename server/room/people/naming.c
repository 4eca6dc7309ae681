/* Names a room: naming.h. */
#include "server/room/people/naming.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/room/out/audit.h"
#include "server/room/out/send.h"
#include "server/room/people/known.h"
#include "server/room/people/room_people.h"
#include "server/room/state/event.h"
#include "server/wire/json.h"

static struct message message_of(const struct room *room)
{
    struct message message = { .type = MESSAGE_ROOM };
    (void)snprintf(message.room.name, sizeof message.room.name, "%s", room->name);
    return message;
}

void name_show(struct room *room, struct member *member)
{
    const struct message message = message_of(room);
    if (room->name[0])
        send_to_member(room, member, &message);
}

void name_set(struct room *room, const char *name, const struct identity *who, const struct member *by,
              const char *address)
{
    if (strcmp(name, room->name) == 0)
        return;
    cJSON *detail = cJSON_CreateObject();
    cJSON_AddStringToObject(detail, "from", room->name);
    cJSON_AddStringToObject(detail, "to", name);
    const struct audit_act act = {
        .by = by, .action = "renamed", .address = address, .who = who, .detail = detail, .before = -1, .after = -1
    };
    (void)snprintf(room->name, sizeof room->name, "%s", name);
    room->shared.is_changed = true;
    room_event(room, ROOM_PEOPLE, NULL);
    audit_tell(room, &act);
    const struct message message = message_of(room);
    send_to_all(room, &message);
}

/* ---- who has been there ----------------------------------------------------------------------------------------- */

/* Adds the line to the list, once. False: it has no place. */
static bool add_line(char *list, size_t size, const char *line)
{
    const size_t n = strlen(line), used = strlen(list);
    for (const char *at = list; n && (at = strstr(at, line)); at++)
        if ((at == list || at[-1] == '\n') && at[n] == '\n')
            return true;
    if (used + n + 2 > size)
        return false;
    if (n)
        (void)snprintf(list + used, size - used, "%s\n", line);
    return true;
}

static const char wall[] = "wall";

void room_names_in(const struct room *room, char names[ROOM_NAMES_BYTES])
{
    int n = 0;
    names[0] = 0;
    for (int i = 0; i < room->members.n && n < ROOM_MAX_NAMES; i++)
        if (room->members.list[i]->role != WIRE_MEMBER_ROLE_WALL)
            n += add_line(names, ROOM_NAMES_BYTES, room->members.list[i]->name);
    for (int i = room->known->n; i-- > 0 && n < ROOM_MAX_NAMES;)
        if (strcmp(room->known->list[i].role, wall) != 0)
            n += add_line(names, ROOM_NAMES_BYTES, room->known->list[i].name);
}

char *room_users_in(const struct room *room)
{
    const size_t size = (size_t)(room->members.n + room->known->n + 1) * (STORE_USER + 1);
    char *list = mem_array(size, 1, 1 << 20, NULL);
    for (int i = 0; list && i < room->members.n; i++)
        (void)add_line(list, size, room->members.list[i]->user);
    for (int i = 0; list && i < room->known->n; i++)
        (void)add_line(list, size, room->known->list[i].user);
    return list;
}

bool room_was_in(const struct room *room, const struct identity *who)
{
    bool is_there = false;
    for (int i = 0; i < room->members.n && who->user[0]; i++)
        is_there = is_there || strcmp(room->members.list[i]->user, who->user) == 0;
    for (int i = 0; i < room->known->n && who->user[0]; i++)
        is_there = is_there || strcmp(room->known->list[i].user, who->user) == 0;
    return is_there;
}
