/* Monotonic time without the stretches in which the thread did not run. */
#include "server/fleet/run_clock.h"

#include "core/base/clock.h"

void run_clock_step(struct run_clock *clock, int64_t max_step_us)
{
    int64_t now_us = clock_now_us();
    if (clock->last_us && now_us - clock->last_us > max_step_us)
        clock->lost_us += now_us - clock->last_us - max_step_us;
    clock->last_us = now_us;
}

int64_t run_clock_us(const struct run_clock *clock)
{
    return clock_now_us() - clock->lost_us;
}
