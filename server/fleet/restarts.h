#pragma once
/* Decides when a renderer that ended is started again. A renderer that had worked is started at once. A renderer that
 * ended without having delivered a picture is started after pauses that double, for as long as a viewer holds the plan.
 * Internal to server/fleet; net thread. */
#include "server/fleet/plan_entry.h"

enum {
    RESTART_FIRST_PAUSE_MS = 1000, /* after the second end in a row without a picture */
    RESTART_LONGEST_PAUSE_MS = 30000,
    RESTART_WORKED_MS = 60000, /* time ready that counts like a picture: of some plans only questions are requested */
    RESTART_QUICK_EVERY_MS = 1000, /* one start of a plan without a pause is allowed in this time, ... */
    RESTART_QUICK_AHEAD_MS = 60000 /* ... and at most as many in a row as fit into this time */
};

/* The pause before the next start, after this many ends in a row without a picture. */
int restart_pause_ms(int n_ends_without_picture);
/* Starts the plan's renderer. When the order cannot be given: a plan that is held waits for its next start, another
 * fails with PROBLEM_BUSY. */
void restart_now(struct fleet *fleet, struct plan_entry *plan);
/* The plan's renderer ended without being told to: plans the next start, or fails the plan when nobody holds it and it
 * ended too often. how: "stopped (signal 11)". */
void restart_after_end(struct fleet *fleet, struct plan_entry *plan, const char *how);
/* Starts the renderer when that is due, and keeps the phase ("it is started again in 5 s") up to date. */
void restart_tick(struct fleet *fleet, struct plan_entry *plan, int64_t now_us);
