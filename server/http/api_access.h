#pragma once
/* The check of rights of calls, the only one, made where the route is known, before rooms are woken. Internal to
 * server/http; net thread. */
#include "server/http/api_state.h"

typedef void api_again(struct api *api, struct call *call);

/* Whether the call may go on to its route. False: it was answered, or waits and is handled by `again`. Where nobody
 * signs in it always may. */
bool api_access_allows(struct api *api, struct call *call, const struct api_route *route, api_again *again);

/* For lists, and for routes whose subject is found out on the way: whether the caller has the right on this plan, by
 * grants or as its owner. */
bool api_access_to_plan(const struct api *api, const struct call *call, enum access_right right, const char *plan_id);
bool api_access_to_found_plan(const struct api *api, const struct call *call, enum access_right right,
                              const struct fleet_plan *plan);
/* Whether the caller may be given the names of the plan's patients; where nobody signs in that is the person at the
 * server's own machine. False with problem. */
NODISCARD bool api_may_name(const struct api *api, const struct call *call, const char *plan_id,
                            struct problem *problem);
/* Whether the caller may make a room on this plan. False with problem: not-found, as of a plan that is not there, or
 * forbidden to who sees the plan. */
NODISCARD bool api_access_makes_room(const struct api *api, const struct call *call, const char *plan_id,
                                     struct problem *problem);
/* Whether the caller may upload, asked before a byte of an archive is kept. Any thread. */
NODISCARD bool api_access_may_upload(const struct api *api, const struct call *call, struct problem *problem);
/* Whether the caller may take away what was made of the plan or, where room_id is not "", of a room on it, as a call to
 * make it is checked. False with problem: forbidden to who sees the one or the other, else not-found, without words. */
NODISCARD bool api_access_may_export(const struct api *api, const struct call *call, const char *plan_id,
                                     const char *room_id, struct problem *problem);
/* Whether the caller may look at this room, awake or asleep. */
bool api_access_sees_room(const struct api *api, const struct call *call, const char *room_id);
