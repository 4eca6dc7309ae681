/* The record of a room's review. */
#include <stdio.h>
#include <string.h>

#include "server/http/api_audit.h"
#include "server/http/api_handlers.h"
#include "server/http/api_queries.h"

/* The newest row of the audit on disk, for --audit-head. */
static cJSON *describe_audit(struct api *api)
{
    const struct net_audit_head head = net_audit_head(api->net);
    cJSON *audit = cJSON_CreateObject();
    cJSON_AddNumberToObject(audit, "rows", (double)head.n);
    cJSON_AddStringToObject(audit, "head", head.hash);
    cJSON_AddNumberToObject(audit, "n_waiting", (double)head.n_waiting);
    return audit;
}

void api_room_record(struct api *api, struct call *call)
{
    struct problem problem;
    struct fleet_plan plan;
    struct fleet_revision revision;
    struct room *room = api_find_room(api, call);
    const char *export = call_query(call, "export");
    const bool is_export = export && strcmp(export, "true") == 0;
    if (!room)
        return;
    if (export && !is_export && strcmp(export, "false") != 0) {
        problem_set(&problem, PROBLEM_VALIDATION, "/export", "type", "export is \"%.20s\", expected true or false",
                    export);
        call_answer_problem(call, &problem);
        return;
    }
    if (!api_plan_revision_known(api, room_plan_id(room), &revision, &problem)) {
        call_answer_problem(call, &problem);
        return;
    }
    room_plan_revision(room, revision.digest);
    if (is_export && !api_audit_export(api, call, "record"))
        return;
    cJSON *record = room_record(room);
    const bool has_plan = fleet_plan_find(net_fleet(api->net), room_plan_id(room), &plan);
    cJSON_AddStringToObject(record, "plan_name", has_plan ? plan.name : "");
    cJSON_AddNumberToObject(record, "n_files", (double)revision.n_files);
    cJSON_AddStringToObject(record, "server", BEAMROOM_VERSION);
    json_add(record, "audit", describe_audit(api));
    if (is_export) {
        char name[128];
        (void)snprintf(name, sizeof name, "attachment; filename=\"record-%.63s.json\"", room_id(room));
        call_add_header(call, "Content-Disposition", name);
    }
    call_answer_json(call, 200, record);
}
