#pragma once
/* Members that left but can come back as the same; members as they are kept. Internal to server/room. */
#include "server/room/state/room_state.h"

struct known {
    struct store_member *list; /* the first to leave first; room for ROOM_MAX_KNOWN. NULL: nobody left */
    int n;
};

void known_init(struct room *room); /* with the room */
void known_free(struct room *room);

void known_write(const struct member *member, struct store_member *kept);
void known_read(const struct store_member *kept, struct member *member);
/* A member leaves the list of members. */
void known_add(struct room *room, const struct store_member *kept);
void known_add_member(struct room *room, const struct member *member);
/* Whether a member with this id and secret left; seat gets what is kept of it. */
bool known_has(const struct room *room, const char *id, const char *secret, struct member *seat);
/* Those of the same user cannot come back; of a guest, all guests of its link, as any can be the same person. */
void known_forget(struct room *room, const struct member *member);
void known_forget_link(struct room *room, const char *digits); /* those who came in by this link */
/* The member with this id and secret who left, as a new struct member that is not yet in the list; NULL: there is
 * none. */
struct member *known_back(struct room *room, const char *id, const char *secret);
/* The role of a new member who enters without a link: presenter in a room without members that knows no
 * presenter who left and might come back, else reviewer. */
enum wire_member_role role_of_newcomer(const struct room *room);
