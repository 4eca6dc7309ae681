/* Reads the "beams" of plan.json. */
#include "core/formats/plan/plan_json_beams.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "core/beam/sera_angles.h"
#include "core/formats/plan/plan_json_delivery.h"

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

#define MOST_OUTLINE_MM 1e4 /* from the isocentre */

static bool parse_polygon(const cJSON *list, struct beam_outline *outline, struct error *err)
{
    size_t at = beam_outline_n_points(outline), n = 0;
    if (!cJSON_IsArray(list))
        return error_set(err, ERROR_FORMAT, "expected polygons, lists of points, [x, y]");
    for (const cJSON *point = list->child; point; point = point->next, n++) {
        if (at + n >= BEAM_OUTLINE_MAX_POINTS)
            return error_set(err, ERROR_LIMIT, "more than %d points", BEAM_OUTLINE_MAX_POINTS);
        if (!cJSON_IsArray(point) || cJSON_GetArraySize(point) != 2)
            return error_set(err, ERROR_FORMAT, "expected points of two numbers, [x, y]");
        for (int axis = 0; axis < 2; axis++) {
            const cJSON *number = cJSON_GetArrayItem(point, axis);
            if (!cJSON_IsNumber(number) || !(fabs(number->valuedouble) <= MOST_OUTLINE_MM))
                return error_set(err, ERROR_RANGE, "expected numbers of at most %g mm", MOST_OUTLINE_MM);
            outline->points_mm[at + n][axis] = (float)number->valuedouble;
        }
    }
    if (n < 3)
        return error_set(err, ERROR_RANGE, "a polygon of %zu points; it needs 3", n);
    outline->ends[outline->n_polygons++] = (uint16_t)(at + n);
    return true;
}

/* Reads "outline", {kind, polygons_mm: [[[x, y], ...], ...]}. */
static bool parse_outline(const struct json_place *at, const cJSON *delivery, struct beam_outline *outline)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(delivery, "outline");
    char kind[16];
    if (!item || cJSON_IsNull(item))
        return true;
    if (!cJSON_IsObject(item))
        return place_fail(at, ERROR_FORMAT, "outline", "expected an object, {...}");
    if (!place_text(at, item, "kind", kind, sizeof kind))
        return false;
    const cJSON *polygons = cJSON_GetObjectItemCaseSensitive(item, "polygons_mm");
    if (!beam_outline_kind_from_word(kind, &outline->kind) || !cJSON_IsArray(polygons) || !polygons->child)
        return place_fail(at, ERROR_FORMAT, "outline", "expected kind, jaws, leaves or blocks, and polygons_mm");
    for (const cJSON *polygon = polygons->child; polygon; polygon = polygon->next) {
        struct error why = { 0 };
        if (outline->n_polygons >= BEAM_OUTLINE_MAX_POLYGONS)
            return place_fail(at, ERROR_LIMIT, "outline", "more than 400 polygons");
        if (!parse_polygon(polygon, outline, &why))
            return place_fail(at, why.code, "outline", why.text);
    }
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
                     &n_control_points) ||
        !parse_outline(at, item, &delivery->outline))
        return false;
    delivery->n_control_points = n_control_points > 0 ? (size_t)n_control_points : 0;
    return !position[0] || patient_position_from_word(position, &delivery->patient_position) ||
           place_fail(at, ERROR_RANGE, "patient_position", "expected HFS, HFP, FFS, FFP, HFDR, HFDL, FFDR or FFDL");
}

#define MOST_SERA_CM 1e4 /* on any axis, and from the target */

static bool parse_sera_number(const struct json_place *at, const cJSON *item, const char *key, double low, double high,
                              double *out)
{
    char what[80];
    (void)snprintf(what, sizeof what, "expected numbers from %g to %g", low, high);
    if (!cJSON_IsNumber(item) || !(item->valuedouble >= low && item->valuedouble <= high))
        return place_fail(at, ERROR_RANGE, key, what);
    *out = item->valuedouble;
    return true;
}

/* Reads "sera", {target_cm: [PA, RL, IS], z_cm, phi_deg, theta_deg}: the line as seraMC's input card gives it. */
static bool parse_sera(const struct json_place *at, const cJSON *item, struct beam *beam)
{
    static const char *const known[] = { "target_cm", "z_cm", "phi_deg", "theta_deg", NULL };
    struct sera_angles angles;
    if (!cJSON_IsObject(item))
        return place_fail(at, ERROR_FORMAT, "sera", "expected an object, {...}");
    place_note_keys(at, item, known);
    const cJSON *target = cJSON_GetObjectItemCaseSensitive(item, "target_cm");
    if (!cJSON_IsArray(target) || cJSON_GetArraySize(target) != 3)
        return place_fail(at, ERROR_FORMAT, "sera", "expected target_cm, three numbers: PA, RL, IS");
    for (int axis = 0; axis < 3; axis++)
        if (!parse_sera_number(at, cJSON_GetArrayItem(target, axis), "sera.target_cm", -MOST_SERA_CM, MOST_SERA_CM,
                               &angles.target_cm[axis]))
            return false;
    if (!parse_sera_number(at, cJSON_GetObjectItemCaseSensitive(item, "z_cm"), "sera.z_cm", 1e-3, MOST_SERA_CM,
                           &angles.z_cm) ||
        !parse_sera_number(at, cJSON_GetObjectItemCaseSensitive(item, "phi_deg"), "sera.phi_deg", -360, 360,
                           &angles.phi_deg) ||
        !parse_sera_number(at, cJSON_GetObjectItemCaseSensitive(item, "theta_deg"), "sera.theta_deg", -360, 360,
                           &angles.theta_deg))
        return false;
    beam->entry_lps_mm = sera_angles_entry_lps_mm(&angles);
    beam->target_lps_mm = sera_angles_target_lps_mm(&angles);
    return true;
}

/* Reads "sera", or "entry_mm" and "target_mm". */
static bool parse_line(const struct json_place *at, const cJSON *entry, struct beam *beam)
{
    const cJSON *sera = cJSON_GetObjectItemCaseSensitive(entry, "sera");
    if (!sera || cJSON_IsNull(sera))
        return place_point(at, entry, "entry_mm", &beam->entry_lps_mm) &&
               place_point(at, entry, "target_mm", &beam->target_lps_mm);
    if (cJSON_GetObjectItemCaseSensitive(entry, "entry_mm") || cJSON_GetObjectItemCaseSensitive(entry, "target_mm"))
        return place_fail(at, ERROR_FORMAT, "sera", "is there beside entry_mm or target_mm; expected one or the other");
    return parse_sera(at, sera, beam);
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
    static const char *const known[] = {
        "id", "name", "entry_mm", "target_mm", "sera", "aperture_mm", "delivery", NULL
    };
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
            !parse_line(&at, entry, beam))
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
