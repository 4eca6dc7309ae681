#pragma once
/* Recordings for the route of new rooms. Internal to server/http; net thread. */
#include "server/http/api.h"
#include "server/http/call.h"

/* Whether the caller may play recordings of rooms on this plan. False with problem. */
NODISCARD bool api_may_replay(const struct api *api, const struct call *call, const char *plan_id,
                              struct problem *problem);
void api_recording_is_missing(const struct call *call, struct problem *problem);
/* True: the recording's room sleeps; it is being woken, and the call is handled again by `again`. */
bool api_recording_sleeps(struct api *api, struct call *call, const cJSON *asked,
                          void (*again)(struct api *api, struct call *call));
/* The room for a body with recording: {room, id}; plan_id may be NULL. NULL with problem. */
struct room *api_replay_new(struct api *api, const struct call *call, const cJSON *asked, const char *plan_id,
                            struct problem *problem);
