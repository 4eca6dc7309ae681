#pragma once
/* A plan's renderer process: its start, and the two ways to do without it (the plan closes, the plan fails). When it is
 * started again: restarts.h. Internal to server/fleet; net thread. */
#include "server/fleet/plan_entry.h"

/* Starts a process for the plan; the state stays. Returns false when the queue of orders to the watch is full: the plan
 * has no process then. */
NODISCARD bool renderer_start(struct fleet *fleet, struct plan_entry *plan);
/* To FLEET_CLOSED: the process ends, requests get PROBLEM_CANCELLED with `why`. */
void renderer_close(struct fleet *fleet, struct plan_entry *plan, const char *why);
/* To FLEET_FAILED: the process ends, requests get the problem. */
void renderer_fail(struct fleet *fleet, struct plan_entry *plan, const struct problem *problem);
