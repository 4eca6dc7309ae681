#pragma once
/* Control of a room: its holder (room->presenter), the members who request it, its lock, and the control message.
 * Internal to server/room. */
#include "server/room/state/room_state.h"

struct control {
    bool is_locked;      /* control is given only, not taken */
    uint64_t n_requests; /* ever made */
    enum wire_control_act act;
    char member[64], by[64]; /* of act */
    bool is_new;             /* act is not told yet */
};

void control_init(struct room *room); /* with the room */
void control_free(struct room *room);

/* Makes the member the presenter, NULL: nobody. A lock ends, and the member's request; with nobody, all requests. */
void control_pass(struct room *room, struct member *member);
/* To be told with the next control message. */
void control_note(struct room *room, enum wire_control_act act, const struct member *member, const struct member *by);
/* The member's connection was lost: its request ends. */
void control_left(struct room *room, struct member *member);
/* Tells all members how things stand, if that has changed since the last time. Returns INT64_MAX. */
int64_t control_settle(struct room *room);
/* Tells one member how things stand. */
/* {presenter, locked, requests}. */
NODISCARD cJSON *control_document(const struct room *room);
void control_send(struct room *room, struct member *member);
