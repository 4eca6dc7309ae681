/* Finds, changes, kills, loses and frees one plan's entry; keeps the fleet's clock and numbers. */
#include "server/fleet/plan_entry.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/fleet/lister.h"
#include "server/fleet/watch.h"

int64_t fleet_now_us(const struct fleet *fleet)
{
    return run_clock_us(&fleet->clock);
}

uint64_t fleet_next_number(struct fleet *fleet)
{
    return ++fleet->last_number;
}

char **fleet_arguments(const char *const *words)
{
    size_t n = 0;
    while (words[n])
        n++;
    char **arguments = mem_new((n + 1) * sizeof *arguments);
    for (size_t i = 0; i < n; i++)
        arguments[i] = mem_copy_text(words[i]);
    return arguments;
}

bool fleet_owns_folder(const struct fleet *fleet, const char *folder)
{
    size_t n = strlen(fleet->plans_home);
    return strncmp(folder, fleet->plans_home, n) == 0 && folder[n] == '/';
}

bool fleet_no_plan(const struct fleet *fleet, const char *plan_id, struct problem *problem)
{
    if (fleet->is_listed)
        return problem_set(problem, PROBLEM_NOT_FOUND, "", "", "there is no plan \"%.64s\"", plan_id);
    problem_set(problem, PROBLEM_BUSY, "", "", "the plan folders are still being listed");
    if (problem)
        problem->retry_after_ms = 500;
    return false;
}

void fleet_rescan(struct fleet *fleet)
{
    fleet->n_list_requests = lister_request(fleet->lister);
    fleet->is_listing = true;
}

uint64_t fleet_n_lists(const struct fleet *fleet)
{
    return fleet->n_lists;
}

uint64_t fleet_list_again(struct fleet *fleet)
{
    fleet_rescan(fleet);
    return fleet->n_list_requests;
}

struct plan_entry *plan_entry_find(const struct fleet *fleet, const char *id)
{
    for (size_t i = 0; i < fleet->n_plans; i++)
        if (!fleet->plans[i]->is_removed && strcmp(fleet->plans[i]->id, id) == 0)
            return fleet->plans[i];
    for (size_t i = 0; i < fleet->n_plans; i++)
        if (!fleet->plans[i]->is_removed && strcmp(fleet->plans[i]->other_id, id) == 0)
            return fleet->plans[i];
    return NULL;
}

struct plan_entry *plan_entry_in_folder(const struct fleet *fleet, const char *folder)
{
    for (size_t i = 0; i < fleet->n_plans; i++)
        if (!fleet->plans[i]->is_removed && strcmp(fleet->plans[i]->folder, folder) == 0)
            return fleet->plans[i];
    return NULL;
}

struct plan_entry *plan_entry_of_process(const struct fleet *fleet, uint64_t process)
{
    for (size_t i = 0; i < fleet->n_plans; i++)
        if (fleet->plans[i]->process == process)
            return fleet->plans[i];
    return NULL;
}

void plan_entry_change(struct fleet *fleet, struct plan_entry *plan, enum fleet_state state)
{
    plan->state = state;
    plan->has_changed = true;
    fleet->options.wake(fleet->options.context);
}

void plan_entry_kill(struct fleet *fleet, struct plan_entry *plan, const char *reason)
{
    if (plan->process && !plan->is_killed)
        watch_stop(fleet->watch, plan->process, true, reason);
    plan->is_killed = plan->process != 0;
}

void plan_entry_lose(struct plan_entry *plan)
{
    plan->process = 0;
    plan->pid = 0;
    plan->memory_bytes = 0;
}

void plan_entry_forget_documents(struct plan_entry *plan)
{
    cJSON_Delete(plan->document);
    cJSON_Delete(plan->default_scene);
    plan->document = plan->default_scene = NULL;
}

void plan_entry_destroy(struct plan_entry *plan)
{
    room_updates_clear(&plan->room_updates);
    plan_entry_forget_documents(plan);
    cJSON_Delete(plan->parts);
    free(plan->folder);
    free(plan);
}
