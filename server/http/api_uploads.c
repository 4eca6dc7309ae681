/* Uploading an archive as a plan, and deleting an uploaded plan. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/base/log.h"
#include "server/auth/auth.h"
#include "server/http/api_films.h"
#include "server/http/api_handlers.h"
#include "server/http/api_jobs.h"
#include "server/net/statements.h"

/* The body was received into a file by server/http/intake.h. */
void api_plan_upload(struct api *api, struct call *call)
{
    struct problem problem;
    const char *name = call_query(call, "name");
    if (!call->upload_path || call->n_upload == 0) {
        problem_set(&problem, PROBLEM_VALIDATION, "", "length",
                    "the body is empty, expected a zip, tar or tar.gz of a plan");
        call_answer_problem(call, &problem);
        return;
    }
    uint64_t number = fleet_upload(net_fleet(api->net), call->upload_path, name ? name : "", &problem);
    free(call->upload_path); /* the fleet has taken the file */
    call->upload_path = NULL;
    if (!number) {
        call_answer_problem(call, &problem);
        return;
    }
    struct api_job *job = api_job_create(api, call, "upload");
    job->upload = number;
    log_info("upload %llu: %llu bytes", (unsigned long long)number, (unsigned long long)call->n_upload);
    api_job_answer(api, call, job);
}

static bool is_plain_text(const char *text)
{
    for (; *text; text++)
        if ((unsigned char)*text < ' ' || *text == 127)
            return false;
    return true;
}

void api_plan_delete(struct api *api, struct call *call)
{
    struct fleet *fleet = net_fleet(api->net);
    struct fleet_plan plan;
    struct problem problem = { 0 };
    char reason[200] = "the plan was deleted";
    const char *by = call_query(call, "by");
    if (by && (strlen(by) > 160 || !is_plain_text(by))) {
        problem_set(&problem, PROBLEM_VALIDATION, "/by", "length",
                    "by is not a name of 160 bytes without control characters");
        call_answer_problem(call, &problem);
        return;
    }
    if (by && by[0])
        (void)snprintf(reason, sizeof reason, "the plan was deleted by “%.160s”", by);
    /* closes the plan's rooms first, but only if the plan can be deleted */
    if (fleet_plan_find(fleet, call->ids[0], &plan) && plan.is_uploaded) {
        if (!api_may_delete(call, net_n_decided_of_plan(api->net, call->ids[0]), "rooms of this plan"))
            return;
        cJSON *detail = cJSON_CreateObject();
        cJSON_AddStringToObject(detail, "why", reason);
        net_audit_by(api->net, &call->identity, call->client, "", call->ids[0], "deleted", detail);
        net_rooms_delete_of_plan(api->net, call->ids[0], call->client, reason);
    }
    struct fleet_erase of;
    fleet_erase_of(fleet, call->ids[0], &of); /* its ids, before it is gone */
    if (!fleet_remove_plan(fleet, call->ids[0], &problem)) {
        call_answer_problem(call, &problem);
        return;
    }
    net_statement_forget(api->net, of.id, of.other_id);
    api_films_erase(api, of.id);
    if (of.other_id[0])
        api_films_erase(api, of.other_id);
    if (api->auth)
        auth_set_owner(api->auth, call->ids[0], "");
    call_answer_nothing(call, 204);
}
