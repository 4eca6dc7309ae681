#pragma once
/* Which regions a picture leaves out, and why: as the renderer says it with a frame, and as rooms and scripts are told.
 */
#include "server/wire/json.h"

enum { MISSING_MAX_REGIONS = 32 }; /* named; there may be more */

/* {n, regions: [{region, reason}]} from the "missing" of a frame packet, which is not trusted. NULL: the picture is
 * whole, or what was said is not such an object. */
NODISCARD cJSON *missing_read(const cJSON *frame);
/* "liver, colon" or "liver, colon, and 7 more", for a header: ids and figures alone. */
void missing_words(const cJSON *missing, char *text, size_t size);
