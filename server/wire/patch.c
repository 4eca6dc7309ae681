/* Applying, checking, completing and telling merge patches: patch.h. */
#include "server/wire/patch.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/wire/json_index.h"
#include "server/wire/json_merge.h"
#include "server/wire/references.h"

/* A part for which there is no memory is missing; callers that use the whole compare mem_n_refused. */
static cJSON *complete_object(const struct field_object *object, const cJSON *defaults, cJSON *json);

/* A map whose keys name things of the plan has an entry for each that defaults has one for, but where they are
 * removable. In other maps an entry that was removed stays removed. Takes json, which is an object. */
static cJSON *complete_map(const struct field *field, const cJSON *defaults, cJSON *json)
{
    const bool is_whole = field->names && !field->is_removable && defaults;
    cJSON *complete = cJSON_CreateObject();
    struct json_index given, fallbacks;
    json_index_init(&given, json);
    json_index_init(&fallbacks, defaults);
    for (const cJSON *item = is_whole ? defaults->child : NULL; item; item = item->next) {
        cJSON *entry = json_index_find(&given, item->string);
        if (entry)
            json_append(complete, /* keeps the name */
                        complete_object(field->object, item, cJSON_DetachItemViaPointer(json, entry)));
        else
            json_append(complete, cJSON_Duplicate(item, true));
    }
    while (json->child) {
        cJSON *entry = cJSON_DetachItemViaPointer(json, json->child);
        json_append(complete, complete_object(field->object, json_index_find(&fallbacks, entry->string), entry));
    }
    json_index_finish(&given);
    json_index_finish(&fallbacks);
    cJSON_Delete(json);
    return complete;
}

/* Takes json, which is a list of objects. */
static cJSON *complete_list(const struct field *field, cJSON *json)
{
    cJSON *element;
    cJSON_ArrayForEach(element, json)(void) complete_object(field->object, NULL, element);
    return json;
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
    if (is_given && field->type == FIELD_LIST)
        return complete_list(field, given);
    if (is_given)
        return given;
    cJSON_Delete(given);
    return fallback ? cJSON_Duplicate(fallback, true) : field_write_default(object, field);
}

/* True if json has every field in the table's order and no field is an object, which could be incomplete itself. */
static bool is_complete(const struct field_object *object, const cJSON *json)
{
    const cJSON *item = json->child;
    for (size_t i = 0; i < object->n_fields; i++, item = item->next)
        if (object->fields[i].object || !item || cJSON_IsNull(item) ||
            strcmp(item->string, object->fields[i].name) != 0)
            return false;
    return true;
}

/* Takes json, an object with fields of the table alone, and returns it with all of them in the table's order. defaults
 * may be NULL or no object: the table's then. */
static cJSON *complete_object(const struct field_object *object, const cJSON *defaults, cJSON *json)
{
    size_t n = is_complete(object, json) ? 0 : object->n_fields;
    for (size_t i = 0; i < n; i++) {
        const struct field *field = &object->fields[i];
        cJSON *given = cJSON_GetObjectItemCaseSensitive(json, field->name);
        const cJSON *fallback = cJSON_GetObjectItemCaseSensitive(defaults, field->name);
        if (given)
            (void)cJSON_DetachItemViaPointer(json, given);
        cJSON *value = complete_field(object, field, fallback, given);
        if (value && value->string)
            json_append(json, value); /* keeps the name */
        else if (value)
            json_add(json, field->name, value);
    }
    return json;
}

/* The checks run on merged before it is completed, so that a pointer names a field as the sender wrote it. Consumes
 * merged; NULL: there was no memory for it. */
static cJSON *check_and_complete(const struct field_object *object, const cJSON *plan, const cJSON *defaults,
                                 cJSON *merged, struct problem *problem)
{
    size_t before = mem_n_refused();
    char *read = mem_new(object->size); /* of some hundred bytes; entries of lists and maps stand elsewhere */
    bool ok = merged ? fields_read(object, merged, NULL, read, problem) : json_no_memory(problem, object->name);
    if (ok)
        fields_finish(object, read);
    free(read);
    if (ok && references_check(object, merged, plan, problem)) {
        cJSON *complete = complete_object(object, defaults, merged);
        if (mem_n_refused() == before)
            return complete;
        json_no_memory(problem, object->name);
    }
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
    struct problem problem = { 0 };
    cJSON *kept = cJSON_Duplicate(current, true);
    if (kept)
        references_remove(object, kept, plan);
    cJSON *renewed = check_and_complete(object, plan, defaults, kept, &problem);
    return renewed || problem.type != PROBLEM_VALIDATION ? renewed : cJSON_Duplicate(defaults, true);
}

/* Returns the patch that turns before into after, with every member of after; after itself where one of them is no
 * object. */
static cJSON *difference(const cJSON *before, const cJSON *after)
{
    if (!cJSON_IsObject(before) || !cJSON_IsObject(after))
        return cJSON_Duplicate(after, true);
    cJSON *told = cJSON_CreateObject();
    struct json_index old_members, new_members;
    json_index_init(&old_members, before);
    json_index_init(&new_members, after);
    for (const cJSON *item = after->child; item; item = item->next)
        json_add(told, item->string, difference(json_index_find(&old_members, item->string), item));
    for (const cJSON *item = before->child; item; item = item->next)
        if (!json_index_find(&new_members, item->string))
            cJSON_AddNullToObject(told, item->string);
    json_index_finish(&old_members);
    json_index_finish(&new_members);
    return told;
}

static cJSON *told_of(const cJSON *before, const cJSON *after, const cJSON *patch)
{
    if (!after)
        return cJSON_CreateNull();
    /* Each of equal names in a patch was applied; a page that is told both takes only the last. */
    if (!cJSON_IsObject(before) || !cJSON_IsObject(after) || !cJSON_IsObject(patch) || json_has_equal_names(patch))
        return difference(before, after);
    cJSON *told = cJSON_CreateObject();
    struct json_index old_members, new_members;
    json_index_init(&old_members, before);
    json_index_init(&new_members, after);
    for (const cJSON *item = patch->child; item; item = item->next) {
        const cJSON *old = json_index_find(&old_members, item->string),
                    *new = json_index_find(&new_members, item->string);
        json_add(told, item->string, told_of(old, new, item));
    }
    json_index_finish(&old_members);
    json_index_finish(&new_members);
    return told;
}

cJSON *patch_told(const cJSON *before, const cJSON *after, const cJSON *patch)
{
    size_t n_before = mem_n_refused();
    cJSON *told = told_of(before, after, patch);
    if (mem_n_refused() == n_before)
        return told;
    cJSON_Delete(told);
    return NULL;
}
