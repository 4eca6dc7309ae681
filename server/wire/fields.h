#pragma once
/* Structs from JSON and back, driven by the field tables that proto/gen writes: the tables are data, the checks are
 * here, once. Thread: any. */
#include <stddef.h>
#include <stdint.h>

#include "server/wire/json.h"

/* The C type at a field's offset in the struct, and its form in JSON. */
enum field_type {
    FIELD_BOOL,
    FIELD_NUMBER,    /* double */
    FIELD_INTEGER,   /* int64_t */
    FIELD_ENUM,      /* an enum of int's size: the index of the word */
    FIELD_COLOR,     /* uint32_t 0xrrggbb; "#rrggbb" */
    FIELD_ID,        /* char[64]; "" where it is not required */
    FIELD_TEXT,      /* char[text_bytes], UTF-8 without control characters */
    FIELD_VEC3,      /* struct vec3; three numbers */
    FIELD_DIRECTION, /* struct vec3 of any length but 0; three numbers */
    FIELD_SIZE,      /* int[2]; two whole numbers */
    FIELD_OBJECT,    /* the object's struct */
    FIELD_LIST,      /* pointer to structs, owned, and their count; a list of objects */
    FIELD_MAP,       /* pointer to entries, owned, and their count; an object of objects by id */
    FIELD_PATCH,     /* char *, owned, NULL: none; an object, kept as text */
    FIELD_JSON       /* cJSON *, owned; an object or a list, not looked into */
};

struct field_words {
    const char *const *words;
    size_t n;
};

/* A kind of part of a plan that a scene may name. */
struct field_reference {
    const char *word; /* "region" */
    const char *list; /* member of the plan document (plan_document.h) that lists what there is */
};

struct field_object;

struct field {
    const char *name;
    enum field_type type;
    size_t offset;
    bool is_nullable, is_required;
    bool has_flag; /* a bool has_<name> stands at has_offset */
    size_t has_offset;
    double min, max;                     /* of a number, of each of several; max: characters of a text */
    const struct field_words *words;     /* enum */
    const struct field_object *object;   /* object, and the elements of a list or map */
    const struct field_reference *names; /* id, and the keys of a map: what of the plan they name; NULL: nothing */
    bool is_removable;     /* map with names: an entry of the defaults may be absent; false: each is there */
    size_t max_items;      /* list, map */
    const char *ascending; /* list: the number of its object that no entry has less of than the one before; or NULL */
    size_t count_offset;   /* list, map: of a size_t */
    size_t entry_size, value_offset; /* list, map: of one entry; of the object in it. A map's entry begins with its
                                        id, char[64] */
    size_t text_bytes;               /* of a text: its size with the final zero */
};

struct field_object {
    const char *name;
    const struct field *fields;
    size_t n_fields; /* at most 64 */
    size_t size;     /* of the struct */
    const void *defaults;
};

/* Fills out (object->size bytes); fields that are absent or null get their defaults. Refuses unknown and duplicate
 * fields, wrong types, values out of range, over-long text, ids outside [a-z0-9-]{1,63}, more entries than max_items,
 * lists that are not in their order. On failure out owns nothing. skip, if given, names one member that is not a field
 * ("type" of a message). */
NODISCARD bool fields_read(const struct field_object *object, const cJSON *json, const char *skip, void *out,
                           struct problem *problem);
/* The whole document, every field, as a new object. NULL: no memory. */
NODISCARD cJSON *fields_write(const struct field_object *object, const void *in);
/* The default of one field as new JSON; NULL: the field is left out, or there is no memory. */
NODISCARD cJSON *field_write_default(const struct field_object *object, const struct field *field);
/* Frees what in owns: lists, maps, patches, json. */
void fields_finish(const struct field_object *object, void *in);
/* "[a-z0-9-]{1,63}" */
bool id_is_valid(const char *id);
