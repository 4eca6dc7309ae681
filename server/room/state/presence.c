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

struct presence { /* one stay of a member */
    char member[64], name[161], user[STORE_USER];
    bool is_guest;
    enum wire_member_role role;
    int64_t entered_ms, left_ms; /* since 1970; left_ms 0: still here, or the server ended */
};

struct presences {
    struct presence *list; /* the first first; room for ROOM_MAX_PRESENCE. NULL: nobody was here */
    int n;
    unsigned n_dropped;
};

void presence_init(struct room *room)
{
    room->presences = mem_new(sizeof *room->presences);
}

void presence_free(struct room *room)
{
    free(room->presences->list);
    free(room->presences);
}

unsigned presence_n_dropped(const struct room *room)
{
    return room->presences->n_dropped;
}

static struct presence *add(struct presences *presences)
{
    if (!presences->list)
        presences->list = mem_array(ROOM_MAX_PRESENCE, sizeof presences->list[0], 1 << 20, NULL);
    if (!presences->list) {
        presences->n_dropped++;
        return NULL;
    }
    if (presences->n == ROOM_MAX_PRESENCE) {
        memmove(presences->list, presences->list + 1, (ROOM_MAX_PRESENCE - 1) * sizeof presences->list[0]);
        presences->n--;
        presences->n_dropped++;
    }
    struct presence *stay = &presences->list[presences->n++];
    *stay = (struct presence){ 0 };
    return stay;
}

static struct presence *last_of(struct presences *presences, const char *member)
{
    for (int i = presences->n; i-- > 0;)
        if (strcmp(presences->list[i].member, member) == 0)
            return &presences->list[i];
    return NULL;
}

void presence_entered(struct room *room, const struct member *member)
{
    const int64_t now_ms = clock_wall_ms();
    if (member->role == WIRE_MEMBER_ROLE_WALL) /* nobody's presence */
        return;
    struct presence *stay = last_of(room->presences, member->id);
    const bool goes_on = stay && stay->left_ms && now_ms - stay->left_ms <= ROOM_SAME_STAY_MS;
    if (!goes_on)
        stay = add(room->presences);
    if (!stay)
        return;
    if (!goes_on)
        stay->entered_ms = now_ms;
    (void)snprintf(stay->member, sizeof stay->member, "%s", member->id);
    (void)snprintf(stay->name, sizeof stay->name, "%s", member->name);
    (void)snprintf(stay->user, sizeof stay->user, "%s", member->user);
    stay->is_guest = member->is_guest;
    stay->role = member->role;
    stay->left_ms = 0;
    room_event(room, ROOM_PRESENCE, NULL);
}

void presence_left(struct room *room, const struct member *member)
{
    struct presence *stay = last_of(room->presences, member->id);
    if (!stay || stay->left_ms)
        return;
    stay->left_ms = clock_wall_ms();
    room_event(room, ROOM_PRESENCE, NULL);
}

static bool is_here(const struct room *room, const struct presence *stay)
{
    for (int i = 0; i < room->members.n; i++)
        if (strcmp(room->members.list[i]->id, stay->member) == 0)
            return room->members.list[i]->connection && !stay->left_ms;
    return false;
}

cJSON *presence_list(const struct room *room)
{
    cJSON *list = cJSON_CreateArray();
    for (int i = 0; i < room->presences->n; i++) {
        const struct presence *stay = &room->presences->list[i];
        cJSON *json = cJSON_CreateObject();
        cJSON_AddStringToObject(json, "member", stay->member);
        cJSON_AddStringToObject(json, "name", stay->name);
        cJSON_AddStringToObject(json, "role", wire_member_role_words.words[stay->role]);
        cJSON_AddNumberToObject(json, "entered_ms", (double)stay->entered_ms);
        json_add(json, "left_ms", stay->left_ms ? cJSON_CreateNumber((double)stay->left_ms) : cJSON_CreateNull());
        cJSON_AddBoolToObject(json, "here", is_here(room, stay));
        if (stay->user[0])
            cJSON_AddStringToObject(json, "user", stay->user);
        if (stay->is_guest)
            cJSON_AddTrueToObject(json, "is_guest");
        json_append(list, json);
    }
    return list;
}

char *presence_write(const struct room *room)
{
    cJSON *json = cJSON_CreateObject();
    cJSON_AddNumberToObject(json, "n_dropped", room->presences->n_dropped);
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
    const char *user = json_text(json, "user");
    (void)snprintf(stay->user, sizeof stay->user, "%.64s", user ? user : "");
    stay->is_guest = json_flag(json, "is_guest", false);
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
    room->presences->n_dropped = n_dropped > 0 && n_dropped < 1e9 ? (unsigned)n_dropped : 0;
    cJSON_ArrayForEach(row, cJSON_GetObjectItemCaseSensitive(json, "stays"))
    {
        struct presence read, *stay = read_stay(row, &read) ? add(room->presences) : NULL;
        if (stay)
            *stay = read;
    }
    cJSON_Delete(json);
}
