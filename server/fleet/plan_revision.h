#pragma once
/* The revision of a plan's files: has a confined program compute it, away from everything that waits for a plan, and
 * only for a plan that somebody asked it of. Internal to server/fleet; net thread. */
#include "server/fleet/plan_entry.h"
#include "server/fleet/watch_event.h"

enum {
    REVISION_AGAIN_MS = 10000,   /* whether files have changed is looked at when it is asked for, at most this often */
    REVISION_LIMIT_MS = 1800000, /* a disk may be slow and a plan large */
    REVISION_MAX_PROGRAMS = 1
};

/* Starts programs that are due. */
void plan_revisions_start(struct fleet *fleet);
/* True: the ended program was one of these. */
bool plan_revision_ended(struct fleet *fleet, const struct watch_event *event);
