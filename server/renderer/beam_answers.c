/* Answers the questions about beams: the numbers of one, and where one would run. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/beam/sera_angles.h"
#include "core/region/cylinder.h"
#include "core/region/ray.h"
#include "core/scene/beam_place.h"
#include "server/renderer/answers.h"
#include "server/wire/document.h"
#include "server/wire/json.h"
#include "server/wire/plan_document.h"

static cJSON *point(struct vec3 p)
{
    return cJSON_CreateDoubleArray((double[3]){ p.x, p.y, p.z }, 3);
}

static const double SAME_DIAMETER_MM = 0.005; /* figures are given to 0.1 mm */

/* A beam and what its axis crosses. */
struct beam_asked {
    const struct plan *plan;
    const struct region_set *regions; /* those that are used */
    struct beam_shown shown;
    const struct beam *planned;          /* NULL: of a draft in a plan without beams */
    double cylinder_mm;                  /* diameter in which univels are counted; NaN: none */
    const struct beam_delivery *opening; /* of a beam without a diameter; NULL: none is known */
    bool is_ring;                        /* that diameter was asked for, and is not the beam's aperture */
    struct ray_band *bands;              /* owned; along the whole axis, depths from the entry */
    size_t n_bands;
};

/* ring_mm: a diameter that was asked for; NaN: none was. */
static bool beam_asked_fill(struct beam_asked *asked, double ring_mm, struct problem *problem)
{
    struct error err = { 0 };
    const double own_mm = asked->shown.aperture_mm;
    asked->cylinder_mm = ring_mm > 0 ? ring_mm : own_mm;
    asked->is_ring = ring_mm > 0 && !(fabs(ring_mm - own_mm) <= SAME_DIAMETER_MM);
    asked->planned = asked->shown.beam >= 0 ? &asked->plan->beams[asked->shown.beam] : NULL;
    bool has_opening = !(asked->cylinder_mm > 0) && asked->planned && !asked->shown.is_draft &&
                       asked->planned->has_delivery && asked->planned->delivery.outline.n_polygons > 0;
    asked->opening = has_opening ? &asked->planned->delivery : NULL;
    return ray_bands_all(asked->regions, asked->shown.entry_lps_mm, asked->shown.direction, &asked->bands,
                         &asked->n_bands, &err) ||
           problem_set(problem, PROBLEM_MEMORY, "", "", "%s", err.text);
}

/* ---- parts of the answer ---------------------------------------------------------------------------------------------- */
static void add_line(cJSON *json, const struct beam_asked *asked)
{
    const struct beam_shown *shown = &asked->shown;
    const struct beam *planned = asked->planned;
    cJSON_AddItemToObject(json, "beam", planned ? cJSON_CreateString(planned->id) : cJSON_CreateNull());
    cJSON_AddBoolToObject(json, "is_draft", shown->is_draft);
    cJSON_AddStringToObject(json, "source",
                            shown->is_draft         ? "draft"
                            : planned->has_delivery ? "treatment-plan"
                                                    : "plan-folder");
    cJSON_AddItemToObject(json, "entry_lps_mm", point(shown->entry_lps_mm));
    cJSON_AddItemToObject(json, "target_lps_mm", point(shown->target_lps_mm));
    cJSON_AddItemToObject(json, "direction", point(shown->direction));
    json_add_finite(json, "length_mm", shown->length_mm);
    json_add_finite(json, "aperture_mm", shown->aperture_mm);
    bool has_radiation = planned && planned->has_delivery && planned->delivery.radiation[0];
    cJSON_AddItemToObject(json, "radiation",
                          has_radiation ? cJSON_CreateString(planned->delivery.radiation) : cJSON_CreateNull());
}

static void add_angles(cJSON *json, const struct beam_asked *asked)
{
    struct sera_angles angles = sera_angles_of(asked->shown.entry_lps_mm, asked->shown.target_lps_mm);
    char card[SERA_CARD_SIZE];
    cJSON *sera = cJSON_AddObjectToObject(json, "sera");
    cJSON_AddItemToObject(sera, "target_cm", cJSON_CreateDoubleArray(angles.target_cm, 3));
    json_add_finite(sera, "z_cm", angles.z_cm);
    json_add_finite(sera, "phi_deg", angles.phi_deg);
    json_add_finite(sera, "theta_deg", angles.theta_deg);
    cJSON_AddStringToObject(json, "card", sera_card(&angles, card));
    if (!asked->planned || !asked->planned->has_delivery) {
        cJSON_AddNullToObject(json, "iec");
        return;
    }
    const struct beam_delivery *delivery = &asked->planned->delivery;
    struct beam_angles room = { .gantry_deg = delivery->gantry_deg, .couch_deg = delivery->couch_deg };
    if (asked->shown.is_draft)
        room = beam_angles_from_direction(vec3_scale(asked->shown.direction, -1), delivery->patient_position, &room);
    cJSON *iec = cJSON_AddObjectToObject(json, "iec");
    json_add_finite(iec, "gantry_deg", room.gantry_deg);
    json_add_finite(iec, "couch_deg", room.couch_deg);
    cJSON_AddStringToObject(iec, "patient_position", patient_position_word(delivery->patient_position));
}

static void add_crossed(cJSON *json, const struct beam_asked *asked)
{
    const struct region_set *set = asked->regions;
    cJSON *bands = cJSON_AddArrayToObject(json, "bands"), *crossed = cJSON_AddArrayToObject(json, "crossed");
    for (size_t i = 0; i < asked->n_bands; i++) {
        const struct ray_band *band = &asked->bands[i];
        cJSON *item = cJSON_CreateObject();
        cJSON_AddStringToObject(item, "region", set->regions[band->region].id);
        json_add_finite(item, "from_mm", band->from_mm);
        json_add_finite(item, "to_mm", band->to_mm);
        cJSON_AddItemToArray(bands, item);
        double length = 0, to_target = 0;
        bool is_first = true;
        for (size_t other = 0; other < asked->n_bands; other++) {
            const struct ray_band *of = &asked->bands[other];
            if (of->region != band->region)
                continue;
            is_first = is_first && other >= i;
            length += of->to_mm - of->from_mm;
            to_target += fmax(fmin(of->to_mm, asked->shown.length_mm) - of->from_mm, 0);
        }
        if (!is_first)
            continue;
        item = cJSON_CreateObject();
        cJSON_AddStringToObject(item, "region", set->regions[band->region].id);
        json_add_finite(item, "length_mm", length);
        json_add_finite(item, "to_target_mm", to_target);
        cJSON_AddItemToArray(crossed, item);
    }
}

static void add_depths(cJSON *json, const struct beam_asked *asked)
{
    double skin = asked->n_bands ? asked->bands[0].from_mm : NAN;
    cJSON_AddItemToObject(json, "skin_lps_mm",
                          asked->n_bands ? point(beam_point(&asked->shown, skin)) : cJSON_CreateNull());
    json_add_finite(json, "skin_along_mm", skin);
    json_add_finite(json, "gap_mm", skin);
    json_add_finite(json, "depth_mm", asked->shown.length_mm - skin);
    cJSON_AddItemToObject(json, "skin_reason",
                          asked->n_bands ? cJSON_CreateNull()
                          : asked->regions->n_regions
                              ? cJSON_CreateString("The beam's axis meets no region.")
                              : cJSON_CreateString("The plan has no regions that a beam could meet."));
    add_crossed(json, asked);
}

/* The opening of jaws, leaves and blocks; not of a draft, whose collimator is not placed. */
static void add_outline(cJSON *json, const struct beam_asked *asked)
{
    bool has_one = !asked->shown.is_draft && asked->planned->has_delivery;
    cJSON *outline = has_one ? beam_outline_object(&asked->planned->delivery.outline) : cJSON_CreateNull();
    if (cJSON_IsObject(outline)) {
        cJSON_AddItemToObject(outline, "x_lps", point(asked->planned->delivery.collimator_x_lps));
        cJSON_AddItemToObject(outline, "y_lps", point(asked->planned->delivery.collimator_y_lps));
    }
    cJSON_AddItemToObject(json, "outline", outline);
}

_Static_assert((int)BEAM_OUTLINE_MAX_POINTS <= (int)REGION_PRISM_MAX_POINTS, "every outline can be counted in");
static bool count_univels(const struct beam_asked *asked, struct region_in_cylinder *found, struct error *err)
{
    const struct vec3 from = asked->shown.entry_lps_mm, direction = asked->shown.direction;
    if (!asked->opening)
        return regions_in_cylinder(asked->regions, from, direction, asked->cylinder_mm / 2, found, err);
    const struct region_prism prism = { .x_lps = asked->opening->collimator_x_lps,
                                        .y_lps = asked->opening->collimator_y_lps,
                                        .points_mm = asked->opening->outline.points_mm,
                                        .ends = asked->opening->outline.ends,
                                        .n_polygons = asked->opening->outline.n_polygons };
    return regions_in_prism(asked->regions, from, direction, &prism, found, err);
}

/* The univels of regions inside the aperture, the opening or the ring, the first met first. */
static bool add_aperture(cJSON *json, const struct beam_asked *asked, struct problem *problem)
{
    const struct region_set *set = asked->regions;
    struct error err = { 0 };
    if (!(asked->cylinder_mm > 0) && !asked->opening) {
        cJSON_AddNullToObject(json, "aperture");
        return true;
    }
    struct region_in_cylinder *found = mem_array(set->n_regions + 1, sizeof *found, UINT64_MAX, &err);
    if (!found || !count_univels(asked, found, &err)) {
        free(found);
        return problem_set(problem, PROBLEM_MEMORY, "", "", "%s", err.text);
    }
    cJSON *aperture = cJSON_AddObjectToObject(json, "aperture");
    json_add_finite(aperture, "diameter_mm", asked->cylinder_mm);
    cJSON_AddItemToObject(aperture, "opening",
                          asked->opening ? cJSON_CreateString(beam_outline_word(asked->opening->outline.kind))
                                         : cJSON_CreateNull());
    cJSON_AddBoolToObject(aperture, "is_ring", asked->is_ring);
    cJSON *list = cJSON_AddArrayToObject(aperture, "regions");
    for (;;) {
        size_t next = set->n_regions;
        for (size_t r = 0; r < set->n_regions; r++)
            if (found[r].n_voxels > 0 &&
                (next == set->n_regions || found[r].first_along_mm < found[next].first_along_mm))
                next = r;
        if (next == set->n_regions)
            break;
        const struct region *region = &set->regions[next];
        double share = (double)found[next].n_voxels / (double)region->n_voxels;
        cJSON *item = cJSON_CreateObject();
        cJSON_AddStringToObject(item, "region", region->id);
        json_add_finite(item, "first_mm", found[next].first_along_mm);
        json_add_finite(item, "inside_cm3", share * region->volume_cm3);
        json_add_finite(item, "region_cm3", region->volume_cm3);
        json_add_finite(item, "share", share);
        cJSON_AddItemToArray(list, item);
        found[next].n_voxels = 0;
    }
    free(found);
    return true;
}

/* All but planned and moved. NULL with problem. */
static cJSON *beam_json(struct beam_asked *asked, double ring_mm, struct problem *problem)
{
    if (!beam_asked_fill(asked, ring_mm, problem))
        return NULL;
    cJSON *json = cJSON_CreateObject();
    add_line(json, asked);
    add_angles(json, asked);
    add_depths(json, asked);
    add_outline(json, asked);
    bool is_good = add_aperture(json, asked, problem);
    free(asked->bands);
    if (is_good)
        return json;
    cJSON_Delete(json);
    return NULL;
}

static bool find_beam(const struct snapshot *snapshot, const char *id, struct beam_shown *shown,
                      struct problem *problem)
{
    const struct plan *plan = snapshot->plan;
    if (beam_shown_of(plan, &snapshot->scene, id, &snapshot->fits, shown))
        return true;
    const char *wanted = id[0] ? id : snapshot->scene.beam.id;
    for (size_t i = 0; i < plan->n_beams; i++) {
        char why[FIT_WHY_SIZE];
        if ((wanted[0] && strcmp(plan->beams[i].id, wanted) != 0) || fit_is_used(&snapshot->fits.beams[i]))
            continue;
        fit_use_sentence(&snapshot->fits, (struct fit_part){ FIT_BEAM, i }, &snapshot->fits.beams[i], why);
        return problem_set(problem, PROBLEM_NOT_FOUND, "/beam", "not-used", "%s", why);
    }
    return id[0] ? problem_set(problem, PROBLEM_NOT_FOUND, "/beam", "", "the plan has no beam \"%.64s\"", id)
                 : problem_set(problem, PROBLEM_NOT_FOUND, "/beam", "",
                               "the plan has no beam, and the scene has no draft of one");
}

cJSON *answer_beam(struct question *question, struct derive *derived, struct problem *problem)
{
    const struct snapshot *snapshot = question->snapshot;
    const struct plan *plan = snapshot->plan;
    struct beam_asked asked = { .plan = plan, .regions = &snapshot->fits.used };
    (void)derived;
    if (!find_beam(snapshot, question->packet.beam.beam, &asked.shown, problem))
        return NULL;
    const double ring_mm = question->packet.beam.has_aperture_mm ? question->packet.beam.aperture_mm : NAN;
    cJSON *json = beam_json(&asked, ring_mm, problem);
    if (!json)
        return NULL;
    const char *name = asked.shown.is_draft ? snapshot->scene.beam.draft.line.name : asked.planned->name;
    cJSON_AddStringToObject(json, "name", name);
    if (!asked.shown.is_draft || !asked.planned) {
        cJSON_AddNullToObject(json, "planned");
        cJSON_AddNullToObject(json, "moved");
        return json;
    }
    struct beam_asked before = { .plan = plan,
                                 .regions = &snapshot->fits.used,
                                 .shown = beam_planned(plan, (size_t)asked.shown.beam) };
    cJSON *planned = beam_json(&before, ring_mm, problem);
    if (!planned) {
        cJSON_Delete(json);
        return NULL;
    }
    cJSON_AddStringToObject(planned, "name", asked.planned->name);
    cJSON_AddItemToObject(json, "planned", planned);
    cJSON *moved = cJSON_AddObjectToObject(json, "moved");
    const struct vec3 a = before.shown.direction, b = asked.shown.direction;
    json_add_finite(moved, "entry_mm", vec3_length(vec3_sub(asked.shown.entry_lps_mm, before.shown.entry_lps_mm)));
    json_add_finite(moved, "target_mm", vec3_length(vec3_sub(asked.shown.target_lps_mm, before.shown.target_lps_mm)));
    json_add_finite(moved, "direction_deg", atan2(vec3_length(vec3_cross(a, b)), vec3_dot(a, b)) * 180 / MATH_PI);
    return json;
}

static bool needs(bool has, const char *name, const char *mode, struct problem *problem)
{
    char pointer[32];
    (void)snprintf(pointer, sizeof pointer, "/%s", name);
    return has || problem_set(problem, PROBLEM_VALIDATION, pointer, "required", "the mode %s needs %s", mode, name);
}

/* False with problem, or with err: the beam cannot be placed so. */
static bool place(const struct region_set *regions, const struct packet_beam_place *asked,
                  const struct beam_shown *beam, struct vec3 *entry_lps_mm, struct problem *problem, struct error *err)
{
    double gap_mm = asked->has_gap_mm ? asked->gap_mm : NAN;
    switch (asked->mode) {
    case PACKET_BEAM_PLACE_MODE_GAP:
        return needs(asked->has_gap_mm, "gap_mm", "gap", problem) &&
               beam_place_gap(regions, beam, gap_mm, entry_lps_mm, err);
    case PACKET_BEAM_PLACE_MODE_THROUGH:
        return needs(asked->has_point_lps_mm, "point_lps_mm", "through", problem) &&
               beam_place_through(regions, beam, asked->point_lps_mm, gap_mm, entry_lps_mm, err);
    case PACKET_BEAM_PLACE_MODE_SHORTEST: return beam_place_shortest(regions, beam, gap_mm, entry_lps_mm, err);
    default:
        return needs(asked->has_phi_deg, "phi_deg", "angles", problem) &&
               needs(asked->has_theta_deg, "theta_deg", "angles", problem) &&
               beam_place_angles(beam, asked->phi_deg, asked->theta_deg, entry_lps_mm, err);
    }
}

/* {entry_mm, target_mm, gap_mm, depth_mm, why} */
cJSON *answer_beam_place(struct question *question, struct derive *derived, struct problem *problem)
{
    const struct region_set *regions = &question->snapshot->fits.used;
    const struct packet_beam_place *asked = &question->packet.beam_place;
    struct beam_shown beam;
    struct beam_skin skin = { NAN, NAN };
    struct vec3 entry_lps_mm;
    struct error why = { 0 };
    (void)derived;
    if (!find_beam(question->snapshot, asked->beam, &beam, problem))
        return NULL;
    bool is_placed = place(regions, asked, &beam, &entry_lps_mm, problem, &why) &&
                     beam_skin_of(regions, entry_lps_mm, beam.target_lps_mm, &skin, &why);
    if (!is_placed && why.code != ERROR_RANGE) {
        if (why.code)
            (void)problem_from_error(problem, &why);
        return NULL;
    }
    cJSON *json = cJSON_CreateObject();
    cJSON_AddItemToObject(json, "entry_mm", is_placed ? point(entry_lps_mm) : cJSON_CreateNull());
    cJSON_AddItemToObject(json, "target_mm", is_placed ? point(beam.target_lps_mm) : cJSON_CreateNull());
    json_add_finite(json, "gap_mm", skin.gap_mm);
    json_add_finite(json, "depth_mm", skin.depth_mm);
    cJSON_AddItemToObject(json, "why", is_placed ? cJSON_CreateNull() : cJSON_CreateString(why.text));
    return json;
}
