/* Cameras of scenes and panes: home position, clip space, refusals. */
#include "core/scene/camera.h"
#include "core/scene/snapshot.h"
#include "tests/check.h"
#include "tests/derived_of.h"
#include "tests/made_plan.h"

static double no_label(struct vec3 p)
{
    return p.x * 0;
}
static double halves(struct vec3 p)
{
    return p.x < 0 ? 1 : 2;
}
static const struct made_region two[] = { { "right", -1, 0x804020 }, { "left", -1, 0x204080 } };

/* 100 x 80 x 60 mm around (10, 20, 30) */
static struct plan *box_plan(void)
{
    const uint32_t size[3] = { 20, 16, 12 };
    struct affine map = made_affine(vec3(5, 0, 0), vec3(0, 5, 0), vec3(0, 0, 5), size, vec3(10, 20, 30));
    struct grid grid = made_grid(size[0], size[1], size[2], map);
    return made_plan(&grid, halves, two, 2);
}

static struct snapshot *snapshot_of(struct plan *plan, struct view view)
{
    struct scene scene;
    struct error err = { 0 };
    char field[128];
    scene_for_plan(plan, &scene);
    struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 7, field, &err);
    assert_string_equal(err.text, "");
    return snapshot;
}

static void expect_vec3(struct vec3 value, double x, double y, double z)
{
    assert_close(value.x, x, 1e-9);
    assert_close(value.y, y, 1e-9);
    assert_close(value.z, z, 1e-9);
}

static void the_home_camera_looks_from_the_front_left_and_above_and_holds_the_whole_plan(void **state)
{
    (void)state;
    struct plan *plan = box_plan();
    struct view view = view_default;
    camera_home(plan, SCENE_KIND_3D, &view.camera);
    struct snapshot *snapshot = snapshot_of(plan, view);
    struct camera camera;
    camera_resolve(snapshot, &camera);
    const double c30 = sqrt(3) / 2, s30 = 0.5, c12 = cos(MATH_PI / 15), s12 = sin(MATH_PI / 15);
    expect_vec3(camera.right, c30, s30, 0); /* patient left on screen right, and nearer */
    expect_vec3(camera.up, -s12 * s30, s12 * c30, c12);
    expect_vec3(camera.forward, -c12 * s30, c12 * c30, -s12); /* to the right, the back and below */
    expect_vec3(camera.target_lps_mm, 10, 20, 30);
    double most = 0;
    for (int i = 0; i < 8; i++) {
        struct vec3 corner = vec3(i & 1 ? 60 : -40, i & 2 ? 60 : -20, i & 4 ? 60 : 0);
        struct vec3 clip = mat4_project(&camera.clip_from_lps_mm, corner);
        most = fmax(most, fmax(fabs(clip.x) * 4 / 3, fabs(clip.y))); /* of the smaller side, 768 of 1024 */
        assert_true(fabs(clip.z) < 1);
    }
    assert_close(most, 1 / 1.08, 1e-9);
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

static double nothing(struct vec3 p)
{
    (void)p;
    return 0;
}

/* box_plan is 100 x 80 x 60 mm, its diagonal 141 mm */
static void a_plan_of_a_small_region_in_a_large_image_is_framed_by_the_image(void **state)
{
    (void)state;
    for (int is_large = 0; is_large < 2; is_large++) {
        struct plan *plan = box_plan();
        double side_mm = is_large ? 10 : 4; /* 20 voxels a side: 346 or 139 mm across */
        const uint32_t size[3] = { 20, 20, 20 };
        struct grid grid =
            made_grid(20, 20, 20,
                      made_affine(vec3(side_mm, 0, 0), vec3(0, side_mm, 0), vec3(0, 0, side_mm), size, vec3(5, 6, 7)));
        plan->images[0].volume = made_volume(&grid, VOXEL_U8, nothing);
        plan->n_images = 1;
        struct scene_camera camera;
        camera_home(plan, SCENE_KIND_3D, &camera);
        if (is_large)
            expect_vec3(camera.target_mm, 5, 6, 7);
        else
            expect_vec3(camera.target_mm, 10, 20, 30);
        plan_and_derived_destroy(plan);
    }
}

static void a_view_without_position_has_the_home_camera(void **state)
{
    (void)state;
    struct plan *plan = box_plan();
    for (int kind = 0; kind < 4; kind++) {
        struct view home = view_default;
        home.kind = (enum scene_kind)kind;
        camera_home(plan, home.kind, &home.camera);
        struct view bare = view_default;
        bare.kind = home.kind;
        struct snapshot *a = snapshot_of(plan, home), *b = snapshot_of(plan, bare);
        struct camera with, without;
        camera_resolve(a, &with);
        camera_resolve(b, &without);
        for (int i = 0; i < 16; i++)
            assert_close(with.clip_from_lps_mm.m[i], without.clip_from_lps_mm.m[i], 1e-9);
        snapshot_unref(a);
        snapshot_unref(b);
    }
    plan_and_derived_destroy(plan);
}

static void clip_space_goes_to_the_patient_and_back(void **state)
{
    (void)state;
    struct plan *plan = box_plan();
    for (int kind = 0; kind < 4; kind++)
        for (int parallel = 0; parallel < 2; parallel++) {
            struct view view = view_default;
            view.kind = (enum scene_kind)kind;
            view.camera.projection = parallel ? SCENE_PROJECTION_PARALLEL : SCENE_PROJECTION_PERSPECTIVE;
            view.camera.has_position_mm = view.camera.has_up = true;
            view.camera.position_mm = vec3(150, -90, 200);
            view.camera.up = vec3(0.2, 0.1, 1);
            struct snapshot *snapshot = snapshot_of(plan, view);
            struct camera camera;
            camera_resolve(snapshot, &camera);
            struct vec3 p = vec3(-12.5, 31, 44);
            struct vec3 clip = mat4_project(&camera.clip_from_lps_mm, p),
                        back = mat4_project(&camera.lps_mm_from_clip, clip);
            assert_close(back.x, p.x, 1e-6);
            assert_close(back.y, p.y, 1e-6);
            assert_close(back.z, p.z, 1e-6);
            struct vec3 across =
                vec3_cross(camera.right, camera.up); /* towards the viewer: right-handed, orthonormal */
            expect_vec3(vec3_add(across, camera.forward), 0, 0, 0);
            snapshot_unref(snapshot);
        }
    plan_and_derived_destroy(plan);
}

static void perspective_spans_the_smaller_side_with_its_opening_angle(void **state)
{
    (void)state;
    struct plan *plan = box_plan();
    struct view view = view_default;
    view.size_px[0] = 300; /* upright: the width is the smaller side */
    view.size_px[1] = 600;
    view.camera.has_position_mm = view.camera.has_target_mm = true;
    view.camera.position_mm = vec3(10, -80, 30);
    view.camera.target_mm = vec3(10, 20, 30); /* 100 mm away */
    view.camera.fov_deg = 50;
    struct snapshot *snapshot = snapshot_of(plan, view);
    struct camera camera;
    camera_resolve(snapshot, &camera);
    struct vec3 edge = mat4_project(&camera.clip_from_lps_mm, vec3(10 + 100 * tan(25 * MATH_PI / 180), 20, 30));
    assert_close(edge.x, 1, 1e-9);
    edge = mat4_project(&camera.clip_from_lps_mm, vec3(10, 20, 30 + 200 * tan(25 * MATH_PI / 180)));
    assert_close(edge.y, 1, 1e-9);
    assert_close(camera.pixels_per_mm, 0, 0);
    snapshot_unref(snapshot);

    view.camera.projection = SCENE_PROJECTION_PARALLEL; /* as much as perspective shows at the target */
    snapshot = snapshot_of(plan, view);
    camera_resolve(snapshot, &camera);
    edge = mat4_project(&camera.clip_from_lps_mm, vec3(10 + 100 * tan(25 * MATH_PI / 180), 55, 30));
    assert_close(edge.x, 1, 1e-9);
    assert_close(camera.pixels_per_mm, 300 / (200 * tan(25 * MATH_PI / 180)), 1e-9);
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

static void panes_lie_on_their_slice_as_radiology_has_them(void **state)
{
    (void)state;
    static const struct {
        enum scene_kind kind;
        struct vec3 right, up, target;
    } cases[] = { { SCENE_KIND_AXIAL, { 1, 0, 0 }, { 0, -1, 0 }, { 1, 2, 13 } },
                  { SCENE_KIND_CORONAL, { 1, 0, 0 }, { 0, 0, 1 }, { 1, 12, 3 } },
                  { SCENE_KIND_SAGITTAL, { 0, 1, 0 }, { 0, 0, 1 }, { 11, 2, 3 } } };
    struct plan *plan = box_plan();
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct scene scene;
        struct error err = { 0 };
        char field[128];
        scene_for_plan(plan, &scene);
        scene.image.slices.sagittal.position_mm = 11;
        scene.image.slices.coronal.position_mm = 12;
        scene.image.slices.axial.position_mm = 13;
        struct view view = view_default;
        view.kind = cases[i].kind;
        view.camera.has_target_mm = view.camera.has_height_mm = true;
        view.camera.target_mm = vec3(1, 2, 3);
        view.camera.height_mm = 192;
        struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 1, field, &err);
        struct camera camera;
        camera_resolve(snapshot, &camera);
        assert_true(camera.is_parallel);
        assert_close(camera.pixels_per_mm, 768 / 192.0, 1e-12);
        expect_vec3(camera.right, cases[i].right.x, cases[i].right.y, cases[i].right.z);
        expect_vec3(camera.up, cases[i].up.x, cases[i].up.y, cases[i].up.z);
        expect_vec3(camera.target_lps_mm, cases[i].target.x, cases[i].target.y, cases[i].target.z);
        struct vec3 right =
            mat4_project(&camera.clip_from_lps_mm, vec3_add(camera.target_lps_mm, vec3_scale(camera.right, 128)));
        assert_close(right.x, 1, 1e-9);
        assert_close(right.y, 0, 1e-9);
        snapshot_unref(snapshot);
    }
    plan_and_derived_destroy(plan);
}

/* However it is turned: without a height of its own, as the highest of the three others. The plan's box is its only
 * grid's. */
static void turning_an_oblique_plane_changes_no_scale(void **state)
{
    (void)state;
    struct plan *plan = box_plan();
    struct vec3 size = vec3_sub(plan->bounds_lps_mm.high, plan->bounds_lps_mm.low);
    double largest_mm = fmax(fmax(size.x, size.y), size.z);
    static const struct vec3 normals[] = { { 0, 0, 1 }, { 0, 1, 1 }, { 1, -2, 0.5 }, { 1, 0, 0 } };
    for (size_t i = 0; i < sizeof normals / sizeof normals[0]; i++) {
        struct plane plane = plane_of_normal(vec3(3, 4, 5), normals[i]);
        struct view view = view_default;
        struct camera camera;
        view.kind = SCENE_KIND_OBLIQUE;
        camera_of_view(plan, &view, &plane, NULL, &camera);
        assert_close(camera.pixels_per_mm, 768 / (1.08 * largest_mm), 1e-9);
        assert_close(plane_height_mm(&plane, camera.target_lps_mm), 0, 1e-9);
        expect_vec3(camera.right, plane.right.x, plane.right.y, plane.right.z);
        expect_vec3(camera.up, plane.up.x, plane.up.y, plane.up.z);
        struct scene_camera home;
        camera_home(plan, SCENE_KIND_OBLIQUE, &home);
        assert_close(home.height_mm, 1.08 * largest_mm, 1e-9);
    }
    plan_and_derived_destroy(plan);
}

static void expect_refused(struct plan *plan, struct scene scene, struct view view, enum error_code code,
                           const char *place)
{
    struct error err = { 0 };
    char field[128];
    assert_null(snapshot_create(derived_of(plan), &scene, &view, 1, field, &err));
    assert_int_equal(err.code, code);
    assert_string_equal(field, place);
    assert_true(strlen(err.text) > 10);
    assert_null(scene.regions); /* taken, also on failure */
}

static void what_cannot_be_drawn_is_refused_with_its_place(void **state)
{
    (void)state;
    struct plan *plan = box_plan();
    struct scene scene;
    scene_for_plan(plan, &scene);
    snprintf(scene.regions[1].id, sizeof scene.regions[1].id, "nobody");
    expect_refused(plan, scene, view_default, ERROR_NOT_FOUND, "/regions/nobody");
    scene_for_plan(plan, &scene);
    snprintf(scene.image.id, sizeof scene.image.id, "ct");
    expect_refused(plan, scene, view_default, ERROR_NOT_FOUND, "/image/id");

    struct view view = view_default;
    view.camera.has_position_mm = view.camera.has_target_mm = true;
    view.camera.position_mm = view.camera.target_mm = vec3(1, 2, 3);
    scene_for_plan(plan, &scene);
    expect_refused(plan, scene, view, ERROR_RANGE, "/camera/position_mm");
    view.camera.has_target_mm = false;
    view.camera.position_mm = vec3(10, 20, 30); /* the plan's own centre */
    scene_for_plan(plan, &scene);
    expect_refused(plan, scene, view, ERROR_RANGE, "/camera/position_mm");
    view.camera.has_up = true;
    view.camera.has_target_mm = true;
    view.camera.target_mm = vec3(10, 20, 90);
    view.camera.up = vec3(0, 0, -2);
    scene_for_plan(plan, &scene);
    expect_refused(plan, scene, view, ERROR_RANGE, "/camera/up");
    view.camera.up = vec3(0, 0, 0);
    scene_for_plan(plan, &scene);
    expect_refused(plan, scene, view, ERROR_RANGE, "/camera/up");
    plan_and_derived_destroy(plan);
}

static void looking_straight_down_without_an_up_still_has_one(void **state)
{
    (void)state;
    struct plan *plan = box_plan();
    struct view view = view_default;
    view.camera.has_position_mm = true;
    view.camera.position_mm = vec3(10, 20, 400);
    struct snapshot *snapshot = snapshot_of(plan, view);
    struct camera camera;
    camera_resolve(snapshot, &camera);
    expect_vec3(camera.up, 0, -1, 0); /* anterior */
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

/* body 1 > organ 2 > tumour 3 */
static double shells(struct vec3 p)
{
    double r = vec3_length(p);
    return r < 5 ? 3 : r < 10 ? 2 : r < 15 ? 1 : 0;
}
static const struct made_region tree[] = { { "body", -1, 0x112233 },
                                           { "organ", 0, 0x445566 },
                                           { "tumour", 1, 0x778899 } };
static double shifted_shells(struct vec3 p)
{
    return shells(vec3_sub(p, vec3(3, -2, 1)));
}

static void a_new_room_sees_through_to_the_innermost_region(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(41);
    struct plan *plan = made_plan(&grid, shifted_shells, tree, 3);
    made_plan_add_image(plan, &grid, VOXEL_U8, no_label);
    struct scene scene;
    scene_for_plan(plan, &scene);
    assert_int_equal(scene.n_regions, 3);
    assert_int_equal(scene.regions[0].value.color_rgb, 0x112233);
    assert_close(scene.regions[0].value.opacity, 0.35, 0);
    assert_close(scene.regions[1].value.opacity, 0.45, 0);
    assert_close(scene.regions[2].value.opacity, 1, 0);
    assert_true(scene.image.slices.axial.visible);
    assert_close(scene.image.slices.sagittal.position_mm, 3, 1e-9);
    assert_close(scene.image.slices.coronal.position_mm, -2, 1e-9);
    assert_close(scene.image.slices.axial.position_mm, 1, 1e-9);
    assert_close(scene.image.window.center, plan->images[0].window_center, 0);
    scene_finish(&scene);
    plan_and_derived_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_home_camera_looks_from_the_front_left_and_above_and_holds_the_whole_plan),
        cmocka_unit_test(a_plan_of_a_small_region_in_a_large_image_is_framed_by_the_image),
        cmocka_unit_test(a_view_without_position_has_the_home_camera),
        cmocka_unit_test(clip_space_goes_to_the_patient_and_back),
        cmocka_unit_test(perspective_spans_the_smaller_side_with_its_opening_angle),
        cmocka_unit_test(panes_lie_on_their_slice_as_radiology_has_them),
        cmocka_unit_test(turning_an_oblique_plane_changes_no_scale),
        cmocka_unit_test(what_cannot_be_drawn_is_refused_with_its_place),
        cmocka_unit_test(looking_straight_down_without_an_up_still_has_one),
        cmocka_unit_test(a_new_room_sees_through_to_the_innermost_region),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
