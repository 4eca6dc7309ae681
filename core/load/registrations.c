/* Reads registrations and applies them. */
#include "core/load/registrations.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/formats/dicom/dicom_registration.h"
#include "core/load/dicom_parts.h"
#include "core/plan/fit.h"

#define SAME_WITHIN_MM 0.1 /* two registrations of one pair of frames; a tenth of the finest voxels */

/* ---- reading ---------------------------------------------------------------------------------------------------- */

static void add_registration(struct plan *plan, const struct dicom_registration *from, int patient)
{
    struct plan_registration *added = &plan->registrations[plan->n_registrations++];
    snprintf(added->from_uid, sizeof added->from_uid, "%.64s", from->from_uid);
    snprintf(added->to_uid, sizeof added->to_uid, "%.64s", from->to_uid);
    added->to_from_lps_mm = from->to_from_lps_mm;
    added->patient = patient;
}

static void read_object(struct loading *loading, const struct dicom_object *object)
{
    struct plan *plan = loading->plan;
    struct plan_dicom_file opened;
    struct dicom_registration found[ORIGIN_MAX_REGISTRATIONS];
    struct error err = { 0 };
    if (!plan_dicom_open(&loading->folder, object->path, &opened, &err)) {
        report_add(&plan->report, REPORT_ERROR, "dicom.unreadable", object->path, "%s", err.text);
        return;
    }
    size_t n = dicom_registration_read(opened.file, object->path, found,
                                       ORIGIN_MAX_REGISTRATIONS - plan->n_registrations, &plan->report);
    plan_dicom_close(&opened);
    for (size_t i = 0; i < n; i++)
        add_registration(plan, &found[i], object->patient);
    report_add(&plan->report, REPORT_NOTE, "registration.read", object->path,
               "A registration of frames of reference with %zu rigid transformation%s.", n, n == 1 ? "" : "s");
}

/* The largest distance between where two maps bring points 200 mm from the frame's origin along its axes: the size of a
 * head. */
static double apart_mm(const struct affine *a, const struct affine *b)
{
    static const struct vec3 points[] = { { 200, 0, 0 },  { -200, 0, 0 }, { 0, 200, 0 },
                                          { 0, -200, 0 }, { 0, 0, 200 },  { 0, 0, -200 } };
    double most = 0;
    for (size_t i = 0; i < sizeof points / sizeof *points; i++)
        most = fmax(most, vec3_length(vec3_sub(affine_point(a, points[i]), affine_point(b, points[i]))));
    return most;
}

/* How far two registrations of the same two frames differ, mm; 0: they are of different frames, or of two patients. */
static double contradiction_mm(const struct plan_registration *a, const struct plan_registration *b)
{
    struct affine back;
    if (a->patient != b->patient)
        return 0;
    if (strcmp(a->from_uid, b->from_uid) == 0 && strcmp(a->to_uid, b->to_uid) == 0)
        return apart_mm(&a->to_from_lps_mm, &b->to_from_lps_mm);
    if (strcmp(a->from_uid, b->to_uid) != 0 || strcmp(a->to_uid, b->from_uid) != 0)
        return 0;
    return affine_invert(&b->to_from_lps_mm, &back) ? apart_mm(&a->to_from_lps_mm, &back) : INFINITY;
}

/* Registrations that contradict each other are taken out: which one holds is not said anywhere. */
static void drop_contradicting(struct plan *plan)
{
    bool is_dropped[ORIGIN_MAX_REGISTRATIONS] = { false };
    double most_mm = 0;
    size_t n = 0, n_dropped = 0;
    for (size_t i = 0; i < plan->n_registrations; i++)
        for (size_t j = 0; j < i; j++) {
            double mm = contradiction_mm(&plan->registrations[i], &plan->registrations[j]);
            if (mm > SAME_WITHIN_MM) {
                is_dropped[i] = is_dropped[j] = true;
                most_mm = fmax(most_mm, mm);
            }
        }
    for (size_t i = 0; i < plan->n_registrations; i++)
        if (is_dropped[i])
            n_dropped++;
        else
            plan->registrations[n++] = plan->registrations[i];
    plan->n_registrations = n;
    if (n_dropped > 0)
        report_add(
            &plan->report, REPORT_WARNING, "registration.not-applied", "",
            "%zu registrations of the same frames of reference differ by up to %.3g mm within 200 mm; none of them "
            "is applied.",
            n_dropped, most_mm);
}

void registrations_read(struct loading *loading)
{
    const struct dicom_index *index = loading->parts.dicom;
    for (size_t i = 0; index && i < index->n_objects; i++)
        if (index->objects[i].kind == DICOM_KIND_REGISTRATION)
            read_object(loading, &index->objects[i]);
    drop_contradicting(loading->plan);
}

/* ---- applying --------------------------------------------------------------------------------------------------- */

/* The first image that is not of another patient than the one that is shown; NULL: none. */
static const struct part_origin *world_of(const struct plan *plan)
{
    int image = fit_first_image(plan);
    return image >= 0 ? &plan->image_origins[image] : NULL;
}

/* The map from the part's frame of reference to that of the world's image, over one registration, in its direction or
 * against it. False: there is none, or none is needed. */
static bool find_map(const struct plan *plan, const struct part_origin *origin, struct affine *map)
{
    const struct part_origin *world = world_of(plan);
    if (!world || !world->frame_uid[0] || !origin->frame_uid[0] || strcmp(origin->frame_uid, world->frame_uid) == 0 ||
        origin->patient != world->patient)
        return false;
    for (size_t i = 0; i < plan->n_registrations; i++) {
        const struct plan_registration *registration = &plan->registrations[i];
        const char *from = registration->from_uid, *to = registration->to_uid;
        if (registration->patient != origin->patient)
            continue;
        if (strcmp(from, origin->frame_uid) == 0 && strcmp(to, world->frame_uid) == 0) {
            *map = registration->to_from_lps_mm;
            return true;
        }
        if (strcmp(to, origin->frame_uid) == 0 && strcmp(from, world->frame_uid) == 0)
            return affine_invert(&registration->to_from_lps_mm, map);
    }
    return false;
}

/* Moves the grids of all volumes (NULL: none there), or of none. */
static bool move_grids(struct volume *const *volumes, size_t n, const struct affine *map)
{
    for (int is_moving = 0; is_moving < 2; is_moving++)
        for (size_t i = 0; i < n; i++) {
            struct grid grid;
            if (!volumes[i])
                continue;
            struct affine moved = affine_compose(map, &volumes[i]->grid.lps_mm_from_ijk);
            if (!grid_init(&grid, volumes[i]->grid.size, &moved, NULL))
                return false;
            if (is_moving)
                volumes[i]->grid = grid;
        }
    return true;
}

static void say(struct plan *plan, const char *what, const char *name, const char *where, const struct affine *map)
{
    double cosine = (map->columns[0].x + map->columns[1].y + map->columns[2].z - 1) / 2;
    double angle_deg = acos(fmax(-1, fmin(1, cosine))) * 180 / 3.14159265358979323846;
    report_add(&plan->report, REPORT_NOTE, "registration.applied", where,
               "%s \"%s\" lies in another frame of reference than the image \"%s\"; the registration of the two was "
               "applied: a turn of %.3g degrees and a shift of (%.4g, %.4g, %.4g) mm.",
               what, name, plan->images[fit_first_image(plan)].id, angle_deg, map->origin.x, map->origin.y,
               map->origin.z);
}

static void mark(struct plan *plan, struct part_origin *origin)
{
    memcpy(origin->frame_uid, world_of(plan)->frame_uid, sizeof origin->frame_uid);
    origin->is_registered = true;
}

static bool refuse(struct plan *plan, const char *what, const char *name, const char *where, const char *why)
{
    report_add(&plan->report, REPORT_WARNING, "registration.not-applied", where,
               "The registration was not applied to %s \"%s\": %s.", what, name, why);
    return false;
}

static const struct part_origin *origin_of_region(const struct plan *plan, const struct region *region)
{
    return region->origin > 0 && region->origin <= plan->n_region_origins ? &plan->region_origins[region->origin - 1]
                                                                          : NULL;
}

static bool is_of_frame(const struct part_origin *origin, const struct part_origin *as)
{
    return origin && origin->patient == as->patient && strcmp(origin->frame_uid, as->frame_uid) == 0;
}

/* True if every region of the layer is of the frame of reference and patient of `as`. */
static bool is_of_one_frame(const struct plan *plan, size_t layer, const struct part_origin *as)
{
    for (size_t r = 0; r < plan->regions.n_regions; r++)
        if (plan->regions.regions[r].layer == layer &&
            !is_of_frame(origin_of_region(plan, &plan->regions.regions[r]), as))
            return false;
    return true;
}

/* Moves every layer with a region of the frame and patient of `as`, or none. */
static bool move_layers(struct plan *plan, const struct part_origin *as, const struct affine *map)
{
    struct volume *moved[REGION_MAX_LAYERS] = { NULL };
    for (size_t r = 0; r < plan->regions.n_regions; r++) {
        const struct region *region = &plan->regions.regions[r];
        if (!is_of_frame(origin_of_region(plan, region), as))
            continue;
        if (!is_of_one_frame(plan, region->layer, as))
            return refuse(plan, "regions", region->name, as->path,
                          "they share a layer with regions of another frame of reference");
        moved[region->layer] = plan->regions.layers[region->layer];
    }
    return move_grids(moved, plan->regions.n_layers, map) ||
           refuse(plan, "regions", "", as->path, "the grid would lie out of bounds");
}

/* Sources of one frame of reference may share layers, and are moved together. */
static void move_regions(struct plan *plan)
{
    for (size_t s = 0; s < plan->n_region_origins; s++) {
        struct affine map;
        const struct part_origin as = plan->region_origins[s];
        if (!find_map(plan, &as, &map) || !move_layers(plan, &as, &map))
            continue;
        say(plan, "Regions of", as.path, as.path, &map);
        for (size_t other = s; other < plan->n_region_origins; other++)
            if (is_of_frame(&plan->region_origins[other], &as))
                mark(plan, &plan->region_origins[other]);
    }
}

void registrations_move_images_and_regions(struct plan *plan)
{
    for (size_t i = 0; i < plan->n_images; i++) {
        struct affine map;
        struct part_origin *origin = &plan->image_origins[i];
        if (!find_map(plan, origin, &map))
            continue;
        if (!move_grids(&plan->images[i].volume, 1, &map)) {
            (void)refuse(plan, "image", plan->images[i].id, origin->path, "it would lie out of bounds");
            continue;
        }
        say(plan, "Image", plan->images[i].id, origin->path, &map);
        mark(plan, origin);
    }
    move_regions(plan);
}

static bool move_dose(struct dose *dose, const struct affine *map)
{
    struct volume *moved[2 * DOSE_N_QUANTITIES + 1] = { dose->mask };
    size_t n = 1;
    for (size_t c = 0; c < dose->n_components; c++) {
        moved[n++] = dose->components[c].values;
        moved[n++] = dose->components[c].error;
    }
    return move_grids(moved, n, map);
}

void registrations_move_doses(struct plan *plan)
{
    for (size_t d = 0; d < plan->n_doses; d++) {
        struct affine map;
        struct part_origin *origin = &plan->dose_origins[d];
        if (origin->is_stated_other || !find_map(plan, origin, &map))
            continue;
        if (!move_dose(&plan->doses[d], &map)) {
            (void)refuse(plan, "dose", plan->doses[d].id, origin->path, "it would lie out of bounds");
            continue;
        }
        say(plan, "Dose", plan->doses[d].name, origin->path, &map);
        mark(plan, origin);
    }
}

void registrations_move_beam(struct plan *plan, size_t index)
{
    struct affine map;
    struct beam *beam = &plan->beams[index];
    if (!find_map(plan, &plan->beam_origins[index], &map))
        return;
    beam->entry_lps_mm = affine_point(&map, beam->entry_lps_mm);
    beam->target_lps_mm = affine_point(&map, beam->target_lps_mm);
    beam->delivery.collimator_x_lps = affine_vector(&map, beam->delivery.collimator_x_lps);
    beam->delivery.collimator_y_lps = affine_vector(&map, beam->delivery.collimator_y_lps);
    say(plan, "Beam", beam->name, plan->beam_origins[index].path, &map);
    mark(plan, &plan->beam_origins[index]);
}

void registrations_warn(struct plan *plan)
{
    size_t n = 0;
    for (size_t i = 0; i < plan->n_images; i++) {
        const char *frame = plan->image_origins[i].frame_uid;
        bool is_new = frame[0] != 0;
        for (size_t before = 0; is_new && before < i; before++)
            is_new = strcmp(plan->image_origins[before].frame_uid, frame) != 0;
        n += is_new;
    }
    if (n > 1)
        report_add(&plan->report, REPORT_WARNING, "geometry.frames-differ", "",
                   "The image series have %zu frames of reference; nothing says how they lie to each other, and their "
                   "coordinates were taken as they are.",
                   n);
}
