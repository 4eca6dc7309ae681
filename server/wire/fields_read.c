/* Structs from JSON, checked: fields_read of fields.h. */
#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/math/vec.h"
#include "server/wire/fields.h"
#include "server/wire/json_index.h"
#include "server/wire/json_pointer.h"

static const double least_direction = 1e-9; /* a shorter vector has no direction */

/* Fills problem and returns false. The sentence begins with the pointer: "/regions/brain is not an object". */
static bool refuse(const struct json_pointer *where, const char *code, struct problem *problem, const char *format, ...)
    PRINTF_LIKE(4, 5);

static bool refuse(const struct json_pointer *where, const char *code, struct problem *problem, const char *format, ...)
{
    char pointer[JSON_POINTER_SIZE], words[sizeof problem->detail];
    va_list args;
    va_start(args, format);
    (void)vsnprintf(words, sizeof words, format, args);
    va_end(args);
    json_pointer_write(where, pointer);
    (void)problem_set(problem, PROBLEM_VALIDATION, pointer, code, "%s %s", pointer, words);
    if (!problem)
        return false;
    va_start(args, format);
    sentence_describe_of(&problem->facts, pointer, format, args);
    va_end(args);
    return false;
}

static bool wrong_type(const struct json_pointer *where, const char *expected, struct problem *problem)
{
    return refuse(where, "type", problem, "is not %s", expected);
}

static size_t code_points(const char *text)
{
    size_t n = 0;
    for (; *text; text++)
        n += ((unsigned char)*text & 0xc0) != 0x80;
    return n;
}

static bool read_number(const struct field *field, const cJSON *json, const struct json_pointer *where, double *value,
                        struct problem *problem)
{
    if (!cJSON_IsNumber(json))
        return wrong_type(where, "a number", problem);
    if (!(json->valuedouble >= field->min && json->valuedouble <= field->max))
        return refuse(where, "range", problem, "is %g, expected %.17g to %.17g", json->valuedouble, field->min,
                      field->max);
    *value = json->valuedouble;
    return true;
}

static bool read_integer(const struct field *field, const cJSON *json, const struct json_pointer *where, int64_t *value,
                         struct problem *problem)
{
    double number;
    if (!read_number(field, json, where, &number, problem))
        return false;
    if (number != floor(number))
        return wrong_type(where, "a whole number", problem);
    *value = (int64_t)number;
    return true;
}

static bool read_word(const struct field *field, const cJSON *json, const struct json_pointer *where, int *value,
                      struct problem *problem)
{
    if (!cJSON_IsString(json))
        return wrong_type(where, "a word", problem);
    for (size_t i = 0; i < field->words->n; i++)
        if (strcmp(json->valuestring, field->words->words[i]) == 0) {
            *value = (int)i;
            return true;
        }
    char list[160] = "";
    for (size_t i = 0, used = 0; i < field->words->n && used < sizeof list; i++)
        used += (size_t)snprintf(list + used, sizeof list - used, "%s%s", i ? ", " : "", field->words->words[i]);
    return refuse(where, "enum", problem, "is \"%.40s\", expected one of: %s", json->valuestring, list);
}

static bool read_color(const cJSON *json, const struct json_pointer *where, uint32_t *rgb, struct problem *problem)
{
    if (!cJSON_IsString(json))
        return wrong_type(where, "a colour", problem);
    const char *text = json->valuestring;
    if (strlen(text) != 7 || text[0] != '#' || strspn(text + 1, "0123456789abcdefABCDEF") != 6)
        return refuse(where, "pattern", problem, "is \"%.20s\", expected #rrggbb", text);
    *rgb = (uint32_t)strtoul(text + 1, NULL, 16);
    return true;
}

static bool read_text(const struct field *field, const cJSON *json, const struct json_pointer *where, char *out,
                      struct problem *problem)
{
    if (!cJSON_IsString(json))
        return wrong_type(where, "text", problem);
    size_t n = strlen(json->valuestring), points = code_points(json->valuestring);
    if ((double)points > field->max || n >= field->text_bytes)
        return refuse(where, "length", problem, "has %zu characters, at most %g are allowed", points, field->max);
    for (const char *c = json->valuestring; *c; c++)
        if ((unsigned char)*c < 0x20 || *c == 0x7f)
            return refuse(where, "pattern", problem, "holds a control character");
    memcpy(out, json->valuestring, n + 1);
    return true;
}

static bool read_id(const struct field *field, const cJSON *json, const struct json_pointer *where, char *out,
                    struct problem *problem)
{
    if (!cJSON_IsString(json))
        return wrong_type(where, "an id", problem);
    bool may_be_empty = !field->is_required && json->valuestring[0] == 0;
    if (!may_be_empty && !id_is_valid(json->valuestring))
        return refuse(where, "pattern", problem, "is \"%.40s\", expected 1 to 63 of a-z, 0-9 and -", json->valuestring);
    memcpy(out, json->valuestring, strlen(json->valuestring) + 1);
    return true;
}

static bool read_numbers(const struct field *field, const cJSON *json, const struct json_pointer *where, int n,
                         double *values, struct problem *problem)
{
    if (!cJSON_IsArray(json) || cJSON_GetArraySize(json) != n)
        return wrong_type(where, n == 3 ? "three numbers" : "two numbers", problem);
    size_t at = 0;
    for (const cJSON *item = json->child; item; item = item->next, at++) {
        struct json_pointer element = { where, NULL, at };
        if (!read_number(field, item, &element, &values[at], problem))
            return false;
    }
    return true;
}

static bool read_vector(const struct field *field, const cJSON *json, const struct json_pointer *where, char *out,
                        struct problem *problem)
{
    double numbers[3];
    if (!read_numbers(field, json, where, 3, numbers, problem))
        return false;
    struct vec3 vector = vec3(numbers[0], numbers[1], numbers[2]);
    if (field->type == FIELD_DIRECTION && !(vec3_length(vector) > least_direction))
        return refuse(where, "range", problem, "has no length, expected a direction");
    memcpy(out, &vector, sizeof vector);
    return true;
}

static bool read_size(const struct field *field, const cJSON *json, const struct json_pointer *where, char *out,
                      struct problem *problem)
{
    double numbers[2];
    if (!read_numbers(field, json, where, 2, numbers, problem))
        return false;
    if (numbers[0] != floor(numbers[0]) || numbers[1] != floor(numbers[1]))
        return wrong_type(where, "two whole numbers", problem);
    int size[2] = { (int)numbers[0], (int)numbers[1] };
    memcpy(out, size, sizeof size);
    return true;
}

static bool read_object(const struct field_object *object, const cJSON *json, const char *skip,
                        const struct json_pointer *where, void *out, struct problem *problem);

/* The entries of a list or map that were read so far become those of the struct at base. */
static void set_entries(const struct field *field, char *base, char *entries, size_t n)
{
    memcpy(base + field->offset, &entries, sizeof entries);
    memcpy(base + field->count_offset, &n, sizeof n);
}

/* Memory for the *n entries of a list or map. NULL with problem: more than allowed, or no memory. */
static char *new_entries(const struct field *field, const cJSON *json, const struct json_pointer *where, size_t *n,
                         struct problem *problem)
{
    struct error err = { 0 };
    *n = (size_t)cJSON_GetArraySize(json);
    if (*n > field->max_items) {
        (void)refuse(where, "count", problem, "has %zu entries, at most %zu are allowed", *n, field->max_items);
        return NULL;
    }
    char *entries = mem_array(*n ? *n : 1, field->entry_size, UINT32_MAX, &err);
    if (!entries)
        problem_from_error(problem, &err);
    return entries;
}

/* Refuses a list whose entries are not in the order that the field asks for. */
static bool check_order(const struct field *field, const char *entries, size_t n, const struct json_pointer *where,
                        struct problem *problem)
{
    size_t number = 0;
    while (strcmp(field->object->fields[number].name, field->ascending) != 0)
        number++;
    size_t offset = field->object->fields[number].offset;
    for (size_t i = 1; i < n; i++) {
        double before, value;
        memcpy(&before, entries + (i - 1) * field->entry_size + offset, sizeof before);
        memcpy(&value, entries + i * field->entry_size + offset, sizeof value);
        if (value < before)
            return refuse(where, "order", problem, "is not in ascending order of %s: %g stands after %g",
                          field->ascending, value, before);
    }
    return true;
}

static bool read_list(const struct field *field, const cJSON *json, const struct json_pointer *where, char *base,
                      struct problem *problem)
{
    if (!cJSON_IsArray(json))
        return wrong_type(where, "a list", problem);
    size_t n, at = 0;
    char *entries = new_entries(field, json, where, &n, problem);
    if (!entries)
        return false;
    for (const cJSON *item = json->child; item; item = item->next, at++) {
        struct json_pointer element = { where, NULL, at };
        if (!read_object(field->object, item, NULL, &element, entries + at * field->entry_size, problem)) {
            set_entries(field, base, entries, at); /* freed with the rest of the struct */
            return false;
        }
    }
    set_entries(field, base, entries, n);
    return !field->ascending || check_order(field, entries, n, where, problem);
}

/* True if a member before this one has its name. */
static bool stands_before(const cJSON *json, const cJSON *member)
{
    for (const cJSON *item = json->child; item != member; item = item->next)
        if (strcmp(item->string, member->string) == 0)
            return true;
    return false;
}

static bool read_map(const struct field *field, const cJSON *json, const struct json_pointer *where, char *base,
                     struct problem *problem)
{
    if (!cJSON_IsObject(json))
        return wrong_type(where, "an object of ids", problem);
    size_t n, at = 0;
    char *entries = new_entries(field, json, where, &n, problem);
    if (!entries)
        return false;
    bool may_repeat = json_has_equal_names(json), ok = true;
    for (const cJSON *item = json->child; item; item = item->next, at++) {
        struct json_pointer member = { where, item->string, 0 };
        char *entry = entries + at * field->entry_size;
        ok = id_is_valid(item->string) || refuse(&member, "pattern", problem, "is not an id");
        if (ok && may_repeat && stands_before(json, item))
            ok = refuse(&member, "duplicate", problem, "stands twice");
        if (ok) {
            memcpy(entry, item->string, strlen(item->string) + 1);
            ok = read_object(field->object, item, NULL, &member, entry + field->value_offset, problem);
        }
        if (!ok)
            break;
    }
    set_entries(field, base, entries, at); /* on failure freed with the rest of the struct */
    return ok;
}

static bool read_field(const struct field *field, const cJSON *json, const struct json_pointer *where, char *base,
                       struct problem *problem)
{
    char *at = base + field->offset;
    switch (field->type) {
    case FIELD_BOOL: {
        if (!cJSON_IsBool(json))
            return wrong_type(where, "true or false", problem);
        bool flag = cJSON_IsTrue(json);
        memcpy(at, &flag, sizeof flag);
        return true;
    }
    case FIELD_NUMBER: {
        double number;
        if (!read_number(field, json, where, &number, problem))
            return false;
        memcpy(at, &number, sizeof number);
        return true;
    }
    case FIELD_INTEGER: {
        int64_t integer = 0;
        if (!read_integer(field, json, where, &integer, problem))
            return false;
        memcpy(at, &integer, sizeof integer);
        return true;
    }
    case FIELD_ENUM: {
        int word = 0;
        if (!read_word(field, json, where, &word, problem))
            return false;
        memcpy(at, &word, sizeof word);
        return true;
    }
    case FIELD_COLOR: {
        uint32_t rgb = 0;
        if (!read_color(json, where, &rgb, problem))
            return false;
        memcpy(at, &rgb, sizeof rgb);
        return true;
    }
    case FIELD_ID: return read_id(field, json, where, at, problem);
    case FIELD_TEXT: return read_text(field, json, where, at, problem);
    case FIELD_VEC3:
    case FIELD_DIRECTION: return read_vector(field, json, where, at, problem);
    case FIELD_SIZE: return read_size(field, json, where, at, problem);
    case FIELD_OBJECT: return read_object(field->object, json, NULL, where, at, problem);
    case FIELD_LIST: return read_list(field, json, where, base, problem);
    case FIELD_MAP: return read_map(field, json, where, base, problem);
    case FIELD_PATCH: {
        if (!cJSON_IsObject(json))
            return wrong_type(where, "an object", problem);
        char *text = json_print(json);
        memcpy(at, &text, sizeof text);
        return text || json_no_memory(problem, "a patch");
    }
    case FIELD_JSON: {
        if (!cJSON_IsObject(json) && !cJSON_IsArray(json))
            return wrong_type(where, "an object", problem);
        cJSON *copy = cJSON_Duplicate(json, true);
        memcpy(at, &copy, sizeof copy);
        return copy || json_no_memory(problem, "a part of a document");
    }
    }
    return false;
}

/* Index of the field of this name; n_fields: there is none. Documents mostly have their fields in the table's order, so
 * the search begins at start. */
static size_t find_field(const struct field_object *object, const char *name, size_t start)
{
    for (size_t n = 0; n < object->n_fields; n++) {
        size_t i = (start + n) % object->n_fields;
        if (strcmp(object->fields[i].name, name) == 0)
            return i;
    }
    return object->n_fields;
}

/* seen: a bit for each field that was read. next: the field that is expected. */
static bool read_member(const struct field_object *object, const cJSON *item, const struct json_pointer *where,
                        uint64_t *seen, size_t *next, char *base, struct problem *problem)
{
    size_t index = find_field(object, item->string, *next);
    if (index == object->n_fields)
        return refuse(where, "unknown-field", problem, "is not a field of %s", object->name);
    if (*seen >> index & 1)
        return refuse(where, "duplicate", problem, "stands twice");
    const struct field *field = &object->fields[index];
    *seen |= (uint64_t)1 << index;
    *next = index + 1;
    if (cJSON_IsNull(item))
        return !field->is_required || refuse(where, "required", problem, "must not be null");
    if (!read_field(field, item, where, base, problem))
        return false;
    if (field->has_flag) {
        bool has = true;
        memcpy(base + field->has_offset, &has, sizeof has);
    }
    return true;
}

static bool read_members(const struct field_object *object, const cJSON *json, const char *skip,
                         const struct json_pointer *where, char *base, struct problem *problem)
{
    uint64_t seen = 0;
    size_t next = 0;
    assert(object->n_fields <= 64);
    for (const cJSON *item = json->child; item; item = item->next) {
        struct json_pointer member = { where, item->string, 0 };
        if (skip && strcmp(item->string, skip) == 0)
            continue;
        if (!read_member(object, item, &member, &seen, &next, base, problem))
            return false;
    }
    for (size_t i = 0; i < object->n_fields; i++)
        if (object->fields[i].is_required && !(seen >> i & 1)) {
            struct json_pointer member = { where, object->fields[i].name, 0 };
            return refuse(&member, "required", problem, "is missing");
        }
    return true;
}

static bool read_object(const struct field_object *object, const cJSON *json, const char *skip,
                        const struct json_pointer *where, void *out, struct problem *problem)
{
    memcpy(out, object->defaults, object->size);
    if (!cJSON_IsObject(json))
        return wrong_type(where, "an object", problem);
    if (read_members(object, json, skip, where, out, problem))
        return true;
    fields_finish(object, out);
    return false;
}

bool fields_read(const struct field_object *object, const cJSON *json, const char *skip, void *out,
                 struct problem *problem)
{
    struct json_pointer top = { 0 };
    return read_object(object, json, skip, &top, out, problem);
}
