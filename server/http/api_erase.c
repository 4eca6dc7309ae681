/* POST /plans/{plan}/erase: what is kept of one patient's plan, for good. */
#include <string.h>
#include <strings.h>

#include "server/http/api_audit.h"
#include "server/http/api_films.h"
#include "server/http/api_handlers.h"
#include "server/http/call.h"
#include "server/room/state/body_check.h"

enum { MAX_REASON_BYTES = 200 };

/* Those of the plan by either of its ids. */
static void erase_films(struct api *api, const char *plan_id)
{
    struct fleet_erase plan;
    fleet_erase_of(net_fleet(api->net), plan_id, &plan);
    const char *const ids[] = { plan_id, plan.id, plan.other_id };
    for (size_t i = 0; i < sizeof ids / sizeof ids[0]; i++)
        api_films_erase(api, ids[i]);
}

static void was_erased(void *context, int64_t n_rooms, int64_t n_records, const struct problem *problem)
{
    struct call *call = context;
    if (problem) {
        call_answer_problem(call, problem);
        return;
    }
    erase_films(call->api, call->ids[0]); /* ordered meanwhile */
    cJSON *answer = cJSON_CreateObject();
    cJSON_AddNumberToObject(answer, "rooms", (double)n_rooms);
    cJSON_AddNumberToObject(answer, "records", (double)n_records);
    call_answer_json(call, 200, answer);
}

static bool is_named_at(const char *text, const char *id)
{
    return id[0] && strncasecmp(text, id, strlen(id)) == 0;
}

/* A row of the audit is never erased, so the reason must not name the plan. */
static bool reason_is_allowed(const char *reason, const struct fleet_erase *plan, struct problem *problem)
{
    if (!reason || !reason[0] || strlen(reason) > MAX_REASON_BYTES)
        return problem_set(problem, PROBLEM_VALIDATION, "/reason", "length",
                           "/reason is a text of 1 to %d bytes: why the plan is erased", MAX_REASON_BYTES);
    for (const char *at = reason; *at; at++)
        if ((unsigned char)*at < ' ' || is_named_at(at, plan->id) || is_named_at(at, plan->other_id))
            return problem_set(problem, PROBLEM_VALIDATION, "/reason", "pattern",
                               "/reason stays in the audit: it must not name the plan, and has no control characters");
    return true;
}

void api_plan_erase(struct api *api, struct call *call)
{
    static const char *const types[] = { "application/json", NULL }, *const names[] = { "reason", NULL };
    struct problem problem;
    struct fleet_erase plan;
    cJSON *body;
    if (!call_read_object(call, types, &body))
        return;
    const struct fleet *fleet = net_fleet(api->net);
    const char *reason = json_text(body, "reason");
    fleet_erase_of(fleet, call->ids[0], &plan);
    const bool is_begun =
        body_names_are(body, names, "", &problem) && reason_is_allowed(reason, &plan, &problem) &&
        api_audit_has_place(api, &problem) &&
        (fleet_is_listed(fleet) ||
         fleet_no_plan(fleet, call->ids[0], &problem)) && /* its folder and other id are known */
        net_erase_plan(api->net, call->ids[0], &call->identity, call->client, reason, was_erased, call, &problem);
    cJSON_Delete(body);
    if (!is_begun) {
        call_answer_problem(call, &problem);
        return;
    }
    erase_films(api, call->ids[0]);
}
