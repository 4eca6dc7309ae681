#pragma once
/* Turns what renderers report, and their ends, into changes of their plans: progress, ready, failed, answers, memory,
 * the end of a process. Internal to server/fleet; net thread. */
#include "server/fleet/plan_entry.h"

struct watch_event;

void renderer_started(struct fleet *fleet, const struct watch_event *event);
void renderer_memory(struct fleet *fleet, const struct watch_event *event);
/* A packet from a renderer. One that breaks the protocol kills the renderer. */
void renderer_packet(struct fleet *fleet, struct watch_event *event);
/* The end of a process; nothing when it was no plan's renderer. */
void renderer_ended(struct fleet *fleet, const struct watch_event *event);
/* Kills a renderer that has read its plan without progress for too long. */
void renderer_check_stall(struct fleet *fleet, struct plan_entry *plan, int64_t now_us);
