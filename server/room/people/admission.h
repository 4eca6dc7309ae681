#pragma once
/* The people of a room, where there is sign-in: who made it, who may come in without a link, who was removed and is not
 * let in again. Decides how a connection enters. Must never know: grants; the room's owner tells the highest role that
 * somebody may have (role_of). Internal to server/room. */
#include "server/room/people/links.h"
#include "server/room/state/room_state.h"

struct admitted { /* how a connection enters */
    enum wire_member_role role;
    bool is_guest;
    struct link *link; /* NULL: by none */
    char key[257];     /* who_key */
    char refusal[200]; /* "": none; else the sentence of bye, with its code */
    const char *code;
};

void admission_init(struct room *room); /* with the room */
void admission_free(struct room *room);

/* The role that this identity, which has signed in, has in the room without a link. False: none, or it was removed. */
bool admission_role(const struct room *room, const struct identity *who, enum wire_member_role *role);
/* How the connection enters; seat NULL: as a new member, else as this one, which it has proved to be. */
struct admitted admission_decide(struct room *room, const struct identity *who, const struct message_hello *hello,
                                 const struct member *seat);
/* The person behind this key is not let in again by what lets it in now. */
void admission_ban(struct room *room, const struct member *member);
/* {owner, is_open, people: [{who, role}], removed: [{user, name}]} */
NODISCARD cJSON *admission_document(const struct room *room);
/* Changes is_open and people, all checked before any of it applies. most: the role of who changes them. */
NODISCARD bool admission_patch(struct room *room, const cJSON *patch, enum wire_member_role most,
                               struct problem *problem);
/* Fills in owner and is_open. */
void admission_facts(const struct room *room, struct store_room *kept);
/* To what is kept and back. False: no memory. */
bool admission_write(const struct room *room, struct store_room *kept);
void admission_read(struct room *room, const struct store_room *kept);
