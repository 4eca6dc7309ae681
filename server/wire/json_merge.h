#pragma once
/* Merge patches (RFC 7396) and comparing of JSON documents, in time that grows with their size: they run on the net
 * thread. Thread: any. */
#include "server/wire/json.h"

/* target (may be NULL) with patch applied, as a new document. Neither argument changes. Of equal names in one object of
 * the patch each is applied after the one before. NULL: no memory. */
NODISCARD cJSON *json_merge(const cJSON *target, const cJSON *patch);
/* Equal but for the order of members. Members of one object have different names. Numbers may differ in the last bit.
 * False when one is NULL. */
bool json_equal(const cJSON *a, const cJSON *b);
