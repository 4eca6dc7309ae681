#pragma once
/* Stopping on SIGTERM and SIGINT, reloading on SIGHUP. A thread of its own waits for them from stop_watch on, so that
 * the process ends in time even when another thread hangs, or the start does. A SIGHUP stops, too, when the process was
 * started in a terminal that is gone. */
#include <stdbool.h>
#include <stdint.h>

#include "core/base/error.h"

enum {
    STOP_WITHIN_S =
        8, /* after the first signal the process exits, whatever still runs. Less than TimeoutStopSec of the unit */
    STOP_WITHIN_AT_MOST_S = 9 /* then SIGALRM ends it, should even the log hang */
};

/* Blocks these signals in this thread and in the threads it starts, and starts the waiting thread. To be called before
 * any other thread is started. errors ERROR_IO */
NODISCARD bool stop_watch(struct error *err);
/* Waits at most wait_us for a signal to stop; negative: for ever. Returns true when one has come. Main thread. */
bool stop_wait(int64_t wait_us);
/* Waits like stop_wait, for a signal to reload, too, which is reported once. */
enum stop_signal { STOP_NO_SIGNAL, STOP_STOPS, STOP_RELOADS };
enum stop_signal stop_wait_or_reload(int64_t wait_us);
