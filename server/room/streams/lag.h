#pragma once
/* Which members wait, and for what: their link or the renderer; member->lag. Internal to server/room. */
#include "server/room/state/room_state.h"

enum {
    LAG_AFTER_US = 1000000, /* a frame or a moving picture is late */
    LAG_KEPT_US = 3000000   /* what was told is told for so long, so that the list of members does not flicker */
};

/* Sets the lag of every member; has_changed is set to true when one has changed. Returns when the next may change
 * without another event; INT64_MAX: none. */
int64_t lags_settle(struct room *room, bool *has_changed);
