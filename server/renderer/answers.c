/* Answers to questions about a plan and a scene, and what --scan and --probe-gl print, as JSON. */
#include "server/renderer/answers.h"

#include <math.h>

#include "core/derive/shapes.h"
#include "core/pick/pick.h"
#include "core/scene/scene_probe.h"
#include "server/wire/document.h"
#include "server/wire/json.h"
#include "server/wire/plan_origins.h"
#include "server/wire/shape_query.h"
#include "wire_gen.h"

static cJSON *point(struct vec3 p)
{
    return cJSON_CreateDoubleArray((double[3]){ p.x, p.y, p.z }, 3);
}

static uint8_t *shape_file(const struct plan *plan, struct subject subject, const struct shape_query *query,
                           const struct shape *shape, size_t *n_bytes, struct error *err)
{
    const struct region *region = &plan->regions.regions[subject.index];
    bool is_surface = query->key.representation == REPRESENTATION_SURFACE;
    const struct mesh_export_about about = { plan->id,
                                             region->id,
                                             is_surface ? surface_algorithm_word(query->key.algorithm)
                                                        : region_representation_word(query->key.representation),
                                             plan->is_phantom,
                                             query->is_faceted || shape->is_faceted,
                                             { region->rgb[0], region->rgb[1], region->rgb[2] } };
    return mesh_export(shape->mesh, query->format, &about, PACKET_MAX_BLOB, n_bytes, err);
}

/* Adds the fields of the query that decide the shape. */
static void add_key(cJSON *json, const struct shape_query *query)
{
    const struct shape_key *key = &query->key;
    cJSON_AddStringToObject(json, "representation", region_representation_word(key->representation));
    if (key->representation == REPRESENTATION_SURFACE) {
        cJSON_AddStringToObject(json, "algorithm", surface_algorithm_word(key->algorithm));
        cJSON_AddStringToObject(json, "normals", scene_normals_words.words[query->is_faceted]);
    } else if (key->representation == REPRESENTATION_OUTLINE) {
        cJSON_AddStringToObject(json, "outline", scene_outline_method_words.words[key->outline]);
    } else if (key->representation == REPRESENTATION_POINTS || key->representation == REPRESENTATION_SOLID) {
        cJSON_AddBoolToObject(json, "inner_boundary", key->has_inner_boundary);
    } else if (key->representation == REPRESENTATION_NURBS) {
        cJSON_AddNumberToObject(json, "order", key->nurbs_order);
        cJSON_AddStringToObject(json, "sampling", scene_nurbs_sampling_words.words[key->nurbs_sampling]);
        cJSON_AddNumberToObject(json, "bins", key->nurbs_bins);
    }
}

/* {region, representation, what else decides the shape, triangles, vertices, lines, points, area_mm2, volume_mm3,
 * univel_volume_mm3, n_univels, distance_mean_mm, distance_max_mm, n_bytes, ms}; null where a shape has no such figure.
 * When the question wants a file also its bytes, at most PACKET_MAX_BLOB. */
cJSON *answer_surface(struct question *question, struct derive *derived, struct problem *problem)
{
    const struct plan *plan = derive_plan(derived);
    const char *id = question->packet.surface.region;
    const struct region *region = region_find(&plan->regions, id);
    struct shape_query query;
    if (!region) {
        (void)problem_set(problem, PROBLEM_NOT_FOUND, "/region", "", "the plan has no region \"%.64s\"", id);
        return NULL;
    }
    if (fit_is_of_other(plan, fit_part_of_region(plan, (size_t)(region - plan->regions.regions)))) {
        (void)problem_set(problem, PROBLEM_NOT_FOUND, "/region", "not-used",
                          "the region \"%.64s\" belongs to another patient than the one shown", id);
        return NULL;
    }
    if (!shape_query_read(question->packet.json, &query, problem))
        return NULL;
    struct error err = { 0 };
    struct shape_facts facts;
    const struct subject subject = subject_region((size_t)(region - plan->regions.regions));
    const struct shape_want want = { subject, query.key, SURFACE_FULL };
    struct shape *shape = derive_shape(derived, &want, &facts, &err);
    bool is_good = shape != NULL, has_mesh = shape && shape->kind == SHAPE_TRIANGLES;
    if (shape && query.is_file)
        is_good = (question->file = shape_file(plan, subject, &query, shape, &question->n_file, &err)) != NULL;
    else if (shape)
        is_good = derive_shape_distance(derived, &want, shape, &facts, &err);
    shape_unref(shape);
    if (!is_good) {
        (void)problem_from_error(problem, &err);
        return NULL;
    }
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "region", subject_id(plan, subject));
    add_key(json, &query);
    json_add_finite(json, "triangles", (double)facts.n_triangles);
    json_add_finite(json, "vertices", (double)facts.n_vertices);
    json_add_finite(json, "lines", (double)facts.n_lines);
    json_add_finite(json, "points", (double)facts.n_points);
    json_add_finite(json, "area_mm2", has_mesh ? facts.area_mm2 : NAN);
    json_add_finite(json, "volume_mm3", has_mesh ? facts.volume_mm3 : NAN);
    json_add_finite(json, "univel_volume_mm3", facts.univel_volume_mm3);
    json_add_finite(json, "n_univels", (double)facts.n_univels);
    json_add_finite(json, "distance_mean_mm", facts.distance_mean_mm);
    json_add_finite(json, "distance_max_mm", facts.distance_max_mm);
    json_add_finite(json, "n_bytes", (double)facts.n_bytes);
    json_add_finite(json, "ms", facts.build_ms);
    return json;
}

/* {point_lps_mm, regions: [id], images: [{id, value, unit}], doses: [{id, quantity, per_ppm, boron_ppm, value,
 * unit, per, frame_of_reference}]}; innermost region first; boron_ppm and frame_of_reference as in the plan document */
cJSON *answer_probe(struct question *question, struct derive *derived, struct problem *problem)
{
    const struct plan *plan = derive_plan(derived);
    const struct vec3 point_lps_mm = question->packet.probe.point_lps_mm;
    struct plan_probe probe;
    (void)problem;
    scene_probe(question->snapshot, point_lps_mm, &probe);
    cJSON *json = cJSON_CreateObject();
    cJSON_AddItemToObject(json, "point_lps_mm", point(point_lps_mm));
    cJSON *regions = cJSON_AddArrayToObject(json, "regions");
    for (size_t i = 0; i < probe.n_regions; i++)
        cJSON_AddItemToArray(regions, cJSON_CreateString(plan->regions.regions[probe.regions[i]].id));
    cJSON *images = cJSON_AddArrayToObject(json, "images");
    for (size_t i = 0; i < plan->n_images; i++) {
        if (!probe.has_image[i])
            continue;
        cJSON *image = cJSON_CreateObject();
        cJSON_AddStringToObject(image, "id", plan->images[i].id);
        json_add_finite(image, "value", probe.image_value[i]);
        cJSON_AddStringToObject(image, "unit", plan->images[i].unit);
        cJSON_AddItemToArray(images, image);
    }
    cJSON *doses = cJSON_AddArrayToObject(json, "doses");
    for (size_t i = 0; i < probe.n_doses; i++) {
        const struct dose *dose = &plan->doses[probe.doses[i].dose];
        const struct dose_component *component = &dose->components[probe.doses[i].component];
        char unit[DOSE_UNIT_SIZE];
        cJSON *item = cJSON_CreateObject();
        cJSON_AddStringToObject(item, "id", dose->id);
        cJSON_AddStringToObject(item, "quantity", dose_quantity_word(component->quantity));
        cJSON_AddBoolToObject(item, "per_ppm", component->is_per_ppm);
        json_add_finite(item, "boron_ppm", component->has_boron_ppm ? component->boron_ppm : NAN);
        json_add_finite(item, "value", probe.doses[i].value);
        dose_unit_of(dose, component->quantity, unit);
        cJSON_AddStringToObject(item, "unit", unit);
        cJSON_AddStringToObject(item, "per", dose->per);
        cJSON_AddItemToObject(item, "frame_of_reference",
                              dose->has_frame ? cJSON_CreateString(dose_frame_word(dose->frame)) : cJSON_CreateNull());
        cJSON_AddItemToArray(doses, item);
    }
    return json;
}

cJSON *answer_identity(struct question *question, struct derive *derived, struct problem *problem)
{
    (void)question;
    (void)problem;
    return plan_identity(derive_plan(derived));
}

/* The planned beam of a hit, and whether its draft was hit; a draft in a plan without beams has the id "". */
static void add_beam(cJSON *json, const struct snapshot *snapshot, struct subject subject)
{
    bool is_beam = subject.kind == SUBJECT_BEAM, is_draft = is_beam && subject.key;
    if (is_draft)
        subject = (struct subject){ SUBJECT_BEAM, snapshot->beam.beam < 0 ? 0 : (size_t)snapshot->beam.beam,
                                    snapshot->beam.beam < 0 };
    if (is_beam)
        cJSON_AddStringToObject(json, "beam", subject_id(snapshot->plan, subject));
    else
        cJSON_AddNullToObject(json, "beam");
    cJSON_AddBoolToObject(json, "draft", is_draft);
}

/* {hits: [{point_lps_mm, region: id | null, level: id | null, beam: id | null, draft, distance_mm, alpha, cap, seen}]},
 * front to back; one is seen */
cJSON *answer_pick(struct question *question, struct derive *derived, struct problem *problem)
{
    const struct snapshot *snapshot = question->snapshot;
    struct pick_hit hits[PICK_MAX_HITS];
    size_t n = snapshot_pick(snapshot, question->packet.pick.px, question->packet.pick.py, hits);
    (void)derived;
    const struct plan *plan = snapshot->plan;
    const struct region *preferred =
        question->packet.pick.has_prefer ? region_find(&plan->regions, question->packet.pick.prefer) : NULL;
    if (question->packet.pick.has_prefer && !preferred) {
        (void)problem_set(problem, PROBLEM_NOT_FOUND, "/prefer", "", "the plan has no region \"%.64s\"",
                          question->packet.pick.prefer);
        return NULL;
    }
    size_t seen = n ? pick_seen(hits, n, preferred ? (int)(preferred - plan->regions.regions) : -1) : 0;
    cJSON *json = cJSON_CreateObject(), *list = cJSON_AddArrayToObject(json, "hits");
    for (size_t i = 0; i < n; i++) {
        cJSON *hit = cJSON_CreateObject();
        cJSON_AddItemToObject(hit, "point_lps_mm", point(hits[i].point_lps_mm));
        if (hits[i].subject.kind == SUBJECT_REGION)
            cJSON_AddStringToObject(hit, "region", subject_id(plan, hits[i].subject));
        else
            cJSON_AddNullToObject(hit, "region");
        if (hits[i].subject.kind == SUBJECT_ISODOSE)
            cJSON_AddStringToObject(hit, "level", snapshot->scene.dose.levels[hits[i].subject.index].id);
        else
            cJSON_AddNullToObject(hit, "level");
        add_beam(hit, snapshot, hits[i].subject);
        json_add_finite(hit, "distance_mm", hits[i].distance_mm);
        json_add_finite(hit, "alpha", hits[i].alpha);
        cJSON_AddBoolToObject(hit, "cap", hits[i].is_on_cap);
        cJSON_AddBoolToObject(hit, "seen", i == seen);
        cJSON_AddItemToArray(list, hit);
    }
    return json;
}

cJSON *answer_question(struct question *question, struct derive *derived, struct problem *problem)
{
#define ANSWER_CALL(TYPE, name) \
    case TYPE: return answer_##name(question, derived, problem);
    switch (question->packet.type) {
        PACKET_QUESTIONS(ANSWER_CALL)
    default: (void)problem_set(problem, PROBLEM_INTERNAL, "", "", "a packet that is no question"); return NULL;
    }
#undef ANSWER_CALL
}

cJSON *answer_summary(const struct plan_summary *summary)
{
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "name", summary->name);
    cJSON_AddStringToObject(json, "note", summary->note);
    cJSON_AddBoolToObject(json, "phantom", summary->is_phantom);
    cJSON_AddBoolToObject(json, "has_plan_file", summary->has_plan_file);
    cJSON_AddBoolToObject(json, "readable", summary->is_readable);
    cJSON_AddStringToObject(json, "reason", summary->reason);
    cJSON_AddStringToObject(json, "patient", summary->patient);
    cJSON_AddStringToObject(json, "patient_id", summary->patient_id);
    cJSON_AddNumberToObject(json, "n_patients", (double)summary->n_patients);
    cJSON_AddStringToObject(json, "label", summary->label);
    cJSON_AddStringToObject(json, "date", summary->date);
    cJSON_AddStringToObject(json, "approval", summary->approval);
    cJSON_AddNumberToObject(json, "n_treatment_plans", (double)summary->n_treatment_plans);
    cJSON *parts = cJSON_AddArrayToObject(json, "parts");
    for (size_t i = 0; i < summary->n_parts; i++)
        cJSON_AddItemToArray(parts, cJSON_CreateString(summary->parts[i]));
    json_add_finite(json, "n_bytes", (double)summary->n_bytes);
    return json;
}

cJSON *answer_gl(const struct render_facts *facts, bool is_stub)
{
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "back_end", is_stub ? "stub" : render_back_end_word(facts->back_end));
    cJSON_AddStringToObject(json, "vendor", facts->vendor);
    cJSON_AddStringToObject(json, "renderer", facts->renderer);
    cJSON_AddStringToObject(json, "version", facts->version);
    cJSON_AddBoolToObject(json, "is_software", facts->is_software);
    return json;
}
