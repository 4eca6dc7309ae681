#include "core/scene/dose_compare.h"

#include <math.h>
#include <string.h>

static const double most_gamma = 2; /* a voxel with more fails, by how much makes no difference on a picture */

bool dose_compare_of(const struct snapshot *snapshot, const struct dose_scale *scale, bool is_gamma,
                     struct dose_comparison_choice *choice, struct error *why)
{
    const struct plan *plan = snapshot->plan;
    const struct scene_dose_compare *asked = &snapshot->scene.dose.compare;
    int second = asked->id[0] ? dose_index_of(plan, asked->id) : -1;
    memset(choice, 0, sizeof *choice);
    if (second < 0)
        return error_set(why, ERROR_NOT_FOUND, "no second dose is chosen");
    if (!snapshot->has_dose_choice)
        return error_set(why, ERROR_NOT_FOUND, "there is no first dose to compare with");
    choice->first = snapshot->dose_choice;
    if (!dose_choice_compared(snapshot, (size_t)second, snapshot->scene.dose.quantity, snapshot->scene.dose.tissue,
                              &choice->second, why))
        return false;
    choice->is_gamma = is_gamma;
    choice->is_in_body = asked->domain == SCENE_COMPARE_DOMAIN_BODY && body_find(&snapshot->fits.used, &choice->body);
    if (!choice->is_in_body)
        memset(&choice->body, 0, sizeof choice->body);
    choice->gamma.threshold =
        isfinite(scale->reference) ? scale->reference * asked->threshold_percent / 100 : -INFINITY;
    if (!is_gamma)
        return true;
    if (!isfinite(scale->reference))
        return error_set(why, ERROR_RANGE, "the reference is unknown: %s", scale->why_no_reference.text);
    choice->gamma.dose_percent = asked->dose_percent;
    choice->gamma.is_local = asked->normalization == SCENE_GAMMA_NORMALIZATION_LOCAL;
    choice->gamma.reference = scale->reference;
    choice->gamma.distance_mm = asked->distance_mm;
    choice->gamma.most = most_gamma;
    return true;
}
