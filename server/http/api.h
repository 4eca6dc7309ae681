#pragma once
/* The HTTP API: its routes and their handlers. Net thread. Knows nothing of libmicrohttpd. */
#include "server/http/api_doors.h"
#include "server/http/call.h"
#include "server/net/net.h"
#include "server/net/plan_rights.h"

struct api;

/* max_upload_bytes 0: no uploads. */
struct api *api_create(struct net *net, struct auth *auth, uint64_t max_upload_bytes, const struct api_doors *doors);
/* Ends what is being drawn as PDF, and lets nothing more begin: before the net ends, on another thread than its. */
void api_stop_printing(struct api *api);
void api_destroy(struct api *api);

struct api_act;

struct api_route {
    const char *method, *path; /* as in proto/http.json: "/api/v1/plans/{plan}/open" */
    void (*handle)(struct api *api, struct call *call);
    const struct api_act *act; /* of api_room_act; else NULL */
};
/* The route number index: those with a handler of their own, then those of api_acts.c, then one for each question of
 * proto/packets.json. False after the last. */
bool api_route_at(size_t index, struct api_route *route);

/* Finds the route, checks the ids and runs the handler. The call is answered now or later, exactly once. */
void api_handle(struct api *api, struct call *call);

/* The screen of a feed (call_answer_feed) has left. Takes the reader's side of the feed. */
void api_display_left(struct api *api, struct feed *feed);

/* Counts an answer for /metrics. Any thread. */
void api_count(struct api *api, int status, int64_t took_us);
