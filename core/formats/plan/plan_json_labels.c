/* Reads a list of label names. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/formats/plan/plan_json.h"
#include "core/formats/plan/plan_json_place.h"
#include "core/formats/text.h"

static bool get_weight(const struct json_place *place, const cJSON *object, const char *key, double *out)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);
    *out = NAN;
    if (!item || cJSON_IsNull(item))
        return true;
    if (!cJSON_IsNumber(item) ||
        !(item->valuedouble >= 0 && item->valuedouble <= 1e6)) /* the limit for SERA's files, too */
        return place_fail(place, ERROR_RANGE, key, "expected a number from 0 to 1000000");
    *out = item->valuedouble;
    return true;
}

static bool get_tissue(const struct json_place *at, const cJSON *entry, struct label_name *label)
{
    struct label_tissue *tissue = &label->tissue;
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(entry, "tissue");
    if (item && !cJSON_IsNull(item) && !cJSON_IsObject(item))
        return place_fail(at, ERROR_FORMAT, "tissue", "expected an object, {...}");
    label->has_tissue = cJSON_IsObject(item);
    return get_weight(at, item, "boron_ratio", &tissue->boron_ratio) &&
           get_weight(at, item, "cbe_boron", &tissue->cbe_boron) &&
           get_weight(at, item, "rbe_nitrogen", &tissue->rbe_nitrogen) &&
           get_weight(at, item, "rbe_fast", &tissue->rbe_fast) && get_weight(at, item, "rbe_gamma", &tissue->rbe_gamma);
}

/* Reads a whole number from 1 to most; 0 when the key is absent. */
static bool get_whole(const struct json_place *at, const cJSON *entry, const char *key, int most, int *out)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(entry, key);
    *out = 0;
    if (!item || cJSON_IsNull(item))
        return true;
    if (!cJSON_IsNumber(item) || item->valuedouble != floor(item->valuedouble) ||
        !(item->valuedouble >= 1 && item->valuedouble <= most)) {
        char what[64];
        snprintf(what, sizeof what, "expected a whole number from 1 to %d", most);
        return place_fail(at, ERROR_RANGE, key, what);
    }
    *out = (int)item->valuedouble;
    return true;
}

static bool get_opacity(const struct json_place *at, const cJSON *entry, double *out)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(entry, "opacity");
    *out = 0;
    if (!item || cJSON_IsNull(item))
        return true;
    if (!cJSON_IsNumber(item) || !(item->valuedouble > 0 && item->valuedouble <= 1))
        return place_fail(at, ERROR_RANGE, "opacity", "expected a number above 0 and at most 1");
    *out = item->valuedouble;
    return true;
}

static bool get_target(const struct json_place *at, const cJSON *entry, bool *out)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(entry, "target");
    *out = cJSON_IsTrue(item);
    return !item || cJSON_IsNull(item) || cJSON_IsBool(item) ||
           place_fail(at, ERROR_FORMAT, "target", "expected true or false");
}

static bool parse_label(const struct json_place *at, const cJSON *entry, struct label_name *label)
{
    const cJSON *value = cJSON_GetObjectItemCaseSensitive(entry, "value");
    if (!cJSON_IsNumber(value) || value->valuedouble != floor(value->valuedouble) ||
        !(value->valuedouble >= 0 && value->valuedouble <= UINT16_MAX))
        return place_fail(at, ERROR_RANGE, "value", "expected a whole number from 0 to 65535");
    label->value = (uint16_t)value->valuedouble;
    return place_text(at, entry, "name", label->name, sizeof label->name) &&
           place_text(at, entry, "parent", label->parent, sizeof label->parent) &&
           place_text(at, entry, "id", label->id, sizeof label->id) &&
           get_whole(at, entry, "place", REGION_MAX, &label->place) &&
           place_color(at, entry, &label->has_color, label->rgb) && get_opacity(at, entry, &label->opacity) &&
           get_target(at, entry, &label->is_target) && get_tissue(at, entry, label);
}

bool label_names_parse(const uint8_t *data, size_t size, const char *name, struct label_names *names, struct error *err)
{
    *names = (struct label_names){ 0 };
    cJSON *root = place_document(data, size, name, err);
    if (!root)
        return false;
    struct json_place top = { .file = name, .err = err };
    const cJSON *list;
    const cJSON *file = cJSON_GetObjectItemCaseSensitive(root, "file");
    if (cJSON_IsString(file))
        text_clean(file->valuestring, names->file, sizeof names->file);
    bool is_read = place_list(&top, root, "labels", PLAN_FILE_MAX_LABELS, &list);
    if (is_read && !list)
        is_read = place_fail(&top, ERROR_FORMAT, "labels", "is missing");
    if (is_read) {
        names->labels = mem_array((size_t)cJSON_GetArraySize(list) + 1, sizeof *names->labels, UINT64_MAX, err);
        is_read = names->labels != NULL;
    }
    for (const cJSON *entry = is_read ? list->child : NULL; is_read && entry; entry = entry->next) {
        struct json_place at = place_at(&top, "labels", (int)names->n);
        is_read = parse_label(&at, entry, &names->labels[names->n++]);
    }
    cJSON_Delete(root);
    if (!is_read)
        label_names_finish(names);
    return is_read;
}
