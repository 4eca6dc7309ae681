#pragma once
/* Checks that the bodies of items have in common. Each fills problem and returns false where something is wrong; where:
 * the pointer to it, "/body" and below. Internal to server/room. */
#include "server/room/state/room_state.h"

bool body_refuse_type(struct problem *problem, const char *where, const char *expected);
/* Refuses members that are none of these names (NULL-terminated, at most 32), or are there twice. */
bool body_names_are(const cJSON *object, const char *const *names, const char *where, struct problem *problem);
/* Checks a text of 1 to `most` characters, not all of them white; lines may break. */
bool body_check_text(const cJSON *json, const char *where, size_t most, struct problem *problem);
bool body_check_id(const cJSON *json, const char *where, struct problem *problem);
