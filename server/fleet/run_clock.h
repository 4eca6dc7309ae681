#pragma once
/* Monotonic time as one thread saw it while it ran. A stretch in which the thread did not run (the process was stopped,
 * the machine slept or had no processor to spare) counts as one step, so nobody is taken for late whom the thread could
 * not hear. */
#include <stdint.h>

struct run_clock {
    int64_t last_us; /* of clock_now_us; 0: not yet looked at */
    int64_t lost_us; /* time that does not count */
};

/* The thread runs: to be called at least every max_step_us. Of a longer time since the last call only max_step_us
 * counts. */
void run_clock_step(struct run_clock *clock, int64_t max_step_us);
int64_t run_clock_us(const struct run_clock *clock);
