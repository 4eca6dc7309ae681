/* HTTP calls that send one question to a plan's renderer (the questions of proto/packets.json): parameters to a packet,
 * the answer's body to the caller. A question without anything special about its call needs no code here. */
#include "server/http/api_questions.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/http/api_access.h"
#include "server/http/api_pictures.h"
#include "server/http/api_queries.h"
#include "server/wire/document.h"

/* ---- parameters ------------------------------------------------------------------------------------------------- */

static const struct field *find_field(const struct packet_description *description, const char *name)
{
    for (size_t i = 0; i < description->object->n_fields; i++)
        if (strcmp(description->object->fields[i].name, name) == 0)
            return &description->object->fields[i];
    return NULL;
}

static bool read_number(const struct call *call, const struct field *field, const char *name, cJSON *fields,
                        struct problem *problem)
{
    double value = 0;
    if (!call_query_number(call, name, field->is_required, &value, problem))
        return false;
    if (!call_query(call, name))
        return true;
    if (!(value >= field->min && value <= field->max)) {
        char pointer[64];
        (void)snprintf(pointer, sizeof pointer, "/%s", name);
        return problem_set(problem, PROBLEM_VALIDATION, pointer, "range", "%s is %g, expected %g to %g", name, value,
                           field->min, field->max);
    }
    cJSON_AddNumberToObject(fields, field->name, value);
    return true;
}

static bool read_point(const struct call *call, const struct field *field, const char *const names[3], cJSON *fields,
                       struct problem *problem)
{
    double point[3] = { 0, 0, 0 };
    bool is_within = true;
    for (int i = 0; i < 3; i++) {
        if (!call_query_number(call, names[i], field->is_required, &point[i], problem))
            return false;
        is_within = is_within && point[i] >= field->min && point[i] <= field->max;
    }
    if (!is_within) {
        char pointer[64];
        (void)snprintf(pointer, sizeof pointer, "/%s", field->name);
        return problem_set(problem, PROBLEM_VALIDATION, pointer, "type",
                           "a point is three numbers in mm, each %.17g to %.17g", field->min, field->max);
    }
    cJSON_AddItemToObject(fields, field->name, cJSON_CreateDoubleArray(point, 3));
    return true;
}

/* "x,y,z" */
static bool read_joined_point(const struct call *call, const struct field *field, const char *name, cJSON *fields,
                              struct problem *problem)
{
    const char *text = call_query(call, name);
    char pointer[64];
    double point[3];
    (void)snprintf(pointer, sizeof pointer, "/%s", name);
    if (!text)
        return !field->is_required ||
               problem_set(problem, PROBLEM_VALIDATION, pointer, "required", "the parameter %s is missing", name);
    const char *at = text;
    for (int i = 0; i < 3; i++) {
        char *end;
        point[i] = strtod(at, &end);
        bool is_number = end != at && *end == (i < 2 ? ',' : 0) && point[i] >= field->min && point[i] <= field->max;
        if (!is_number || strspn(at, "+-.0123456789eE") != (size_t)(end - at))
            return problem_set(problem, PROBLEM_VALIDATION, pointer, "type",
                               "%s is not a point: x,y,z in mm, each %.17g to %.17g", name, field->min, field->max);
        at = end + 1;
    }
    cJSON_AddItemToObject(fields, field->name, cJSON_CreateDoubleArray(point, 3));
    return true;
}

static bool read_parameter(const struct call *call, const struct packet_description *description,
                           const struct packet_parameter *parameter, cJSON *fields, struct problem *problem)
{
    const struct field *field = find_field(description, parameter->field);
    if (field->type == FIELD_VEC3 && !parameter->names[1])
        return read_joined_point(call, field, parameter->names[0], fields, problem);
    if (field->type == FIELD_VEC3)
        return read_point(call, field, parameter->names, fields, problem);
    if (field->type == FIELD_NUMBER || field->type == FIELD_INTEGER)
        return read_number(call, field, parameter->names[0], fields, problem);
    const char *name = parameter->names[0], *text = call_query(call, name);
    if (!text && field->is_required) {
        char pointer[64];
        (void)snprintf(pointer, sizeof pointer, "/%s", name);
        return problem_set(problem, PROBLEM_VALIDATION, pointer, "required", "the parameter %s is missing", name);
    }
    if (text && field->type == FIELD_BOOL && (strcmp(text, "true") == 0 || strcmp(text, "false") == 0))
        cJSON_AddBoolToObject(fields, field->name, text[0] == 't');
    else if (text)
        cJSON_AddStringToObject(fields, field->name, text);
    return true;
}

bool api_question_read(const struct call *call, enum packet_type type, cJSON *fields, struct packet *packet,
                       struct problem *problem)
{
    const struct packet_description *description = &packet_descriptions[type];
    cJSON_AddStringToObject(fields, "type", description->name);
    cJSON_AddNumberToObject(fields, "id", 0); /* the fleet's to set */
    for (size_t i = 0; i < description->question->n_parameters; i++)
        if (!read_parameter(call, description, &description->question->parameters[i], fields, problem)) {
            cJSON_Delete(fields);
            return false;
        }
    return packet_from_json(fields, PACKET_TO_RENDERER, 0, packet, problem);
}

/* ---- the call --------------------------------------------------------------------------------------------------- */

struct question_call {
    struct packet packet;
    char plan_id[64];
    cJSON *view; /* of a question about a scene; complete */
};

static void question_call_destroy(struct question_call *question)
{
    packet_finish(&question->packet);
    cJSON_Delete(question->view);
    free(question);
}

/* Sends a question about a scene once the plan is loaded: scene is the room's with its acceptances, or the plan's own.
 */
static void send_with_scene(struct call *call, struct question_call *question, const struct fleet_plan *plan,
                            const cJSON *scene, const cJSON *acceptances)
{
    struct problem problem;
    cJSON *shown = scene_document_for_view(plan->document, plan->default_scene, scene, question->view, &problem);
    if (!shown) {
        problem_below(&problem, "/view");
        call_answer_problem(call, &problem);
        return;
    }
    struct packet_snapshot *snapshot =
        (void *)((char *)&question->packet + packet_descriptions[question->packet.type].snapshot_offset);
    snapshot->scene = shown;
    snapshot->acceptances = acceptances;
    snapshot->view = question->view;
    api_query_send(call->api, call, question->plan_id, &question->packet, api_query_answer);
    cJSON_Delete(shown);
}

static void plan_is_ready(void *context, struct packet *answer, const struct problem *not_ready)
{
    struct call *call = context;
    struct api *api = call->api;
    struct question_call *question = call->context;
    struct problem problem;
    struct fleet_plan plan;
    const char *room_id = call_query(call, "room");
    struct room *room = room_id && api_access_sees_room(api, call, room_id) ? net_room_find(api->net, room_id) : NULL;
    uint32_t revision;
    (void)answer;
    if (not_ready) {
        call_answer_problem(call, not_ready);
    } else if (!fleet_plan_find(net_fleet(api->net), question->plan_id, &plan) || !plan.document ||
               !plan.default_scene) {
        problem_set(&problem, PROBLEM_BUSY, "", "", "the plan was closed meanwhile");
        call_answer_problem(call, &problem);
    } else if (room_id && (!room || strcmp(room_plan_id(room), question->plan_id) != 0)) {
        problem_set(&problem, PROBLEM_NOT_FOUND, "/room", "", "there is no room \"%.63s\" on this plan", room_id);
        call_answer_problem(call, &problem);
    } else {
        const cJSON *scene = room ? room_scene(room, &revision) : NULL;
        send_with_scene(call, question, &plan, scene ? scene : plan.default_scene,
                        scene ? room_acceptances(room) : NULL);
    }
    question_call_destroy(question);
}

static enum packet_type find_question(const char *path)
{
    for (int type = 0; type < PACKET_N_TYPES; type++)
        if (packet_descriptions[type].question && packet_descriptions[type].question->path == path)
            return (enum packet_type)type;
    return PACKET_N_TYPES;
}

void api_question(struct api *api, struct call *call)
{
    enum packet_type type = find_question(call->route);
    struct fleet_plan plan;
    struct problem problem;
    struct packet packet;
    if (!api_find_plan(api, call, &plan))
        return;
    cJSON *fields = cJSON_CreateObject();
    if (packet_descriptions[type].question->path_field)
        cJSON_AddStringToObject(fields, packet_descriptions[type].question->path_field, call->ids[1]);
    if (!api_question_read(call, type, fields, &packet, &problem)) {
        call_answer_problem(call, &problem);
        return;
    }
    if (!packet_descriptions[type].has_snapshot) {
        api_query_send(api, call, call->ids[0], &packet, api_query_answer);
        packet_finish(&packet);
        return;
    }
    cJSON *view = api_view_parameter(call);
    if (!view) {
        packet_finish(&packet);
        return;
    }
    if (call->is_of_wall) /* the scene as it is shown to all */
        cJSON_DeleteItemFromObjectCaseSensitive(view, "override");
    struct question_call *question = mem_new(sizeof *question);
    *question = (struct question_call){ .packet = packet, .view = view };
    (void)snprintf(question->plan_id, sizeof question->plan_id, "%s", call->ids[0]);
    call->context = question;
    api_when_ready(api, call, call->ids[0], plan_is_ready);
}

bool api_question_route(size_t index, const char **path)
{
    for (int type = 0; type < PACKET_N_TYPES; type++) {
        const struct packet_question *question = packet_descriptions[type].question;
        if (question && question->path && !question->has_own_handler && index-- == 0) {
            *path = question->path;
            return true;
        }
    }
    return false;
}
