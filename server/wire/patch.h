#pragma once
/* Merge patches on a document that a field table describes: applied, checked against table and plan, completed. What
 * proto/scene.json says of a field is all that is known here of it. In time that grows with the document: it runs on
 * the net thread. */
#include "server/wire/fields.h"

/* current with patch applied, as a new, complete document; NULL with problem, current untouched. The fields are checked
 * by object's table, and every id that names something by plan, the document of the plan (plan_document.h): what the
 * plan does not have is a validation problem at its field. What the patch leaves out or sets to null, and current does
 * not have, gets its value from defaults, a complete document, else the table's default. */
NODISCARD cJSON *patch_apply(const struct field_object *object, const cJSON *plan, const cJSON *defaults,
                             const cJSON *current, const cJSON *patch, struct problem *problem);
/* current for a plan that was loaded again and may have changed: what names something the plan lost is left out, and if
 * the rest does not pass the checks, the result is a copy of defaults. NULL: no memory. */
NODISCARD cJSON *patch_renew(const struct field_object *object, const cJSON *plan, const cJSON *defaults,
                             const cJSON *current);
/* The change for clients that keep a copy of the document, after patch made before into after: the present value of
 * each field that patch names, so that json_merge alone makes their copy the new document. A value that patch set to
 * null is its default; a new entry of a map, and a list, is complete. A field that is null now is null in it: absent
 * and null mean the same. NULL: no memory. */
NODISCARD cJSON *patch_told(const cJSON *before, const cJSON *after, const cJSON *patch);
