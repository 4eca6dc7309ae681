/* Computes the bounds of a plan from its regions, images, doses and beams, without those of other patients. */
#include "core/plan/plan_bounds.h"

#include <math.h>

#include "core/plan/fit.h"
#include "core/region/body.h"
#include "core/volume/otsu.h"

static void add_box(struct box3 *bounds, const struct box3 *box)
{
    if (box3_is_empty(box))
        return;
    box3_add(bounds, box->low);
    box3_add(bounds, box->high);
}

/* The box of all regions, or with `body` of those that are part of it. */
static struct box3 box_of_regions(const struct plan *plan, const struct body *body)
{
    struct box3 bounds = box3_empty();
    for (size_t i = 0; i < plan->regions.n_regions; i++) {
        const struct region *region = &plan->regions.regions[i];
        const struct affine *map = &plan->regions.layers[region->layer]->grid.lps_mm_from_ijk;
        if (fit_is_of_other(plan, fit_part_of_region(plan, i)) || (body && region->layer != body->layer))
            continue;
        int outer = (int)i;
        while (body && body->region >= 0 && outer >= 0 && outer != body->region)
            outer = plan->regions.regions[outer].parent;
        if (outer < 0)
            continue;
        for (int corner = 0; region->n_voxels > 0 && corner < 8; corner++)
            box3_add(&bounds,
                     affine_point(map, vec3(corner & 1 ? region->high_ijk[0] + 0.5 : region->low_ijk[0] - 0.5,
                                            corner & 2 ? region->high_ijk[1] + 0.5 : region->low_ijk[1] - 0.5,
                                            corner & 4 ? region->high_ijk[2] + 0.5 : region->low_ijk[2] - 0.5)));
    }
    return bounds;
}

static bool boxes_overlap(const struct box3 *a, const struct box3 *b)
{
    return a->low.x <= b->high.x && b->low.x <= a->high.x && a->low.y <= b->high.y && b->low.y <= a->high.y &&
           a->low.z <= b->high.z && b->low.z <= a->high.z;
}

static void check_part(struct plan *plan, const struct box3 *regions, const struct box3 *part, const char *what,
                       const char *id)
{
    if (!box3_is_empty(regions) && !boxes_overlap(regions, part))
        report_add(&plan->report, REPORT_WARNING, "geometry.apart", "",
                   "The %s \"%s\" and the regions do not overlap anywhere.", what, id);
}

/* For a plan without grids: room for a patient around the targets of its beams. */
static struct box3 box_of_beams(const struct plan *plan)
{
    static const double half_mm = 150;
    struct box3 bounds = box3_empty();
    for (size_t i = 0; i < plan->n_beams; i++) {
        if (fit_is_of_other(plan, (struct fit_part){ FIT_BEAM, i }))
            continue;
        struct vec3 target = plan->beams[i].target_lps_mm;
        box3_add(&bounds, vec3(target.x - half_mm, target.y - half_mm, target.z - half_mm));
        box3_add(&bounds, vec3(target.x + half_mm, target.y + half_mm, target.z + half_mm));
    }
    return bounds;
}

static double diagonal_mm(const struct box3 *box)
{
    return box3_is_empty(box) ? 0 : vec3_length(vec3_sub(box->high, box->low));
}

/* The region of the body; where there is none, or no more than a lesion (less than half as long as the image), the
 * bright voxels of the first image. */
static struct box3 box_of_body(const struct plan *plan)
{
    int image = fit_first_image(plan);
    struct body body;
    struct box3 box = body_find(&plan->regions, &body) ? box_of_regions(plan, &body) : box3_empty();
    if (image < 0)
        return box;
    struct box3 whole = grid_bounds_lps_mm(&plan->images[image].volume->grid);
    if (diagonal_mm(&box) >= diagonal_mm(&whole) / 2)
        return box;
    double least = plan->images[image].is_inverted ? NAN : otsu_threshold(plan->images[image].volume);
    return isfinite(least) ? otsu_box_lps_mm(plan->images[image].volume, least) : whole;
}

void plan_measure_bounds(struct plan *plan)
{
    struct box3 body = box_of_body(plan);
    if (!box3_is_empty(&body) && vec3_is_finite(body.low) && vec3_is_finite(body.high))
        plan->body_lps_mm = body;
    struct box3 regions = box_of_regions(plan, NULL), others = box3_empty();
    for (size_t i = 0; i < plan->n_images; i++) {
        if (fit_is_of_other(plan, (struct fit_part){ FIT_IMAGE, i }))
            continue;
        struct box3 box = grid_bounds_lps_mm(&plan->images[i].volume->grid);
        check_part(plan, &regions, &box, "image", plan->images[i].id);
        add_box(&others, &box);
    }
    for (size_t i = 0; i < plan->n_doses; i++)
        for (size_t c = 0; !fit_is_of_other(plan, (struct fit_part){ FIT_DOSE, i }) && c < plan->doses[i].n_components;
             c++) {
            struct box3 box = grid_bounds_lps_mm(&plan->doses[i].components[c].values->grid);
            if (c == 0)
                check_part(plan, &regions, &box, "dose", plan->doses[i].id);
            add_box(&others, &box);
        }
    plan->bounds_lps_mm = !box3_is_empty(&regions) ? regions : !box3_is_empty(&others) ? others : box_of_beams(plan);
}
