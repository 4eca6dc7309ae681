#pragma once
/* Look-ups by name in one JSON object, or by "id" in one list of objects, for callers with many names: cJSON compares a
 * name with member after member, so n look-ups by it take n^2 steps. Here names that come in the document's own order
 * are found in one step each, all others in log n. Thread: any. The document may only change as json_index_find says.
 */
#include "server/wire/json.h"

struct json_index_entry;

struct json_index {
    const cJSON *parent;              /* the object or list; borrowed, NULL: there is none */
    cJSON *next;                      /* the member behind the one found last */
    bool is_of_ids;                   /* elements by their "id", not members by their names */
    int n_walks;                      /* look-ups that walked the linked list so far */
    struct json_index_entry *entries; /* sorted by name; owned, NULL: not needed so far */
    size_t n_entries;
};

/* The members of object. NULL and other types have none. */
void json_index_init(struct json_index *index, const cJSON *object);
/* The elements of list that are objects with a text "id". */
void json_index_init_ids(struct json_index *index, const cJSON *list);
/* Finds the member of a name; NULL: none. With equal names it is any of them; fields_read refuses such documents. The
 * member that is returned may be taken out or replaced if its name stays in memory and is not looked up again. Appended
 * members may be missed. */
cJSON *json_index_find(struct json_index *index, const char *name);
void json_index_finish(struct json_index *index);

/* True if two members of object have one name, and where there is no memory to find out. */
bool json_has_equal_names(const cJSON *object);
