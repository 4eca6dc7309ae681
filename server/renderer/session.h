#pragma once
/* One opened plan on one socket: the main thread's work. Reads what the daemon asks, hands pictures to the pipeline and
 * questions to the loader, sends what comes back. Never works itself for longer than a few milliseconds. */
#include <stdint.h>

#include "core/render/render.h"

struct session_options {
    int socket;
    const char *plan_folder, *plan_id;
    enum render_back_end back_end;
    bool is_stub;
    const char *confined; /* what confine() got */
    const char *cache;    /* folder that may be written */
    uint64_t max_bytes;   /* of memory; 0: no limit */
};

enum { SESSION_DONE = 0, SESSION_BROKEN = 1, SESSION_UNREADABLE = 3 };

/* Until the daemon's end closes (SESSION_DONE) or the plan cannot be read (SESSION_UNREADABLE). Gives the exit status.
 */
int session_run(const struct session_options *options);
