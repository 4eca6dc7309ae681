#pragma once
/* The paper of a kept record, as JSON (proto/answers.json, paper): {title, identity: {fields, line}, foot, printed,
 * blocks}. Reads what was kept at the decision and nothing else, so that it is the same whenever it is made, but for
 * "printed" and for what was signed and corrected since. All text is made visible (core/base/invisible.h). Thread: any.
 */
#include <stdbool.h>
#include <stdint.h>

#include "server/wire/json.h"

struct paper_source {
    const char *id, *room, *plan, *hash; /* as of the record; hash: SHA-256 of its body */
    int64_t time_ms, now_ms;             /* of the decision; of printing, since 1970 */
    int now_offset_min;                  /* of the server's zone when it is printed */
    const char *now_zone;
    const cJSON *item, *body;            /* of the record; body {} of a record of an early version */
    const cJSON *signatures, *decisions; /* items that were written in the room since; NULL: none */
    bool is_open;                        /* the server is open to everybody */
};

/* Owned by the caller. */
cJSON *paper_of_record(const struct paper_source *source);
/* Puts the patient in full (an entry of GET /plans/{plan}/identity) where the masked one stood. */
void paper_name_patient(cJSON *paper, const cJSON *patient);
