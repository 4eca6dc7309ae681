/* Plans: their list, one plan's document, opening and closing. */
#include <stdio.h>
#include <string.h>

#include "server/http/api_access.h"
#include "server/http/api_handlers.h"
#include "server/http/api_jobs.h"
#include "server/http/api_queries.h"
#include "server/wire/sentence_json.h"

/* Adds the person who has stated the patient where the files name none; else null. */
static void add_stated(cJSON *json, const struct fleet_plan *plan)
{
    if (!plan->stated_by[0]) {
        cJSON_AddNullToObject(json, "stated");
        return;
    }
    cJSON *stated = cJSON_AddObjectToObject(json, "stated");
    cJSON_AddStringToObject(stated, "by", plan->stated_by);
    cJSON_AddNumberToObject(stated, "time_ms", (double)plan->stated_ms);
}

cJSON *api_plan_head(const struct fleet_plan *plan)
{
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "id", plan->id);
    cJSON_AddStringToObject(json, "name", plan->name);
    cJSON_AddStringToObject(json, "note", plan->note);
    cJSON_AddStringToObject(json, "patient", plan->stated_by[0] ? plan->stated_patient : plan->patient);
    add_stated(json, plan);
    cJSON_AddNumberToObject(json, "n_patients", plan->n_patients);
    cJSON_AddStringToObject(json, "label", plan->label);
    cJSON_AddStringToObject(json, "date", plan->date);
    cJSON_AddStringToObject(json, "approval", plan->approval);
    cJSON_AddNumberToObject(json, "n_plans", plan->n_treatment_plans);
    cJSON_AddBoolToObject(json, "is_phantom", plan->is_phantom);
    cJSON_AddBoolToObject(json, "uploaded", plan->is_uploaded);
    cJSON_AddBoolToObject(json, "has_plan_file", plan->has_plan_file);
    cJSON_AddStringToObject(json, "state", fleet_state_word(plan->state));
    cJSON_AddItemToObject(json, "parts", plan->parts ? cJSON_Duplicate(plan->parts, true) : cJSON_CreateArray());
    cJSON_AddNumberToObject(json, "n_bytes", (double)plan->n_bytes);
    if (plan->state == FLEET_STARTING || plan->state == FLEET_LOADING || plan->state == FLEET_RESTARTING) {
        cJSON_AddStringToObject(json, "phase", plan->phase);
        cJSON_AddNumberToObject(json, "percent", plan->percent);
    }
    if (plan->problem) { /* unreadable, failed, or waiting for a restart */
        cJSON_AddStringToObject(json, "reason", plan->problem->detail);
        sentence_add_json(json, "reason", &plan->problem->facts);
        cJSON_AddItemToObject(json, "problem", problem_to_json(plan->problem));
    } else {
        cJSON_AddNullToObject(json, "reason");
    }
    const cJSON *line;
    int n_warnings = 0;
    cJSON_ArrayForEach(line,
                       cJSON_GetObjectItemCaseSensitive(cJSON_GetObjectItemCaseSensitive(plan->document, "report"),
                                                        "lines"))
    {
        const char *severity = json_text(line, "severity");
        n_warnings += severity && strcmp(severity, "note") != 0;
    }
    if (plan->document)
        cJSON_AddNumberToObject(json, "n_warnings", n_warnings);
    return json;
}

void api_plans(struct api *api, struct call *call)
{
    struct fleet *fleet = net_fleet(api->net);
    fleet_rescan(fleet);
    cJSON *answer = cJSON_CreateObject(), *list = cJSON_AddArrayToObject(answer, "plans");
    struct fleet_plan plan;
    for (size_t i = 0; i < fleet_n_plans(fleet); i++)
        if (fleet_plan_at(fleet, i, &plan) && api_access_to_found_plan(api, call, ACCESS_LOOK, &plan))
            cJSON_AddItemToArray(list, api_plan_head(&plan));
    call_answer_json(call, 200, answer);
}

void api_plan(struct api *api, struct call *call)
{
    struct fleet_plan plan;
    if (!api_find_plan(api, call, &plan))
        return;
    cJSON *answer = api_plan_head(&plan);
    const cJSON *part;
    cJSON_ArrayForEach(part, plan.document) /* images, regions, ...: known only of a loaded plan */
    {
        if (!cJSON_GetObjectItemCaseSensitive(answer, part->string))
            cJSON_AddItemToObject(answer, part->string, cJSON_Duplicate(part, true));
    }
    if (plan.memory_bytes)
        cJSON_AddNumberToObject(answer, "memory_bytes", (double)plan.memory_bytes);
    call_answer_json(call, 200, answer);
}

bool api_plan_revision_known(struct api *api, const char *plan_id, struct fleet_revision *revision,
                             struct problem *problem)
{
    if (fleet_revision(net_fleet(api->net), plan_id, revision))
        return true;
    if (revision->reason && revision->reason[0])
        return problem_set(problem, PROBLEM_PLAN_UNREADABLE, "", "", "the plan's files cannot be read: %s",
                           revision->reason);
    problem_set(problem, PROBLEM_BUSY, "", "", "the plan's files are being read");
    problem->retry_after_ms = 500;
    return false;
}

void api_plan_revision(struct api *api, struct call *call)
{
    struct fleet_plan plan;
    struct fleet_revision revision;
    struct problem problem;
    if (!api_find_plan(api, call, &plan))
        return;
    if (!api_plan_revision_known(api, call->ids[0], &revision, &problem)) {
        call_answer_problem(call, &problem);
        return;
    }
    cJSON *answer = cJSON_CreateObject();
    cJSON_AddStringToObject(answer, "revision", revision.digest);
    cJSON_AddNumberToObject(answer, "n_files", (double)revision.n_files);
    call_answer_json(call, 200, answer);
}

void api_plan_open(struct api *api, struct call *call)
{
    struct fleet_plan plan;
    struct problem problem;
    if (!api_find_plan(api, call, &plan))
        return;
    net_audit_often(api->net, &call->identity, call->client, "", call->ids[0], "open", "plan", false);
    if (!fleet_open(net_fleet(api->net), call->ids[0], &problem)) {
        call_answer_problem(call, &problem);
        return;
    }
    struct api_job *job = api_job_create(api, call, "open");
    (void)snprintf(job->plan_id, sizeof job->plan_id, "%s", call->ids[0]);
    if (fleet_plan_find(net_fleet(api->net), call->ids[0], &plan))
        job->opening = plan.opening;
    api_job_answer(api, call, job);
}

void api_plan_close(struct api *api, struct call *call)
{
    struct fleet_plan plan;
    if (!api_find_plan(api, call, &plan))
        return;
    fleet_close(net_fleet(api->net), call->ids[0]);
    call_answer_nothing(call, 204);
}
