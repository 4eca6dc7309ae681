/* Reads the "beams" of plan.json. */
#include "core/formats/plan_json_beams.h"

#include <math.h>
#include <stdlib.h>

#include "core/formats/plan_json_delivery.h"

/* A number of a treatment plan has no limit of its own; a count must be exact as a double, up to 2^53. */
#define MOST_NUMBER 1e300
#define MOST_COUNT 9007199254740992.0

static bool parse_numbers(const struct json_place *at, const cJSON *item, const char *key, int n, double *out)
{
    bool is_list = n > 1;
    for (int i = 0; i < n; i++)
        out[i] = NAN;
    if (!item || cJSON_IsNull(item))
        return true;
    if (is_list && (!cJSON_IsArray(item) || cJSON_GetArraySize(item) != n))
        return place_fail(at, ERROR_FORMAT, key, n == 2 ? "expected two numbers" : "expected three numbers");
    for (int i = 0; i < n; i++) {
        const cJSON *number = is_list ? cJSON_GetArrayItem(item, i) : item;
        if (is_list && cJSON_IsNull(number))
            continue;
        if (!cJSON_IsNumber(number) || !(fabs(number->valuedouble) <= MOST_NUMBER))
            return place_fail(at, ERROR_RANGE, key, "expected numbers of at most 1e300");
        out[i] = number->valuedouble;
    }
    return true;
}

static bool parse_count(const struct json_place *at, const cJSON *item, const char *key, int64_t *out)
{
    double value;
    *out = 0;
    if (!parse_numbers(at, item, key, 1, &value))
        return false;
    if (isnan(value))
        return true;
    if (value != floor(value) || fabs(value) > MOST_COUNT)
        return place_fail(at, ERROR_RANGE, key, "expected a whole number of at most 2^53");
    *out = (int64_t)value;
    return true;
}

/* Reads "delivery", the values of a treatment plan for a beam; absent numbers become not-a-number. */
static bool parse_delivery(const struct json_place *at, const cJSON *entry, struct beam *beam)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(entry, "delivery");
    struct beam_delivery *delivery = &beam->delivery;
    char position[8];
    int64_t n_control_points;
    if (!item || cJSON_IsNull(item))
        return true;
    if (!cJSON_IsObject(item))
        return place_fail(at, ERROR_FORMAT, "delivery", "expected an object, {...}");
    beam->has_delivery = true;
    for (int i = 0; i < N_DELIVERY_NUMBERS; i++)
        if (!parse_numbers(at, cJSON_GetObjectItemCaseSensitive(item, delivery_numbers[i].key), delivery_numbers[i].key,
                           1, (double *)((char *)delivery + delivery_numbers[i].at)))
            return false;
    for (int i = 0; i < N_DELIVERY_LISTS; i++)
        if (!parse_numbers(at, cJSON_GetObjectItemCaseSensitive(item, delivery_lists[i].key), delivery_lists[i].key,
                           delivery_lists[i].n, (double *)((char *)delivery + delivery_lists[i].at)))
            return false;
    if (!place_text(at, item, "radiation", delivery->radiation, sizeof delivery->radiation) ||
        !place_text(at, item, "machine", delivery->machine, sizeof delivery->machine) ||
        !place_text(at, item, "meterset_unit", delivery->meterset_unit, sizeof delivery->meterset_unit) ||
        !place_text(at, item, "patient_position", position, sizeof position) ||
        !parse_count(at, cJSON_GetObjectItemCaseSensitive(item, "number"), "number", &delivery->number) ||
        !parse_count(at, cJSON_GetObjectItemCaseSensitive(item, "n_fractions"), "n_fractions",
                     &delivery->n_fractions) ||
        !parse_count(at, cJSON_GetObjectItemCaseSensitive(item, "n_control_points"), "n_control_points",
                     &n_control_points))
        return false;
    delivery->n_control_points = n_control_points > 0 ? (size_t)n_control_points : 0;
    return !position[0] || patient_position_from_word(position, &delivery->patient_position) ||
           place_fail(at, ERROR_RANGE, "patient_position", "expected HFS, HFP, FFS, FFP, HFDR, HFDL, FFDR or FFDL");
}

static bool parse_beam_file(const struct json_place *at, const cJSON *entry, struct plan_file *file)
{
    static const char *const known[] = { "path", NULL };
    place_note_keys(at, entry, known);
    if (file->n_beam_files >= PLAN_FILE_MAX_BEAM_FILES)
        return place_fail(at, ERROR_LIMIT, "path", "more than 16 files of beams");
    return place_path(at, entry, "path", true, file->beam_files[file->n_beam_files++].path);
}

bool plan_json_beams(const struct json_place *top, const cJSON *root, struct plan_file *file)
{
    static const char *const known[] = { "id", "name", "entry_mm", "target_mm", "aperture_mm", "delivery", NULL };
    const cJSON *list;
    if (!place_list(top, root, "beams", PLAN_FILE_MAX_BEAMS, &list))
        return false;
    for (const cJSON *entry = list ? list->child : NULL; entry; entry = entry->next) {
        struct json_place at = place_at(top, "beams", (int)(file->n_beams + file->n_beam_files));
        if (cJSON_GetObjectItemCaseSensitive(entry, "path")) {
            if (!parse_beam_file(&at, entry, file))
                return false;
            continue;
        }
        struct beam *beam = &file->beams[file->n_beams++];
        place_note_keys(&at, entry, known);
        if (!place_text(&at, entry, "id", beam->id, sizeof beam->id) ||
            !place_text(&at, entry, "name", beam->name, sizeof beam->name) || !parse_delivery(&at, entry, beam) ||
            !place_point(&at, entry, "entry_mm", &beam->entry_lps_mm) ||
            !place_point(&at, entry, "target_mm", &beam->target_lps_mm))
            return false;
        if (vec3_length(vec3_sub(beam->entry_lps_mm, beam->target_lps_mm)) < BEAM_MIN_LENGTH_MM)
            return place_fail(&at, ERROR_RANGE, "target_mm", "is the same point as entry_mm");
        const cJSON *aperture = cJSON_GetObjectItemCaseSensitive(entry, "aperture_mm");
        beam->aperture_mm = NAN;
        if (aperture && !cJSON_IsNull(aperture)) {
            if (!cJSON_IsNumber(aperture) ||
                !(aperture->valuedouble > 0 && aperture->valuedouble <= BEAM_MAX_APERTURE_MM))
                return place_fail(&at, ERROR_RANGE, "aperture_mm", "expected a diameter above 0 and at most 2000 mm");
            beam->aperture_mm = aperture->valuedouble;
        }
    }
    return true;
}
