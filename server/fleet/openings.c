/* Opens, closes, holds and releases plans within the limit of renderers that run at once. */
#include "server/fleet/openings.h"

#include <stdio.h>

#include "server/fleet/renderers.h"
#include "server/fleet/requests.h"
#include "server/fleet/restarts.h"

enum { SLOT_RETRY_US = 2000000 /* a held plan without a slot tries again after this */ };

static bool has_renderer(const struct plan_entry *plan)
{
    return plan->process != 0 || plan->restart_at_us != 0;
}

static bool is_unused(const struct fleet *fleet, const struct plan_entry *plan)
{
    bool is_at_rest = plan->state == FLEET_READY || (plan->restart_at_us && !plan->process);
    return is_at_rest && plan->n_holds == 0 && !requests_has_any(fleet, plan);
}

/* Makes sure that one more renderer may run, if need be by closing the longest unused plan. */
static bool free_slot(struct fleet *fleet)
{
    struct plan_entry *oldest = NULL;
    int n_running = 0;
    for (size_t i = 0; i < fleet->n_plans; i++) {
        struct plan_entry *plan = fleet->plans[i];
        n_running += has_renderer(plan);
        if (is_unused(fleet, plan) && (!oldest || plan->used_us < oldest->used_us))
            oldest = plan;
    }
    if (fleet->options.max_renderers <= 0 || n_running < fleet->options.max_renderers)
        return true;
    if (!oldest)
        return false;
    renderer_close(fleet, oldest, "another plan needs its place");
    return true;
}

bool fleet_open(struct fleet *fleet, const char *plan_id, struct problem *problem)
{
    struct plan_entry *plan = plan_entry_find(fleet, plan_id);
    if (!plan)
        return fleet_no_plan(fleet, plan_id, problem);
    if (plan->state == FLEET_UNREADABLE) {
        if (problem)
            *problem = plan->problem;
        return false;
    }
    plan->used_us = fleet_now_us(fleet);
    if (plan->state != FLEET_CLOSED && plan->state != FLEET_FAILED)
        return true;
    if (!free_slot(fleet)) {
        problem_set(problem, PROBLEM_BUSY, "", "", "%d plans are open and in use, which is as many as may be",
                    fleet->options.max_renderers);
        if (problem)
            problem->retry_after_ms = 5000;
        return false;
    }
    plan->problem = (struct problem){ 0 };
    plan->was_ready = false;
    plan_entry_forget_documents(plan);
    plan->n_ends_without_picture = 0;
    plan->is_failure_final = plan->waits_for_slot = false;
    plan->opening++;
    (void)snprintf(plan->phase, sizeof plan->phase, "starting the renderer");
    plan_entry_change(fleet, plan, FLEET_STARTING);
    restart_now(fleet, plan);
    return true;
}

void fleet_close(struct fleet *fleet, const char *plan_id)
{
    struct plan_entry *plan = plan_entry_find(fleet, plan_id);
    if (plan && has_renderer(plan))
        renderer_close(fleet, plan, "somebody asked for it");
}

void fleet_read_anew(struct fleet *fleet, const char *plan_id)
{
    struct plan_entry *plan = plan_entry_find(fleet, plan_id);
    struct problem problem;
    if (!plan || !has_renderer(plan))
        return;
    renderer_close(fleet, plan, "it is read anew");
    if (!fleet_open(fleet, plan->id, &problem) && plan->n_holds > 0)
        opening_of_held(fleet, plan);
}

void opening_of_held(struct fleet *fleet, struct plan_entry *plan)
{
    struct problem problem;
    if (fleet_open(fleet, plan->id, &problem) || problem.type != PROBLEM_BUSY)
        return;
    plan->slot_retry_at_us = fleet_now_us(fleet) + SLOT_RETRY_US;
    if (plan->waits_for_slot)
        return;
    plan->waits_for_slot = true;
    problem_set(&plan->problem, PROBLEM_BUSY, "", "", "%.200s; this one is opened as soon as there is a place",
                problem.detail);
    plan_entry_change(fleet, plan, FLEET_FAILED);
}

bool fleet_hold(struct fleet *fleet, const char *plan_id)
{
    struct plan_entry *plan = plan_entry_find(fleet, plan_id);
    if (!plan)
        return false;
    plan->n_holds++;
    if (plan->state == FLEET_CLOSED ||
        (plan->state == FLEET_FAILED && !plan->is_failure_final && !plan->waits_for_slot))
        opening_of_held(fleet, plan);
    return true;
}

void fleet_release(struct fleet *fleet, const char *plan_id)
{
    struct plan_entry *plan = plan_entry_find(fleet, plan_id);
    if (plan && plan->n_holds > 0) {
        plan->n_holds--;
        plan->used_us = fleet_now_us(fleet);
    }
    if (plan && plan->n_holds == 0 && plan->waits_for_slot)
        renderer_close(fleet, plan, "nobody is there any more");
}

int64_t opening_left_us(const struct fleet *fleet, const struct plan_entry *plan, int64_t now_us)
{
    if (plan->waits_for_slot)
        return plan->slot_retry_at_us - now_us;
    if (fleet->options.idle_close_s > 0 && is_unused(fleet, plan))
        return plan->used_us + fleet->options.idle_close_s * 1000000LL - now_us;
    return INT64_MAX;
}

void opening_tick(struct fleet *fleet, struct plan_entry *plan, int64_t now_us)
{
    if (plan->waits_for_slot && now_us >= plan->slot_retry_at_us)
        opening_of_held(fleet, plan);
    if (fleet->options.idle_close_s > 0 && is_unused(fleet, plan) &&
        now_us - plan->used_us > fleet->options.idle_close_s * 1000000LL)
        renderer_close(fleet, plan, "nobody used it");
}
