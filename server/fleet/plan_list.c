/* Adds and drops plan entries as their folders come and go. */
#include "server/fleet/plan_list.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/auth/digest.h"
#include "server/fleet/requests.h"

/* An id that does not tell the folder's name: 16 digits of a hash of its path, of an uploaded plan of its name, which
 * stays where the data folder is moved to another place. */
static void make_hidden_id(const struct fleet *fleet, const char *path, char id[PLAN_ID_SIZE])
{
    char digest[DIGEST_TEXT], named[320];
    const char *last = strrchr(path, '/');
    (void)snprintf(named, sizeof named, "uploads/%.255s", last ? last + 1 : path);
    digest_text(fleet_owns_folder(fleet, path) ? named : path, digest);
    (void)snprintf(id, PLAN_ID_SIZE, "%.16s", digest);
}

static void add_plan(struct fleet *fleet, const struct plan_folder *found)
{
    char base[PLAN_ID_SIZE], shown[PLAN_ID_SIZE];
    folder_make_id(found->name, base);
    struct plan_entry *plan = mem_new(sizeof *plan);
    (void)snprintf(shown, sizeof shown, "%s", base);
    for (int i = 2; plan_entry_find(fleet, shown); i++)
        (void)snprintf(shown, sizeof shown, "%.52s-%d", base, i);
    const bool hides = fleet->options.hides_folders;
    (void)snprintf(hides ? plan->other_id : plan->id, PLAN_ID_SIZE, "%s", shown);
    make_hidden_id(fleet, found->path, hides ? plan->id : plan->other_id);
    plan->folder = mem_copy_text(found->path);
    (void)snprintf(plan->name, sizeof plan->name, "%s", hides ? plan->id : found->name);
    plan->state = FLEET_CLOSED;
    plan->parts = cJSON_CreateArray();
    plan->fingerprint = found->fingerprint;
    plan->wants_scan = true;
    fleet->plans[fleet->n_plans++] = plan;
    fleet->list_has_changed = true;
}

static bool is_at_rest(const struct fleet *fleet, const struct plan_entry *plan)
{
    return plan->process == 0 && plan->restart_at_us == 0 && plan->scan == 0 && plan->revision.program == 0 &&
           plan->n_holds == 0 && !requests_has_any(fleet, plan);
}

static void drop(struct fleet *fleet, size_t index)
{
    plan_entry_destroy(fleet->plans[index]);
    memmove(fleet->plans + index, fleet->plans + index + 1, (fleet->n_plans - index - 1) * sizeof *fleet->plans);
    fleet->n_plans--;
    fleet->list_has_changed = true;
}

void plan_list_update(struct fleet *fleet, const struct folder_list *found)
{
    if (found->problem[0])
        log_warn("plan folder %s", found->problem);
    if (found->n_left_out > 0)
        log_warn("%zu plans are beyond the limit of %d and left out", found->n_left_out, FLEET_MAX_PLANS);
    for (size_t i = 0; i < fleet->n_plans; i++)
        fleet->plans[i]->is_missing = true;
    for (size_t i = 0; i < found->n_folders; i++) {
        struct plan_entry *plan = plan_entry_in_folder(fleet, found->folders[i].path);
        if (!plan) {
            /* an uploaded plan that was deleted while the folders were listed is not a new plan */
            bool is_there =
                !fleet_owns_folder(fleet, found->folders[i].path) || access(found->folders[i].path, F_OK) == 0;
            if (is_there && fleet->n_plans < FLEET_MAX_PLANS)
                add_plan(fleet, &found->folders[i]);
            continue;
        }
        plan->is_missing = false;
        if (plan->fingerprint != found->folders[i].fingerprint) {
            plan->fingerprint = found->folders[i].fingerprint;
            plan->wants_scan = true;
        }
    }
    for (size_t i = fleet->n_plans; i-- > 0;)
        if (fleet->plans[i]->is_missing && is_at_rest(fleet, fleet->plans[i]))
            drop(fleet, i);
}

void plan_list_drop_removed(struct fleet *fleet)
{
    for (size_t i = fleet->n_plans; i-- > 0;)
        if (fleet->plans[i]->is_removed && is_at_rest(fleet, fleet->plans[i]))
            drop(fleet, i);
}
