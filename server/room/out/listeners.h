#pragma once
/* Tells listeners, and keeps the newest of what they were told for those who come back. Numbers count from the first
 * listener of a room on; epoch is another word for each room in memory, so that a number of before a restart means
 * nothing. Internal to server/room; what others use stands in room_listeners.h and room.h. */
#include "server/room/out/room_listeners.h"
#include "server/room/state/room_state.h"
#include "server/wire/message.h"

enum { LISTENERS_KEPT = 1024, LISTENERS_KEPT_BYTES = 1 << 20 };

struct room_listener {
    struct room_listener *next;
    struct room *room;
    struct room_listener_callbacks callbacks;
};

struct listeners {
    struct room_listener *first;
    int n;
    char epoch[17];
    uint64_t number; /* of the newest event */
    struct {
        const char *name; /* of the message */
        char *text;
    } kept[LISTENERS_KEPT]; /* event k at k % LISTENERS_KEPT; text NULL: not kept any more */
    uint64_t oldest;        /* the oldest that is kept is this one; number + 1: none is */
    size_t n_bytes;         /* of those kept */
};

/* Begins to keep what is told, unless that was done. */
struct listeners *listeners_begin(struct room *room);
/* Whether anybody is or was told. */
bool listeners_are_told(const struct room *room, enum message_type type);
/* text: the message as members are sent it; NULL: there was no memory for it, and who comes back begins anew. */
void listeners_tell(struct room *room, enum message_type type, const char *text);
/* Tells a listener what came after event number; false: that is not kept any more, or of another epoch. */
NODISCARD bool listeners_tell_since(const struct room_listener *listener, const char *epoch, uint64_t number);
void listeners_end(struct room *room, const char *reason); /* with the room */
