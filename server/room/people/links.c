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
#include "server/room/state/secret.h"

static_assert(SECRET_TEXT == 33, "room.h tells the size of a token");

struct links {
    struct link list[ROOM_MAX_LINKS];
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

bool link_create(struct room *room, enum wire_member_role role, int64_t expires_s, bool is_one_use, char token[33],
                 struct problem *problem)
{
    assert(expires_s >= ROOM_LINK_MIN_S && expires_s <= ROOM_LINK_MAX_S);
    if (room->links->n == ROOM_MAX_LINKS)
        forget(room); /* only now: until then a late visitor is told why the link ended */
    if (room->links->n == ROOM_MAX_LINKS)
        return problem_set(problem, PROBLEM_LIMIT, "", "", "%d links of this room are valid, more are not allowed",
                           room->links->n);
    struct link *link = &room->links->list[room->links->n++];
    *link = (struct link){ .role = role,
                           .expires_us = room->now_us + expires_s * INT64_C(1000000),
                           .expires_ms = clock_wall_ms() + expires_s * 1000,
                           .is_one_use = is_one_use };
    secret_make(token);
    secret_hash(token, link->token_hash);
    room->links->were_made = true;
    room_event(room, ROOM_LINKS, NULL);
    return true;
}

const char *link_find(struct room *room, const char *token, const char *person, struct link **found)
{
    struct link *link = NULL;
    for (int i = 0; i < room->links->n; i++) /* all of them, whichever it is */
        if (secret_matches(token, room->links->list[i].token_hash))
            link = &room->links->list[i];
    if (!link)
        return "the link is not one of this room, or ended long ago: ask for a new one";
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
        json_append(list, json);
    }
    return list;
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
        room->links->n--;
        memmove(&room->links->list[i], &room->links->list[i + 1],
                (size_t)(room->links->n - i) * sizeof room->links->list[0]);
        room_event(room, ROOM_LINKS, NULL);
        return true;
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
        (void)snprintf(to->role, sizeof to->role, "%s", wire_member_role_words.words[link->role]);
        to->expires_ms = link->expires_ms;
        to->is_one_use = link->is_one_use;
        to->is_used = link->is_used;
    }
    return kept->links != NULL;
}

static void read_link(struct room *room, const struct store_link *from)
{
    size_t role = 0;
    while (role < wire_member_role_words.n && strcmp(from->role, wire_member_role_words.words[role]) != 0)
        role++;
    if (role == wire_member_role_words.n) {
        log_error("room %s: a link is left out: its role is \"%s\"", room->id, from->role);
        return;
    }
    const int64_t now_ms = clock_wall_ms(), most_ms = ROOM_LINK_MAX_S * INT64_C(1000);
    int64_t left_ms = from->expires_ms <= now_ms ? 0 : most_ms; /* at most, also when the clock was set back */
    if (left_ms && from->expires_ms < now_ms + most_ms)
        left_ms = from->expires_ms - now_ms;
    struct link *link = &room->links->list[room->links->n++];
    *link = (struct link){ .role = (enum wire_member_role)role,
                           .expires_us = room->now_us + left_ms * 1000,
                           .expires_ms = now_ms + left_ms,
                           .is_one_use = from->is_one_use,
                           .is_used = from->is_used };
    memcpy(link->token_hash, from->token_hash, sizeof link->token_hash);
    memcpy(link->person, from->person, sizeof link->person);
}

void links_read(struct room *room, const struct store_room *kept)
{
    room->links->were_made = kept->has_links || kept->n_links > 0;
    for (size_t i = 0; i < kept->n_links && room->links->n < ROOM_MAX_LINKS; i++)
        read_link(room, &kept->links[i]);
}
