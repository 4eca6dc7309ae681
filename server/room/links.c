/* Makes links, and finds the link of a token. */
#include "server/room/links.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

static_assert(SECRET_TEXT == 33, "room.h tells the size of a token");

static bool is_over(const struct room *room, const struct link *link)
{
    return room->now_us >= link->expires_us;
}

/* Forgets links that let nobody in any more. */
static void forget(struct room *room)
{
    int n = 0;
    for (int i = 0; i < room->n_links; i++)
        if (!is_over(room, &room->links[i]) && !room->links[i].is_used)
            room->links[n++] = room->links[i];
    room->n_links = n;
}

bool room_link_create(struct room *room, enum wire_member_role role, int64_t expires_s, bool is_one_use, int64_t now_us,
                      char token[33], struct problem *problem)
{
    assert(expires_s >= ROOM_LINK_MIN_S && expires_s <= ROOM_LINK_MAX_S);
    room->now_us = now_us;
    if (room->n_links == ROOM_MAX_LINKS)
        forget(room); /* not before, so that who comes late is told why */
    if (room->n_links == ROOM_MAX_LINKS)
        return problem_set(problem, PROBLEM_LIMIT, "", "", "%d links of this room are valid, more are not allowed",
                           room->n_links);
    struct link *link = &room->links[room->n_links++];
    *link =
        (struct link){ .role = role, .expires_us = now_us + expires_s * INT64_C(1000000), .is_one_use = is_one_use };
    secret_make(link->token);
    room->has_links = true;
    memcpy(token, link->token, sizeof link->token);
    return true;
}

const char *link_find(struct room *room, const char *token, const char *person, struct link **found)
{
    struct link *link = NULL;
    for (int i = 0; i < room->n_links; i++) /* all of them, whichever it is */
        if (secret_is(room->links[i].token, token))
            link = &room->links[i];
    if (!link)
        return "the link is not one of this room, or ended long ago: ask for a new one";
    if (is_over(room, link))
        return "the link has expired: ask for a new one";
    if (link->is_used && (link->person[0] == 0 || strcmp(link->person, person) != 0))
        return "the link was for one person and has been used: ask for one of your own";
    *found = link;
    return NULL;
}

void link_used(struct link *link, const char *person)
{
    if (!link->is_one_use)
        return;
    link->is_used = true;
    (void)snprintf(link->person, sizeof link->person, "%s", person);
}
