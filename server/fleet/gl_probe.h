#pragma once
/* Which graphics the renderers get: the GL facts of the newest renderer that reported them, and the probe program
 * (beamroom-render --probe-gl) that reports them before any plan is open (fleet_gl). Internal to server/fleet; net
 * thread. */
#include "server/fleet/plan_entry.h"

struct watch_event;

void gl_probe_start(struct fleet *fleet);
/* Returns true when the event was the probe's end. */
bool gl_probe_ended(struct fleet *fleet, const struct watch_event *event);
/* A "gl" packet, or what the probe printed. Returns false when it breaks the protocol. */
bool gl_facts_received(struct fleet *fleet, const cJSON *json);
