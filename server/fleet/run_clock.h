#pragma once
/* Monotonic time while one thread ran. A stretch in which the thread did not run (the process was stopped, the machine
 * slept or was overloaded) counts as one step: others must not count as late when it was this thread that could not
 * read. */
#include <stdint.h>

struct run_clock {
    int64_t last_us; /* clock_now_us of the last step; 0: no step yet */
    int64_t lost_us; /* sum of the time left out */
};

/* To be called by the thread at least every max_step_us. Of a longer time since the last call only max_step_us counts.
 */
void run_clock_step(struct run_clock *clock, int64_t max_step_us);
int64_t run_clock_us(const struct run_clock *clock);
