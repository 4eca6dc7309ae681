/* Sends queries of calls to renderers and answers the calls. */
#include "server/http/api_queries.h"

#include <stdio.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "server/http/api_handlers.h"

struct listing { /* a call that waits for a list of the plan folders */
    struct call *call;
    void (*again)(struct api *api, struct call *call);
};

static void plans_were_listed(void *context)
{
    const struct listing listing = *(struct listing *)context;
    free(context);
    listing.again(listing.call->api, listing.call);
}

bool api_lists_first(struct api *api, struct call *call, void (*again)(struct api *api, struct call *call))
{
    if (call->has_listed || !fleet_is_listed(net_fleet(api->net)))
        return false;
    call->has_listed = true;
    struct listing *listing = mem_new(sizeof *listing);
    *listing = (struct listing){ call, again };
    net_list_plans(api->net, plans_were_listed, listing);
    return true;
}

bool api_find_plan(struct api *api, struct call *call, struct fleet_plan *plan)
{
    if (fleet_plan_find(net_fleet(api->net), call->ids[0], plan))
        return true;
    struct problem problem;
    fleet_no_plan(net_fleet(api->net), call->ids[0], &problem);
    call_answer_problem(call, &problem);
    return false;
}

void api_query_send(struct api *api, struct call *call, const char *plan_id, struct packet *question, fleet_reply reply)
{
    struct problem problem;
    if (fleet_open(net_fleet(api->net), plan_id, &problem))
        (void)fleet_request(net_fleet(api->net), plan_id, question, reply, call);
    else
        reply(call, NULL, &problem);
}

/* The media type is chosen here and not by the renderer, which is not trusted. PLY has no registered type. */
static const char *media_type(enum mesh_format format)
{
    return format == MESH_STL ? "model/stl" : format == MESH_GLB ? "model/gltf-binary" : "application/octet-stream";
}

void api_mesh_answer(struct call *call, struct packet *answer, const char *name, enum mesh_format format)
{
    struct problem broken;
    if (!answer->blob) {
        problem_set(&broken, PROBLEM_RENDERER, "", "", "the renderer's answer has no surface");
        call_answer_problem(call, &broken);
        return;
    }
    char disposition[256]; /* ids need no quoting */
    (void)snprintf(disposition, sizeof disposition, "attachment; filename=\"%s.%s\"", name, mesh_format_word(format));
    call_add_header(call, "Content-Disposition", disposition);
    uint8_t *bytes = answer->blob;
    answer->blob = NULL;
    call_answer_bytes(call, 200, media_type(format), bytes, answer->n_blob);
}

void api_query_answer(void *context, struct packet *answer, const struct problem *problem)
{
    struct call *call = context;
    const cJSON *table = answer ? cJSON_GetObjectItemCaseSensitive(answer->answer.body, ANSWER_CSV) : NULL;
    const cJSON *mesh = answer ? cJSON_GetObjectItemCaseSensitive(answer->answer.body, ANSWER_MESH) : NULL;
    enum mesh_format format;
    if (problem)
        call_answer_problem(call, problem);
    else if (cJSON_IsString(table))
        call_answer_text(call, 200, "text/csv; charset=utf-8", table->valuestring);
    else if (cJSON_IsString(mesh) && mesh_format_from_word(mesh->valuestring, &format)) {
        char name[192];
        (void)snprintf(name, sizeof name, "%.63s-%.63s", call->ids[0], call->ids[1]);
        api_mesh_answer(call, answer, name, format);
    } else
        call_answer_json(call, 200, packet_take_document(answer, answer->answer.body));
}

void api_when_ready(struct api *api, struct call *call, const char *plan_id, fleet_reply reply)
{
    struct packet packet;
    packet_init(&packet, PACKET_AWAIT_READY);
    api_query_send(api, call, plan_id, &packet, reply);
}

struct room *api_find_room(struct api *api, struct call *call)
{
    struct room *room = net_room_find(api->net, call->ids[0]);
    if (!room) {
        struct problem problem;
        problem_set(&problem, PROBLEM_NOT_FOUND, "", "", "there is no room \"%.63s\"", call->ids[0]);
        call_answer_problem(call, &problem);
    }
    return room;
}
