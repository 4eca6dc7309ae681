#pragma once
/* Which pictures a change of the scene reaches: only those are drawn anew. A pure function on documents. Internal to
 * server/room. */
#include "server/wire/json.h"

/* False if the picture of a view without override is the same in two scenes: the fields of patch in which they differ
 * are of other planes, are drawn in 3-D only, by the browser, or of a dose that it does not show. In doubt true.
 *   view           complete view document
 *   before, after  complete scenes; after is before with patch applied, a merge patch */
bool change_reaches(const cJSON *view, const cJSON *before, const cJSON *after, const cJSON *patch);
