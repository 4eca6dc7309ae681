#pragma once
/* What renderers say and how they end; part of the fleet. */
#include "server/fleet/parts.h"

void news_packet(struct fleet *fleet, struct watch_event *event);
void news_ended(struct fleet *fleet, const struct watch_event *event);
bool fleet_take_gl(struct fleet *fleet, const cJSON *json);
void plan_entry_lose(struct plan_entry *plan); /* has no process any more */
/* To FLEET_FAILED: its process ends, what waits is answered with the problem. */
void plan_entry_fail(struct fleet *fleet, struct plan_entry *plan, const struct problem *problem);
