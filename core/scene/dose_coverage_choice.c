/* Turns a scene's coverage into the recipe of its result. */
#include "core/scene/dose_coverage_choice.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/region/target.h"

static bool find_region(const struct snapshot *snapshot, size_t *index, struct error *why)
{
    const struct region_set *set = &snapshot->fits.used;
    const char *id = snapshot->scene.dose.coverage.region;
    const struct region *region = id[0] ? region_find(set, id) : NULL;
    int target = id[0] ? -1 : region_first_target(set);
    if (!region && target < 0)
        return error_set(why, ERROR_NOT_FOUND, "the coverage's region is not chosen, and the plan has no target");
    if (region && !fit_is_used(region_use(&snapshot->fits, (size_t)(region - set->regions)))) {
        char sentence[FIT_WHY_SIZE];
        size_t r = (size_t)(region - set->regions);
        fit_use_sentence(&snapshot->fits, fit_part_of_region(snapshot->plan, r), region_use(&snapshot->fits, r),
                         sentence);
        return error_set(why, ERROR_STATE, "%s", sentence);
    }
    *index = region ? (size_t)(region - set->regions) : (size_t)target;
    return true;
}

/* A limit in the unit of the choice's own field. A percentage is one of the reference that this field has: that of the
 * drawn one may be in another quantity, or with one tissue's weights everywhere. */
static bool find_limits(const struct snapshot *snapshot, const struct dose_scale *scale,
                        enum scene_dose_quantity quantity, struct dose_coverage_choice *choice, struct error *why)
{
    const struct scene_dose_coverage *wanted = &snapshot->scene.dose.coverage;
    bool is_drawn = memcmp(&choice->dose, &snapshot->dose_choice, sizeof choice->dose) == 0,
         is_percent = wanted->unit == SCENE_DOSE_UNIT_PERCENT && (wanted->has_low || wanted->has_high);
    struct dose_scale other = { .field = NULL };
    if (is_percent && !is_drawn) {
        struct snapshot *own = mem_new(sizeof *own);
        *own = *snapshot;
        own->scene.dose.quantity = quantity;
        own->dose_choice = choice->dose;
        own->has_dose_choice = true;
        bool is_good = dose_scale_begin(own, &other);
        free(own);
        if (!is_good) {
            *why = other.why;
            return false;
        }
        scale = &other;
    }
    choice->low = wanted->has_low ? dose_level_value(scale, wanted->unit, wanted->low) : -INFINITY;
    choice->high = wanted->has_high ? dose_level_value(scale, wanted->unit, wanted->high) : INFINITY;
    bool is_known = !isnan(choice->low) && !isnan(choice->high);
    if (!is_known)
        *why = scale->why_no_reference;
    dose_scale_finish(&other);
    return is_known;
}

bool dose_coverage_choice_of(const struct snapshot *snapshot, const struct dose_scale *scale,
                             struct dose_coverage_choice *choice, struct error *why)
{
    const struct scene_dose_coverage *wanted = &snapshot->scene.dose.coverage;
    enum scene_dose_quantity quantity = snapshot->scene.dose.quantity;
    memset(choice, 0, sizeof *choice);
    if (wanted->quantity[0] && !dose_quantity_from_scene_word(wanted->quantity, &quantity))
        return error_set(why, ERROR_NOT_FOUND, "\"%.40s\" is no quantity", wanted->quantity);
    choice->population = scene_population(snapshot->plan, &snapshot->scene);
    return dose_choice_in(snapshot, (size_t)snapshot->dose, quantity, wanted->tissue, &choice->dose, why) &&
           find_limits(snapshot, scale, quantity, choice, why) && find_region(snapshot, &choice->region, why);
}
