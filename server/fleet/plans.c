#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/fleet/parts.h"

enum { MAX_PARTS = 32 };

struct plan_entry *plan_entry_find(const struct fleet *fleet, const char *id)
{
    for (size_t i = 0; i < fleet->n_plans; i++)
        if (!fleet->plans[i]->is_removed && strcmp(fleet->plans[i]->id, id) == 0)
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

void plan_entry_destroy(struct plan_entry *plan)
{
    owed_forget(plan);
    cJSON_Delete(plan->parts);
    cJSON_Delete(plan->document);
    cJSON_Delete(plan->default_scene);
    free(plan->folder);
    free(plan);
}

struct plan_entry *plan_entry_in_folder(const struct fleet *fleet, const char *folder)
{
    for (size_t i = 0; i < fleet->n_plans; i++)
        if (!fleet->plans[i]->is_removed && strcmp(fleet->plans[i]->folder, folder) == 0)
            return fleet->plans[i];
    return NULL;
}

static void add_plan(struct fleet *fleet, const struct plan_folder *found)
{
    char base[PLAN_ID_SIZE];
    folder_make_id(found->name, base);
    struct plan_entry *plan = mem_new(sizeof *plan);
    (void)snprintf(plan->id, sizeof plan->id, "%s", base);
    for (int i = 2; plan_entry_find(fleet, plan->id); i++)
        (void)snprintf(plan->id, sizeof plan->id, "%.52s-%d", base, i);
    plan->folder = mem_copy_text(found->path);
    (void)snprintf(plan->name, sizeof plan->name, "%s", found->name);
    plan->state = FLEET_CLOSED;
    plan->parts = cJSON_CreateArray();
    plan->fingerprint = found->fingerprint;
    plan->wants_scan = true;
    fleet->plans[fleet->n_plans++] = plan;
    fleet->list_has_changed = true;
}

static bool is_at_rest(const struct fleet *fleet, const struct plan_entry *plan)
{
    return plan->process == 0 && plan->restart_at_us == 0 && plan->scan == 0 && plan->n_holds == 0 &&
           !asks_has_any(fleet, plan);
}

static void drop(struct fleet *fleet, size_t index)
{
    plan_entry_destroy(fleet->plans[index]);
    memmove(fleet->plans + index, fleet->plans + index + 1, (fleet->n_plans - index - 1) * sizeof *fleet->plans);
    fleet->n_plans--;
    fleet->list_has_changed = true;
}

void plans_take_folders(struct fleet *fleet, const struct folder_list *found)
{
    if (found->problem[0])
        log_warn("plan folder %s", found->problem);
    if (found->n_left_out > 0)
        log_warn("%zu plans are beyond the limit of %d and left out", found->n_left_out, FLEET_MAX_PLANS);
    for (size_t i = 0; i < fleet->n_plans; i++)
        fleet->plans[i]->is_gone = true;
    for (size_t i = 0; i < found->n_folders; i++) {
        struct plan_entry *plan = plan_entry_in_folder(fleet, found->folders[i].path);
        if (!plan) {
            /* an uploaded one that was removed while the folders were looked at is no new plan */
            bool is_there = !uploads_owns(fleet, found->folders[i].path) || access(found->folders[i].path, F_OK) == 0;
            if (is_there && fleet->n_plans < FLEET_MAX_PLANS)
                add_plan(fleet, &found->folders[i]);
            continue;
        }
        plan->is_gone = false;
        if (plan->fingerprint != found->folders[i].fingerprint) {
            plan->fingerprint = found->folders[i].fingerprint;
            plan->wants_scan = true;
        }
    }
    for (size_t i = fleet->n_plans; i-- > 0;)
        if (fleet->plans[i]->is_gone && is_at_rest(fleet, fleet->plans[i]))
            drop(fleet, i);
}

void plans_drop_removed(struct fleet *fleet)
{
    for (size_t i = fleet->n_plans; i-- > 0;)
        if (fleet->plans[i]->is_removed && is_at_rest(fleet, fleet->plans[i]))
            drop(fleet, i);
}

void plans_start_scans(struct fleet *fleet)
{
    for (size_t i = 0; i < fleet->n_plans && fleet->n_scans < FLEET_MAX_SCANS; i++) {
        struct plan_entry *plan = fleet->plans[i];
        if (!plan->wants_scan || plan->scan || plan->is_removed)
            continue;
        plan->scan = fleet_number(fleet);
        char **arguments = fleet_arguments((const char *const[]){ fleet->renderer_path, "--scan", plan->folder, NULL });
        if (!watch_start_program(fleet->watch, plan->scan, arguments, fleet->times.scan)) {
            plan->scan = 0;
            return; /* the next tick tries again */
        }
        plan->wants_scan = false;
        fleet->n_scans++;
    }
}

static void copy_text(char *to, size_t n, const cJSON *json, const char *name)
{
    const char *text = json_text(json, name);
    (void)snprintf(to, n, "%s", text ? text : "");
}

/* What the program printed into the entry; false with a reason when it is not what it should be. */
static bool take_summary(struct plan_entry *plan, const cJSON *json, char reason[240])
{
    const cJSON *parts = cJSON_GetObjectItemCaseSensitive(json, "parts");
    double n_bytes = json_number(json, "n_bytes", 0);
    if (!cJSON_IsObject(json) || !cJSON_IsArray(parts)) {
        (void)snprintf(reason, 240, "looking at the plan gave no description of it");
        return false;
    }
    if (json_text(json, "name") && json_text(json, "name")[0])
        copy_text(plan->name, sizeof plan->name, json, "name");
    copy_text(plan->note, sizeof plan->note, json, "note");
    plan->is_phantom = json_flag(json, "phantom", false);
    plan->n_bytes = n_bytes >= 0 && n_bytes < 9e15 ? (uint64_t)n_bytes : 0;
    cJSON_Delete(plan->parts);
    plan->parts = cJSON_CreateArray();
    int n = 0;
    for (const cJSON *part = parts->child; part && n < MAX_PARTS; part = part->next)
        if (cJSON_IsString(part) && strlen(part->valuestring) < 128) {
            cJSON_AddItemToArray(plan->parts, cJSON_CreateString(part->valuestring));
            n++;
        }
    if (json_flag(json, "readable", false))
        return true;
    copy_text(reason, 240, json, "reason");
    return false;
}

cJSON *plans_scan_document(const struct watch_event *event, char reason[240])
{
    struct problem problem = { 0 };
    if (event->is_exit && event->status == 0) {
        cJSON *json = json_read(event->output ? event->output : "", event->n_output, &problem);
        if (json)
            return json;
        (void)snprintf(reason, 240, "looking at the plan gave no description of it");
    } else if (event->signal && !event->reason[0]) {
        (void)snprintf(reason, 240, "the program that looks at plans stopped (signal %d)", event->signal);
    } else if (event->reason[0]) {
        (void)snprintf(reason, 240, "looking at the plan %.200s", event->reason);
    } else {
        (void)snprintf(reason, 240, "the program that looks at plans ended with status %d", event->status);
    }
    return NULL;
}

bool plans_scan_ended(struct fleet *fleet, const struct watch_event *event)
{
    struct plan_entry *plan = NULL;
    for (size_t i = 0; i < fleet->n_plans && !plan; i++)
        if (fleet->plans[i]->scan == event->number)
            plan = fleet->plans[i];
    if (!plan)
        return false;
    plan->scan = 0;
    fleet->n_scans--;
    char reason[240] = "";
    bool is_readable = false;
    cJSON *json = plans_scan_document(event, reason);
    if (json)
        is_readable = take_summary(plan, json, reason);
    cJSON_Delete(json);
    bool was_failed = plan->state == FLEET_FAILED || plan->state == FLEET_UNREADABLE;
    bool is_newer = plan->state != FLEET_FAILED || event->number > plan->failed_number;
    if ((plan->state == FLEET_CLOSED || plan->state == FLEET_UNREADABLE || plan->state == FLEET_FAILED) && is_newer) {
        plan_entry_change(fleet, plan, is_readable ? FLEET_CLOSED : FLEET_UNREADABLE);
        plan->problem = (struct problem){ 0 };
        plan->wants_place = false;
        if (!is_readable)
            problem_set(&plan->problem, PROBLEM_PLAN_UNREADABLE, "", "", "%s", reason);
        else if (plan->n_holds > 0 && was_failed)
            plan_entry_open_held(fleet, plan); /* its files have changed, and somebody waits for it */
    }
    plan->has_changed = true;
    fleet->list_has_changed = true;
    return true;
}
