#pragma once
/* The HTTP calls that send one question to a plan's renderer: one for each row of "questions" in proto/packets.json
 * that needs no handler of its own. Internal to server/http; net thread. */
#include "server/http/api_state.h"

/* Handles such a call; call->route is the path of its row. */
void api_question(struct api *api, struct call *call);
/* The path number index among them; false after the last. */
bool api_question_route(size_t index, const char **path);
/* The packet of a question from the call's parameters, checked whole; packet_finish it. fields: those that the path
 * gives, taken. False with problem. */
NODISCARD bool api_question_read(const struct call *call, enum packet_type type, cJSON *fields, struct packet *packet,
                                 struct problem *problem);
