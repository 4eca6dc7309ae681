#pragma once
/* The list of regions that a picture leaves out, and why: from the renderer's frame packet to rooms and to scripts.
 * Thread: any. */
#include "server/wire/json.h"

enum { MISSING_MAX_REGIONS = 32 }; /* listed by id at most; more are only counted */

/* A new {n, regions: [{region, reason}]} from the member "missing" of a frame packet, which is not trusted: ids are
 * checked, reasons cut, unknown members dropped. NULL when the picture is whole or the member is malformed. */
NODISCARD cJSON *missing_read(const cJSON *frame);
/* "liver, colon" or "liver, colon, and 7 more", for an HTTP header: nothing but ids and a count. text holds size bytes.
 */
void missing_words(const cJSON *missing, char *text, size_t size);
