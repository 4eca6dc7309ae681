/* Picking in a volume: where rays lose half of their light, reach a value, or meet the largest, in closed form. */
#include "core/pick/pick.h"
#include "core/pick/pick_volume.h"
#include "tests/check.h"
#include "tests/derived_of.h"
#include "tests/made_plan.h"

static double constant(struct vec3 p)
{
    return 100 + 0 * p.x;
}
static double along_p(struct vec3 p)
{
    return p.y + 30; /* 0 to 60 through the grid */
}
static double ball(struct vec3 p)
{
    return 1000 - 10 * vec3_length(p);
}
static const struct vec3 peak = { 4, -7, 11 };
static double peaked(struct vec3 p)
{
    struct vec3 d = vec3_sub(p, peak);
    return 5000 - vec3_dot(d, d);
}

static struct plan *plan_of(double (*value)(struct vec3 p))
{
    struct grid grid = made_cube_grid(60); /* outer faces at 30 mm */
    struct plan *plan = plan_create("made");
    plan->bounds_lps_mm = grid_bounds_lps_mm(&grid);
    made_plan_add_image(plan, &grid, VOXEL_F32, value);
    return plan;
}

static struct scene volume_scene(const struct plan *plan, enum scene_volume_method method, double opacity)
{
    struct scene scene;
    scene_for_plan(plan, &scene);
    scene.image.slices.axial.visible = scene.image.slices.coronal.visible = scene.image.slices.sagittal.visible = false;
    struct scene_volume_style *volume = &scene.image.volume;
    free(volume->points);
    volume->n_points = 1;
    volume->points = mem_new(sizeof *volume->points);
    volume->points[0].opacity = opacity;
    volume->visible = true;
    volume->method = method;
    return scene;
}

/* Consumes the scene. */
static struct snapshot *snapshot_of(struct plan *plan, struct scene scene, struct vec3 eye_lps_mm)
{
    struct view view = view_default;
    struct error err = { 0 };
    char field[128];
    view.size_px[0] = view.size_px[1] = 101; /* the middle pixel's middle is the line of sight */
    view.camera.has_position_mm = view.camera.has_target_mm = true;
    view.camera.position_mm = eye_lps_mm;
    struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 1, field, &err);
    assert_string_equal(err.text, "");
    return snapshot;
}

/* Position along P of the only hit of a ray from the front through the patient's origin, and its alpha. */
static double hit_from_front(struct plan *plan, struct scene scene, double *alpha, bool is_on_cap)
{
    struct pick_hit hits[PICK_MAX_HITS];
    struct snapshot *snapshot = snapshot_of(plan, scene, vec3(0, -400, 0));
    assert_int_equal(snapshot_pick(snapshot, 50.5, 50.5, hits), 1);
    assert_int_equal(hits[0].subject.kind, SUBJECT_IMAGE);
    assert_int_equal(hits[0].is_on_cap, is_on_cap);
    assert_close(hits[0].point_lps_mm.x, 0, 1e-6);
    assert_close(hits[0].point_lps_mm.z, 0, 1e-6);
    assert_close(hits[0].distance_mm, hits[0].point_lps_mm.y + 400, 1e-6);
    if (alpha)
        *alpha = hits[0].alpha;
    snapshot_unref(snapshot);
    return hits[0].point_lps_mm.y;
}

static void in_a_constant_volume_half_of_the_light_is_gone_where_it_should_be(void **state)
{
    (void)state;
    struct plan *plan = plan_of(constant);
    double alpha;
    double y = hit_from_front(plan, volume_scene(plan, SCENE_VOLUME_METHOD_RAY, 0.04), &alpha, false);
    assert_close(y, -30 + log(0.5) / log(1 - 0.04), 1e-6); /* 0.96^d = 1/2 */
    assert_close(alpha, 1 - pow(0.96, 60), 1e-6);
    plan_and_derived_destroy(plan);
}

static void a_volume_that_lets_more_than_half_of_the_light_pass_is_not_hit(void **state)
{
    (void)state;
    struct plan *plan = plan_of(constant);
    struct pick_volume_hit hit;
    struct snapshot *snapshot =
        snapshot_of(plan, volume_scene(plan, SCENE_VOLUME_METHOD_RAY, 0.011), vec3(0, -400, 0)); /* 0.989^60 = 0.515 */
    assert_false(pick_volume(snapshot, vec3(0, -400, 0), vec3(0, 1, 0), &hit));
    snapshot_unref(snapshot);
    snapshot = snapshot_of(plan, volume_scene(plan, SCENE_VOLUME_METHOD_RAY, 0.012), vec3(0, -400, 0)); /* 0.485 */
    assert_true(pick_volume(snapshot, vec3(0, -400, 0), vec3(0, 1, 0), &hit));
    assert_false(pick_volume(snapshot, vec3(31, -400, 0), vec3(0, 1, 0), &hit)); /* beside the grid */
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

/* Opacity k s of 1 mm at s mm behind the face: the light of s mm is exp of the integral of ln(1 - k s). */
static void opacity_that_grows_along_the_ray_is_added_up(void **state)
{
    (void)state;
    struct plan *plan = plan_of(along_p);
    struct scene scene = volume_scene(plan, SCENE_VOLUME_METHOD_RAY, 0);
    const double k = 0.5 / 60;
    free(scene.image.volume.points);
    scene.image.volume.n_points = 2;
    scene.image.volume.points = mem_new(2 * sizeof *scene.image.volume.points);
    scene.image.volume.points[1] = (struct scene_transfer_point){ .value = 60, .opacity = 0.5 };
    double low = 0, high = 60;
    while (high - low > 1e-9) {
        double s = (low + high) / 2, passing = 1 - k * s;
        double absorbed = (passing * log(passing) + k * s) / k;
        *(absorbed < log(2) ? &low : &high) = s;
    }
    assert_close(hit_from_front(plan, scene, NULL, false), low - 30, 0.01); /* the outer half voxels have one value */
    plan_and_derived_destroy(plan);
}

static void slices_are_hit_where_the_value_reaches_the_culled_one(void **state)
{
    (void)state;
    struct plan *plan = plan_of(ball);
    struct scene scene = volume_scene(plan, SCENE_VOLUME_METHOD_SLICES, 0);
    scene.image.volume.cull_below = 800;                                /* a sphere of 20 mm */
    assert_close(hit_from_front(plan, scene, NULL, false), -20, 0.015); /* trilinear: off by 2 / (8 20) */
    plan_and_derived_destroy(plan);
}

static void a_projection_is_hit_where_the_value_is_largest(void **state)
{
    (void)state;
    struct plan *plan = plan_of(peaked);
    double alpha;
    double y = hit_from_front(plan, volume_scene(plan, SCENE_VOLUME_METHOD_MIP, 0), &alpha, false);
    assert_close(y, peak.y, 0.5); /* between two voxels, linear */
    const struct plan_image *image = &plan->images[0];
    double largest = 5000 - peak.x * peak.x - peak.z * peak.z;
    assert_close(alpha, (largest - image->window_center) / image->window_width + 0.5, 1e-3);
    plan_and_derived_destroy(plan);
}

static void a_clip_plane_hides_what_it_cuts_off_and_its_cap_is_hit(void **state)
{
    (void)state;
    struct plan *plan = plan_of(constant);
    for (int is_capped = 0; is_capped < 2; is_capped++)
        for (int is_clipped = 0; is_clipped < 2; is_clipped++) {
            struct scene scene = volume_scene(plan, SCENE_VOLUME_METHOD_RAY, 0.2);
            scene.clip.coronal_low = (struct scene_clip_axis){ true, 7, is_capped };
            scene.image.volume.clipped = is_clipped;
            double deep = log(0.5) / log(0.8), y = hit_from_front(plan, scene, NULL, is_clipped && is_capped);
            assert_close(y, !is_clipped ? -30 + deep : is_capped ? 7 : 7 + deep, 1e-5);
        }
    plan_and_derived_destroy(plan);
}

static void a_volume_that_is_not_drawn_is_not_hit(void **state)
{
    (void)state;
    struct plan *plan = plan_of(constant);
    struct pick_volume_hit hit;
    struct scene scene = volume_scene(plan, SCENE_VOLUME_METHOD_RAY, 0.5);
    scene.image.volume.visible = false;
    struct snapshot *snapshot = snapshot_of(plan, scene, vec3(0, -400, 0));
    assert_false(pick_volume(snapshot, vec3(0, -400, 0), vec3(0, 1, 0), &hit));
    snapshot_unref(snapshot);
    scene = volume_scene(plan, SCENE_VOLUME_METHOD_RAY, 0.5);
    scene.image.volume.cull_below = 101; /* all of it is culled */
    snapshot = snapshot_of(plan, scene, vec3(0, -400, 0));
    assert_false(pick_volume(snapshot, vec3(0, -400, 0), vec3(0, 1, 0), &hit));
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(in_a_constant_volume_half_of_the_light_is_gone_where_it_should_be),
        cmocka_unit_test(a_volume_that_lets_more_than_half_of_the_light_pass_is_not_hit),
        cmocka_unit_test(opacity_that_grows_along_the_ray_is_added_up),
        cmocka_unit_test(slices_are_hit_where_the_value_reaches_the_culled_one),
        cmocka_unit_test(a_projection_is_hit_where_the_value_is_largest),
        cmocka_unit_test(a_clip_plane_hides_what_it_cuts_off_and_its_cap_is_hit),
        cmocka_unit_test(a_volume_that_is_not_drawn_is_not_hit),
    };
    return cmocka_run_group_tests_name("pick_volume", tests, NULL, NULL);
}
