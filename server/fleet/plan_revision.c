/* Runs the program that digests a plan's files, and keeps what it printed. */
#include "server/fleet/plan_revision.h"

#include <stdio.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "server/fleet/plan_scan.h"
#include "server/fleet/watch.h"

bool fleet_revision(struct fleet *fleet, const char *plan_id, struct fleet_revision *revision)
{
    struct plan_entry *plan = plan_entry_find(fleet, plan_id);
    *revision = (struct fleet_revision){ .reason = "" };
    if (!plan)
        return false;
    const int64_t now_us = fleet_now_us(fleet);
    const bool is_old = plan->revision.fingerprint != plan->fingerprint ||
                        plan->revision.generation != plan->generation ||
                        now_us - plan->revision.looked_us >= REVISION_AGAIN_MS * INT64_C(1000);
    if (!plan->revision.program && (is_old || (!plan->revision.digest[0] && !plan->revision.reason[0])))
        plan->revision.is_wanted = true;
    plan_revisions_start(fleet);
    memcpy(revision->digest, plan->revision.digest, sizeof revision->digest);
    memcpy(revision->key, plan->revision.key, sizeof revision->key);
    revision->n_files = plan->revision.n_files;
    revision->reason = plan->revision.reason;
    revision->is_current = !is_old && !plan->revision.program && !plan->revision.is_wanted;
    return plan->revision.digest[0] != 0;
}

void fleet_look_at_files(struct fleet *fleet, const char *plan_id)
{
    struct plan_entry *plan = plan_entry_find(fleet, plan_id);
    if (!plan)
        return;
    plan->revision.is_wanted = true; /* a look that runs may have passed the file that changes now */
    plan_revisions_start(fleet);
}

void plan_revisions_start(struct fleet *fleet)
{
    for (size_t i = 0; i < fleet->n_plans && fleet->n_revisions < REVISION_MAX_PROGRAMS; i++) {
        struct plan_entry *plan = fleet->plans[i];
        if (!plan->revision.is_wanted || plan->revision.program || plan->is_removed)
            continue;
        const char *known = plan->revision.digest[0] ? plan->revision.key : NULL;
        plan->revision.program = fleet_next_number(fleet);
        char **arguments = fleet_arguments((const char *const[]){ fleet->renderer_path, "--digest", plan->folder,
                                                                  known ? "--known" : NULL, known, NULL });
        if (!watch_start_program(fleet->watch, plan->revision.program, arguments, REVISION_LIMIT_MS)) {
            plan->revision.program = 0;
            return; /* the next tick tries again */
        }
        plan->revision.is_wanted = false;
        plan->revision.fingerprint = plan->fingerprint;
        plan->revision.generation = plan->generation;
        fleet->n_revisions++;
    }
}

static bool is_digest(const char *text)
{
    return text && strlen(text) == 64 && strspn(text, "0123456789abcdef") == 64;
}

/* The first digest of a process is what that process has read; another one later: the files have changed since. */
static void compare_with_loaded(struct plan_entry *plan)
{
    if (!plan->revision.generation)
        return;
    if (plan->revision.loaded_generation != plan->revision.generation) {
        memcpy(plan->revision.loaded, plan->revision.digest, sizeof plan->revision.loaded);
        plan->revision.loaded_generation = plan->revision.generation;
        plan->revision.loaded_ms = clock_wall_ms();
        plan->revision.changed_ms = 0;
    } else if (strcmp(plan->revision.loaded, plan->revision.digest) == 0) {
        plan->revision.changed_ms = 0;
    } else if (!plan->revision.changed_ms) {
        plan->revision.changed_ms = clock_wall_ms();
        log_warn("plan %s: its files have changed since they were read", plan->id);
    }
}

bool plan_revision_ended(struct fleet *fleet, const struct watch_event *event)
{
    struct plan_entry *plan = NULL;
    char reason[240] = "";
    for (size_t i = 0; i < fleet->n_plans && !plan; i++)
        if (fleet->plans[i]->revision.program == event->number)
            plan = fleet->plans[i];
    if (!plan || !event->number)
        return false;
    fleet->n_revisions--;
    plan->revision.program = 0;
    plan->revision.looked_us = fleet_now_us(fleet);
    cJSON *json = plan_scan_summary(event, reason);
    const char *digest = json_text(json, "revision"), *key = json_text(json, "key"), *why = json_text(json, "reason");
    if (is_digest(key) && (is_digest(digest) || plan->revision.digest[0])) {
        (void)snprintf(plan->revision.key, sizeof plan->revision.key, "%s", key);
        if (digest)
            (void)snprintf(plan->revision.digest, sizeof plan->revision.digest, "%s", digest);
        plan->revision.n_files = (uint64_t)json_number(json, "n_files", 0);
        plan->revision.reason[0] = 0;
        compare_with_loaded(plan);
    } else {
        plan->revision.digest[0] = 0;
        (void)snprintf(plan->revision.reason, sizeof plan->revision.reason, "%s",
                       why         ? why
                       : reason[0] ? reason
                                   : "the program that reads it failed");
        log_warn("plan %s: its revision is not known: %s", plan->id, plan->revision.reason);
    }
    cJSON_Delete(json);
    plan->has_changed = true;
    return true;
}
