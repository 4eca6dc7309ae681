#pragma once
/* Answers to questions about a plan and a scene, as JSON bodies of the web API; the caller frees them. Any thread. */
#include "core/load/summary.h"
#include "core/render/render.h"
#include "server/renderer/question.h"

/* The answer to a question of proto/packets.json, one function each: answer_probe for "probe". derived: the store of
 * the loaded plan. Gives the body of the HTTP answer; NULL with problem. */
#define ANSWER_DECLARE(TYPE, name) \
    NODISCARD cJSON *answer_##name(struct question *question, struct derive *derived, struct problem *problem);
PACKET_QUESTIONS(ANSWER_DECLARE)
/* Calls the function of the question's type. */
NODISCARD cJSON *answer_question(struct question *question, struct derive *derived, struct problem *problem);

/* {name, note, phantom, readable, reason, parts, n_bytes} */
NODISCARD cJSON *answer_summary(const struct plan_summary *summary);
/* {back_end, vendor, renderer, version, is_software} */
NODISCARD cJSON *answer_gl(const struct render_facts *facts, bool is_stub);
