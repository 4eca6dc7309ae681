/* Reads the values of JSON objects of a plan's folder. */
#include "core/formats/plan/plan_json_place.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/beam/beam.h"
#include "core/formats/text.h"

/* cJSON does not tell a text that is no JSON from a lack of memory. Before main: no other thread uses it yet. */
__attribute__((constructor)) static void count_failures(void)
{
    cJSON_InitHooks(&(cJSON_Hooks){ mem_counted, free });
}

struct json_place place_at(const struct json_place *up, const char *list, int index)
{
    struct json_place place = { .file = up->file, .report = up->report, .err = up->err };
    snprintf(place.path, sizeof place.path, "%.60s%s%.30s[%d]", up->path, up->path[0] ? "." : "", list, index);
    return place;
}

bool place_fail(const struct json_place *place, enum error_code code, const char *key, const char *what)
{
    return error_set(place->err, code, "%s: %s%s%s: %s", place->file, place->path, place->path[0] && key[0] ? "." : "",
                     key, what);
}

cJSON *place_document(const uint8_t *data, size_t size, const char *file, struct error *err)
{
    const char *stopped = NULL;
    if (size >= 3 && memcmp(data, "\xef\xbb\xbf", 3) == 0) {
        data += 3;
        size -= 3;
    }
    size_t n_lacked = error_n_memory();
    cJSON *root = cJSON_ParseWithLengthOpts((const char *)data, size, &stopped, false);
    if (!root && error_n_memory() != n_lacked) {
        error_set(err, ERROR_MEMORY, "%s: no memory to read %zu bytes of JSON", file, size);
        return NULL;
    }
    if (!root) {
        size_t line = 1;
        for (const char *c = (const char *)data; stopped && c < stopped; c++)
            line += *c == '\n';
        error_set(err, ERROR_FORMAT, "%s: line %zu: not valid JSON", file, line);
        return NULL;
    }
    if (!cJSON_IsObject(root)) {
        error_set(err, ERROR_FORMAT, "%s: expected an object, {...}", file);
        cJSON_Delete(root);
        return NULL;
    }
    return root;
}

bool place_text(const struct json_place *place, const cJSON *object, const char *key, char *out, size_t size)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);
    out[0] = 0;
    if (!item || cJSON_IsNull(item))
        return true;
    if (!cJSON_IsString(item))
        return place_fail(place, ERROR_FORMAT, key, "expected a text");
    text_clean(item->valuestring, out, size);
    return true;
}

/* Refuses a path that is too long: cut short it would name another file. */
bool place_path(const struct json_place *place, const cJSON *object, const char *key, bool is_required,
                char out[FOLDER_NAME_SIZE])
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);
    out[0] = 0;
    if (!item && !is_required)
        return true;
    if (!cJSON_IsString(item))
        return place_fail(place, ERROR_FORMAT, key, item ? "expected a text" : "is missing");
    char clean[FOLDER_NAME_SIZE];
    text_clean(item->valuestring, clean, sizeof clean);
    if (strlen(item->valuestring) < sizeof clean && strcmp(item->valuestring, clean) != 0)
        return place_fail(place, ERROR_RANGE, key, "a path must be UTF-8 without control characters");
    if (!folder_check_name(item->valuestring, place->err)) {
        if (place->err)
            error_prefix(place->err, "%s: %s.%s", place->file, place->path, key);
        return false;
    }
    memcpy(out, item->valuestring, strlen(item->valuestring) + 1);
    return true;
}

bool place_bool(const struct json_place *place, const cJSON *object, const char *key, bool *out)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);
    *out = false;
    if (!item)
        return true;
    if (!cJSON_IsBool(item))
        return place_fail(place, ERROR_FORMAT, key, "expected true or false");
    *out = cJSON_IsTrue(item);
    return true;
}

bool place_point(const struct json_place *place, const cJSON *object, const char *key, struct vec3 *out)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);
    double v[3] = { 0 };
    if (!cJSON_IsArray(item) || cJSON_GetArraySize(item) != 3)
        return place_fail(place, ERROR_FORMAT, key, "expected three numbers, millimetres");
    for (int i = 0; i < 3; i++) {
        const cJSON *number = cJSON_GetArrayItem(item, i);
        if (!cJSON_IsNumber(number) || !(fabs(number->valuedouble) <= BEAM_MAX_PLACE_MM))
            return place_fail(place, ERROR_RANGE, key, "expected three numbers of at most 1000000 mm");
        v[i] = number->valuedouble;
    }
    *out = vec3(v[0], v[1], v[2]);
    return true;
}

bool place_list(const struct json_place *place, const cJSON *object, const char *key, size_t most, const cJSON **list)
{
    *list = cJSON_GetObjectItemCaseSensitive(object, key);
    if (!*list)
        return true;
    if (!cJSON_IsArray(*list))
        return place_fail(place, ERROR_FORMAT, key, "expected a list, [...]");
    if ((size_t)cJSON_GetArraySize(*list) > most) {
        char what[64];
        snprintf(what, sizeof what, "%d entries; at most %zu are read", cJSON_GetArraySize(*list), most);
        return place_fail(place, ERROR_LIMIT, key, what);
    }
    for (const cJSON *entry = (*list)->child; entry; entry = entry->next)
        if (!cJSON_IsObject(entry))
            return place_fail(place, ERROR_FORMAT, key, "every entry must be an object, {...}");
    return true;
}

void place_note_keys(const struct json_place *place, const cJSON *object, const char *const *known)
{
    for (const cJSON *item = object->child; item; item = item->next) {
        bool is_known = false;
        for (size_t i = 0; known[i]; i++)
            is_known |= strcmp(item->string, known[i]) == 0;
        char key[64];
        text_clean(item->string, key, sizeof key);
        if (!is_known)
            report_add(place->report, REPORT_NOTE, "plan.unknown-key", place->file,
                       "%s%s%s is not a key that is known; it was ignored.", place->path, place->path[0] ? "." : "",
                       key);
    }
}

bool place_color(const struct json_place *place, const cJSON *object, bool *has_color, uint8_t rgb[3])
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, "color");
    *has_color = false;
    if (!item || cJSON_IsNull(item))
        return true;
    unsigned value = 0;
    if (cJSON_IsString(item)) {
        const char *text = item->valuestring;
        if (strlen(text) != 7 || text[0] != '#' || strspn(text + 1, "0123456789abcdefABCDEF") != 6)
            return place_fail(place, ERROR_FORMAT, "color", "expected \"#rrggbb\"");
        value = (unsigned)strtoul(text + 1, NULL, 16);
    } else {
        double v[3], most = 0;
        for (int i = 0; i < 3; i++) {
            const cJSON *number =
                cJSON_IsArray(item) && cJSON_GetArraySize(item) == 3 ? cJSON_GetArrayItem(item, i) : NULL;
            if (!cJSON_IsNumber(number) || !(number->valuedouble >= 0 && number->valuedouble <= 255))
                return place_fail(place, ERROR_FORMAT, "color",
                                  "expected \"#rrggbb\" or three numbers of 0 to 1 or 0 to 255");
            v[i] = number->valuedouble;
            most = fmax(most, v[i]);
        }
        double scale = most <= 1 ? 255 : 1;
        for (int i = 0; i < 3; i++)
            value = value << 8 | (unsigned)(v[i] * scale + 0.5);
    }
    rgb[0] = (uint8_t)(value >> 16);
    rgb[1] = (uint8_t)(value >> 8);
    rgb[2] = (uint8_t)value;
    *has_color = true;
    return true;
}
