/* A cursor in document order, then a sorted array: json_index.h. */
#include "server/wire/json_index.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

struct json_index_entry {
    const char *name; /* borrowed */
    cJSON *item;
};

enum { MAX_WALKS = 8, FEW = 8 }; /* beyond about so many walks, or members to compare in pairs, sorting pays */

void json_index_init(struct json_index *index, const cJSON *object)
{
    bool is_object = cJSON_IsObject(object);
    *index = (struct json_index){ .parent = is_object ? object : NULL, .next = is_object ? object->child : NULL };
}

void json_index_init_ids(struct json_index *index, const cJSON *list)
{
    bool is_list = cJSON_IsArray(list);
    *index =
        (struct json_index){ .parent = is_list ? list : NULL, .next = is_list ? list->child : NULL, .is_of_ids = true };
}

static const char *name_of(const struct json_index *index, const cJSON *item)
{
    return index->is_of_ids ? json_text(item, "id") : item->string;
}

static int compare(const void *a, const void *b)
{
    return strcmp(((const struct json_index_entry *)a)->name, ((const struct json_index_entry *)b)->name);
}

/* Sorts the members by name. False: there is no memory for it. */
static bool sort(struct json_index *index)
{
    index->entries = mem_array((size_t)cJSON_GetArraySize(index->parent), sizeof *index->entries, UINT32_MAX, NULL);
    if (!index->entries)
        return false;
    for (cJSON *item = index->parent->child; item; item = item->next) {
        const char *name = name_of(index, item);
        if (name)
            index->entries[index->n_entries++] = (struct json_index_entry){ name, item };
    }
    qsort(index->entries, index->n_entries, sizeof *index->entries, compare);
    return true;
}

static cJSON *walk(struct json_index *index, const char *name)
{
    index->n_walks++;
    for (cJSON *item = index->parent->child; item; item = item->next) {
        const char *item_name = name_of(index, item);
        if (item_name && strcmp(item_name, name) == 0)
            return item;
    }
    return NULL;
}

static cJSON *search(struct json_index *index, const char *name)
{
    if (!index->entries && !sort(index))
        return walk(index, name);
    struct json_index_entry key = { name, NULL };
    struct json_index_entry *entry = bsearch(&key, index->entries, index->n_entries, sizeof key, compare);
    return entry ? entry->item : NULL;
}

cJSON *json_index_find(struct json_index *index, const char *name)
{
    if (!index->parent)
        return NULL;
    cJSON *found = index->next;
    const char *found_name = found ? name_of(index, found) : NULL;
    if (!found_name || strcmp(found_name, name) != 0)
        found = index->entries || index->n_walks >= MAX_WALKS ? search(index, name) : walk(index, name);
    if (found)
        index->next = found->next;
    return found;
}

void json_index_finish(struct json_index *index)
{
    free(index->entries);
    *index = (struct json_index){ 0 };
}

bool json_has_equal_names(const cJSON *object)
{
    struct json_index index;
    bool has_some = false;
    int n = 0;
    for (const cJSON *item = object->child; item && n <= FEW; item = item->next, n++)
        for (const cJSON *before = object->child; before != item; before = before->next)
            if (strcmp(before->string, item->string) == 0)
                return true;
    if (n <= FEW)
        return false;
    json_index_init(&index, object);
    if (!sort(&index))
        return true;
    for (size_t i = 1; i < index.n_entries && !has_some; i++)
        has_some = strcmp(index.entries[i - 1].name, index.entries[i].name) == 0;
    json_index_finish(&index);
    return has_some;
}
