#include "server/wire/patch.h"

#include <stdlib.h>

#include "core/base/mem.h"
#include "server/wire/json_index.h"
#include "server/wire/json_merge.h"
#include "server/wire/references.h"

static cJSON *must(cJSON *json)
{
    if (!json)
        abort(); /* no memory: as mem_new */
    return json;
}

static cJSON *complete_object(const struct field_object *object, const cJSON *defaults, cJSON *json);

/* A map whose keys name things of the plan has an entry for each that defaults has one for. In other maps an entry that
 * was removed stays removed. Takes json, which is an object. */
static cJSON *complete_map(const struct field *field, const cJSON *defaults, cJSON *json)
{
    cJSON *complete = must(cJSON_CreateObject());
    struct json_index given, fallbacks;
    json_index_init(&given, json);
    json_index_init(&fallbacks, defaults);
    for (const cJSON *item = field->names && defaults ? defaults->child : NULL; item; item = item->next) {
        cJSON *entry = json_index_find(&given, item->string);
        if (entry)
            cJSON_AddItemToArray(complete, /* keeps the name */
                                 complete_object(field->object, item, cJSON_DetachItemViaPointer(json, entry)));
        else
            cJSON_AddItemToArray(complete, must(cJSON_Duplicate(item, true)));
    }
    while (json->child) {
        cJSON *entry = cJSON_DetachItemViaPointer(json, json->child);
        cJSON_AddItemToArray(complete,
                             complete_object(field->object, json_index_find(&fallbacks, entry->string), entry));
    }
    json_index_finish(&given);
    json_index_finish(&fallbacks);
    cJSON_Delete(json);
    return complete;
}

/* The value of a field; NULL: it is left out. Takes given; given and fallback may be NULL. */
static cJSON *complete_field(const struct field_object *object, const struct field *field, const cJSON *fallback,
                             cJSON *given)
{
    bool is_given = given && !cJSON_IsNull(given);
    if (is_given && field->type == FIELD_OBJECT)
        return complete_object(field->object, fallback, given);
    if (is_given && field->type == FIELD_MAP)
        return complete_map(field, fallback, given);
    if (is_given)
        return given;
    cJSON_Delete(given);
    return fallback ? must(cJSON_Duplicate(fallback, true)) : field_write_default(object, field);
}

/* Takes json, an object with fields of the table alone; puts them in the table's order. */
static cJSON *complete_object(const struct field_object *object, const cJSON *defaults, cJSON *json)
{
    for (size_t i = 0; i < object->n_fields; i++) {
        const struct field *field = &object->fields[i];
        cJSON *given = cJSON_GetObjectItemCaseSensitive(json, field->name);
        const cJSON *fallback = cJSON_GetObjectItemCaseSensitive(defaults, field->name);
        if (given)
            (void)cJSON_DetachItemViaPointer(json, given);
        cJSON *value = complete_field(object, field, fallback, given);
        if (value && value->string)
            cJSON_AddItemToArray(json, value); /* keeps the name */
        else if (value)
            cJSON_AddItemToObject(json, field->name, value);
    }
    return json;
}

/* The checks run on what was said, so that a pointer names what the sender wrote. Takes merged. */
static cJSON *check_and_complete(const struct field_object *object, const cJSON *plan, const cJSON *defaults,
                                 cJSON *merged, struct problem *problem)
{
    char *read = mem_new(object->size);
    bool ok = fields_read(object, merged, NULL, read, problem);
    if (ok)
        fields_finish(object, read);
    free(read);
    if (ok && references_check(object, merged, plan, problem))
        return complete_object(object, defaults, merged);
    cJSON_Delete(merged);
    return NULL;
}

cJSON *patch_apply(const struct field_object *object, const cJSON *plan, const cJSON *defaults, const cJSON *current,
                   const cJSON *patch, struct problem *problem)
{
    if (!cJSON_IsObject(patch)) {
        problem_set(problem, PROBLEM_VALIDATION, "", "type", "a merge patch on the %s must be an object", object->name);
        return NULL;
    }
    return check_and_complete(object, plan, defaults, json_merge(current, patch), problem);
}

cJSON *patch_renew(const struct field_object *object, const cJSON *plan, const cJSON *defaults, const cJSON *current)
{
    cJSON *kept = must(cJSON_Duplicate(current, true));
    references_remove(object, kept, plan);
    cJSON *renewed = check_and_complete(object, plan, defaults, kept, NULL);
    return renewed ? renewed : must(cJSON_Duplicate(defaults, true));
}

cJSON *patch_told(const cJSON *document, const cJSON *patch)
{
    if (cJSON_IsNull(patch) && document)
        return must(cJSON_Duplicate(document, true));
    if (!cJSON_IsObject(patch))
        return must(cJSON_Duplicate(patch, true));
    cJSON *told = must(cJSON_CreateObject());
    struct json_index members;
    json_index_init(&members, document);
    for (const cJSON *item = patch->child; item; item = item->next)
        cJSON_AddItemToObject(told, item->string, patch_told(json_index_find(&members, item->string), item));
    json_index_finish(&members);
    return told;
}
