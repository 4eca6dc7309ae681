#pragma once
/* One opened plan on one socket: the main thread's loop. Reads packets, hands pictures to the pipeline and questions to
 * the loader, and sends their results. Never runs for longer than a few milliseconds at a time. */
#include <stdbool.h>
#include <stdint.h>

#include "core/render/render.h"

struct session_options {
    int socket;
    const char *plan_folder, *plan_id;
    bool hides_folder;     /* as in loader_options */
    bool awaits_statement; /* the first packet is a statement, and the plan is read after it */
    enum render_back_end back_end;
    bool is_stub;
    const char *confined; /* what confine() reported */
    const char *cache;    /* writable folder */
    uint64_t max_bytes;   /* of memory; 0: no limit */
};

enum { SESSION_DONE = 0, SESSION_BROKEN = 1, SESSION_UNREADABLE = 3 };

/* Runs until the daemon closes the socket (SESSION_DONE), the connection breaks (SESSION_BROKEN) or the plan cannot be
 * read (SESSION_UNREADABLE). Returns the exit status. */
int session_run(const struct session_options *options);
