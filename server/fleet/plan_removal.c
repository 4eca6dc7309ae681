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

static bool throw_cache_away(struct fleet *fleet, const char *plan_id)
{
    char cache[PATH_MAX];
    (void)snprintf(cache, sizeof cache, "%s/cache/%s", fleet->data_folder, plan_id);
    if (data_throw_away(fleet, cache) || errno == ENOENT)
        return true;
    log_warn("plan %s: its cache cannot be removed: %s", plan_id, strerror(errno));
    return false;
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
    (void)throw_cache_away(fleet, plan->id);
    plan->is_removed = true;
    fleet->list_has_changed = true;
    fleet_rescan(fleet);
    return true;
}

void fleet_erase_paths(const struct fleet *fleet, const char *plan_id, char folder[1024], char cache[1024])
{
    const struct plan_entry *plan = plan_entry_find(fleet, plan_id);
    const char *below =
        plan && fleet_owns_folder(fleet, plan->folder) ? plan->folder + strlen(fleet->plans_home) : NULL;
    (void)snprintf(folder, 1024, "%s%s", below ? "plans" : "", below ? below : "");
    (void)snprintf(cache, 1024, "cache/%s", plan_id);
}

bool fleet_erase_plan(struct fleet *fleet, const char *plan_id, struct problem *problem)
{
    struct plan_entry *plan = plan_entry_find(fleet, plan_id);
    if (plan && fleet_owns_folder(fleet, plan->folder))
        return fleet_remove_plan(fleet, plan_id, problem);
    if (plan)
        end_renderer(fleet, plan);
    return throw_cache_away(fleet, plan_id) ||
           problem_set(problem, PROBLEM_STORAGE, "", "", "the plan's cache cannot be moved away: %s", strerror(errno));
}

bool fleet_is_removing(const struct fleet *fleet)
{
    return !remover_is_idle(fleet->remover);
}
