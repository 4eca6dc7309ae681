/* Frees the fields that a struct owns by its table, and checks ids: fields.h. Reading and writing have files of their
 * own. */
#include "server/wire/fields.h"

#include <stdlib.h>
#include <string.h>

bool id_is_valid(const char *id)
{
    size_t n = strlen(id);
    return n >= 1 && n <= 63 && strspn(id, "abcdefghijklmnopqrstuvwxyz0123456789-") == n;
}

static void finish_entries(const struct field *field, char *base)
{
    size_t n;
    char *entries;
    memcpy(&n, base + field->count_offset, sizeof n);
    memcpy(&entries, base + field->offset, sizeof entries);
    for (size_t i = 0; i < n; i++)
        fields_finish(field->object, entries + i * field->entry_size + field->value_offset);
    memset(base + field->count_offset, 0, sizeof n);
}

void fields_finish(const struct field_object *object, void *in)
{
    char *base = in;
    for (size_t i = 0; i < object->n_fields; i++) {
        const struct field *field = &object->fields[i];
        void *owned = NULL, *none = NULL;
        switch (field->type) {
        case FIELD_OBJECT: fields_finish(field->object, base + field->offset); continue;
        case FIELD_LIST:
        case FIELD_MAP: finish_entries(field, base); break;
        case FIELD_PATCH:
        case FIELD_JSON: break;
        default: continue;
        }
        memcpy(&owned, base + field->offset, sizeof owned);
        memcpy(base + field->offset, &none, sizeof none);
        if (field->type == FIELD_JSON)
            cJSON_Delete(owned);
        else
            free(owned);
    }
}
