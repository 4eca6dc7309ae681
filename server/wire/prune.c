/* One walk over field table and document, which removes and tells: prune.h. */
#include "server/wire/prune.h"

#include <stdio.h>
#include <string.h>

#include "server/wire/json_index.h"
#include "server/wire/json_pointer.h"

enum { MAX_KINDS = 8 }; /* of references in one description */

struct walk {
    const cJSON *plan;
    size_t n_kinds;
    const struct field_reference *kinds[MAX_KINDS];
    struct json_index lists[MAX_KINDS]; /* of the plan, by kind */
    const char *prefix;
    prune_told *told;
    void *context;
};

static bool plan_has(struct walk *walk, const struct field_reference *kind, const char *id)
{
    size_t i = 0;
    while (i < walk->n_kinds && walk->kinds[i] != kind)
        i++;
    if (i == MAX_KINDS)
        return true; /* the checks that follow refuse it */
    if (i == walk->n_kinds) {
        walk->kinds[walk->n_kinds++] = kind;
        json_index_init_ids(&walk->lists[i], cJSON_GetObjectItemCaseSensitive(walk->plan, kind->list));
    }
    return json_index_find(&walk->lists[i], id) != NULL;
}

static void tell(struct walk *walk, const struct json_pointer *at, const char *code, const char *detail)
{
    char pointer[JSON_POINTER_SIZE], whole[2 * JSON_POINTER_SIZE];
    json_pointer_write(at, pointer);
    (void)snprintf(whole, sizeof whole, "%.159s%s", walk->prefix, pointer);
    walk->told(walk->context, whole, code, detail);
}

/* True, and told, if the plan does not have the id. */
static bool is_unknown(struct walk *walk, const struct field *field, const char *id, const struct json_pointer *at)
{
    char detail[160];
    if (!field->names || !id || !id[0] || plan_has(walk, field->names, id))
        return false;
    (void)snprintf(detail, sizeof detail, "the plan has no %s \"%.63s\"", field->names->word, id);
    tell(walk, at, "unknown-id", detail);
    return true;
}

static void prune_object(struct walk *walk, const struct field_object *object, cJSON *json,
                         const struct json_pointer *at);

/* False when the value has to go. */
static bool prune_value(struct walk *walk, const struct field *field, cJSON *json, const struct json_pointer *at)
{
    if (field->type == FIELD_ID)
        return !is_unknown(walk, field, cJSON_GetStringValue(json), at);
    if (field->type == FIELD_OBJECT && cJSON_IsObject(json))
        prune_object(walk, field->object, json, at);
    if (!(field->type == FIELD_MAP && cJSON_IsObject(json)) && !(field->type == FIELD_LIST && cJSON_IsArray(json)))
        return true;
    size_t index = 0;
    for (cJSON *item = json->child, *following; item; item = following, index++) {
        following = item->next;
        struct json_pointer member = { at, item->string, index };
        if (field->type == FIELD_MAP && is_unknown(walk, field, item->string, &member))
            cJSON_Delete(cJSON_DetachItemViaPointer(json, item));
        else if (cJSON_IsObject(item))
            prune_object(walk, field->object, item, &member);
    }
    return true;
}

static const struct field *field_of_name(const struct field_object *object, const char *name)
{
    for (size_t i = 0; i < object->n_fields; i++)
        if (strcmp(object->fields[i].name, name) == 0)
            return &object->fields[i];
    return NULL;
}

static void prune_object(struct walk *walk, const struct field_object *object, cJSON *json,
                         const struct json_pointer *at)
{
    for (cJSON *item = json->child, *following; item; item = following) {
        following = item->next;
        struct json_pointer member = { at, item->string, 0 };
        const struct field *field = field_of_name(object, item->string);
        char detail[160];
        if (!field) {
            (void)snprintf(detail, sizeof detail, "this version does not know %.60s", item->string);
            tell(walk, &member, "unknown-field", detail);
        }
        if (!field || (!cJSON_IsNull(item) && !prune_value(walk, field, item, &member)))
            cJSON_Delete(cJSON_DetachItemViaPointer(json, item));
    }
}

void prune(const struct field_object *object, cJSON *json, const cJSON *plan, const char *prefix, prune_told *told,
           void *context)
{
    struct walk walk = { .plan = plan, .prefix = prefix, .told = told, .context = context };
    struct json_pointer top = { 0 };
    if (cJSON_IsObject(json))
        prune_object(&walk, object, json, &top);
    for (size_t i = 0; i < walk.n_kinds; i++)
        json_index_finish(&walk.lists[i]);
}

/* The next name of a pointer, unescaped; returns what follows it. */
static const char *next_name(const char *pointer, char *name, size_t size)
{
    size_t n = 0;
    for (pointer++; *pointer && *pointer != '/'; pointer++) {
        char c = *pointer;
        if (c == '~' && (pointer[1] == '0' || pointer[1] == '1'))
            c = *++pointer == '0' ? '~' : '/';
        if (n + 1 < size)
            name[n++] = c;
    }
    name[n] = 0;
    return pointer;
}

bool prune_at(cJSON *json, const char *pointer)
{
    char name[JSON_POINTER_SIZE];
    cJSON *parent = NULL, *at = json;
    while (*pointer == '/' && cJSON_IsObject(at)) {
        pointer = next_name(pointer, name, sizeof name);
        cJSON *member = cJSON_GetObjectItemCaseSensitive(at, name);
        if (!member)
            break;
        parent = at;
        at = member;
    }
    if (!parent)
        return false;
    cJSON_Delete(cJSON_DetachItemViaPointer(parent, at));
    return true;
}
