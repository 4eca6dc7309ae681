#pragma once
/* Calls that do in a room what members do by messages. Internal to server/http; net thread. */
#include "server/http/api_state.h"

struct api_act {
    const char *method, *path; /* as in proto/http.json */
    const char *message;       /* its name in proto/messages.json */
    const char *kind;          /* of an item; NULL: it is about none */
};
extern const size_t api_n_acts;

/* The route of the act number index. False after the last. */
bool api_act_route(size_t index, struct api_route *route);
/* Does what the message says, as the call's member or identity, and answers the call: with the item, else with 204.
 * Takes json. name: who writes an item without being a member; NULL: none is said. */
void api_act_in(struct room *room, struct call *call, cJSON *json, const char *name);
/* Does what call->act says. */
void api_room_act(struct api *api, struct call *call);
