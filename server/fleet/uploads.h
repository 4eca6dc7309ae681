#pragma once
/* Uploads: an archive in data/uploads becomes a plan in data/plans (fleet_upload, fleet_upload_find,
 * fleet_upload_cancel). Internal to server/fleet; net thread. */
#include "server/fleet/plan_entry.h"

struct watch_event;

/* Starts waiting uploads, and ends uploads whose plan is listed. */
void uploads_tick(struct fleet *fleet);
/* A line or the end of a process. Returns true when the process was an upload's. */
bool uploads_event(struct fleet *fleet, const struct watch_event *event);
bool uploads_rest(const struct fleet *fleet); /* all have ended */
void uploads_destroy(struct fleet *fleet);
