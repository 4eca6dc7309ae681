/* One walk over field table and document for ids that name something of the plan: references.h. */
#include "server/wire/references.h"

#include <assert.h>

#include "server/wire/json_index.h"
#include "server/wire/json_pointer.h"

enum { MAX_KINDS = 8 }; /* of references in one description */

/* One walk over a document. */
struct search {
    const cJSON *plan;
    size_t n_kinds;
    const struct field_reference *kinds[MAX_KINDS];
    struct json_index lists[MAX_KINDS]; /* of the plan, by kind */
    struct problem *problem;
};

static bool plan_has(struct search *search, const struct field_reference *kind, const char *id)
{
    size_t i = 0;
    while (i < search->n_kinds && search->kinds[i] != kind)
        i++;
    if (i == search->n_kinds) {
        assert(search->n_kinds < MAX_KINDS);
        search->kinds[search->n_kinds++] = kind;
        json_index_init_ids(&search->lists[i], cJSON_GetObjectItemCaseSensitive(search->plan, kind->list));
    }
    return json_index_find(&search->lists[i], id) != NULL;
}

static void search_finish(struct search *search)
{
    for (size_t i = 0; i < search->n_kinds; i++)
        json_index_finish(&search->lists[i]);
}

static bool is_unknown(struct search *search, const struct field *field, const char *id)
{
    return field->names && id && id[0] && !plan_has(search, field->names, id);
}

static bool refuse(struct search *search, const struct field *field, const struct json_pointer *at, const char *id)
{
    char pointer[JSON_POINTER_SIZE];
    json_pointer_write(at, pointer);
    return problem_set(search->problem, PROBLEM_VALIDATION, pointer, "unknown-id", "the plan has no %s \"%.63s\"",
                       field->names->word, id);
}

/* Whether a field of the object, or of an object in it, names something: elements of lists and maps need no look else.
 */
static bool names_something(const struct field_object *object)
{
    for (size_t i = 0; i < object->n_fields; i++)
        if (object->fields[i].names || (object->fields[i].object && names_something(object->fields[i].object)))
            return true;
    return false;
}

static bool check_object(struct search *search, const struct field_object *object, const cJSON *json,
                         const struct json_pointer *at);

static bool check_list(struct search *search, const struct field *field, const cJSON *json,
                       const struct json_pointer *at)
{
    size_t index = 0;
    if (!names_something(field->object))
        return true;
    for (const cJSON *item = json->child; item; item = item->next) {
        struct json_pointer element = { at, NULL, index++ };
        if (!check_object(search, field->object, item, &element))
            return false;
    }
    return true;
}

static bool check_map(struct search *search, const struct field *field, const cJSON *json,
                      const struct json_pointer *at)
{
    bool goes_on = names_something(field->object);
    if (!field->names && !goes_on)
        return true;
    for (const cJSON *item = json->child; item; item = item->next) {
        struct json_pointer member = { at, item->string, 0 };
        if (is_unknown(search, field, item->string))
            return refuse(search, field, &member, item->string);
        if (goes_on && !check_object(search, field->object, item, &member))
            return false;
    }
    return true;
}

static bool check_field(struct search *search, const struct field *field, const cJSON *json,
                        const struct json_pointer *at)
{
    const char *id = cJSON_GetStringValue(json);
    switch (field->type) {
    case FIELD_ID: return !is_unknown(search, field, id) || refuse(search, field, at, id);
    case FIELD_OBJECT: return check_object(search, field->object, json, at);
    case FIELD_LIST: return check_list(search, field, json, at);
    case FIELD_MAP: return check_map(search, field, json, at);
    default: return true;
    }
}

static bool check_object(struct search *search, const struct field_object *object, const cJSON *json,
                         const struct json_pointer *at)
{
    for (size_t i = 0; i < object->n_fields; i++) {
        const struct field *field = &object->fields[i];
        const cJSON *value = cJSON_GetObjectItemCaseSensitive(json, field->name);
        if (!value || cJSON_IsNull(value))
            continue;
        struct json_pointer member = { at, field->name, 0 };
        if (!check_field(search, field, value, &member))
            return false;
    }
    return true;
}

bool references_check(const struct field_object *object, const cJSON *json, const cJSON *plan, struct problem *problem)
{
    struct search search = { .plan = plan, .problem = problem };
    struct json_pointer top = { 0 };
    bool ok = check_object(&search, object, json, &top);
    search_finish(&search);
    return ok;
}

static bool remove_in_object(struct search *search, const struct field_object *object, cJSON *json);

/* False when the field itself has to go. */
static bool remove_in_field(struct search *search, const struct field *field, cJSON *json)
{
    if (field->type == FIELD_ID)
        return !is_unknown(search, field, cJSON_GetStringValue(json));
    if (field->type == FIELD_OBJECT)
        return remove_in_object(search, field->object, json);
    if (field->type != FIELD_MAP && field->type != FIELD_LIST)
        return true;
    for (cJSON *item = json->child, *following; item; item = following) {
        following = item->next;
        bool is_gone = field->type == FIELD_MAP && is_unknown(search, field, item->string);
        if (is_gone || !remove_in_object(search, field->object, item))
            cJSON_Delete(cJSON_DetachItemViaPointer(json, item));
    }
    return true;
}

/* False when a required field of the object had to go. */
static bool remove_in_object(struct search *search, const struct field_object *object, cJSON *json)
{
    bool is_whole = true;
    for (size_t i = 0; i < object->n_fields; i++) {
        const struct field *field = &object->fields[i];
        cJSON *value = cJSON_GetObjectItemCaseSensitive(json, field->name);
        if (!value || remove_in_field(search, field, value))
            continue;
        cJSON_Delete(cJSON_DetachItemViaPointer(json, value));
        is_whole = is_whole && !field->is_required;
    }
    return is_whole;
}

void references_remove(const struct field_object *object, cJSON *json, const cJSON *plan)
{
    struct search search = { .plan = plan };
    (void)remove_in_object(&search, object, json);
    search_finish(&search);
}
