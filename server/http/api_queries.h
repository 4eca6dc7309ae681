#pragma once
/* Queries to a plan's renderer for a call: finding the plan or room, opening it, sending the query, answering the call
 * with the renderer's body. Internal to server/http; net thread. */
#include "server/http/api_state.h"
#include "server/wire/shape_query.h"

/* The plan that the call's address names. Returns false when there is none: the call was answered. */
bool api_find_plan(struct api *api, struct call *call, struct fleet_plan *plan);
/* The room that the call's address names; NULL: there is none, the call was answered. */
struct room *api_find_room(struct api *api, struct call *call);
/* Opens the plan, sends the question, and calls reply with the call as its context, exactly once. */
void api_query_send(struct api *api, struct call *call, const char *plan_id, struct packet *question,
                    fleet_reply reply);
/* Answers the call with the answer's blob, a mesh, under a name without its ending. */
void api_mesh_answer(struct call *call, struct packet *answer, const char *name, enum mesh_format format);
/* A fleet_reply that answers the call with the body of the renderer's answer, or the file that the body says it is. */
void api_query_answer(void *context, struct packet *answer, const struct problem *problem);
/* Opens the plan and calls reply once it is ready, or with the problem. */
void api_when_ready(struct api *api, struct call *call, const char *plan_id, fleet_reply reply);
