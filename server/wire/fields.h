#pragma once
/* Structs from JSON and back, driven by the field tables that proto/gen makes. The tables are data; the checks are
 * here, once. */
#include <stddef.h>
#include <stdint.h>

#include "server/wire/json.h"

enum field_type {
    FIELD_BOOL,
    FIELD_NUMBER,
    FIELD_INTEGER,
    FIELD_ENUM,
    FIELD_COLOR,
    FIELD_ID,
    FIELD_TEXT,
    FIELD_VEC3,
    FIELD_SIZE,
    FIELD_OBJECT,
    FIELD_MAP,
    FIELD_PATCH,
    FIELD_JSON
};

struct field_words {
    const char *const *words;
    size_t n;
};

struct field_object;

struct field {
    const char *name;
    enum field_type type;
    size_t offset;
    bool is_nullable, is_required;
    bool has_flag; /* a bool has_<name> stands at has_offset */
    size_t has_offset;
    double min, max;
    const struct field_words *words;
    const struct field_object *object;                        /* object, map: of the (entry's) value */
    size_t max_items, count_offset, entry_size, value_offset; /* map */
    size_t text_bytes;                                        /* text: room with the final zero */
};

struct field_object {
    const char *name;
    const struct field *fields;
    size_t n_fields;
    size_t size;
    const void *defaults;
};

/* Fills out (object->size bytes), absent and null fields get their defaults. Refuses unknown and duplicate fields,
 * wrong types, values out of range, over-long text, ids outside [a-z0-9-]{1,63}. On failure out owns nothing. skip, if
 * given, names one member that is not a field ("type" of a message). */
NODISCARD bool fields_read(const struct field_object *object, const cJSON *json, const char *skip, void *out,
                           struct problem *problem);
/* The whole document, every field, as a new object. */
NODISCARD cJSON *fields_write(const struct field_object *object, const void *in);
/* Frees what in owns: maps, patches, json. */
void fields_finish(const struct field_object *object, void *in);
/* "[a-z0-9-]{1,63}" */
bool id_is_valid(const char *id);
