#pragma once
/* Requests to renderers (a picture, a number) and their answers: each request is sent when its plan is ready, answered
 * exactly once, and fails when the renderer ends or the time is up (fleet_request, fleet_forget_request, fleet_tell).
 * Internal to server/fleet; net thread. */
#include "server/fleet/plan_entry.h"

/* Sends the plan's requests that waited for FLEET_READY. */
void requests_send_waiting(struct fleet *fleet, struct plan_entry *plan);
/* Sends the room updates that the watch had no room for. */
void requests_send_room_updates(struct fleet *fleet);
/* Fails the requests of a plan (NULL: of all plans); only_sent: those that wait for FLEET_READY go on waiting. Their
 * replies are called by requests_deliver_failed. */
void requests_fail(struct fleet *fleet, const struct plan_entry *plan, bool only_sent, const struct problem *problem);
void requests_deliver_failed(struct fleet *fleet);
/* Fails requests that are not answered within times.request. */
void requests_check_time(struct fleet *fleet, int64_t now_us);
bool requests_has_any(const struct fleet *fleet, const struct plan_entry *plan);
/* True if the renderer has been sent a request that it has not answered. */
bool requests_has_sent(const struct fleet *fleet, const struct plan_entry *plan);
/* A frame, answer or problem came. Returns false when it breaks the protocol. */
bool requests_answer(struct fleet *fleet, struct plan_entry *plan, struct packet *packet);
/* Frees all requests without a reply. */
void requests_destroy(struct fleet *fleet);
