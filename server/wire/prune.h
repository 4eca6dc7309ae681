#pragma once
/* Takes out of a document what this version or this plan does not have, and tells what it took: for documents that were
 * made by another version or for a plan whose files have changed since. Driven by the generated field tables. Thread:
 * any. */
#include "server/wire/fields.h"

/* Told of each part that is taken out: where (prefix and JSON pointer), code unknown-field or unknown-id, a sentence.
 * The texts are borrowed. */
typedef void prune_told(void *context, const char *pointer, const char *code, const char *detail);

/* json: a document or merge patch of the object, whose values need not be valid. plan: the plan's document. */
void prune(const struct field_object *object, cJSON *json, const cJSON *plan, const char *prefix, prune_told *told,
           void *context);
/* Takes out the value at the pointer, or the innermost object that the pointer leads through: then the pointer is of a
 * field that is missing there. Lists are taken out whole. Returns false when that would be the document itself. */
NODISCARD bool prune_at(cJSON *json, const char *pointer);
