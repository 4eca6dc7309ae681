/* Adds DICOM structure sets, segmentations and the beams of treatment plans to a plan. */
#include "core/load/assemble_dicom.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/formats/text.h"
#include "core/load/dicom_parts.h"
#include "core/load/origins.h"
#include "core/load/plan_ids.h"
#include "core/load/registrations.h"

/* ---- structure sets --------------------------------------------------------------------------------------------- */

static struct box3 bounds_of_contours(const struct rtstruct *structs)
{
    struct box3 bounds = box3_empty();
    for (size_t r = 0; r < structs->n_rois; r++)
        for (size_t c = 0; c < structs->rois[r].contours.n_contours; c++) {
            const struct contour *contour = &structs->rois[r].contours.contours[c];
            for (size_t p = 0; p < contour->n_points; p++) {
                struct vec3 point = vec3(contour->points_lps_mm[3 * p], contour->points_lps_mm[3 * p + 1],
                                         contour->points_lps_mm[3 * p + 2]);
                if (vec3_is_finite(point))
                    box3_add(&bounds, point);
            }
        }
    return bounds;
}

static double overlap_mm3(const struct box3 *a, const struct box3 *b)
{
    double x = fmin(a->high.x, b->high.x) - fmax(a->low.x, b->low.x);
    double y = fmin(a->high.y, b->high.y) - fmax(a->low.y, b->low.y);
    double z = fmin(a->high.z, b->high.z) - fmax(a->low.z, b->low.z);
    return x >= 0 && y >= 0 && z >= 0 ? (x + 1) * (y + 1) * (z + 1)
                                      : 0; /* plus 1 mm, as a contour on a single slice has no thickness */
}

/* Number of leading folders that the path of an image's first file shares with another path. */
static size_t folders_shared(const struct loading *loading, size_t image, const char *path)
{
    const struct dicom_index *index = loading->parts.dicom;
    const char *other = index->objects[loading_stack_of(loading, image)->objects[0]].path;
    size_t n = 0;
    for (size_t i = 0; path[i] && path[i] == other[i]; i++)
        n += path[i] == '/';
    return n;
}

/* Chooses the image to fill contours on: the series the set was drawn on; else an image with the same frame of
 * reference, the nearest by folders; else the image whose box overlaps the contours most. -1: none. */
static int choose_image(const struct loading *loading, const struct rtstruct *structs, const char *where,
                        struct report *report)
{
    const struct plan *plan = loading->plan;
    const char *frame = structs->n_rois > 0 ? structs->rois[0].frame_uid : "";
    for (size_t i = 0; i < plan->n_images; i++)
        if (loading_stack_of(loading, i) && structs->series_uid[0] &&
            strcmp(loading_stack_of(loading, i)->series, structs->series_uid) == 0)
            return (int)i;
    int best = -1;
    for (size_t i = 0; i < plan->n_images; i++)
        if (loading_stack_of(loading, i) && frame[0] &&
            strcmp(loading_stack_of(loading, i)->frame_of_reference, frame) == 0 &&
            (best < 0 || folders_shared(loading, i, where) > folders_shared(loading, (size_t)best, where)))
            best = (int)i;
    if (best >= 0) {
        report_add(report, REPORT_NOTE, "region.image-chosen", where,
                   "The series the contours were drawn on is not here; they were filled on "
                   "the image \"%s\", which has the same frame of reference.",
                   plan->images[best].id);
        return best;
    }
    struct box3 bounds = bounds_of_contours(structs);
    double most = 0;
    for (size_t i = 0; i < plan->n_images && !box3_is_empty(&bounds); i++) {
        struct box3 box = grid_bounds_lps_mm(&plan->images[i].volume->grid);
        double overlap = overlap_mm3(&bounds, &box);
        if (overlap > most) {
            most = overlap;
            best = (int)i;
        }
    }
    if (best >= 0)
        report_add(report, REPORT_WARNING, "region.image-chosen", where,
                   "Nothing says which image the contours were drawn on; they were "
                   "filled on \"%s\", where most of them lies.",
                   plan->images[best].id);
    else
        report_add(report, REPORT_WARNING, "region.image-chosen", where,
                   "No image lies where the contours are; they were filled on a "
                   "grid of their own.");
    return best;
}

static bool is_selected(const struct plan_file_region *entry, const struct rtstruct_roi *roi)
{
    return !entry->name[0] || text_equal(entry->name, roi->name);
}

/* kind: RT ROI Interpreted Type */
static bool is_target_type(const char *kind)
{
    return text_equal(kind, "GTV") || text_equal(kind, "CTV") || text_equal(kind, "PTV");
}

/* The regions of one structure set while they are filled. */
struct filling {
    struct loading *loading;
    struct region_builder *builder;
    const struct part_reading *reading;
    const struct contour_options *options;
    const char *first_left; /* the first region that the plan has no room for; NULL: none */
    size_t n_left;
};

static void leave_out(struct filling *filling, const struct rtstruct_roi *roi)
{
    filling->first_left = filling->n_left++ == 0 ? roi->name : filling->first_left;
}

/* Adds a filled region to the plan, if there is room. */
static bool add_roi(struct filling *filling, const struct mask *mask, const struct rtstruct_roi *roi,
                    const struct contour_choice *choice, struct error *err)
{
    struct plan *plan = filling->loading->plan;
    const struct part_reading *reading = filling->reading;
    const struct plan_file_region *entry = &filling->loading->file->regions[reading->index];
    const uint8_t *rgb = entry->has_color ? entry->rgb : roi->has_color ? roi->rgb : NULL;
    struct error why = { 0 };
    if (!region_builder_add_bits(filling->builder, mask, &choice->grid, roi->name, rgb, reading->path, &why)) {
        if (why.code == ERROR_LIMIT)
            leave_out(filling, roi);
        else if (err)
            *err = why;
        return why.code == ERROR_LIMIT;
    }
    plan->regions.regions[plan->regions.n_regions - 1].is_target = is_target_type(roi->kind);
    struct part_origin origin = origin_of_roi(filling->loading, reading, roi->frame_uid);
    return origins_add_regions(plan, &origin, plan->regions.n_regions - 1, err);
}

/* Fills a region; one that is beyond a limit is reported and left out. */
static bool fill_roi(struct filling *filling, const struct rtstruct_roi *roi, const struct contour_choice *choice,
                     struct error *err)
{
    struct report *report = &filling->loading->plan->report;
    const char *path = filling->reading->path;
    struct contour_facts facts;
    struct error why = { 0 };
    if (filling->builder->set->n_regions >= REGION_MAX) {
        leave_out(filling, roi);
        return true;
    }
    struct mask *mask = contour_fill(&roi->contours, &choice->grid, filling->options, &facts, &why);
    if (!mask && why.code == ERROR_LIMIT) {
        report_add(report, REPORT_ERROR, "region.contours-refused", path, "\"%s\" was left out: %s.", roi->name,
                   why.text);
        return true;
    }
    if (mask)
        rtstruct_report_fill(roi, choice, &facts, path, report);
    bool is_added = mask && add_roi(filling, mask, roi, choice, &why);
    mask_destroy(mask);
    if (is_added)
        return true;
    error_prefix(&why, "%s: %s", path, roi->name);
    if (err)
        *err = why;
    return false;
}

static bool fill_rois(struct filling *filling, const struct contour_choice *choices, struct error *err)
{
    struct loading *loading = filling->loading;
    const struct rtstruct *structs = filling->reading->structs;
    const struct region_set *set = filling->builder->set;
    const struct plan_file_region *entry = &loading->file->regions[filling->reading->index];
    for (size_t r = 0; r < structs->n_rois; r++) {
        if (loading_is_cancelled(loading))
            return error_set(err, ERROR_CANCELLED, "loading was cancelled");
        loading_phase(loading, "filling contours of", structs->rois[r].name, 80, 95);
        if (is_selected(entry, &structs->rois[r]) && !fill_roi(filling, &structs->rois[r], &choices[r], err))
            return false;
        loading_work(loading, 1);
    }
    if (filling->n_left > 0)
        report_add(&loading->plan->report, REPORT_ERROR, "region.too-many", filling->reading->path,
                   "The plan has no room for %zu regions of this file, the first is \"%s\": it has %zu regions on %zu "
                   "layers of labels, and holds %d on %d.",
                   filling->n_left, filling->first_left, set->n_regions, set->n_layers, REGION_MAX, REGION_MAX_LAYERS);
    return true;
}

bool plan_dicom_add_regions(struct loading *loading, struct region_builder *builder, struct part_reading *reading,
                            struct error *err)
{
    const struct rtstruct *structs = reading->structs;
    struct plan *plan = loading->plan;
    if (structs->n_rois == 0)
        return true;
    int image = choose_image(loading, structs, reading->path, &plan->report);
    const struct dicom_stack *stack = image >= 0 ? loading_stack_of(loading, (size_t)image) : NULL;
    rtstruct_check_frame(structs, stack ? stack->frame_of_reference : NULL, reading->path, &plan->report);
    struct contour_set *sets = mem_new(structs->n_rois * sizeof *sets);
    struct contour_choice *choices = mem_new(structs->n_rois * sizeof *choices);
    for (size_t r = 0; r < structs->n_rois; r++)
        sets[r] = structs->rois[r].contours; /* borrowed */
    struct contour_options options = contour_defaults;
    options.n_threads = parallel_cores();
    const struct grid *grid = image >= 0 ? &plan->images[image].volume->grid : NULL;
    options.spacing_mm = contour_usual_spacing_mm(sets, structs->n_rois, grid);
    loading_phase(loading, "choosing grids for", reading->path, 80, 95);
    bool is_added = contour_choose_grids(sets, structs->n_rois, grid, &options, choices, err);
    if (!is_added)
        error_prefix(err, "%s", reading->path);
    if (is_added && image >= 0)
        rtstruct_report_reach(structs, choices, loading->file->regions[reading->index].name, plan->images[image].id,
                              reading->path, &plan->report);
    struct filling filling = { loading, builder, reading, &options, NULL, 0 };
    is_added = is_added && fill_rois(&filling, choices, err);
    free(sets);
    free(choices);
    return is_added;
}

/* ---- segmentations ---------------------------------------------------------------------------------------------- */

void plan_dicom_check_segmentation(struct loading *loading, struct part_reading *reading)
{
    const struct plan *plan = loading->plan;
    const struct plan_file_region *entry = &loading->file->regions[reading->index];
    const struct dicom_object *object =
        plan_dicom_object(loading->parts.dicom, DICOM_KIND_SEGMENTATION, reading->path, 0);
    bool has_series = false, has_frame = false, has_image = false;
    for (size_t i = 0; i < plan->n_images; i++) {
        const struct dicom_stack *stack = loading_stack_of(loading, i);
        has_image |= stack != NULL;
        has_series |=
            stack && object && object->referenced_series[0] && strcmp(stack->series, object->referenced_series) == 0;
        has_frame |= stack && object && object->frame_of_reference[0] &&
                     strcmp(stack->frame_of_reference, object->frame_of_reference) == 0;
    }
    if (has_image && object && object->frame_of_reference[0] && !has_frame)
        report_add(&loading->plan->report, REPORT_WARNING, "region.frame-differs", reading->path,
                   "The segments were drawn in another frame of reference "
                   "(0020,0052) than any image's and may be shifted against it.");
    else if (has_image && object && !has_series)
        report_add(&loading->plan->report, REPORT_NOTE, "region.image-chosen", reading->path,
                   "The series the segments were drawn on is not here.");
    for (size_t i = 0; entry->has_color && i < reading->layers->n; i++)
        for (size_t n = 0; n < reading->layers->names[i].n; n++) {
            struct label_name *name = &reading->layers->names[i].labels[n];
            name->has_color = true;
            memcpy(name->rgb, entry->rgb, sizeof name->rgb);
        }
}

/* ---- beams ------------------------------------------------------------------------------------------------------ */

/* Distance from a point to the nearest image's box; 0 inside one, and when there is no image. */
static double outside_images_mm(const struct plan *plan, struct vec3 point)
{
    double least = INFINITY;
    for (size_t i = 0; i < plan->n_images; i++) {
        struct box3 box = grid_bounds_lps_mm(&plan->images[i].volume->grid);
        struct vec3 out = vec3(fmax(0, fmax(box.low.x - point.x, point.x - box.high.x)),
                               fmax(0, fmax(box.low.y - point.y, point.y - box.high.y)),
                               fmax(0, fmax(box.low.z - point.z, point.z - box.high.z)));
        least = fmin(least, vec3_length(out));
    }
    return isfinite(least) ? least : 0;
}

void plan_dicom_add_beams(struct loading *loading)
{
    struct plan *plan = loading->plan;
    size_t n_left = 0;
    for (size_t i = 0; i < loading->n_readings; i++) {
        const struct rtplan *from = loading->readings[i].rtplan;
        for (size_t b = 0; from && b < from->n_beams; b++) {
            const char *others[PLAN_MAX_BEAMS];
            if (plan->n_beams >= PLAN_MAX_BEAMS) {
                n_left++;
                continue;
            }
            for (size_t o = 0; o < plan->n_beams; o++)
                others[o] = plan->beams[o].id;
            struct beam *beam = &plan->beams[plan->n_beams];
            *beam = from->beams[b];
            plan->beam_origins[plan->n_beams] = origin_of_reading(loading, &loading->readings[i]);
            registrations_move_beam(plan, plan->n_beams);
            double outside_mm = outside_images_mm(plan, beam->target_lps_mm);
            if (outside_mm > 0)
                report_add(&plan->report, REPORT_WARNING, "beam.outside", loading->readings[i].path,
                           "Beam \"%s\": its isocentre (%.4g, %.4g, %.4g mm) "
                           "lies %.4g mm outside every image.",
                           beam->name, beam->target_lps_mm.x, beam->target_lps_mm.y, beam->target_lps_mm.z, outside_mm);
            plan_make_id(beam->id, from->beams[b].id[0] ? from->beams[b].id : from->beams[b].name, "beam", others,
                         plan->n_beams++);
        }
    }
    if (n_left > 0)
        report_add(&plan->report, REPORT_WARNING, "plan.ignored-file", "", "More than %d beams; %zu were left out.",
                   PLAN_MAX_BEAMS, n_left);
}
