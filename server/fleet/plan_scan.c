/* Runs the program that summarises a plan folder, and reads the summary it prints. */
#include "server/fleet/plan_scan.h"

#include <stdio.h>
#include <string.h>

#include "server/fleet/openings.h"
#include "server/fleet/watch.h"

enum { MAX_PARTS = 32 };

void plan_scans_start(struct fleet *fleet)
{
    for (size_t i = 0; i < fleet->n_plans && fleet->n_scans < FLEET_MAX_SCANS; i++) {
        struct plan_entry *plan = fleet->plans[i];
        if (!plan->wants_scan || plan->scan || plan->is_removed)
            continue;
        plan->scan = fleet_next_number(fleet);
        const char *hide = fleet->options.hides_folders ? "--hide-folder" : NULL;
        char **arguments =
            fleet_arguments((const char *const[]){ fleet->renderer_path, "--scan", plan->folder, hide, NULL });
        if (!watch_start_program(fleet->watch, plan->scan, arguments, fleet->times.scan)) {
            plan->scan = 0;
            return; /* the next tick tries again */
        }
        plan->wants_scan = false;
        fleet->n_scans++;
    }
}

static int count(const cJSON *json, const char *name)
{
    const double n = json_number(json, name, 0);
    return n >= 0 && n < 1000 ? (int)n : 0;
}

/* The printed summary into the entry. Returns false with a reason when it is malformed or says that the plan cannot be
 * read. */
static bool read_summary(struct plan_entry *plan, const cJSON *json, char reason[240])
{
    const cJSON *parts = cJSON_GetObjectItemCaseSensitive(json, "parts");
    double n_bytes = json_number(json, "n_bytes", 0);
    if (!cJSON_IsObject(json) || !cJSON_IsArray(parts)) {
        (void)snprintf(reason, 240, "looking at the plan gave no description of it");
        return false;
    }
    if (json_text(json, "name") && json_text(json, "name")[0])
        json_put_text(plan->name, sizeof plan->name, json, "name");
    json_put_text(plan->note, sizeof plan->note, json, "note");
    json_put_text(plan->shown.masked, sizeof plan->shown.masked, json, "patient");
    json_put_text(plan->shown.id, sizeof plan->shown.id, json, "patient_id");
    json_put_text(plan->shown.label, sizeof plan->shown.label, json, "label");
    json_put_text(plan->shown.date, sizeof plan->shown.date, json, "date");
    json_put_text(plan->shown.approval, sizeof plan->shown.approval, json, "approval");
    plan->shown.n_patients = count(json, "n_patients");
    plan->shown.n_treatment_plans = count(json, "n_treatment_plans");
    plan->is_phantom = json_flag(json, "phantom", false);
    plan->has_plan_file = json_flag(json, "has_plan_file", false);
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
    json_put_text(reason, 240, json, "reason");
    return false;
}

cJSON *plan_scan_summary(const struct watch_event *event, char reason[240])
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

bool plan_scan_ended(struct fleet *fleet, const struct watch_event *event)
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
    cJSON *json = plan_scan_summary(event, reason);
    if (json)
        is_readable = read_summary(plan, json, reason);
    cJSON_Delete(json);
    bool was_failed = plan->state == FLEET_FAILED || plan->state == FLEET_UNREADABLE;
    bool is_newer = plan->state != FLEET_FAILED || event->number > plan->failed_number;
    if ((plan->state == FLEET_CLOSED || plan->state == FLEET_UNREADABLE || plan->state == FLEET_FAILED) && is_newer) {
        plan_entry_change(fleet, plan, is_readable ? FLEET_CLOSED : FLEET_UNREADABLE);
        plan->problem = (struct problem){ 0 };
        plan->waits_for_slot = false;
        if (!is_readable)
            problem_set(&plan->problem, PROBLEM_PLAN_UNREADABLE, "", "", "%s", reason);
        else if (plan->n_holds > 0 && was_failed)
            opening_of_held(fleet, plan); /* its files have changed, and a viewer holds it */
    }
    plan->has_changed = true;
    fleet->list_has_changed = true;
    return true;
}
