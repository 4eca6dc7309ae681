#pragma once
/* When a renderer that ended is started again; part of the fleet. A renderer that had worked is started at once. One
 * that ended without having delivered a picture is started after pauses that double, for as long as somebody is there
 * to see the plan. */
#include "server/fleet/parts.h"

enum {
    RESTART_FIRST_PAUSE_MS = 1000, /* after the second end in a row without a picture */
    RESTART_LONGEST_PAUSE_MS = 30000,
    RESTART_WORKED_MS = 60000, /* ready for this long counts like a picture: some plans are only asked for numbers */
    RESTART_QUICK_EVERY_MS = 1000, /* quick starts of one plan: one in this time, ... */
    RESTART_QUICK_AHEAD_MS = 60000 /* ... and before that as many as fit into this */
};

/* The pause before the next start after this many ends in a row without a picture. */
int restart_pause_ms(int n_barren);
/* The plan's renderer has ended without being told to: the next start is planned, or, when nobody holds the plan and it
 * ended too often, the plan fails. how: "stopped (signal 11)". */
void restart_after_end(struct fleet *fleet, struct plan_entry *plan, const char *how);
/* The plan is held, and no process could be made for it: one more start without a picture, never at once. */
void restart_not_begun(struct fleet *fleet, struct plan_entry *plan, const char *how);
/* Starts what is due, and says how long the pause still is. */
void restart_tick(struct fleet *fleet, struct plan_entry *plan, int64_t now_us);
