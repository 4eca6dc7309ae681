/* Deletes an uploaded plan for good (fleet_remove_plan): its renderer, its folder, its cache, its entry in the list. */
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/fleet/data_folders.h"
#include "server/fleet/remover.h"
#include "server/fleet/renderers.h"
#include "server/fleet/watch.h"

static void end_renderer(struct fleet *fleet, struct plan_entry *plan)
{
    if (plan->process)
        watch_stop(fleet->watch, plan->process, true,
                   "draws a plan that is deleted"); /* at once: it may be writing to its cache */
    renderer_close(fleet, plan, "it is deleted");
}

/* cache_id: the plan's id, or its other one, which no log tells. */
static bool throw_cache_away(struct fleet *fleet, const char *cache_id, const char *plan_id)
{
    char cache[PATH_MAX];
    (void)snprintf(cache, sizeof cache, "%s/cache/%s", fleet->data_folder, cache_id);
    if (data_throw_away(fleet, cache) || errno == ENOENT)
        return true;
    log_warn("plan %s: its cache cannot be removed: %s", plan_id, strerror(errno));
    return false;
}

/* The id that the plan had, or will have, where folders are hidden, or are not; "": another plan has it now. */
static const char *other_id(const struct fleet *fleet, const struct plan_entry *plan)
{
    return plan_entry_find(fleet, plan->other_id) == plan ? plan->other_id : "";
}

static bool throw_caches_away(struct fleet *fleet, const struct plan_entry *plan)
{
    const char *other = other_id(fleet, plan);
    const bool ok = throw_cache_away(fleet, plan->id, plan->id);
    return (!other[0] || throw_cache_away(fleet, other, plan->id)) && ok;
}

bool fleet_remove_plan(struct fleet *fleet, const char *plan_id, struct problem *problem)
{
    struct plan_entry *plan = plan_entry_find(fleet, plan_id);
    if (!plan)
        return fleet_no_plan(fleet, plan_id, problem);
    if (!fleet_owns_folder(fleet, plan->folder))
        return problem_set(problem, PROBLEM_FORBIDDEN, "", "",
                           "the plan lies in a folder that the server does not own: only uploaded plans are deleted");
    if (!data_throw_away(fleet, plan->folder) && errno != ENOENT)
        return problem_set(problem, PROBLEM_STORAGE, "", "", "the plan's folder cannot be moved away: %s",
                           strerror(errno));
    /* a plan of a collection: the folder around it goes too when it is empty */
    char *collection = mem_copy_text(plan->folder);
    *strrchr(collection, '/') = 0;
    if (fleet_owns_folder(fleet, collection))
        (void)rmdir(collection);
    free(collection);
    end_renderer(fleet, plan);
    (void)throw_caches_away(fleet, plan);
    plan->is_removed = true;
    fleet->list_has_changed = true;
    fleet_rescan(fleet);
    return true;
}

void fleet_erase_of(const struct fleet *fleet, const char *plan_id, struct fleet_erase *what)
{
    const struct plan_entry *plan = plan_entry_find(fleet, plan_id);
    const char *below =
        plan && fleet_owns_folder(fleet, plan->folder) ? plan->folder + strlen(fleet->plans_home) : NULL;
    *what = (struct fleet_erase){ .folder = "" };
    (void)snprintf(what->id, sizeof what->id, "%s", plan ? plan->id : plan_id);
    (void)snprintf(what->other_id, sizeof what->other_id, "%s", plan ? other_id(fleet, plan) : "");
    if (below)
        (void)snprintf(what->folder, sizeof what->folder, "plans%s", below);
    (void)snprintf(what->cache, sizeof what->cache, "cache/%s", what->id);
    if (what->other_id[0])
        (void)snprintf(what->other_cache, sizeof what->other_cache, "cache/%s", what->other_id);
}

bool fleet_erase_plan(struct fleet *fleet, const char *plan_id, struct problem *problem)
{
    struct plan_entry *plan = plan_entry_find(fleet, plan_id);
    if (plan && fleet_owns_folder(fleet, plan->folder))
        return fleet_remove_plan(fleet, plan_id, problem);
    if (plan)
        end_renderer(fleet, plan);
    return (plan ? throw_caches_away(fleet, plan) : throw_cache_away(fleet, plan_id, plan_id)) ||
           problem_set(problem, PROBLEM_STORAGE, "", "", "the plan's cache cannot be moved away: %s", strerror(errno));
}

bool fleet_is_removing(const struct fleet *fleet)
{
    return !remover_is_idle(fleet->remover);
}
