/* Answers the question of doses along a line: curves of the scene's dose, the regions it runs through, what is read off
 * the curves, and the curves that the plan's files give for a phantom. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/region/target.h"
#include "core/scene/dose_scale.h"
#include "server/renderer/answers.h"
#include "server/renderer/dose_answers.h"
#include "server/renderer/profile_line.h"
#include "server/wire/json.h"

static void add_numbers(cJSON *json, const char *name, const double *values, size_t n)
{
    cJSON *list = cJSON_AddArrayToObject(json, name);
    for (size_t i = 0; i < n; i++)
        json_append(list, json_finite(values[i]));
}

/* ---- curves ----------------------------------------------------------------------------------------------------------- */
struct profile {
    const struct snapshot *snapshot;
    const struct dose *dose;
    struct profile_line line;
    struct ray_band *bands;
    size_t n_bands;
    double *values;   /* of the curve that is being made; [line.n] */
    double *weighted; /* each component's part of the weighted dose */
};

/* Fills values with a quantity of a scene's dose along the line. Returns the field, one reference; NULL with why. */
static struct dose_field *fill_values(const struct profile *profile, const struct scene *scene,
                                      enum scene_dose_quantity quantity, struct dose_choice *choice, double *values,
                                      struct error *why)
{
    const struct snapshot *snapshot = profile->snapshot;
    struct snapshot *with = mem_new(sizeof *with); /* borrows all but the scene */
    *with = *snapshot;
    with->scene = *scene;
    bool is_good = dose_choice_of(with, (size_t)snapshot->dose, quantity, choice, why);
    free(with);
    if (!is_good)
        return NULL;
    struct dose_field *field = dose_field_get(snapshot->derived, choice, why);
    for (size_t i = 0; field && i < profile->line.n; i++)
        if (!dose_field_value(field, ray_point(&profile->line.ray, profile_depth(&profile->line, i)), &values[i]))
            values[i] = NAN;
    return field;
}

/* {quantity, unit, values, physical, physical_unit}: physical of weighted components, else null. weighing: the field of
 * the weighted dose and its choice; NULL: components are shown as they are. */
static bool add_curve(cJSON *curves, const struct profile *profile, enum scene_dose_quantity quantity,
                      const struct dose_field *weighing, const struct dose_choice *weights)
{
    struct dose_choice choice;
    struct error why = { 0 };
    struct dose_field *field =
        fill_values(profile, &profile->snapshot->scene, quantity, &choice, profile->values, &why);
    if (!field)
        return false;
    size_t n = profile->line.n;
    bool is_weighted = weighing && choice.shown == DOSE_SHOWN_QUANTITY && dose_is_summand(choice.quantity);
    for (size_t i = 0; is_weighted && i < n; i++) {
        struct vec3 point = ray_point(&profile->line.ray, profile_depth(&profile->line, i));
        uint8_t row = dose_field_row(weighing, point);
        profile->weighted[i] =
            row == DOSE_NO_ROW ? NAN : profile->values[i] * dose_weight_of(choice.quantity, &weights->rows[row]);
    }
    cJSON *curve = cJSON_CreateObject();
    cJSON_AddStringToObject(curve, "quantity", dose_quantity_scene_word(quantity));
    cJSON_AddStringToObject(curve, "unit", is_weighted ? weighing->unit : field->unit);
    add_numbers(curve, "values", is_weighted ? profile->weighted : profile->values, n);
    if (is_weighted)
        add_numbers(curve, "physical", profile->values, n);
    else
        cJSON_AddNullToObject(curve, "physical");
    json_add_text(curve, "physical_unit", is_weighted ? field->unit : NULL);
    cJSON_AddItemToArray(curves, curve);
    derive_result_unref(&field->base);
    return true;
}

/* The scene's quantity, then each component, then the other totals. */
static void add_curves(cJSON *json, const struct profile *profile)
{
    const struct scene *scene = &profile->snapshot->scene;
    enum scene_dose_quantity shown = scene->dose.quantity;
    static const enum scene_dose_quantity totals[] = { SCENE_DOSE_QUANTITY_WEIGHTED, SCENE_DOSE_QUANTITY_TOTAL,
                                                       SCENE_DOSE_QUANTITY_ISOEFFECTIVE };
    struct dose_choice choice;
    struct error why = { 0 };
    cJSON *curves = cJSON_AddArrayToObject(json, "curves");
    (void)add_curve(curves, profile, shown, NULL, NULL);
    struct dose_field *weighing = NULL;
    if (shown == SCENE_DOSE_QUANTITY_WEIGHTED)
        weighing = fill_values(profile, scene, shown, &choice, profile->values, &why);
    for (size_t c = 0; c < profile->dose->n_components; c++) {
        enum scene_dose_quantity quantity;
        if (dose_quantity_from_scene_word(dose_quantity_word(profile->dose->components[c].quantity), &quantity) &&
            quantity != shown && quantity != SCENE_DOSE_QUANTITY_TOTAL)
            (void)add_curve(curves, profile, quantity, weighing, &choice);
    }
    for (size_t i = 0; i < sizeof totals / sizeof *totals; i++)
        if (totals[i] != shown)
            (void)add_curve(curves, profile, totals[i], NULL, NULL);
    if (weighing)
        derive_result_unref(&weighing->base);
}

/* ---- what is read off ------------------------------------------------------------------------------------------------- */
/* The innermost region around a region, itself included, that is no target; -1: none. */
static int normal_around(const struct region_set *set, int region)
{
    while (region >= 0 && region_is_target(&set->regions[region]))
        region = set->regions[region].parent;
    return region;
}

/* The greatest dose to normal tissue on the line; in a target that of the tissue around it. -INFINITY: none. */
static double normal_high(const struct profile *profile, struct scene *scene, enum scene_dose_quantity quantity)
{
    const struct region_set *set = &profile->snapshot->plan->regions;
    double high = -INFINITY;
    for (size_t b = 0; b < profile->n_bands; b++) {
        int region = normal_around(set, (int)profile->bands[b].region);
        struct dose_choice choice;
        if (region < 0 || !fit_is_used(region_use(&profile->snapshot->fits, (size_t)region)))
            continue;
        memcpy(scene->dose.tissue, set->regions[region].id, sizeof set->regions[region].id);
        struct dose_field *field = fill_values(profile, scene, quantity, &choice, profile->values, NULL);
        for (size_t i = 0; field && i < profile->line.n; i++) {
            double depth = profile_depth(&profile->line, i);
            if (depth >= profile->bands[b].from_mm && depth <= profile->bands[b].to_mm && isfinite(profile->values[i]))
                high = fmax(high, profile->values[i]);
        }
        if (field)
            derive_result_unref(&field->base);
    }
    return high;
}

/* {target, unit, normal_high, advantage_mm, from_entry_mm, reason}. False with why, or with a depth. */
static bool find_advantage(const struct profile *profile, cJSON *json, double *depth, struct error *why)
{
    const struct plan *plan = profile->snapshot->plan;
    struct scene scene = profile->snapshot->scene; /* its lists stay the snapshot's */
    enum scene_dose_quantity quantity = scene.dose.quantity == SCENE_DOSE_QUANTITY_ISOEFFECTIVE
                                            ? SCENE_DOSE_QUANTITY_ISOEFFECTIVE
                                            : SCENE_DOSE_QUANTITY_WEIGHTED;
    struct dose_choice choice;
    int target = region_first_target(&profile->snapshot->fits.used);
    if (target < 0)
        return error_set(why, ERROR_NOT_FOUND, "the plan has no target whose weights a tumour would have");
    cJSON_AddStringToObject(json, "target", plan->regions.regions[target].id);
    double high = normal_high(profile, &scene, quantity);
    json_add_finite(json, "normal_high", high);
    if (!isfinite(high))
        return error_set(why, ERROR_NOT_FOUND, "the line meets no normal tissue with a dose");
    memcpy(scene.dose.tissue, plan->regions.regions[target].id, sizeof plan->regions.regions[target].id);
    struct dose_field *field = fill_values(profile, &scene, quantity, &choice, profile->values, why);
    if (!field)
        return false;
    json_add_text(json, "unit", field->unit);
    derive_result_unref(&field->base);
    return profile_advantage_depth(&profile->line, profile->values, high, depth) ||
           error_set(why, ERROR_NOT_FOUND,
                     "along the line the dose to a tumour does not fall below the greatest dose to normal tissue");
}

static void add_read_outs(cJSON *json, const struct profile *profile)
{
    const struct region_set *set = &profile->snapshot->plan->regions;
    cJSON *bands = cJSON_AddArrayToObject(json, "bands");
    for (size_t i = 0; i < profile->n_bands; i++) {
        cJSON *band = cJSON_CreateObject();
        cJSON_AddStringToObject(band, "region", set->regions[profile->bands[i].region].id);
        json_add_finite(band, "from_mm", profile->bands[i].from_mm);
        json_add_finite(band, "to_mm", profile->bands[i].to_mm);
        cJSON_AddItemToArray(bands, band);
    }
    double entry = profile->n_bands ? profile->bands[0].from_mm : NAN, depth = NAN;
    struct dose_choice choice;
    struct error why = { 0 };
    size_t at;
    json_add_finite(json, "entry_mm", entry);
    const struct scene *scene = &profile->snapshot->scene;
    struct dose_field *field = fill_values(profile, scene, scene->dose.quantity, &choice, profile->values, &why);
    if (field && profile_peak(profile->values, profile->line.n, &at)) {
        cJSON *peak = cJSON_AddObjectToObject(json, "peak");
        json_add_finite(peak, "depth_mm", profile_depth(&profile->line, at));
        json_add_finite(peak, "from_entry_mm", profile_depth(&profile->line, at) - entry);
        json_add_finite(peak, "value", profile->values[at]);
    } else
        cJSON_AddNullToObject(json, "peak");
    if (field)
        derive_result_unref(&field->base);
    cJSON *advantage = cJSON_AddObjectToObject(json, "advantage");
    bool has_one = find_advantage(profile, advantage, &depth, &why);
    json_add_finite(advantage, "depth_mm", has_one ? depth : NAN);
    json_add_finite(advantage, "from_entry_mm", has_one ? depth - entry : NAN);
    json_add_text(advantage, "reason", has_one ? NULL : why.text);
    json_add_finite(json, "advantage_mm", has_one ? depth : NAN);
}

/* ---- curves of the files ---------------------------------------------------------------------------------------------- */
static void add_references(cJSON *json, const struct plan *plan, cJSON *notes)
{
    cJSON *list = cJSON_AddArrayToObject(json, "references");
    for (size_t c = 0; c < plan->n_curves; c++) {
        const struct dose_curve *curve = &plan->curves[c];
        for (size_t column = 0; column < curve->n_columns; column++) {
            char unit[DOSE_UNIT_SIZE], words[DOSE_UNIT_SIZE + 16];
            double *values = mem_array(curve->n_depths, sizeof *values, UINT64_MAX, NULL);
            if (!values)
                return;
            for (size_t i = 0; i < curve->n_depths; i++)
                if (!dose_curve_value(curve, column, curve->depths_mm[i], curve->radii_mm[0], &values[i]))
                    values[i] = NAN;
            dose_quantity_unit(curve->unit, curve->quantities[column], unit);
            snprintf(words, sizeof words, "%s%s", unit, curve->is_per_ppm[column] ? " per ppm" : "");
            cJSON *item = cJSON_CreateObject();
            cJSON_AddStringToObject(item, "id", curve->id);
            cJSON_AddStringToObject(item, "name", curve->name);
            cJSON_AddStringToObject(item, "quantity", dose_quantity_word(curve->quantities[column]));
            cJSON_AddStringToObject(item, "unit", words);
            cJSON_AddStringToObject(item, "per", curve->per);
            json_add_finite(item, "radius_mm", curve->radii_mm[0]);
            add_numbers(item, "depths_mm", curve->depths_mm, curve->n_depths);
            add_numbers(item, "values", values, curve->n_depths);
            cJSON_AddItemToArray(list, item);
            free(values);
        }
    }
    if (plan->n_curves > 0)
        cJSON_AddItemToArray(notes, cJSON_CreateString("Reference curves were computed in a phantom, not in this "
                                                       "patient; their depths begin at the phantom's surface."));
}

/* {id, per, quantity, unit, reason, missing, blood_ppm, weights_name, method, from_lps_mm, direction, depths_mm,
 * curves, bands, entry_mm, peak, advantage_mm, advantage, references, notes} */
cJSON *answer_profile(struct question *question, struct derive *derived, struct problem *problem)
{
    const struct snapshot *snapshot = question->snapshot;
    const struct plan *plan = snapshot->plan;
    struct error err = { 0 };
    (void)derived;
    if (!dose_is_there(snapshot, problem))
        return NULL;
    struct profile profile = { .snapshot = snapshot, .dose = &plan->doses[snapshot->dose] };
    if (!profile_line_find(snapshot, profile.dose, &question->packet.profile, &profile.line, problem))
        return NULL;
    profile.values = mem_array(profile.line.n, sizeof(double), UINT64_MAX, &err);
    profile.weighted = mem_array(profile.line.n, sizeof(double), UINT64_MAX, &err);
    cJSON *json = NULL;
    if (profile.values && profile.weighted &&
        ray_bands(&snapshot->fits.used, &profile.line.ray, &profile.bands, &profile.n_bands, &err)) {
        const struct vec3 from = profile.line.ray.from_lps_mm, way = profile.line.ray.direction;
        cJSON *notes = cJSON_CreateArray();
        json = cJSON_CreateObject();
        struct dose_scale scale;
        (void)dose_scale_of(snapshot, &scale);
        dose_add_basis(json, snapshot, &scale);
        dose_add_weights(json, snapshot);
        dose_scale_finish(&scale);
        cJSON_AddStringToObject(
            json, "method",
            "tri-linear in the dose's grid; depths in mm from the line's first point; bands end at "
            "the faces of univels; advantage depth: where the weighted dose that the target's "
            "tissue would have falls below the greatest weighted dose to normal tissue on the line (in targets: to the tissue around them)");
        cJSON_AddItemToObject(json, "from_lps_mm", cJSON_CreateDoubleArray((double[]){ from.x, from.y, from.z }, 3));
        cJSON_AddItemToObject(json, "direction", cJSON_CreateDoubleArray((double[]){ way.x, way.y, way.z }, 3));
        for (size_t i = 0; i < profile.line.n; i++)
            profile.values[i] = profile_depth(&profile.line, i);
        add_numbers(json, "depths_mm", profile.values, profile.line.n);
        add_curves(json, &profile);
        add_read_outs(json, &profile);
        add_references(json, plan, notes);
        cJSON_AddItemToObject(json, "notes", notes);
    } else
        (void)problem_set(problem, PROBLEM_MEMORY, "", "", "%s", err.text);
    free(profile.bands);
    free(profile.values);
    free(profile.weighted);
    return json;
}
