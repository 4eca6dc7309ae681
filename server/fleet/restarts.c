/* Decides after a renderer's end whether and when it is started again, and starts it then. */
#include "server/fleet/restarts.h"

#include <stdio.h>
#include <string.h>

#include "core/base/log.h"
#include "server/fleet/renderers.h"
#include "server/fleet/requests.h"

int restart_pause_ms(int n_ends_without_picture)
{
    int pause_ms = RESTART_FIRST_PAUSE_MS;
    for (int i = 2; i < n_ends_without_picture && pause_ms < RESTART_LONGEST_PAUSE_MS; i++)
        pause_ms *= 2;
    return n_ends_without_picture < 2 ? 0 : pause_ms < RESTART_LONGEST_PAUSE_MS ? pause_ms : RESTART_LONGEST_PAUSE_MS;
}

/* Books a start without a pause. Returns false when too many were booked: a renderer that ends after each picture must
 * not use up the machine. */
static bool book_quick(struct plan_entry *plan, int64_t now_us)
{
    int64_t from_us = plan->quick_booked_us > now_us ? plan->quick_booked_us : now_us;
    if (from_us - now_us >= RESTART_QUICK_AHEAD_MS * 1000LL)
        return false;
    plan->quick_booked_us = from_us + RESTART_QUICK_EVERY_MS * 1000LL;
    return true;
}

static void count_end(struct plan_entry *plan, int64_t now_us)
{
    bool has_worked = plan->has_drawn || (plan->ready_us && now_us - plan->ready_us >= RESTART_WORKED_MS * 1000LL);
    if (has_worked && book_quick(plan, now_us))
        plan->n_ends_without_picture = 0;
    else if (has_worked && plan->n_ends_without_picture == 0)
        plan->n_ends_without_picture = 2; /* not at once */
    else
        plan->n_ends_without_picture++;
}

/* Sets state, phase and problem of a plan whose start is planned. The words change once a second. */
static void describe_pause(struct fleet *fleet, struct plan_entry *plan, int64_t now_us)
{
    char phase[sizeof plan->phase];
    long long seconds = (plan->restart_at_us - now_us + 999999) / 1000000;
    if (seconds > 0) {
        problem_set(&plan->problem, PROBLEM_RENDERER, "", "", "the renderer %s", plan->end_reason);
        plan->problem.retry_after_ms = (int)seconds * 1000;
        (void)snprintf(phase, sizeof phase, "the renderer %.120s; it is started again in %lld s", plan->end_reason,
                       seconds);
    } else {
        (void)snprintf(phase, sizeof phase, "starting the renderer again");
    }
    if (strcmp(phase, plan->phase) == 0 && plan->state == FLEET_RESTARTING)
        return;
    memcpy(plan->phase, phase, sizeof plan->phase);
    plan_entry_change(fleet, plan, FLEET_RESTARTING);
}

/* Counts the end; returns true when the next start is due at once. */
static bool plan_next_start(struct fleet *fleet, struct plan_entry *plan, const char *how)
{
    int64_t now_us = fleet_now_us(fleet);
    struct problem problem;
    count_end(plan, now_us);
    if (plan->n_holds == 0 && plan->n_ends_without_picture > FLEET_MAX_RESTARTS) {
        problem_set(&problem, PROBLEM_RENDERER, "", "",
                    "the renderer stopped %d times without having drawn a picture; the last time it %.160s",
                    plan->n_ends_without_picture, how);
        renderer_fail(fleet, plan, &problem);
        return false;
    }
    int pause_ms = restart_pause_ms(plan->n_ends_without_picture);
    (void)snprintf(plan->end_reason, sizeof plan->end_reason, "%s", how);
    plan->restart_at_us = now_us + pause_ms * 1000LL;
    plan->percent = 0;
    problem_set(&problem, PROBLEM_RENDERER, "", "", "the renderer %.200s and is being started again", how);
    problem.retry_after_ms = pause_ms + 500;
    requests_fail(fleet, plan, true, &problem);
    describe_pause(fleet, plan, now_us);
    log_warn("plan %s: the renderer %s; starting it again in %d ms", plan->id, how, pause_ms);
    return pause_ms == 0;
}

void restart_now(struct fleet *fleet, struct plan_entry *plan)
{
    struct problem problem;
    if (renderer_start(fleet, plan))
        return;
    if (plan->n_holds > 0) {
        /* at least the second such end: after the first the next start would come at once, and fail again */
        if (plan->n_ends_without_picture < 1)
            plan->n_ends_without_picture = 1;
        (void)plan_next_start(fleet, plan, "could not be started: too much is waiting to be told to renderers");
        return;
    }
    problem_set(&problem, PROBLEM_BUSY, "", "", "too much is waiting to be told to renderers");
    renderer_fail(fleet, plan, &problem);
}

void restart_after_end(struct fleet *fleet, struct plan_entry *plan, const char *how)
{
    if (plan_next_start(fleet, plan, how))
        restart_now(fleet, plan); /* the next tick would be late */
}

void restart_tick(struct fleet *fleet, struct plan_entry *plan, int64_t now_us)
{
    if (!plan->restart_at_us)
        return;
    bool is_due = now_us >= plan->restart_at_us;
    describe_pause(fleet, plan, now_us);
    if (is_due && plan->n_holds == 0 && plan->n_ends_without_picture > FLEET_MAX_RESTARTS)
        renderer_close(fleet, plan, "its renderer does not work, and nobody is there to see it");
    else if (is_due)
        restart_now(fleet, plan);
}
