/* Judges whether a dose lies on the plan's image. */
#include "core/plan/dose_fit.h"

#include <math.h>
#include <stdio.h>

static const char *const words[DOSE_N_FITS] = { "same", "unknown", "differs", "apart" };

const char *dose_fit_word(enum dose_fit fit)
{
    return words[fit];
}

static bool boxes_meet(const struct box3 *a, const struct box3 *b)
{
    return a->low.x < b->high.x && b->low.x < a->high.x && a->low.y < b->high.y && b->low.y < a->high.y &&
           a->low.z < b->high.z && b->low.z < a->high.z;
}

/* The box around a region's univels. */
static struct box3 region_box(const struct region_set *set, const struct region *region)
{
    struct box3 box = box3_empty();
    for (int corner = 0; corner < 8; corner++)
        box3_add(&box, affine_point(&set->layers[region->layer]->grid.lps_mm_from_ijk,
                                    vec3(corner & 1 ? region->high_ijk[0] + 0.5 : region->low_ijk[0] - 0.5,
                                         corner & 2 ? region->high_ijk[1] + 0.5 : region->low_ijk[1] - 0.5,
                                         corner & 4 ? region->high_ijk[2] + 0.5 : region->low_ijk[2] - 0.5)));
    return box;
}

/* True if a grid meets a region, or an image of a plan without regions. A plan with neither has nothing to miss. */
static bool meets_patient(const struct plan *plan, const struct grid *grid)
{
    struct box3 dose = grid_bounds_lps_mm(grid);
    bool is_any = false;
    for (size_t r = 0; r < plan->regions.n_regions; r++) {
        if (plan->regions.regions[r].n_voxels == 0)
            continue;
        struct box3 box = region_box(&plan->regions, &plan->regions.regions[r]);
        is_any = true;
        if (boxes_meet(&dose, &box))
            return true;
    }
    for (size_t i = 0; !is_any && i < plan->n_images; i++) {
        struct box3 box = grid_bounds_lps_mm(&plan->images[i].volume->grid);
        if (boxes_meet(&dose, &box))
            return true;
    }
    return !is_any && plan->n_images == 0;
}

enum dose_fit dose_fit_of(const struct plan *plan, size_t index, char why[DOSE_FIT_WHY_SIZE])
{
    static const char *const sentences[DOSE_N_FITS] = {
        [DOSE_FIT_SAME] = "Dose and image share a frame of reference.",
        [DOSE_FIT_UNKNOWN] = "The files do not say whether dose and image share a frame of reference.",
        [DOSE_FIT_DIFFERS] = ("The dose was computed in another frame of reference than the image's: it may be shifted "
                              "against the image, or be another patient's."),
        [DOSE_FIT_APART] = "The dose's grid does not meet the patient: it may be another patient's, or a phantom's.",
    };
    const struct dose *dose = &plan->doses[index];
    enum dose_fit fit = !dose->has_frame || dose->frame == DOSE_FRAME_UNKNOWN ? DOSE_FIT_UNKNOWN
                        : dose->frame == DOSE_FRAME_SAME                      ? DOSE_FIT_SAME
                                                                              : DOSE_FIT_DIFFERS;
    for (size_t c = 0; c < dose->n_components; c++)
        if (!meets_patient(plan, &dose->components[c].values->grid))
            fit = DOSE_FIT_APART;
    if (why)
        snprintf(why, DOSE_FIT_WHY_SIZE, "%s", sentences[fit]);
    return fit;
}
