/* Creates and destroys an empty plan. */
#include "core/plan/plan.h"

#include <stdio.h>
#include <stdlib.h>

#include "core/base/mem.h"

struct plan *plan_create(const char *id)
{
    struct plan *plan = mem_new(sizeof *plan);
    snprintf(plan->id, sizeof plan->id, "%s", id);
    static const struct part_origin nobody = { .patient = -1, .treatment_plan = -1 };
    for (size_t i = 0; i < PLAN_MAX_IMAGES; i++)
        plan->image_origins[i] = nobody;
    for (size_t i = 0; i < PLAN_MAX_DOSES; i++)
        plan->dose_origins[i] = nobody;
    for (size_t i = 0; i < PLAN_MAX_BEAMS; i++)
        plan->beam_origins[i] = nobody;
    plan->tracks_origin = nobody;
    plan->body_lps_mm = (struct box3){ vec3(1, 1, 1), vec3(-1, -1, -1) };
    return plan;
}

void plan_destroy(struct plan *plan)
{
    if (!plan)
        return;
    for (size_t i = 0; i < plan->n_images; i++)
        volume_unref(plan->images[i].volume);
    region_set_finish(&plan->regions);
    for (size_t i = 0; i < plan->n_doses; i++)
        dose_finish(&plan->doses[i]);
    for (size_t i = 0; i < plan->n_curves; i++)
        dose_curve_finish(&plan->curves[i]);
    track_set_finish(&plan->tracks);
    free(plan->region_origins);
    report_finish(&plan->report);
    free(plan);
}
