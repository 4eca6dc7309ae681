/* Turns a scene's coverage into the recipe of its result. */
#include "core/scene/dose_coverage_choice.h"

#include <math.h>
#include <string.h>

#include "core/region/target.h"

static bool find_region(const struct snapshot *snapshot, size_t *index, struct error *why)
{
    const struct region_set *set = &snapshot->plan->regions;
    const char *id = snapshot->scene.dose.coverage.region;
    const struct region *region = id[0] ? region_find(set, id) : NULL;
    int target = id[0] ? -1 : region_first_target(set);
    if (!region && target < 0)
        return error_set(why, ERROR_NOT_FOUND, "the coverage's region is not chosen, and the plan has no target");
    *index = region ? (size_t)(region - set->regions) : (size_t)target;
    return true;
}

bool dose_coverage_choice_of(const struct snapshot *snapshot, const struct dose_scale *scale,
                             struct dose_coverage_choice *choice, struct error *why)
{
    const struct scene_dose_coverage *wanted = &snapshot->scene.dose.coverage;
    memset(choice, 0, sizeof *choice);
    choice->dose = snapshot->dose_choice;
    choice->low = wanted->has_low ? dose_level_value(scale, wanted->unit, wanted->low) : -INFINITY;
    choice->high = wanted->has_high ? dose_level_value(scale, wanted->unit, wanted->high) : INFINITY;
    if (isnan(choice->low) || isnan(choice->high)) {
        *why = scale->why_no_reference;
        return false;
    }
    return find_region(snapshot, &choice->region, why);
}
