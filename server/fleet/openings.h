#pragma once
/* Opens, closes, holds and releases plans within the limit of renderers that run at once (fleet_open, fleet_close,
 * fleet_hold, fleet_release). Internal to server/fleet; net thread. */
#include "server/fleet/plan_entry.h"

/* Opens a plan that is held. Without a free slot it goes to FLEET_FAILED with a sentence, and tries again later. */
void opening_of_held(struct fleet *fleet, struct plan_entry *plan);
/* Time until opening_tick has something to do; INT64_MAX: it has nothing. */
int64_t opening_left_us(const struct fleet *fleet, const struct plan_entry *plan, int64_t now_us);
/* Tries again for a slot, and closes a plan that nobody used for idle_close_s. */
void opening_tick(struct fleet *fleet, struct plan_entry *plan, int64_t now_us);
