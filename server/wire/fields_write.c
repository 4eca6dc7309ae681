/* JSON from structs: fields_write of fields.h. */
#include <stdio.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/math/vec.h"
#include "server/wire/fields.h"

static cJSON *write_numbers(int n, const double *values)
{
    return cJSON_CreateDoubleArray(values, n);
}

/* Without memory for a part, that part is missing. */
static cJSON *write_object(const struct field_object *object, const void *in);

static cJSON *write_list(const struct field *field, const char *base)
{
    size_t n;
    const char *entries;
    memcpy(&n, base + field->count_offset, sizeof n);
    memcpy(&entries, base + field->offset, sizeof entries);
    cJSON *list = cJSON_CreateArray();
    for (size_t i = 0; i < n; i++)
        json_append(list, write_object(field->object, entries + i * field->entry_size + field->value_offset));
    return list;
}

static cJSON *write_map(const struct field *field, const char *base)
{
    size_t n;
    const char *entries;
    memcpy(&n, base + field->count_offset, sizeof n);
    memcpy(&entries, base + field->offset, sizeof entries);
    cJSON *map = cJSON_CreateObject();
    for (size_t i = 0; i < n; i++) {
        const char *entry = entries + i * field->entry_size;
        json_add(map, entry, write_object(field->object, entry + field->value_offset));
    }
    return map;
}

static cJSON *write_field(const struct field *field, const char *base)
{
    const char *at = base + field->offset;
    if (field->has_flag) {
        bool has;
        memcpy(&has, base + field->has_offset, sizeof has);
        if (!has)
            return cJSON_CreateNull();
    }
    switch (field->type) {
    case FIELD_BOOL: {
        bool flag;
        memcpy(&flag, at, sizeof flag);
        return cJSON_CreateBool(flag);
    }
    case FIELD_NUMBER: {
        double number;
        memcpy(&number, at, sizeof number);
        return cJSON_CreateNumber(number);
    }
    case FIELD_INTEGER: {
        int64_t integer;
        memcpy(&integer, at, sizeof integer);
        return cJSON_CreateNumber((double)integer);
    }
    case FIELD_ENUM: {
        int word;
        memcpy(&word, at, sizeof word);
        return cJSON_CreateString(word >= 0 && (size_t)word < field->words->n ? field->words->words[word] : "");
    }
    case FIELD_COLOR: {
        uint32_t rgb;
        char text[16];
        memcpy(&rgb, at, sizeof rgb);
        (void)snprintf(text, sizeof text, "#%06x", rgb & 0xffffff);
        return cJSON_CreateString(text);
    }
    case FIELD_ID:
    case FIELD_TEXT: return cJSON_CreateString(at);
    case FIELD_VEC3:
    case FIELD_DIRECTION: {
        struct vec3 vector;
        memcpy(&vector, at, sizeof vector);
        return write_numbers(3, (double[]){ vector.x, vector.y, vector.z });
    }
    case FIELD_SIZE: {
        int size[2];
        memcpy(size, at, sizeof size);
        return write_numbers(2, (double[]){ size[0], size[1] });
    }
    case FIELD_OBJECT: return write_object(field->object, at);
    case FIELD_LIST: return write_list(field, base);
    case FIELD_MAP: return write_map(field, base);
    case FIELD_PATCH: {
        char *text;
        memcpy(&text, at, sizeof text);
        return text ? cJSON_Parse(text) : NULL; /* none: the field is left out */
    }
    case FIELD_JSON: {
        cJSON *json;
        memcpy(&json, at, sizeof json);
        return json ? cJSON_Duplicate(json, true) : cJSON_CreateNull();
    }
    }
    return NULL;
}

static cJSON *write_object(const struct field_object *object, const void *in)
{
    cJSON *json = cJSON_CreateObject();
    for (size_t i = 0; i < object->n_fields; i++)
        json_add(json, object->fields[i].name, write_field(&object->fields[i], in));
    return json;
}

cJSON *fields_write(const struct field_object *object, const void *in)
{
    size_t before = mem_n_refused();
    cJSON *json = write_object(object, in);
    if (mem_n_refused() == before)
        return json;
    cJSON_Delete(json);
    return NULL;
}

cJSON *field_write_default(const struct field_object *object, const struct field *field)
{
    return write_field(field, object->defaults);
}
