#pragma once
/* Scans: a confined program (beamroom-render --scan) looks into a plan folder and prints a summary: name, parts,
 * whether it can be read. Internal to server/fleet; net thread. */
#include "server/fleet/plan_entry.h"

struct watch_event;

/* Starts scans of plans that want one, at most FLEET_MAX_SCANS at once. */
void plan_scans_start(struct fleet *fleet);
/* Returns true when the event was the end of a plan's scan. */
bool plan_scan_ended(struct fleet *fleet, const struct watch_event *event);
/* The summary that an ended scan printed; NULL with a reason when it printed none. The caller deletes it. */
NODISCARD cJSON *plan_scan_summary(const struct watch_event *event, char reason[240]);
