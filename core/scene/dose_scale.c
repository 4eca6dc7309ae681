/* Finds field and reference of the dose that a snapshot shows. */
#include "core/scene/dose_scale.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/derive/dose_extremes.h"
#include "core/region/target.h"

static double unknown(struct dose_scale *scale, const char *why)
{
    (void)error_set(&scale->why_no_reference, ERROR_NOT_FOUND, "%s", why);
    return NAN;
}

/* The reference that a file states, times the factors of the parts. */
static double file_reference(const struct snapshot *snapshot, struct dose_scale *scale)
{
    const struct dose_choice *choice = &snapshot->dose_choice;
    const struct dose *dose = &snapshot->plan->doses[choice->parts[0].dose];
    double reference = dose->reference[choice->quantity];
    snprintf(scale->words, sizeof scale->words, "the file's own reference");
    if (choice->shown != DOSE_SHOWN_QUANTITY || !(reference > 0))
        return unknown(scale, "the file states no reference for this quantity");
    if (choice->n_parts > 1)
        return unknown(scale, "the file's reference is not that of a sum of doses");
    return reference * choice->parts[0].factor;
}

static double measured_reference(const struct snapshot *snapshot, struct dose_scale *scale)
{
    const struct scene_dose_reference *wanted = &snapshot->scene.dose.reference;
    const struct region_set *set = &snapshot->fits.used;
    bool is_body = wanted->kind == SCENE_DOSE_REFERENCE_KIND_BODY, has_used = false;
    for (size_t r = 0; r < set->n_regions; r++)
        has_used |= fit_is_used(region_use(&snapshot->fits, r));
    const struct region *region = wanted->region[0] ? region_find(set, wanted->region) : NULL;
    if (!wanted->region[0] && region_first_target(set) >= 0)
        region = &set->regions[region_first_target(set)];
    bool is_mean = wanted->kind == SCENE_DOSE_REFERENCE_KIND_REGION_MEAN;
    if (is_body)
        snprintf(scale->words, sizeof scale->words, has_used ? "maximum in the body" : "maximum of the grid");
    else
        snprintf(scale->words, sizeof scale->words, "%s of %.64s", is_mean ? "mean" : "maximum",
                 region ? region->name : "a region");
    if (!is_body && !region)
        return unknown(scale, "the reference's region is not chosen, and the plan has no target");
    if (!is_body && !fit_is_used(region_use(&snapshot->fits, (size_t)(region - set->regions))))
        return unknown(scale, "the reference's region is not used with this dose");
    struct dose_extremes *extremes =
        dose_extremes_get(snapshot->derived, &snapshot->dose_choice, &scale->why_no_reference);
    if (!extremes)
        return NAN;
    size_t index = region ? (size_t)(region - set->regions) : 0;
    double reference = is_body ? extremes->body_high : is_mean ? extremes->mean[index] : extremes->high[index];
    derive_result_unref(&extremes->base);
    return isnan(reference) ? unknown(scale, "the dose has no value there") : reference;
}

static double find_reference(const struct snapshot *snapshot, struct dose_scale *scale)
{
    const struct scene_dose_reference *wanted = &snapshot->scene.dose.reference;
    double value;
    switch (wanted->kind) {
    case SCENE_DOSE_REFERENCE_KIND_FILE: return file_reference(snapshot, scale);
    case SCENE_DOSE_REFERENCE_KIND_VALUE:
        snprintf(scale->words, sizeof scale->words, "prescription");
        return wanted->value;
    case SCENE_DOSE_REFERENCE_KIND_POINT:
        snprintf(scale->words, sizeof scale->words, "value at a point");
        return dose_field_value(scale->field, wanted->point_mm, &value)
                   ? value
                   : unknown(scale, "the dose has no value at the reference's point");
    case SCENE_DOSE_REFERENCE_KIND_BODY:
    case SCENE_DOSE_REFERENCE_KIND_REGION_MAX:
    case SCENE_DOSE_REFERENCE_KIND_REGION_MEAN: break;
    }
    return measured_reference(snapshot, scale);
}

bool dose_scale_begin(const struct snapshot *snapshot, struct dose_scale *scale)
{
    memset(scale, 0, sizeof *scale);
    scale->reference = NAN;
    scale->why = snapshot->dose_why;
    scale->field =
        snapshot->has_dose_choice ? dose_field_begin(snapshot->derived, &snapshot->dose_choice, &scale->why) : NULL;
    if (!scale->field)
        return false;
    scale->reference = find_reference(snapshot, scale);
    if (!(scale->reference > 0) && !scale->why_no_reference.code)
        scale->reference = unknown(scale, "the reference is not above zero");
    return true;
}

bool dose_scale_is_whole(const struct dose_scale *scale, struct error *err)
{
    const struct error *failure = scale->why.code == ERROR_MEMORY                ? &scale->why
                                  : scale->why_no_reference.code == ERROR_MEMORY ? &scale->why_no_reference
                                                                                 : NULL;
    if (failure)
        *err = *failure;
    return !failure;
}

bool dose_scale_of(const struct snapshot *snapshot, struct dose_scale *scale)
{
    if (!dose_scale_begin(snapshot, scale))
        return false;
    dose_field_need_all(scale->field);
    return true;
}

void dose_scale_finish(struct dose_scale *scale)
{
    if (scale->field)
        derive_result_unref(&scale->field->base);
    scale->field = NULL;
}

double dose_level_value(const struct dose_scale *scale, enum scene_dose_unit unit, double value)
{
    return unit == SCENE_DOSE_UNIT_DOSE ? value : value / 100 * scale->reference;
}
