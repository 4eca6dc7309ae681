#pragma once
/* The graphics of the renderers: the GL facts of the newest renderer that reported them, and the probe program
 * (beamroom-render --probe-gl) that reports them before any plan is open (fleet_gl). Internal to server/fleet; net
 * thread. */
#include "server/fleet/plan_entry.h"
#include "server/wire/packet.h"

struct watch_event;

void gl_probe_start(struct fleet *fleet);
/* Returns true when the event was the probe's end. */
bool gl_probe_ended(struct fleet *fleet, const struct watch_event *event);
/* The facts of a "gl" packet. Returns false when they name neither a back end nor a problem. */
bool gl_facts_received(struct fleet *fleet, const struct packet_gl *gl);
