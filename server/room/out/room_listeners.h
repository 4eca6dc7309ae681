#pragma once
/* Listeners of a room: who is told, in the order of the members' messages, what changes in it. Included by room.h. */
#include "server/room/state/room_types.h"

/* A listener is no member, neither keeps a room awake nor counts as its use. */
struct room_listener;
struct room_listener_callbacks {
    /* Tells a change, as the message with this name that members are sent: plan (without the plan), renderer, scene,
     * members, item, acceptances, control, files, recording. Numbers grow by one. Borrowed. */
    void (*told)(void *context, const char *epoch, uint64_t number, const char *name, const char *text);
    /* The whole of what the events tell, as it is after event `number`: {room, scene, control, items, recordings}.
     * Called by room_listener_add alone. Borrowed. */
    void (*state)(void *context, const char *epoch, uint64_t number, const cJSON *state);
    void (*ended)(void *context, const char *reason); /* with the room: the listener is gone */
    void *context;
};
