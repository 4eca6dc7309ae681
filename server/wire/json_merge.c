/* RFC 7396 and comparing, with look-ups by json_index: json_merge.h. */
#include "server/wire/json_merge.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/wire/json_index.h"

/* One member of a patch. */
struct change {
    const cJSON *item;
    size_t position;      /* in the patch */
    struct change *first; /* the first with the same name; of that one: */
    bool is_found;        /* its name was looked up in the target */
    cJSON *member;        /* of the target under that name by now, NULL: none */
};

enum { MAX_PAIRS = 8 }; /* up to so many members, equal names are found by comparing each with each */

static int compare_names(const void *a, const void *b)
{
    const struct change *x = *(struct change *const *)a, *y = *(struct change *const *)b;
    int order = strcmp(x->item->string, y->item->string);
    return order ? order : (x->position > y->position) - (x->position < y->position);
}

static void find_first_of_few(struct change *changes, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        changes[i].first = &changes[i];
        for (size_t before = 0; before < i; before++)
            if (strcmp(changes[before].item->string, changes[i].item->string) == 0) {
                changes[i].first = &changes[before];
                break;
            }
    }
}

/* False: no memory. */
static bool find_first(struct change *changes, size_t n)
{
    if (n <= MAX_PAIRS) {
        find_first_of_few(changes, n);
        return true;
    }
    struct change **sorted = mem_array(n, sizeof *sorted, UINT32_MAX, NULL);
    if (!sorted)
        return false;
    for (size_t i = 0; i < n; i++)
        sorted[i] = &changes[i];
    qsort(sorted, n, sizeof *sorted, compare_names);
    for (size_t i = 0; i < n; i++) {
        bool is_same = i > 0 && strcmp(sorted[i - 1]->item->string, sorted[i]->item->string) == 0;
        sorted[i]->first = is_same ? sorted[i - 1]->first : sorted[i];
    }
    free(sorted);
    return true;
}

static bool merge_into(cJSON *target, const cJSON *patch);

/* A new value as a patch gives it. NULL: no memory. */
static cJSON *value_of(const cJSON *patch)
{
    if (!cJSON_IsObject(patch))
        return cJSON_Duplicate(patch, true);
    cJSON *value = cJSON_CreateObject();
    if (value && merge_into(value, patch))
        return value;
    cJSON_Delete(value);
    return NULL;
}

/* Puts value in the place of member and gives it member's name. Takes both. */
static void replace(cJSON *target, cJSON *member, cJSON *value)
{
    if (!(value->type & cJSON_StringIsConst))
        cJSON_free(value->string);
    value->string = member->string;
    value->type = (value->type & 0xff) | (member->type & cJSON_StringIsConst);
    member->string = NULL;
    cJSON_ReplaceItemViaPointer(target, member, value);
}

/* Puts a new value under the name of the change, in the place of member if there is one. False: no memory. */
static bool put(cJSON *target, struct json_index *members, cJSON *member, struct change *change)
{
    cJSON *value = value_of(change->item);
    if (!value)
        return false;
    change->first->member = value;
    if (member) {
        if (members->next == member) /* a name that stands twice: the index must not read what is freed */
            members->next = value;
        replace(target, member, value);
    } else if (!cJSON_AddItemToObject(target, change->item->string, value)) {
        cJSON_Delete(value);
        return false;
    }
    return true;
}

/* Adds a member that was taken out of target to the list *removed. False: no memory. */
static bool apply_change(cJSON *target, struct json_index *members, struct change *change, cJSON **removed)
{
    struct change *first = change->first;
    const cJSON *item = change->item;
    if (!first->is_found)
        first->member = json_index_find(members, item->string);
    first->is_found = true;
    cJSON *member = first->member;
    if (cJSON_IsNull(item)) {
        first->member = NULL;
        if (member) {
            (void)cJSON_DetachItemViaPointer(target, member);
            member->next = *removed;
            *removed = member;
        }
        return true;
    }
    if (member && cJSON_IsObject(member) && cJSON_IsObject(item))
        return merge_into(member, item);
    return put(target, members, member, change);
}

/* Both are objects; target changes. False: no memory, target is changed in part. */
static bool merge_into(cJSON *target, const cJSON *patch)
{
    size_t n = (size_t)cJSON_GetArraySize(patch), at = 0;
    struct change few[MAX_PAIRS];
    struct change *changes = n <= MAX_PAIRS ? few : mem_array(n, sizeof *changes, UINT32_MAX, NULL);
    struct json_index members;
    cJSON *removed = NULL; /* freed at the end: the index still holds their names */
    if (!changes)
        return false;
    json_index_init(&members, target);
    for (const cJSON *item = patch->child; item; item = item->next, at++)
        changes[at] = (struct change){ .item = item, .position = at };
    bool ok = find_first(changes, n);
    for (size_t i = 0; ok && i < n; i++)
        ok = apply_change(target, &members, &changes[i], &removed);
    json_index_finish(&members);
    cJSON_Delete(removed); /* with those behind it */
    if (changes != few)
        free(changes);
    return ok;
}

cJSON *json_merge(const cJSON *target, const cJSON *patch)
{
    if (!cJSON_IsObject(patch) || !cJSON_IsObject(target))
        return value_of(patch);
    cJSON *merged = cJSON_Duplicate(target, true);
    if (merged && merge_into(merged, patch))
        return merged;
    cJSON_Delete(merged);
    return NULL;
}

static bool members_are_equal(const cJSON *a, const cJSON *b)
{
    if (cJSON_GetArraySize(a) != cJSON_GetArraySize(b))
        return false;
    struct json_index index;
    bool is_equal = true;
    json_index_init(&index, b);
    for (const cJSON *item = a->child; item && is_equal; item = item->next)
        is_equal = json_equal(item, json_index_find(&index, item->string));
    json_index_finish(&index);
    return is_equal;
}

static bool elements_are_equal(const cJSON *a, const cJSON *b)
{
    const cJSON *x = a->child, *y = b->child;
    for (; x && y; x = x->next, y = y->next)
        if (!json_equal(x, y))
            return false;
    return !x && !y;
}

bool json_equal(const cJSON *a, const cJSON *b)
{
    if (!a || !b || (a->type & 0xff) != (b->type & 0xff))
        return false;
    switch (a->type & 0xff) {
    case cJSON_False:
    case cJSON_True:
    case cJSON_NULL: return true;
    case cJSON_Number:
        return fabs(a->valuedouble - b->valuedouble) <= fmax(fabs(a->valuedouble), fabs(b->valuedouble)) * DBL_EPSILON;
    case cJSON_String:
    case cJSON_Raw: return strcmp(a->valuestring, b->valuestring) == 0;
    case cJSON_Array: return elements_are_equal(a, b);
    case cJSON_Object: return members_are_equal(a, b);
    default: return false;
    }
}
