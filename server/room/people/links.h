#pragma once
/* Links that let new members in with a role: making one, and finding one for a hello. Internal to server/room. */
#include "server/room/people/room_links.h"
#include "server/room/state/room_state.h"

struct link { /* lets new members in */
    unsigned char token_hash[SECRET_HASH_BYTES];
    char person[257]; /* who has used it, if it is for one */
    enum wire_member_role role;
    int64_t expires_us, expires_ms; /* the same moment on the room's clock and on the wall's */
    bool is_one_use, is_used, allows_guests;
    bool is_of_meeting;                /* of the meeting that the room is a case of; it is not kept here */
    char maker[STORE_USER], name[161]; /* the user who made it; what it is for. "": not known */
};
extern const char link_is_unknown[]; /* of link_find */

void links_init(struct room *room); /* with the room */
void links_free(struct room *room);

/* There was one; then those who are no members may do less: room_call_may. */
bool links_were_made(const struct room *room);
/* Makes one: room_link_create. */
NODISCARD bool link_create(struct room *room, const struct room_link *wanted, char token[33], struct problem *problem);
/* [{id, role, expires_s, one_use, used, guests, name, by, came}] of those that are not over. */
NODISCARD cJSON *links_list(const struct room *room);
void link_digits(const struct link *link, char digits[9]);
/* Those of all links that let somebody in now; returns their number. */
int links_all_digits(const struct room *room, char digits[ROOM_MAX_LINKS][9]);
/* The link lets nobody in any more. False: there is none. */
bool link_end(struct room *room, const char *digits);
/* Forgets the link with these digits. False: there is none. */
NODISCARD bool link_revoke(struct room *room, const char *digits, const struct member *by, const char *address);
/* Finds the link that the token opens for this person. Returns NULL, or the sentence why it opens nothing. */
const char *link_find(struct room *room, const struct identity *who, const char *token, const char *person,
                      struct link **found);
/* The member came in by it. */
void link_used(struct room *room, struct link *link, const struct member *member, const char *person);
/* To what is kept and back. False: no memory. */
bool links_write(const struct room *room, struct store_room *kept);
void links_read(struct room *room, const struct store_room *kept);
