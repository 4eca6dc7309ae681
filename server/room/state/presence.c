/* Keeps stays. */
#include "server/room/state/presence.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/room/state/event.h"
#include "server/wire/json.h"

static struct presence *add(struct room *room)
{
    if (!room->presences)
        room->presences = mem_array(ROOM_MAX_PRESENCE, sizeof room->presences[0], 1 << 20, NULL);
    if (!room->presences) {
        room->n_presences_dropped++;
        return NULL;
    }
    if (room->n_presences == ROOM_MAX_PRESENCE) {
        memmove(room->presences, room->presences + 1, (ROOM_MAX_PRESENCE - 1) * sizeof room->presences[0]);
        room->n_presences--;
        room->n_presences_dropped++;
    }
    struct presence *stay = &room->presences[room->n_presences++];
    *stay = (struct presence){ 0 };
    return stay;
}

static struct presence *last_of(struct room *room, const char *member)
{
    for (int i = room->n_presences; i-- > 0;)
        if (strcmp(room->presences[i].member, member) == 0)
            return &room->presences[i];
    return NULL;
}

void presence_entered(struct room *room, const struct member *member)
{
    const int64_t now_ms = clock_wall_ms();
    struct presence *stay = last_of(room, member->id);
    const bool goes_on = stay && stay->left_ms && now_ms - stay->left_ms <= ROOM_SAME_STAY_MS;
    if (!goes_on)
        stay = add(room);
    if (!stay)
        return;
    if (!goes_on)
        stay->entered_ms = now_ms;
    (void)snprintf(stay->member, sizeof stay->member, "%s", member->id);
    (void)snprintf(stay->name, sizeof stay->name, "%s", member->name);
    stay->role = member->role;
    stay->left_ms = 0;
    room_event(room, ROOM_PRESENCE, NULL);
}

void presence_left(struct room *room, const struct member *member)
{
    struct presence *stay = last_of(room, member->id);
    if (!stay || stay->left_ms)
        return;
    stay->left_ms = clock_wall_ms();
    room_event(room, ROOM_PRESENCE, NULL);
}

static bool is_here(const struct room *room, const struct presence *stay)
{
    for (int i = 0; i < room->n_members; i++)
        if (strcmp(room->members[i]->id, stay->member) == 0)
            return room->members[i]->connection && !stay->left_ms;
    return false;
}

cJSON *presence_list(const struct room *room)
{
    cJSON *list = cJSON_CreateArray();
    for (int i = 0; i < room->n_presences; i++) {
        const struct presence *stay = &room->presences[i];
        cJSON *json = cJSON_CreateObject();
        cJSON_AddStringToObject(json, "member", stay->member);
        cJSON_AddStringToObject(json, "name", stay->name);
        cJSON_AddStringToObject(json, "role", wire_member_role_words.words[stay->role]);
        cJSON_AddNumberToObject(json, "entered_ms", (double)stay->entered_ms);
        json_add(json, "left_ms", stay->left_ms ? cJSON_CreateNumber((double)stay->left_ms) : cJSON_CreateNull());
        cJSON_AddBoolToObject(json, "here", is_here(room, stay));
        json_append(list, json);
    }
    return list;
}

char *presence_write(const struct room *room)
{
    cJSON *json = cJSON_CreateObject();
    cJSON_AddNumberToObject(json, "n_dropped", room->n_presences_dropped);
    json_add(json, "stays", presence_list(room));
    char *text = json_print(json);
    cJSON_Delete(json);
    return text;
}

static bool read_stay(const cJSON *json, struct presence *stay)
{
    const char *member = json_text(json, "member"), *name = json_text(json, "name"), *role = json_text(json, "role");
    const double entered_ms = json_number(json, "entered_ms", -1), left_ms = json_number(json, "left_ms", 0);
    *stay = (struct presence){ 0 };
    if (!member || !id_is_valid(member) || !name || strlen(name) >= sizeof stay->name || !role ||
        !(entered_ms >= 0 && entered_ms < 9e15 && left_ms >= 0 && left_ms < 9e15))
        return false;
    (void)snprintf(stay->member, sizeof stay->member, "%s", member);
    (void)snprintf(stay->name, sizeof stay->name, "%s", name);
    stay->entered_ms = (int64_t)entered_ms;
    stay->left_ms = (int64_t)left_ms;
    for (size_t i = 0; i < wire_member_role_words.n; i++)
        if (strcmp(role, wire_member_role_words.words[i]) == 0) {
            stay->role = (enum wire_member_role)i;
            return true;
        }
    return false;
}

void presence_read(struct room *room, const char *text)
{
    cJSON *json = text ? json_read(text, strlen(text), NULL) : NULL;
    const double n_dropped = json_number(json, "n_dropped", 0);
    const cJSON *row;
    if (text && !json)
        log_error("room %s: who was there is not readable in the database", room->id);
    room->n_presences_dropped = n_dropped > 0 && n_dropped < 1e9 ? (unsigned)n_dropped : 0;
    cJSON_ArrayForEach(row, cJSON_GetObjectItemCaseSensitive(json, "stays"))
    {
        struct presence read, *stay = read_stay(row, &read) ? add(room) : NULL;
        if (stay)
            *stay = read;
    }
    cJSON_Delete(json);
}
