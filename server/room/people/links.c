/* Makes and keeps links, and finds the link of a token. */
#include "server/room/people/links.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/room/out/audit.h"
#include "server/room/people/room_links.h"
#include "server/room/state/event.h"
#include "server/room/state/roles.h"
#include "server/room/state/secret.h"

const char link_is_unknown[] = "the link is not one of this room, or ended long ago: ask for a new one";
static_assert(SECRET_TEXT == 33, "room.h tells the size of a token");

struct links {
    struct link list[ROOM_MAX_LINKS];
    struct link of_meeting; /* as link_find found it last */
    int n;
    bool were_made; /* there was one, perhaps none any more */
};

void links_init(struct room *room)
{
    room->links = mem_new(sizeof *room->links);
}

void links_free(struct room *room)
{
    free(room->links);
}

bool links_were_made(const struct room *room)
{
    return room->links->were_made;
}

static bool is_over(const struct room *room, const struct link *link)
{
    return room->now_us >= link->expires_us;
}

/* Forgets links that let nobody in any more. */
static void forget(struct room *room)
{
    int n = 0;
    for (int i = 0; i < room->links->n; i++)
        if (!is_over(room, &room->links->list[i]) && !room->links->list[i].is_used)
            room->links->list[n++] = room->links->list[i];
    room->links->n = n;
}

bool link_create(struct room *room, const struct room_link *wanted, char token[33], struct problem *problem)
{
    assert(wanted->expires_s >= ROOM_LINK_MIN_S && wanted->expires_s <= ROOM_LINK_WALL_MAX_S);
    if (room->links->n == ROOM_MAX_LINKS)
        forget(room); /* only now: until then a late visitor is told why the link ended */
    if (room->links->n == ROOM_MAX_LINKS)
        return problem_set(problem, PROBLEM_LIMIT, "", "", "%d links of this room are valid, more are not allowed",
                           room->links->n);
    struct link *link = &room->links->list[room->links->n++];
    *link = (struct link){ .role = wanted->role,
                           .expires_us = room->now_us + wanted->expires_s * INT64_C(1000000),
                           .expires_ms = clock_wall_ms() + wanted->expires_s * 1000,
                           .is_one_use = wanted->is_one_use,
                           .allows_guests = wanted->allows_guests };
    (void)snprintf(link->maker, sizeof link->maker, "%s", wanted->maker);
    (void)snprintf(link->name, sizeof link->name, "%s", wanted->name);
    secret_make(token);
    secret_hash(token, link->token_hash);
    room->links->were_made = true;
    room_event(room, ROOM_LINKS, NULL);
    return true;
}

/* The link of the room's meeting, good until the next is looked for. NULL: it is none. */
static struct link *find_of_meeting(struct room *room, const struct identity *who, const char *token)
{
    const struct room_meeting_callbacks *meeting = room->callbacks.meeting;
    struct room_meeting_link of;
    if (!meeting || !meeting->link(room->callbacks.context, room, who, token, &of))
        return NULL;
    struct link *link = &room->links->of_meeting;
    *link = (struct link){
        .role = of.role, .expires_us = INT64_MAX, .allows_guests = of.allows_guests, .is_of_meeting = true
    };
    memcpy(link->token_hash, of.token_hash, sizeof link->token_hash);
    (void)snprintf(link->maker, sizeof link->maker, "%s", of.maker);
    (void)snprintf(link->name, sizeof link->name, "%s", of.name);
    return link;
}

const char *link_find(struct room *room, const struct identity *who, const char *token, const char *person,
                      struct link **found)
{
    struct link *link = NULL;
    for (int i = 0; i < room->links->n; i++) /* all of them, whichever it is */
        if (secret_matches(token, room->links->list[i].token_hash))
            link = &room->links->list[i];
    if (!link)
        link = find_of_meeting(room, who, token);
    if (!link)
        return link_is_unknown;
    if (is_over(room, link))
        return "the link has expired: ask for a new one";
    if (link->is_used && (link->person[0] == 0 || strcmp(link->person, person) != 0))
        return "the link was for one person and has been used: ask for one of your own";
    *found = link;
    return NULL;
}

/* Writes eight digits of the token's hash: they tell links apart and let nobody in. */
static void write_digits(const unsigned char hash[SECRET_HASH_BYTES], char digits[9])
{
    (void)snprintf(digits, 9, "%02x%02x%02x%02x", hash[0], hash[1], hash[2], hash[3]);
}

void link_digits(const struct link *link, char digits[9])
{
    write_digits(link->token_hash, digits);
}

int links_all_digits(const struct room *room, char digits[ROOM_MAX_LINKS][9])
{
    int n = 0;
    for (int i = 0; i < room->links->n; i++)
        if (!is_over(room, &room->links->list[i]))
            link_digits(&room->links->list[i], digits[n++]);
    return n;
}

void room_link_digits(const char *token, char digits[9])
{
    unsigned char hash[SECRET_HASH_BYTES];
    secret_hash(token, hash);
    write_digits(hash, digits);
}

static cJSON *describe(const struct link *link)
{
    char digits[9];
    cJSON *detail = cJSON_CreateObject();
    write_digits(link->token_hash, digits);
    cJSON_AddStringToObject(detail, "link", digits);
    cJSON_AddStringToObject(detail, "role", wire_member_role_words.words[link->role]);
    cJSON_AddBoolToObject(detail, "one_use", link->is_one_use);
    return detail;
}

void link_used(struct room *room, struct link *link, const struct member *member, const char *person)
{
    const struct audit_act act = {
        .by = member, .action = "link", .detail = describe(link), .before = -1, .after = -1
    };
    audit_tell(room, &act);
    if (!link->is_one_use)
        return;
    link->is_used = true;
    (void)snprintf(link->person, sizeof link->person, "%s", person);
    room_event(room, ROOM_LINKS, NULL);
}

/* Members, connected or away, who came in by it. */
static int n_came(const struct room *room, const char *digits)
{
    int n = 0;
    for (int i = 0; i < room->members.n; i++)
        n += strcmp(room->members.list[i]->link, digits) == 0;
    return n;
}

cJSON *links_list(const struct room *room)
{
    cJSON *list = cJSON_CreateArray();
    for (int i = 0; i < room->links->n; i++) {
        const struct link *link = &room->links->list[i];
        char digits[9];
        if (is_over(room, link))
            continue;
        cJSON *json = cJSON_CreateObject();
        write_digits(link->token_hash, digits);
        cJSON_AddStringToObject(json, "id", digits);
        cJSON_AddStringToObject(json, "role", wire_member_role_words.words[link->role]);
        cJSON_AddNumberToObject(json, "expires_s", (double)((link->expires_us - room->now_us + 999999) / 1000000));
        cJSON_AddBoolToObject(json, "one_use", link->is_one_use);
        cJSON_AddBoolToObject(json, "used", link->is_used);
        cJSON_AddBoolToObject(json, "guests", link->allows_guests);
        cJSON_AddStringToObject(json, "name", link->name);
        cJSON_AddStringToObject(json, "by", link->maker);
        cJSON_AddNumberToObject(json, "came", n_came(room, digits));
        json_append(list, json);
    }
    return list;
}

bool link_end(struct room *room, const char *digits)
{
    for (int i = 0; i < room->links->n; i++) {
        char found[9];
        link_digits(&room->links->list[i], found);
        if (strcmp(found, digits) != 0)
            continue;
        room->links->n--;
        memmove(&room->links->list[i], &room->links->list[i + 1],
                (size_t)(room->links->n - i) * sizeof room->links->list[0]);
        room_event(room, ROOM_LINKS, NULL);
        return true;
    }
    return false;
}

bool link_revoke(struct room *room, const char *digits, const struct member *by, const char *address)
{
    for (int i = 0; i < room->links->n; i++) {
        char found[9];
        write_digits(room->links->list[i].token_hash, found);
        if (strcmp(found, digits) != 0)
            continue;
        const struct audit_act act = { .by = by,
                                       .action = "link-revoked",
                                       .address = address,
                                       .detail = describe(&room->links->list[i]),
                                       .before = -1,
                                       .after = -1 };
        audit_tell(room, &act);
        return link_end(room, digits);
    }
    return false;
}

bool links_write(const struct room *room, struct store_room *kept)
{
    kept->links = mem_array((size_t)room->links->n, sizeof kept->links[0], 1 << 20, NULL);
    for (int i = 0; kept->links && i < room->links->n; i++) {
        const struct link *link = &room->links->list[i];
        struct store_link *to = &kept->links[kept->n_links++];
        memcpy(to->token_hash, link->token_hash, sizeof to->token_hash);
        memcpy(to->person, link->person, sizeof to->person);
        (void)snprintf(to->maker, sizeof to->maker, "%s", link->maker);
        (void)snprintf(to->name, sizeof to->name, "%s", link->name);
        to->allows_guests = link->allows_guests;
        (void)snprintf(to->role, sizeof to->role, "%s", wire_member_role_words.words[link->role]);
        to->expires_ms = link->expires_ms;
        to->is_one_use = link->is_one_use;
        to->is_used = link->is_used;
    }
    return kept->links != NULL;
}

static void read_link(struct room *room, const struct store_link *from)
{
    enum wire_member_role role;
    if (!role_of_word(from->role, &role)) {
        log_error("room %s: a link is left out: its role is \"%s\"", room->id, from->role);
        return;
    }
    const int most_s = role == WIRE_MEMBER_ROLE_WALL ? ROOM_LINK_WALL_MAX_S : ROOM_LINK_MAX_S;
    const int64_t now_ms = clock_wall_ms(), most_ms = most_s * INT64_C(1000);
    int64_t left_ms = from->expires_ms <= now_ms ? 0 : most_ms; /* at most, also when the clock was set back */
    if (left_ms && from->expires_ms < now_ms + most_ms)
        left_ms = from->expires_ms - now_ms;
    struct link *link = &room->links->list[room->links->n++];
    *link = (struct link){ .role = role,
                           .expires_us = room->now_us + left_ms * 1000,
                           .expires_ms = now_ms + left_ms,
                           .is_one_use = from->is_one_use,
                           .is_used = from->is_used,
                           .allows_guests = from->allows_guests };
    (void)snprintf(link->maker, sizeof link->maker, "%s", from->maker);
    (void)snprintf(link->name, sizeof link->name, "%.160s", from->name);
    memcpy(link->token_hash, from->token_hash, sizeof link->token_hash);
    memcpy(link->person, from->person, sizeof link->person);
}

void links_read(struct room *room, const struct store_room *kept)
{
    room->links->were_made = kept->has_links || kept->n_links > 0;
    for (size_t i = 0; i < kept->n_links && room->links->n < ROOM_MAX_LINKS; i++)
        read_link(room, &kept->links[i]);
}
