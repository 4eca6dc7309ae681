/* POST /plans/{plan}/render: a picture of a plan without a room. The request patches the plan's default scene, which is
 * known only once the plan is loaded: so the plan is opened first, unless the request says only_loaded. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/http/api_audit.h"
#include "server/http/api_handlers.h"
#include "server/http/api_pictures.h"
#include "server/http/api_queries.h"
#include "server/room/items/acceptance_body.h"
#include "server/room/state/body_check.h"

struct render_call {
    char plan_id[64];
    cJSON *body; /* checked by check_body */
};

static void render_call_destroy(struct render_call *request)
{
    cJSON_Delete(request->body);
    free(request);
}

static bool check_body(const cJSON *body, struct problem *problem)
{
    static const char *const known[] = { "scene",       "view",        "format",     "quality",
                                         "annotations", "only_loaded", "acceptances" };
    const cJSON *item;
    cJSON_ArrayForEach(item, body)
    {
        bool is_known = false;
        for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
            is_known = is_known || strcmp(item->string, known[i]) == 0;
        char pointer[64];
        (void)snprintf(pointer, sizeof pointer, "/%.60s", item->string);
        if (!is_known)
            return problem_set(problem, PROBLEM_VALIDATION, pointer, "unknown-field",
                               "%.60s is not a field of a render request", item->string);
        bool right = strcmp(item->string, "format") == 0        ? cJSON_IsString(item)
                     : strcmp(item->string, "quality") == 0     ? cJSON_IsNumber(item)
                     : strcmp(item->string, "annotations") == 0 ? cJSON_IsBool(item)
                     : strcmp(item->string, "only_loaded") == 0 ? cJSON_IsBool(item)
                     : strcmp(item->string, "acceptances") == 0 ? cJSON_IsArray(item)
                                                                : cJSON_IsObject(item);
        if (!right)
            return problem_set(problem, PROBLEM_VALIDATION, pointer, "type", "%.60s has the wrong type", item->string);
    }
    return true;
}

/* The acceptances of the body, checked as those of a room, for the renderer: {thing, with, by, words}. NULL with
 * problem. */
static cJSON *read_acceptances(const cJSON *list, const cJSON *plan, struct problem *problem)
{
    cJSON *read = cJSON_CreateArray();
    const cJSON *entry;
    int at = 0;
    if (cJSON_GetArraySize(list) > ACCEPTANCE_MAX) {
        problem_set(problem, PROBLEM_VALIDATION, "/acceptances", "count", "at most %d acceptances are allowed",
                    ACCEPTANCE_MAX);
        cJSON_Delete(read);
        return NULL;
    }
    if (!read) {
        json_no_memory(problem, "acceptances");
        return NULL;
    }
    cJSON_ArrayForEach(entry, list)
    {
        static const char *const names[] = { "thing", "with", "words" };
        static const char *const known_names[] = { "thing", "with", "reason", "words", NULL };
        char where[32];
        (void)snprintf(where, sizeof where, "/acceptances/%d", at++);
        if (!(cJSON_IsObject(entry) || body_refuse_type(problem, where, "an object")) ||
            !body_names_are(entry, known_names, where, problem) || !acceptance_check(plan, entry, where, problem)) {
            cJSON_Delete(read);
            return NULL;
        }
        cJSON *told = cJSON_CreateObject();
        for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
            cJSON_AddStringToObject(told, names[i], json_text(entry, names[i]));
        cJSON_AddStringToObject(told, "by", "a call of the API");
        json_append(read, told);
    }
    return read;
}

/* Each is a row of the audit, as one of a room is. */
static void audit_acceptances(struct api *api, const struct call *call, const char *plan_id, const cJSON *list)
{
    const cJSON *entry;
    cJSON_ArrayForEach(entry, list)
    {
        static const char *const names[] = { "thing", "with", "reason", "words" };
        cJSON *detail = cJSON_CreateObject();
        cJSON_AddStringToObject(detail, "what", "picture");
        for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
            cJSON_AddStringToObject(detail, names[i], json_text(entry, names[i]));
        net_audit_by(api->net, &call->identity, call->client, "", plan_id, "acceptance", detail);
    }
}

static void render_when_ready(void *context, struct packet *answer, const struct problem *not_ready)
{
    struct call *call = context;
    struct api *api = call->api;
    struct render_call *request = call->context;
    struct problem problem;
    struct fleet_plan plan;
    (void)answer;
    if (not_ready) {
        render_call_destroy(request);
        call_answer_problem(call, not_ready);
        return;
    }
    cJSON *scene = NULL, *view = NULL, *shown = NULL, *acceptances = NULL, *nothing = cJSON_CreateObject();
    if (!fleet_plan_find(net_fleet(api->net), request->plan_id, &plan) || !plan.document || !plan.default_scene) {
        problem_set(&problem, PROBLEM_BUSY, "", "", "the plan was closed meanwhile");
        goto refuse;
    }
    const cJSON *scene_patch = cJSON_GetObjectItemCaseSensitive(request->body, "scene");
    const cJSON *view_patch = cJSON_GetObjectItemCaseSensitive(request->body, "view");
    scene = scene_document_patch(plan.document, plan.default_scene, plan.default_scene,
                                 scene_patch ? scene_patch : nothing, &problem);
    if (!scene) {
        problem_below(&problem, "/scene");
        goto refuse;
    }
    view = view_document_patch(NULL, view_patch ? view_patch : nothing, &problem);
    shown = view ? scene_document_for_view(plan.document, plan.default_scene, scene, view, &problem) : NULL;
    if (!shown) {
        problem_below(&problem, "/view");
        goto refuse;
    }
    const cJSON *accepted = cJSON_GetObjectItemCaseSensitive(request->body, "acceptances");
    acceptances = read_acceptances(accepted, plan.document, &problem);
    if (!acceptances)
        goto refuse;
    audit_acceptances(api, call, request->plan_id, accepted);
    api_picture_request(api, call, request->plan_id, shown, acceptances, NULL, view, json_text(request->body, "format"),
                        json_number(request->body, "quality", 92),
                        (struct api_marking){ .has_caption = json_flag(request->body, "annotations", false) }, NULL);
    goto done;
refuse:
    call_answer_problem(call, &problem);
done:
    cJSON_Delete(nothing);
    cJSON_Delete(scene);
    cJSON_Delete(view);
    cJSON_Delete(shown);
    cJSON_Delete(acceptances);
    render_call_destroy(request);
}

void api_plan_render(struct api *api, struct call *call)
{
    static const char *const media_types[] = { "application/json", NULL };
    struct fleet_plan plan;
    struct problem problem;
    cJSON *body;
    if (!api_find_plan(api, call, &plan) || !call_read_object(call, media_types, &body))
        return;
    if (!check_body(body, &problem)) {
        cJSON_Delete(body);
        call_answer_problem(call, &problem);
        return;
    }
    if (json_flag(body, "only_loaded", false) && plan.state != FLEET_READY) {
        cJSON_Delete(body);
        problem_set(&problem, PROBLEM_BUSY, "", "", "the plan is not loaded, and only_loaded keeps it so");
        call_answer_problem(call, &problem);
        return;
    }
    if (!json_flag(body, "only_loaded", false) && /* that is for thumbnails */
        !api_audit_export(api, call, "picture")) {
        cJSON_Delete(body);
        return;
    }
    struct render_call *request = mem_new(sizeof *request);
    (void)snprintf(request->plan_id, sizeof request->plan_id, "%s", call->ids[0]);
    request->body = body;
    call->context = request;
    api_when_ready(api, call, call->ids[0], render_when_ready);
}
