/* Shapes of every representation, pictures of our own rasteriser and of GL, and their compression, while a call of the
 * system fails. */
#include "core/annotate/describe.h"
#include "core/derive/shapes.h"
#include "core/encode/encode.h"
#include "core/render/render.h"
#include "core/render/visible/visible.h"
#include "tests/check.h"
#include "tests/faults/walk.h"
#include "tests/made_ragged.h"

static double grey(struct vec3 lps_mm)
{
    return floor(10 * lps_mm.x + 3 * lps_mm.y + lps_mm.z);
}

static struct plan *make_plan(void)
{
    struct plan *plan = ragged_plan();
    struct grid grid = ragged_grid();
    made_plan_add_image(plan, &grid, VOXEL_I16, grey);
    struct dose *dose = &plan->doses[plan->n_doses++];
    snprintf(dose->id, sizeof dose->id, "mc");
    snprintf(dose->unit, sizeof dose->unit, "Gy");
    for (int i = 0; i < 2; i++)
        dose->components[dose->n_components++] = (struct dose_component){
            .quantity = i ? DOSE_GAMMA : DOSE_BORON, .is_per_ppm = !i, .values = made_volume(&grid, VOXEL_F32, grey)
        };
    plan->beams[plan->n_beams++] =
        (struct beam){ .id = "field", .entry_lps_mm = { 0, -40, 0 }, .target_lps_mm = { 0, 0, 0 }, .aperture_mm = 20 };
    return plan;
}

/* In the plan's box and across it, of all classes. */
static void add_tracks(struct plan *plan)
{
    enum { N = 300 };
    struct track_set *set = &plan->tracks;
    set->segments = mem_new(N * sizeof *set->segments);
    for (; set->n_segments < N; set->n_segments++) {
        float at = (float)set->n_segments;
        set->segments[set->n_segments] = (struct track_segment){
            .from_lps_mm = { fmodf(at, 7), fmodf(at, 11), fmodf(at, 13) },
            .to_lps_mm = { fmodf(at, 17) - 4, fmodf(at, 5), set->n_segments % 40 ? fmodf(at, 19) : 900 },
            .class = (uint8_t)(set->n_segments % TRACK_N_CLASSES),
            .energy_mev = NAN,
        };
        set->n_of_class[set->n_segments % TRACK_N_CLASSES]++;
    }
}

static void add_shape(struct outcome *outcome, const struct shape *shape)
{
    outcome_add_number(outcome, shape->kind);
    if (shape->mesh) {
        outcome_add_number(outcome, (double)shape->mesh->n_triangles);
        outcome_add(outcome, shape->mesh->positions_lps_mm, shape->mesh->n_vertices * 3 * sizeof(float));
        outcome_add(outcome, shape->mesh->indices, shape->mesh->n_triangles * 3 * sizeof(uint32_t));
    } else if (shape->lines) {
        outcome_add(outcome, shape->lines->positions_lps_mm, shape->lines->n_vertices * 3 * sizeof(float));
    } else {
        outcome_add(outcome, shape->points->positions_lps_mm, shape->points->n_points * 3 * sizeof(float));
    }
}

/* Twice: what failed once is not remembered as impossible. */
struct shape_case {
    struct shape_key key;
    enum surface_detail detail;
};

static void build_shape(void *context, struct outcome *outcome)
{
    const struct shape_case *wanted = context;
    struct error again = { 0 };
    faults_pause();
    struct plan *plan = make_plan();
    struct derive *derived = derive_create(plan);
    const struct shape_want want = { subject_region(0), wanted->key, wanted->detail };
    faults_go_on();
    struct shape_facts facts;
    struct shape *shape = derive_shape(derived, &want, &facts, &outcome->err);
    if (shape) {
        outcome->is_done = true;
        add_shape(outcome, shape);
        shape_unref(shape);
    } else {
        faults_pause();
        shape = derive_shape(derived, &want, &facts, &again);
        if (!shape)
            outcome->err = (struct error){ ERROR_NONE, "" }; /* a finding: it fails for ever */
        shape_unref(shape);
        faults_go_on();
    }
    derive_destroy(derived);
    plan_destroy(plan);
}

static void walk_shapes(void)
{
    for (int r = 0; r < REPRESENTATION_N; r++)
        for (int a = 0; a < (r == REPRESENTATION_SURFACE ? SURFACE_N_ALGORITHMS : 1); a++)
            for (int coarse = 0; coarse < (r == REPRESENTATION_SURFACE ? 2 : 1); coarse++) {
                struct shape_case wanted = { { .representation = (enum region_representation)r,
                                               .algorithm = (enum surface_algorithm)a,
                                               .nurbs_order = 4,
                                               .nurbs_bins = 32 },
                                             coarse ? SURFACE_COARSE : SURFACE_FULL };
                char name[128];
                snprintf(name, sizeof name, "a region as %s%s%s%s is built",
                         region_representation_word((enum region_representation)r), r ? "" : " by ",
                         r ? "" : surface_algorithm_word((enum surface_algorithm)a), coarse ? ", coarse," : "");
                const struct walk walk = { .name = name,
                                           .run = build_shape,
                                           .context = &wanted,
                                           .kinds = { [FAULT_MEMORY] = true, [FAULT_START] = true } };
                walk_run(&walk);
            }
}

struct picture_case {
    enum render_back_end back_end;
    enum scene_kind kind;
    enum scene_representation representation;
    bool is_checked;
    bool is_cut;   /* with caps, outlined */
    bool has_dose; /* in colours, lines and surfaces, and a region's coverage */
    bool has_tracks;
    bool has_beams; /* one and its draft, translucent apertures */
};

/* A picture that leaves a region out says which (visible_missing). */
static void draw(void *context, struct outcome *outcome)
{
    const struct picture_case *wanted = context;
    struct renderer *renderer = NULL;
    struct encoder *encoder = NULL;
    struct encoded jpeg = { 0 }, png = { 0 };
    struct image *image = NULL;
    struct camera camera;
    struct render_timing timing;
    char field[128];
    faults_pause();
    struct plan *plan = make_plan();
    struct derive *derived = derive_create(plan);
    struct scene scene;
    scene_for_plan(plan, &scene);
    for (size_t i = 0; i < scene.n_regions; i++) {
        scene.regions[i].value.representation = wanted->representation;
        scene.regions[i].value.opacity = i == 0 ? 0.5 : 1;
    }
    if (wanted->is_cut) {
        scene.clip.axial_high.enabled = scene.clip.free.enabled = true;
        scene.clip.free.normal = vec3(1, -1, 1);
        scene.clip.cap.regions = scene.clip.cap.outlines = true;
        scene.image.window.gamma = 1.5; /* its table of tones */
    }
    if (wanted->has_tracks) {
        add_tracks(plan);
        scene.tracks.visible = true;
    }
    if (wanted->has_dose) {
        scene.dose.lines.visible = scene.dose.surfaces.visible = true;
        scene.dose.wash.visible = wanted->kind == SCENE_KIND_3D; /* on a slice lines find the dose themselves */
        for (size_t i = 0; i < scene.dose.n_levels; i++)
            scene.dose.levels[i].value.surface = true;
        scene.dose.coverage.visible = true;
        scene.dose.coverage.has_low = true;
        scene.dose.coverage.low = 50;
        memcpy(scene.dose.coverage.region, scene.regions[0].id, sizeof scene.dose.coverage.region);
    }
    scene.beam.draft.enabled = wanted->has_beams;
    scene.beam.draft.line.entry_mm = vec3(-40, 0, 5);
    struct view view = view_default;
    view.kind = wanted->kind;
    view.size_px[0] = 120;
    view.size_px[1] = 90;
    faults_go_on();
    struct snapshot *snapshot = snapshot_create(derived, &scene, &view, 1, field, &outcome->err);
    if (!snapshot)
        goto done;
    renderer = renderer_create(wanted->back_end, &outcome->err);
    if (!renderer)
        goto done;
    const struct render_options options = { 120, 90, SURFACE_FULL, true };
    image = render_snapshot(renderer, snapshot, &options, &camera, &timing, &outcome->err);
    if (!image)
        goto done;
    encoder = encoder_create();
    const struct encode_options as_jpeg = { ENCODE_JPEG, 90, true }, as_png = { ENCODE_PNG, 0, false };
    if (!encode_image(encoder, image, &as_jpeg, &jpeg, &outcome->err) ||
        !encode_image(encoder, image, &as_png, &png, &outcome->err))
        goto done;
    outcome->is_done = true;
    outcome_add(outcome, image->rgba, (size_t)image->width_px * (size_t)image->height_px * 4);
    outcome_add(outcome, jpeg.bytes, jpeg.n_bytes);
    outcome_add(outcome, png.bytes, png.n_bytes);
done:
    faults_pause();
    if (outcome->is_done) {
        struct visible_missing missing[VISIBLE_MAX_MISSING];
        size_t n = visible_missing(snapshot, SURFACE_FULL, missing);
        outcome->is_told = n > 0;
        outcome_note(outcome, n > 0 ? missing[0].why.text : "");
    }
    faults_go_on();
    free(jpeg.bytes);
    free(png.bytes);
    encoder_destroy(encoder);
    image_destroy(image);
    snapshot_unref(snapshot);
    if (renderer)
        renderer_forget(renderer, plan);
    renderer_destroy(renderer);
    derive_destroy(derived);
    plan_destroy(plan);
}

static void walk_pictures(void)
{
    for (int r = 0; r <= SCENE_REPRESENTATION_FAN; r++) {
        struct picture_case wanted = { .back_end = RENDER_SOFT,
                                       .kind = SCENE_KIND_3D,
                                       .representation = (enum scene_representation)r };
        char name[128];
        snprintf(name, sizeof name, "regions as %s are drawn and compressed",
                 region_representation_word((enum region_representation)r));
        const struct walk walk = { .name = name,
                                   .run = draw,
                                   .context = &wanted,
                                   .is_library_leaky = true,
                                   .kinds = { [FAULT_MEMORY] = true, [FAULT_START] = true } };
        walk_run(&walk);
    }
    struct picture_case slice = { .back_end = RENDER_SOFT, .kind = SCENE_KIND_AXIAL };
    const struct walk walk = { .name = "a slice is drawn and compressed",
                               .run = draw,
                               .context = &slice,
                               .is_library_leaky = true,
                               .kinds = { [FAULT_MEMORY] = true, [FAULT_START] = true } };
    walk_run(&walk);
    struct picture_case cut = { .back_end = RENDER_SOFT, .kind = SCENE_KIND_3D, .is_cut = true };
    const struct walk cut_walk = { .name = "regions that are cut and capped are drawn and compressed",
                                   .run = draw,
                                   .context = &cut,
                                   .is_library_leaky = true,
                                   .kinds = { [FAULT_MEMORY] = true, [FAULT_START] = true } };
    walk_run(&cut_walk);
    struct picture_case tracks = { .back_end = RENDER_SOFT,
                                   .kind = SCENE_KIND_3D,
                                   .representation = SCENE_REPRESENTATION_SURFACE,
                                   .is_cut = true,
                                   .has_tracks = true };
    const struct walk tracks_walk = { .name = "tracks among regions that are cut are drawn and compressed",
                                      .run = draw,
                                      .context = &tracks,
                                      .is_library_leaky = true,
                                      .kinds = { [FAULT_MEMORY] = true, [FAULT_START] = true } };
    walk_run(&tracks_walk);
    for (int in_space = 0; in_space < 2; in_space++) {
        struct picture_case dose = { .back_end = RENDER_SOFT,
                                     .kind = in_space ? SCENE_KIND_3D : SCENE_KIND_AXIAL,
                                     .representation = SCENE_REPRESENTATION_SURFACE,
                                     .has_dose = true };
        const struct walk dose_walk = { .name = in_space ? "a dose in space is drawn and compressed"
                                                         : "a dose on a slice is drawn and compressed",
                                        .run = draw,
                                        .context = &dose,
                                        .is_library_leaky = true,
                                        .kinds = { [FAULT_MEMORY] = true, [FAULT_START] = true } };
        walk_run(&dose_walk);
    }
}

static void walk_beams(void)
{
    for (int in_space = 0; in_space < 2; in_space++) {
        struct picture_case beams = { .back_end = RENDER_SOFT,
                                      .kind = in_space ? SCENE_KIND_3D : SCENE_KIND_AXIAL,
                                      .representation = SCENE_REPRESENTATION_SURFACE,
                                      .has_beams = true };
        const struct walk walk = { .name = in_space ? "beams in space are drawn and compressed"
                                                    : "beams on a slice are drawn and compressed",
                                   .run = draw,
                                   .context = &beams,
                                   .is_library_leaky = true,
                                   .kinds = { [FAULT_MEMORY] = true } };
        walk_run(&walk);
    }
}

/* A caption of a snapshot of which a picture was drawn. */
static void annotate(void *context, struct outcome *outcome)
{
    (void)context;
    char field[128];
    struct error err = { 0 };
    struct annotations annotations = { .n_items = 0 };
    faults_pause();
    struct plan *plan = make_plan();
    struct derive *derived = derive_create(plan);
    struct scene scene;
    struct view view = view_default;
    view.kind = SCENE_KIND_AXIAL;
    scene_for_plan(plan, &scene);
    struct snapshot *snapshot = snapshot_create(derived, &scene, &view, 1, field, &err);
    struct image *image = image_create(200, 150, &err), *annotated = NULL;
    faults_go_on();
    if (annotations_describe(&annotations, snapshot, 200, "2026-07-01 09:30 UTC 腫瘍", &outcome->err))
        annotated = annotate_image(image, &annotations, &outcome->err);
    annotations_finish(&annotations);
    struct encoded png = { 0 };
    if (annotated && encode_png_with_text(annotated, "beamroom", "{\"version\": 1}", &png, &outcome->err)) {
        outcome->is_done = true;
        outcome_add(outcome, png.bytes, png.n_bytes);
    }
    free(png.bytes);
    image_destroy(annotated);
    image_destroy(image);
    snapshot_unref(snapshot);
    derive_destroy(derived);
    plan_destroy(plan);
}

static void walk_annotations(void)
{
    const struct walk walk = { .name = "a picture is annotated and compressed",
                               .run = annotate,
                               .kinds = { [FAULT_MEMORY] = true } };
    walk_run(&walk);
}

int main(void)
{
    walk_annotations();
    walk_shapes();
    walk_pictures();
    walk_beams();
    return walks_end();
}
