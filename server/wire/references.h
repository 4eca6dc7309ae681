#pragma once
/* Ids in a document that name something of the plan ("names" in proto/scene.json): refused or removed where the plan
 * document (plan_document.h) does not list them. Driven by the generated field tables; an empty id names nothing.
 * Thread: any. */
#include "server/wire/fields.h"

/* True when the plan has everything that json names; else a validation problem, code unknown-id, at the first field in
 * the table's order. json passed fields_read with the same object. */
NODISCARD bool references_check(const struct field_object *object, const cJSON *json, const cJSON *plan,
                                struct problem *problem);
/* Takes out of json what names something the plan does not have: the field, or the member of a map under that key. */
void references_remove(const struct field_object *object, cJSON *json, const cJSON *plan);
