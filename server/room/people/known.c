/* The list of members that left. */
#include "server/room/people/known.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/room/state/roles.h"
#include "server/room/state/who.h"

void known_init(struct room *room)
{
    room->known = mem_new(sizeof *room->known);
}

void known_free(struct room *room)
{
    free(room->known->list);
    free(room->known);
}

void known_write(const struct member *member, struct store_member *kept)
{
    *kept = (struct store_member){ 0 };
    (void)snprintf(kept->id, sizeof kept->id, "%s", member->id);
    (void)snprintf(kept->name, sizeof kept->name, "%s", member->name);
    (void)snprintf(kept->color, sizeof kept->color, "#%06x", (unsigned)color_rgb(member->color) & 0xffffff);
    (void)snprintf(kept->role, sizeof kept->role, "%s", wire_member_role_words.words[member->role]);
    (void)snprintf(kept->user, sizeof kept->user, "%s", member->user);
    (void)snprintf(kept->link, sizeof kept->link, "%s", member->link);
    kept->is_guest = member->is_guest;
    kept->waits_outside = member->waits_outside;
    memcpy(kept->secret_hash, member->secret_hash, sizeof kept->secret_hash);
}

void known_read(const struct store_member *kept, struct member *member)
{
    (void)snprintf(member->id, sizeof member->id, "%s", kept->id);
    (void)snprintf(member->name, sizeof member->name, "%.160s", kept->name);
    member->number = (uint32_t)strtoul(kept->id + (kept->id[0] == 'm'), NULL, 10);
    memcpy(member->secret_hash, kept->secret_hash, sizeof member->secret_hash);
    member->role = WIRE_MEMBER_ROLE_REVIEWER; /* of a member from before there were roles */
    (void)role_of_word(kept->role, &member->role);
    (void)snprintf(member->user, sizeof member->user, "%s", kept->user);
    who_key_of_user(kept->user, member->person); /* of others it is not kept */
    (void)snprintf(member->link, sizeof member->link, "%s", kept->link);
    member->is_guest = kept->is_guest;
    member->waits_outside = kept->waits_outside;
    for (int i = 0; i < ROLES_N_COLORS; i++) {
        char color[8];
        (void)snprintf(color, sizeof color, "#%06x", (unsigned)color_rgb(i) & 0xffffff);
        if (strcmp(kept->color, color) == 0)
            member->color = i;
    }
}

static void known_remove(struct room *room, int index)
{
    room->known->n--;
    memmove(&room->known->list[index], &room->known->list[index + 1],
            (size_t)(room->known->n - index) * sizeof room->known->list[0]);
}

/* Presenters are forgotten last: once none is known, the next stranger in the empty room becomes one. */
static int first_to_forget(const struct room *room)
{
    int first = 0;
    while (first < room->known->n &&
           strcmp(room->known->list[first].role, wire_member_role_words.words[WIRE_MEMBER_ROLE_PRESENTER]) == 0)
        first++;
    return first < room->known->n ? first : 0;
}

void known_add(struct room *room, const struct store_member *kept)
{
    if (!room->known->list)
        room->known->list = mem_array(ROOM_MAX_KNOWN, sizeof room->known->list[0], 1 << 20, NULL);
    if (!room->known->list)
        return; /* then it cannot come back as the same */
    if (room->known->n == ROOM_MAX_KNOWN)
        known_remove(room, first_to_forget(room));
    room->known->list[room->known->n] = *kept;
    room->known->list[room->known->n++].has_left = true;
}

void known_add_member(struct room *room, const struct member *member)
{
    struct store_member kept;
    known_write(member, &kept);
    known_add(room, &kept);
}

/* -1: there is none. */
static int find(const struct room *room, const char *id, const char *secret)
{
    for (int i = 0; i < room->known->n && id[0]; i++)
        if (strcmp(room->known->list[i].id, id) == 0 && secret_matches(secret, room->known->list[i].secret_hash))
            return i;
    return -1;
}

bool known_has(const struct room *room, const char *id, const char *secret, struct member *seat)
{
    const int index = find(room, id, secret);
    if (index >= 0)
        known_read(&room->known->list[index], seat);
    return index >= 0;
}

void known_forget(struct room *room, const struct member *member)
{
    for (int i = room->known->n; i-- > 0;) {
        const struct store_member *known = &room->known->list[i];
        const bool is_same = member->user[0]
                                 ? strcmp(known->user, member->user) == 0
                                 : member->is_guest && known->is_guest && strcmp(known->link, member->link) == 0;
        if (is_same)
            known_remove(room, i);
    }
}

void known_forget_link(struct room *room, const char *digits)
{
    for (int i = room->known->n; i-- > 0;)
        if (strcmp(room->known->list[i].link, digits) == 0)
            known_remove(room, i);
}

struct member *known_back(struct room *room, const char *id, const char *secret)
{
    const int index = find(room, id, secret);
    if (index < 0)
        return NULL;
    struct member *member = mem_new(sizeof *member);
    known_read(&room->known->list[index], member);
    known_remove(room, index);
    return member;
}

enum wire_member_role role_of_newcomer(const struct room *room)
{
    bool is_first = true;
    for (int i = 0; is_first && i < room->members.n; i++)
        is_first = room->members.list[i]->role == WIRE_MEMBER_ROLE_WALL;
    for (int i = 0; is_first && i < room->known->n; i++)
        is_first = strcmp(room->known->list[i].role, wire_member_role_words.words[WIRE_MEMBER_ROLE_PRESENTER]) != 0;
    return is_first ? WIRE_MEMBER_ROLE_PRESENTER : WIRE_MEMBER_ROLE_REVIEWER;
}
