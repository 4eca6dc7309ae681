/* The ladder of scales and qualities, and the smoothed measurements that choose the step. */
#include "server/room/state/pace.h"

static const struct {
    int scale_percent, quality;
} ladder[] = { { 100, 80 }, { 75, 78 }, { 60, 75 }, { 50, 65 } };
enum { N_STEPS = sizeof ladder / sizeof ladder[0], LEAST_DRAWN = 3 };

/* A new value weighs one third, so that three pictures decide and one outlier does not. */
static double smooth(double old, double value, bool is_first)
{
    return is_first ? value : old + (value - old) / 3;
}

void pace_start(struct pace *pace, bool is_software)
{
    *pace = (struct pace){ .is_software = is_software, .up_after_us = PACE_UP_AFTER_US };
}

struct pace_choice pace_choose(const struct pace *pace)
{
    return (struct pace_choice){ .scale_percent = ladder[pace->step].scale_percent,
                                 .quality = ladder[pace->step].quality,
                                 .coarse = pace->is_software || pace->step == N_STEPS - 1 };
}

static void step_to(struct pace *pace, int step)
{
    pace->step = step;
    pace->n_drawn = 0;
    pace->good_since_us = 0;
    pace->lag_us = 0;
}

void pace_drawn(struct pace *pace, int64_t render_us, int64_t encode_us, int64_t turnaround_us, int n_outstanding,
                int64_t now_us)
{
    /* Other streams share the renderer, so the waiting time per outstanding picture counts too ... */
    double cost = (double)(render_us + encode_us),
           waited = (double)turnaround_us / (n_outstanding > 1 ? n_outstanding : 1);
    /* ... but not for a single request: its time holds the way to the renderer and back, which no step makes shorter */
    if (n_outstanding > 1 && waited > cost)
        cost = waited;
    pace->cost_us = smooth(pace->cost_us, cost, pace->n_drawn == 0);
    pace->render_us = smooth(pace->render_us, (double)render_us, pace->n_drawn == 0);
    bool has_pause =
        now_us - pace->drawn_us > PACE_UP_AFTER_US / 2; /* time without pictures says nothing about speed */
    pace->drawn_us = now_us;
    pace->n_drawn++;

    bool is_good = pace->cost_us < PACE_FAST_US && pace->lag_us <= PACE_LAG_US;
    if (!is_good)
        pace->good_since_us = 0;
    else if (pace->good_since_us == 0 || has_pause)
        pace->good_since_us = now_us;

    if (pace->n_drawn < LEAST_DRAWN)
        return;
    if ((pace->cost_us > PACE_SLOW_US || pace->lag_us > PACE_LAG_US) && pace->step < N_STEPS - 1) {
        /* repeated every second, a step up that does not hold would be visible as flicker */
        if (pace->stepped_up_us && now_us - pace->stepped_up_us < 3 * PACE_UP_AFTER_US)
            pace->up_after_us = pace->up_after_us > PACE_UP_AT_MOST_US / 2 ? PACE_UP_AT_MOST_US : 2 * pace->up_after_us;
        step_to(pace, pace->step + 1);
    } else if (is_good && pace->step > 0 && now_us - pace->good_since_us >= pace->up_after_us) {
        pace->stepped_up_us = now_us;
        step_to(pace, pace->step - 1);
    }
}

void pace_lagged(struct pace *pace, int64_t excess_us)
{
    /* a single late acknowledgement, from a tab in the background, must not count: it is cut so that two are needed */
    pace->lag_us = smooth(pace->lag_us, (double)(excess_us < 2 * PACE_LAG_US ? excess_us : 2 * PACE_LAG_US), false);
}
