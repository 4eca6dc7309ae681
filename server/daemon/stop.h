#pragma once
/* SIGTERM and SIGINT. A thread of its own waits for them from stop_watch on, so that the process ends in time also when
 * another thread hangs or the start itself does. */
#include <stdbool.h>
#include <stdint.h>

#include "core/base/error.h"

enum {
    STOP_WITHIN_S =
        8, /* after the first signal; then the process is ended as it is. Less than TimeoutStopSec of the unit */
    STOP_WITHIN_AT_MOST_S = 9 /* the kernel ends it then, should even the log hang */
};

/* Blocks both signals in this thread and in all that it starts, and starts the waiting thread. Before any other thread.
 * errors ERROR_IO */
NODISCARD bool stop_watch(struct error *err);
/* Waits until one of the signals has come, at most wait_us; negative: for ever. True: it has. The main thread. */
bool stop_wait(int64_t wait_us);
