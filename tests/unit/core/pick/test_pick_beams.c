/* Picking beams: their lines within a few pixels, in space and on slice panes. */
#include "core/pick/pick.h"
#include "core/pick/pick_beams.h"
#include "tests/check.h"
#include "tests/derived_of.h"
#include "tests/made_plan.h"

/* A box of 20 mm around the origin in a body of 80 mm; the beam runs down along y = 0, 30 mm left of the middle. */
static double nested(struct vec3 p)
{
    double r = fmax(fmax(fabs(p.x), fabs(p.y)), fabs(p.z));
    return r < 10 ? 2 : r < 40 ? 1 : 0;
}
static const struct made_region two[] = { { "body", -1, 0xff0000 }, { "organ", 0, 0x00ff00 } };

static struct plan *beam_plan(void)
{
    const uint32_t size[3] = { 50, 50, 50 };
    struct grid grid =
        made_grid(50, 50, 50, made_affine(vec3(2, 0, 0), vec3(0, 2, 0), vec3(0, 0, 2), size, vec3(0, 0, 0)));
    struct plan *plan = made_plan(&grid, nested, two, 2);
    struct beam *beam = &plan->beams[plan->n_beams++];
    snprintf(beam->id, sizeof beam->id, "field");
    beam->entry_lps_mm = vec3(30, 0, 90);
    beam->target_lps_mm = vec3(30, 0, 0);
    beam->aperture_mm = 30;
    return plan;
}

struct looking {
    enum scene_kind kind;
    bool is_parallel, is_hidden, is_drafted, is_translucent;
    double axial_mm;
};

/* 1 mm a pixel in parallel views, from the front; the middle of the picture is the patient's origin. */
static struct snapshot *look(struct plan *plan, const struct looking *how)
{
    struct scene scene;
    struct view view = view_default;
    struct error err = { 0 };
    char field[128];
    scene_for_plan(plan, &scene);
    for (size_t i = 0; i < scene.n_regions; i++)
        scene.regions[i].value.opacity = how->is_translucent ? 0.3 : 1;
    scene.surface.translucency = SCENE_TRANSLUCENCY_PLAIN;
    scene.beam.looks = mem_new(sizeof *scene.beam.looks);
    scene.beam.n_looks = 1;
    scene.beam.looks[0] = (struct scene_beam_look_entry){ "field", scene_beam_look_default };
    scene.beam.looks[0].value.visible = !how->is_hidden;
    scene.beam.draft.enabled = how->is_drafted;
    scene.beam.draft.line.entry_mm = vec3(-30, 0, 90);
    scene.beam.draft.line.target_mm = vec3(-30, 0, 0);
    scene.image.slices.axial.position_mm = how->axial_mm;
    view.kind = how->kind;
    view.size_px[0] = view.size_px[1] = 200;
    view.camera.has_position_mm = view.camera.has_target_mm = view.camera.has_height_mm = true;
    view.camera.position_mm = vec3(0, -400, 0);
    view.camera.target_mm = vec3(0, 0, 0);
    view.camera.height_mm = 200;
    view.camera.projection = how->is_parallel ? SCENE_PROJECTION_PARALLEL : SCENE_PROJECTION_PERSPECTIVE;
    struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 1, field, &err);
    assert_string_equal(err.text, "");
    return snapshot;
}

/* Index of the first hit of a beam; -1: none. */
static int beam_hit(const struct pick_hit *hits, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (hits[i].subject.kind == SUBJECT_BEAM)
            return (int)i;
    return -1;
}

static void a_line_is_hit_within_four_pixels(void **state)
{
    (void)state;
    struct plan *plan = beam_plan();
    struct snapshot *snapshot = look(plan, &(struct looking){ .kind = SCENE_KIND_3D, .is_parallel = true });
    struct pick_hit hits[PICK_MAX_HITS];
    for (double off = -6; off <= 6; off += 0.5) { /* 70 mm up, above the body: x = 30 mm is at 130 px */
        size_t n = snapshot_pick(snapshot, 130 + off, 30, hits);
        assert_int_equal(n, fabs(off) <= 4);
        if (n == 0)
            continue;
        assert_int_equal(hits[0].subject.kind, SUBJECT_BEAM);
        assert_int_equal(hits[0].subject.index, 0);
        assert_close(hits[0].point_lps_mm.x, 30, 1e-6);
        assert_close(hits[0].point_lps_mm.y, 0, 1e-6);
        assert_close(hits[0].point_lps_mm.z, 70, 1e-6);
        assert_close(hits[0].distance_mm, hypot(400, hypot(30, 70)), 1e-6); /* from the eye */
    }
    /* the wall of the aperture, 15 mm aside, is looked through */
    assert_int_equal(snapshot_pick(snapshot, 145, 30, hits), 0);
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

static void a_line_is_hit_where_perspective_shows_it(void **state)
{
    (void)state;
    struct plan *plan = beam_plan();
    struct snapshot *snapshot = look(plan, &(struct looking){ .kind = SCENE_KIND_3D });
    struct camera camera;
    camera_resolve(snapshot, &camera);
    struct pick_hit hits[PICK_MAX_HITS];
    /* the smaller side spans the opening angle at 400 mm */
    double px_per_mm = 100 / (400 * tan(snapshot->view.camera.fov_deg / 2 * MATH_PI / 180));
    size_t n = snapshot_pick(snapshot, 100 + 30 * px_per_mm, 100 - 60 * px_per_mm, hits);
    assert_int_equal(n, 1);
    assert_close(hits[0].point_lps_mm.z, 60, 1e-6);
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

static void an_opaque_region_hides_the_line_and_a_translucent_one_does_not(void **state)
{
    (void)state;
    struct plan *plan = beam_plan();
    for (int is_translucent = 0; is_translucent < 2; is_translucent++) {
        struct snapshot *snapshot =
            look(plan,
                 &(struct looking){ .kind = SCENE_KIND_3D, .is_parallel = true, .is_translucent = is_translucent });
        struct pick_hit hits[PICK_MAX_HITS];
        size_t n = snapshot_pick(snapshot, 130.5, 100.5, hits);
        assert_int_equal(n, 2); /* the body's wall at y = -40, the line at 0 */
        assert_int_equal(hits[0].subject.kind, SUBJECT_REGION);
        assert_int_equal(hits[1].subject.kind, SUBJECT_BEAM);
        assert_int_equal(pick_seen(hits, n, -1), is_translucent);
        snapshot_unref(snapshot);
    }
    plan_and_derived_destroy(plan);
}

static void what_is_not_drawn_is_not_hit(void **state)
{
    (void)state;
    struct plan *plan = beam_plan();
    struct pick_hit hits[PICK_MAX_HITS];
    struct snapshot *hidden =
        look(plan, &(struct looking){ .kind = SCENE_KIND_3D, .is_parallel = true, .is_hidden = true });
    assert_int_equal(snapshot_pick(hidden, 130, 30, hits), 0);
    snapshot_unref(hidden);
    /* the beam's-eye view has its own line in the middle of the picture and does not draw it */
    struct snapshot *own = look(plan, &(struct looking){ .kind = SCENE_KIND_BEAM });
    assert_int_equal(beam_hit(hits, snapshot_pick(own, 100, 100, hits)), -1);
    snapshot_unref(own);
    plan_and_derived_destroy(plan);
}

static void a_draft_and_its_planned_beam_are_told_apart(void **state)
{
    (void)state;
    struct plan *plan = beam_plan();
    struct snapshot *snapshot =
        look(plan, &(struct looking){ .kind = SCENE_KIND_3D, .is_parallel = true, .is_drafted = true });
    struct pick_hit hits[PICK_MAX_HITS];
    assert_int_equal(snapshot_pick(snapshot, 130, 30, hits), 1);
    assert_int_equal(hits[0].subject.key, 0);
    assert_int_equal(snapshot_pick(snapshot, 70, 30, hits), 1);
    assert_int_equal(hits[0].subject.key, 1);
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

static void on_a_slice_pane_the_projected_line_comes_first(void **state)
{
    (void)state;
    struct plan *plan = beam_plan();
    struct pick_hit hits[PICK_MAX_HITS];
    struct snapshot *coronal = look(plan, &(struct looking){ .kind = SCENE_KIND_CORONAL });
    size_t n = snapshot_pick(coronal, 132.5, 90.5, hits);
    assert_int_equal(beam_hit(hits, n), 0);
    assert_int_equal(pick_seen(hits, n, -1), 0);
    assert_close(hits[0].point_lps_mm.x, 32.5, 1e-6); /* the point of the pane, as that of regions */
    assert_close(hits[0].point_lps_mm.z, 9.5, 1e-6);
    assert_int_equal(beam_hit(hits, snapshot_pick(coronal, 136, 90.5, hits)), -1);
    snapshot_unref(coronal);
    /* across the beam: a dot */
    struct snapshot *axial = look(plan, &(struct looking){ .kind = SCENE_KIND_AXIAL, .axial_mm = 10 });
    assert_int_equal(beam_hit(hits, snapshot_pick(axial, 128, 103, hits)), 0);
    assert_int_equal(beam_hit(hits, snapshot_pick(axial, 125, 100, hits)), -1);
    snapshot_unref(axial);
    plan_and_derived_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_line_is_hit_within_four_pixels),
        cmocka_unit_test(a_line_is_hit_where_perspective_shows_it),
        cmocka_unit_test(an_opaque_region_hides_the_line_and_a_translucent_one_does_not),
        cmocka_unit_test(what_is_not_drawn_is_not_hit),
        cmocka_unit_test(a_draft_and_its_planned_beam_are_told_apart),
        cmocka_unit_test(on_a_slice_pane_the_projected_line_comes_first),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
