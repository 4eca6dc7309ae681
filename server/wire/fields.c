#include "server/wire/fields.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/math/vec.h"

struct place { /* where we are, for the pointer in a problem */
    char pointer[160];
};

static struct place inside(const struct place *outer, const char *name)
{
    struct place place = *outer;
    size_t used = strlen(place.pointer);
    if (used + 1 < sizeof place.pointer)
        place.pointer[used++] = '/';
    for (const char *c = name; *c && used + 2 < sizeof place.pointer; c++) { /* RFC 6901: ~ and / are escaped */
        if (*c == '~' || *c == '/') {
            place.pointer[used++] = '~';
            place.pointer[used++] = *c == '~' ? '0' : '1';
        } else {
            place.pointer[used++] = *c;
        }
    }
    place.pointer[used] = 0;
    return place;
}

static bool wrong_type(const struct place *place, const char *expected, struct problem *problem)
{
    return problem_set(problem, PROBLEM_VALIDATION, place->pointer, "type", "%s is not %s", place->pointer, expected);
}

bool id_is_valid(const char *id)
{
    size_t n = strlen(id);
    return n >= 1 && n <= 63 && strspn(id, "abcdefghijklmnopqrstuvwxyz0123456789-") == n;
}

static size_t code_points(const char *text)
{
    size_t n = 0;
    for (; *text; text++)
        n += ((unsigned char)*text & 0xc0) != 0x80;
    return n;
}

static bool read_number(const struct field *field, const cJSON *json, const struct place *place, double *value,
                        struct problem *problem)
{
    if (!cJSON_IsNumber(json))
        return wrong_type(place, "a number", problem);
    if (!(json->valuedouble >= field->min && json->valuedouble <= field->max))
        return problem_set(problem, PROBLEM_VALIDATION, place->pointer, "range", "%s is %g, expected %.17g to %.17g",
                           place->pointer, json->valuedouble, field->min, field->max);
    *value = json->valuedouble;
    return true;
}

static bool read_integer(const struct field *field, const cJSON *json, const struct place *place, int64_t *value,
                         struct problem *problem)
{
    double number;
    if (!read_number(field, json, place, &number, problem))
        return false;
    if (number != floor(number))
        return wrong_type(place, "a whole number", problem);
    *value = (int64_t)number;
    return true;
}

static bool read_word(const struct field *field, const cJSON *json, const struct place *place, int *value,
                      struct problem *problem)
{
    if (!cJSON_IsString(json))
        return wrong_type(place, "a word", problem);
    for (size_t i = 0; i < field->words->n; i++)
        if (strcmp(json->valuestring, field->words->words[i]) == 0) {
            *value = (int)i;
            return true;
        }
    char list[160] = "";
    for (size_t i = 0, used = 0; i < field->words->n && used < sizeof list; i++)
        used += (size_t)snprintf(list + used, sizeof list - used, "%s%s", i ? ", " : "", field->words->words[i]);
    return problem_set(problem, PROBLEM_VALIDATION, place->pointer, "enum", "%s is \"%.40s\", expected one of: %s",
                       place->pointer, json->valuestring, list);
}

static bool read_color(const cJSON *json, const struct place *place, uint32_t *rgb, struct problem *problem)
{
    if (!cJSON_IsString(json))
        return wrong_type(place, "a colour", problem);
    const char *text = json->valuestring;
    if (strlen(text) != 7 || text[0] != '#' || strspn(text + 1, "0123456789abcdefABCDEF") != 6)
        return problem_set(problem, PROBLEM_VALIDATION, place->pointer, "pattern", "%s is \"%.20s\", expected #rrggbb",
                           place->pointer, text);
    *rgb = (uint32_t)strtoul(text + 1, NULL, 16);
    return true;
}

static bool read_text(const struct field *field, const cJSON *json, const struct place *place, char *out,
                      struct problem *problem)
{
    if (!cJSON_IsString(json))
        return wrong_type(place, "text", problem);
    size_t n = strlen(json->valuestring), points = code_points(json->valuestring);
    if ((double)points > field->max || n >= field->text_bytes)
        return problem_set(problem, PROBLEM_VALIDATION, place->pointer, "length",
                           "%s has %zu characters, at most %g are allowed", place->pointer, points, field->max);
    for (const char *c = json->valuestring; *c; c++)
        if ((unsigned char)*c < 0x20 || *c == 0x7f)
            return problem_set(problem, PROBLEM_VALIDATION, place->pointer, "pattern", "%s holds a control character",
                               place->pointer);
    memcpy(out, json->valuestring, n + 1);
    return true;
}

static bool read_id(const struct field *field, const cJSON *json, const struct place *place, char *out,
                    struct problem *problem)
{
    if (!cJSON_IsString(json))
        return wrong_type(place, "an id", problem);
    bool may_be_empty = !field->is_required && json->valuestring[0] == 0;
    if (!may_be_empty && !id_is_valid(json->valuestring))
        return problem_set(problem, PROBLEM_VALIDATION, place->pointer, "pattern",
                           "%s is \"%.40s\", expected 1 to 63 of a-z, 0-9 and -", place->pointer, json->valuestring);
    memcpy(out, json->valuestring, strlen(json->valuestring) + 1);
    return true;
}

static bool read_numbers(const struct field *field, const cJSON *json, const struct place *place, int n, double *values,
                         struct problem *problem)
{
    if (!cJSON_IsArray(json) || cJSON_GetArraySize(json) != n)
        return wrong_type(place, n == 3 ? "three numbers" : "two numbers", problem);
    int at = 0;
    for (const cJSON *item = json->child; item; item = item->next, at++) {
        char index[4] = { (char)('0' + at), 0 };
        struct place element = inside(place, index);
        if (!read_number(field, item, &element, &values[at], problem))
            return false;
    }
    return true;
}

static bool read_object(const struct field_object *object, const cJSON *json, const char *skip,
                        const struct place *place, void *out, struct problem *problem);

static bool read_map(const struct field *field, const cJSON *json, const struct place *place, char *base,
                     struct problem *problem)
{
    if (!cJSON_IsObject(json))
        return wrong_type(place, "an object of ids", problem);
    size_t n = (size_t)cJSON_GetArraySize(json), at = 0;
    if (n > field->max_items)
        return problem_set(problem, PROBLEM_VALIDATION, place->pointer, "count",
                           "%s has %zu entries, at most %zu are allowed", place->pointer, n, field->max_items);
    char *entries = mem_new((n ? n : 1) * field->entry_size);
    for (const cJSON *item = json->child; item; item = item->next, at++) {
        struct place entry = inside(place, item->string);
        char *id = entries + at * field->entry_size;
        bool ok = id_is_valid(item->string) ||
                  problem_set(problem, PROBLEM_VALIDATION, entry.pointer, "pattern", "%s is not an id", entry.pointer);
        for (size_t other = 0; ok && other < at; other++)
            if (strcmp(entries + other * field->entry_size, item->string) == 0)
                ok = problem_set(problem, PROBLEM_VALIDATION, entry.pointer, "duplicate", "%s stands twice",
                                 entry.pointer);
        if (ok) {
            memcpy(id, item->string, strlen(item->string) + 1);
            ok = read_object(field->object, item, NULL, &entry, id + field->value_offset, problem);
        }
        if (!ok) { /* values of map entries own nothing */
            free(entries);
            return false;
        }
    }
    memcpy(base + field->offset, &entries, sizeof entries);
    memcpy(base + field->count_offset, &n, sizeof n);
    return true;
}

static bool read_field(const struct field *field, const cJSON *json, const struct place *place, char *base,
                       struct problem *problem)
{
    char *at = base + field->offset;
    double numbers[3];
    int64_t integer = 0;
    int word = 0;
    switch (field->type) {
    case FIELD_BOOL: {
        if (!cJSON_IsBool(json))
            return wrong_type(place, "true or false", problem);
        bool flag = cJSON_IsTrue(json);
        memcpy(at, &flag, sizeof flag);
        return true;
    }
    case FIELD_NUMBER: {
        double number;
        if (!read_number(field, json, place, &number, problem))
            return false;
        memcpy(at, &number, sizeof number);
        return true;
    }
    case FIELD_INTEGER:
        if (!read_integer(field, json, place, &integer, problem))
            return false;
        memcpy(at, &integer, sizeof integer);
        return true;
    case FIELD_ENUM:
        if (!read_word(field, json, place, &word, problem))
            return false;
        memcpy(at, &word, sizeof word);
        return true;
    case FIELD_COLOR: {
        uint32_t rgb = 0;
        if (!read_color(json, place, &rgb, problem))
            return false;
        memcpy(at, &rgb, sizeof rgb);
        return true;
    }
    case FIELD_ID: return read_id(field, json, place, at, problem);
    case FIELD_TEXT: return read_text(field, json, place, at, problem);
    case FIELD_VEC3: {
        if (!read_numbers(field, json, place, 3, numbers, problem))
            return false;
        struct vec3 vector = vec3(numbers[0], numbers[1], numbers[2]);
        memcpy(at, &vector, sizeof vector);
        return true;
    }
    case FIELD_SIZE: {
        if (!read_numbers(field, json, place, 2, numbers, problem))
            return false;
        if (numbers[0] != floor(numbers[0]) || numbers[1] != floor(numbers[1]))
            return wrong_type(place, "two whole numbers", problem);
        int size[2] = { (int)numbers[0], (int)numbers[1] };
        memcpy(at, size, sizeof size);
        return true;
    }
    case FIELD_OBJECT: return read_object(field->object, json, NULL, place, at, problem);
    case FIELD_MAP: return read_map(field, json, place, base, problem);
    case FIELD_PATCH: {
        if (!cJSON_IsObject(json))
            return wrong_type(place, "an object", problem);
        char *text = json_write(json);
        memcpy(at, &text, sizeof text);
        return true;
    }
    case FIELD_JSON: {
        if (!cJSON_IsObject(json) && !cJSON_IsArray(json))
            return wrong_type(place, "an object", problem);
        cJSON *copy = cJSON_Duplicate(json, true);
        memcpy(at, &copy, sizeof copy);
        return copy != NULL;
    }
    }
    return false;
}

static const struct field *find_field(const struct field_object *object, const char *name, size_t *index)
{
    for (size_t i = 0; i < object->n_fields; i++)
        if (strcmp(object->fields[i].name, name) == 0) {
            *index = i;
            return &object->fields[i];
        }
    return NULL;
}

static bool read_members(const struct field_object *object, const cJSON *json, const char *skip,
                         const struct place *place, char *base, struct problem *problem)
{
    uint64_t seen = 0;
    assert(object->n_fields <= 64);
    for (const cJSON *item = json->child; item; item = item->next) {
        size_t index = 0;
        if (skip && strcmp(item->string, skip) == 0)
            continue;
        struct place here = inside(place, item->string);
        const struct field *field = find_field(object, item->string, &index);
        if (!field)
            return problem_set(problem, PROBLEM_VALIDATION, here.pointer, "unknown-field", "%s is not a field of %s",
                               here.pointer, object->name);
        if (seen >> index & 1)
            return problem_set(problem, PROBLEM_VALIDATION, here.pointer, "duplicate", "%s stands twice", here.pointer);
        seen |= (uint64_t)1 << index;
        if (cJSON_IsNull(item)) {
            if (field->is_required)
                return problem_set(problem, PROBLEM_VALIDATION, here.pointer, "required", "%s must not be null",
                                   here.pointer);
            continue;
        }
        if (!read_field(field, item, &here, base, problem))
            return false;
        if (field->has_flag) {
            bool has = true;
            memcpy(base + field->has_offset, &has, sizeof has);
        }
    }
    for (size_t i = 0; i < object->n_fields; i++)
        if (object->fields[i].is_required && !(seen >> i & 1)) {
            struct place here = inside(place, object->fields[i].name);
            return problem_set(problem, PROBLEM_VALIDATION, here.pointer, "required", "%s is missing", here.pointer);
        }
    return true;
}

static bool read_object(const struct field_object *object, const cJSON *json, const char *skip,
                        const struct place *place, void *out, struct problem *problem)
{
    memcpy(out, object->defaults, object->size);
    if (!cJSON_IsObject(json))
        return wrong_type(place, "an object", problem);
    if (read_members(object, json, skip, place, out, problem))
        return true;
    fields_finish(object, out);
    return false;
}

bool fields_read(const struct field_object *object, const cJSON *json, const char *skip, void *out,
                 struct problem *problem)
{
    struct place top = { "" };
    return read_object(object, json, skip, &top, out, problem);
}

static cJSON *write_numbers(int n, const double *values)
{
    return cJSON_CreateDoubleArray(values, n);
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
    case FIELD_VEC3: {
        struct vec3 vector;
        memcpy(&vector, at, sizeof vector);
        return write_numbers(3, (double[]){ vector.x, vector.y, vector.z });
    }
    case FIELD_SIZE: {
        int size[2];
        memcpy(size, at, sizeof size);
        return write_numbers(2, (double[]){ size[0], size[1] });
    }
    case FIELD_OBJECT: return fields_write(field->object, at);
    case FIELD_MAP: {
        size_t n;
        char *entries;
        memcpy(&n, base + field->count_offset, sizeof n);
        memcpy(&entries, at, sizeof entries);
        cJSON *map = cJSON_CreateObject();
        for (size_t i = 0; i < n; i++) {
            const char *entry = entries + i * field->entry_size;
            cJSON_AddItemToObject(map, entry, fields_write(field->object, entry + field->value_offset));
        }
        return map;
    }
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

cJSON *fields_write(const struct field_object *object, const void *in)
{
    cJSON *json = cJSON_CreateObject();
    for (size_t i = 0; i < object->n_fields; i++) {
        cJSON *item = write_field(&object->fields[i], in);
        if (item)
            cJSON_AddItemToObject(json, object->fields[i].name, item);
    }
    return json;
}

void fields_finish(const struct field_object *object, void *in)
{
    char *base = in;
    for (size_t i = 0; i < object->n_fields; i++) {
        const struct field *field = &object->fields[i];
        void *owned = NULL, *none = NULL;
        switch (field->type) {
        case FIELD_OBJECT: fields_finish(field->object, base + field->offset); continue;
        case FIELD_MAP: memset(base + field->count_offset, 0, sizeof(size_t)); /* fall through */
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
