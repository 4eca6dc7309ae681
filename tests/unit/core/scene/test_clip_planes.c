/* The clip planes of a scene: which half of the patient each cuts off, exactly along the axes, alike in all 48 signed
 * orders of the axes, and without a jump when a plane is turned a little. */
#include "core/scene/clip.h"
#include "tests/check.h"
#include "tests/made_plan.h"

static struct plan *make_plan(void)
{
    struct plan *plan = plan_create("made");
    plan->n_beams = 2;
    plan->beams[0] = (struct beam){ .id = "first", .entry_lps_mm = { 0, 0, 80 }, .target_lps_mm = { 0, 0, 10 } };
    plan->beams[1] = (struct beam){ .id = "second", .entry_lps_mm = { 30, 0, 40 }, .target_lps_mm = { 0, 0, 0 } };
    return plan;
}

/* S is +z, P is +y, L is +x. Low planes cut off what lies below their position, high ones what lies above it; the
 * height of a point is its distance to the bit, as no axis plane is turned. */
static void each_axis_plane_cuts_off_its_side(void **state)
{
    (void)state;
    struct plan *plan = make_plan();
    struct scene scene = scene_default;
    struct scene_clip_style *clip = &scene.clip;
    struct scene_clip_axis *axes[6] = { &clip->axial_low,    &clip->axial_high,   &clip->coronal_low,
                                        &clip->coronal_high, &clip->sagittal_low, &clip->sagittal_high };
    for (int i = 0; i < 6; i++) {
        int axis = 2 - i / 2; /* of x, y, z */
        struct clip_plane planes[CLIP_MAX];
        *axes[i] = (struct scene_clip_axis){ true, 7.1, i % 3 == 0 };
        assert_int_equal(clip_planes(plan, &scene, NULL, planes), 1);
        assert_int_equal(planes[0].name, i);
        assert_int_equal(planes[0].is_capped, i % 3 == 0);
        for (int way = -1; way <= 1; way += 2) {
            double p[3] = { 3.3, -4.7, 1.9 };
            p[axis] = 7.1 + way * 2.3;
            bool is_cut_off = i % 2 == 0 ? way < 0 : way > 0;
            struct vec3 point = vec3(p[0], p[1], p[2]);
            assert_int_equal(clip_cuts(planes, 1, point), is_cut_off);
            double height_mm = fabs(p[axis] - 7.1);
            assert_close(plane_height_mm(&planes[0].plane, point), is_cut_off ? height_mm : -height_mm, 0);
        }
        axes[i]->enabled = false;
    }
    plan_destroy(plan);
}

static void all_planes_at_once_keep_their_order(void **state)
{
    (void)state;
    struct plan *plan = make_plan();
    struct scene scene = scene_default;
    struct clip_plane planes[CLIP_MAX];
    struct scene_clip_style *clip = &scene.clip;
    assert_int_equal(clip_planes(plan, &scene, NULL, planes), 0);
    clip->axial_low.enabled = clip->axial_high.enabled = clip->coronal_low.enabled = clip->coronal_high.enabled = true;
    clip->sagittal_low.enabled = clip->sagittal_high.enabled = clip->beam.enabled = clip->free.enabled = true;
    assert_int_equal(clip_planes(plan, &scene, NULL, planes), CLIP_MAX);
    for (int i = 0; i < CLIP_MAX; i++)
        assert_int_equal(planes[i].name, i);
    plan_destroy(plan);
}

/* The second beam runs from (30, 0, 40) to the origin: 20 mm along it is (18, 0, 24). */
static void a_plane_across_a_beam_cuts_off_what_the_beam_meets_first(void **state)
{
    (void)state;
    struct plan *plan = make_plan();
    struct scene scene = scene_default;
    struct clip_plane planes[CLIP_MAX];
    scene.clip.beam.enabled = true;
    scene.clip.beam.along_mm = 20;
    assert_int_equal(clip_planes(plan, &scene, NULL, planes), 1);
    assert_close(plane_height_mm(&planes[0].plane, vec3(5, 6, 80)), 20, 1e-12);
    assert_close(plane_height_mm(&planes[0].plane, vec3(5, 6, 10)), -50, 1e-12);
    snprintf(scene.clip.beam.id, sizeof scene.clip.beam.id, "second");
    assert_int_equal(clip_planes(plan, &scene, NULL, planes), 1);
    assert_close(plane_height_mm(&planes[0].plane, vec3(18, 0, 24)), 0, 1e-12);
    assert_close(plane_height_mm(&planes[0].plane, vec3(30, 0, 40)), 20, 1e-12);
    assert_close(plane_height_mm(&planes[0].plane, vec3(0, 9, 0)), -30, 1e-12);
    snprintf(scene.clip.beam.id, sizeof scene.clip.beam.id, "gone");
    assert_int_equal(clip_planes(plan, &scene, NULL, planes), 0);
    plan_destroy(plan);
}

/* The point's coordinates in another order and with other signs. */
static struct vec3 permuted(struct vec3 p, int order, int signs)
{
    static const int orders[6][3] = { { 0, 1, 2 }, { 0, 2, 1 }, { 1, 0, 2 }, { 1, 2, 0 }, { 2, 0, 1 }, { 2, 1, 0 } };
    const double from[3] = { p.x, p.y, p.z };
    double to[3];
    for (int i = 0; i < 3; i++)
        to[i] = signs >> i & 1 ? -from[orders[order][i]] : from[orders[order][i]];
    return vec3(to[0], to[1], to[2]);
}

/* Heights depend on no axis: turning origin, normal and point alike changes none. normals: oblique, along an axis,
 * along a diagonal, where two axes are equally near. */
static void the_free_plane_cuts_alike_in_all_orders_of_the_axes(void **state)
{
    (void)state;
    struct plan *plan = make_plan();
    const struct vec3 normals[] = { { 0.3, -1.2, 2 }, { 0, 0, 4 }, { 1, 1, 1 }, { 0, -3, 3 } },
                      origin = { 11.1, -7.3, 5.9 }, point = { 2, 3, -4 };
    for (size_t n = 0; n < sizeof normals / sizeof normals[0]; n++) {
        double expected = vec3_dot(vec3_sub(point, origin), normals[n]) / vec3_length(normals[n]);
        for (int i = 0; i < 48; i++) {
            struct scene scene = scene_default;
            struct clip_plane planes[CLIP_MAX];
            scene.clip.free = (struct scene_clip_free){ true, permuted(origin, i / 8, i % 8),
                                                        permuted(normals[n], i / 8, i % 8), true };
            assert_int_equal(clip_planes(plan, &scene, NULL, planes), 1);
            const struct plane *plane = &planes[0].plane;
            assert_close(plane_height_mm(plane, permuted(point, i / 8, i % 8)), expected, 1e-12);
            assert_close(vec3_dot(plane->right, plane->up), 0, 1e-15);
            assert_close(vec3_length(vec3_cross(plane->right, plane->up)), 1, 1e-12);
            if (n == 1) /* along an axis: every component is 0, 1 or -1, and no coordinate is rounded */
                for (int c = 0; c < 3; c++) {
                    const double normal[3] = { plane->normal.x, plane->normal.y, plane->normal.z };
                    assert_true(fabs(normal[c]) < 1e-300 || fabs(fabs(normal[c]) - 1) < 1e-300);
                }
        }
    }
    plan_destroy(plan);
}

/* While the nearest axis is the same, a normal turned by 1e-7 turns right and up by as little. */
static void a_plane_that_is_turned_a_little_moves_a_little(void **state)
{
    (void)state;
    for (int turn = 0; turn < 720; turn++)
        for (int rise = -80; rise <= 80; rise += 10) {
            struct plane planes[2];
            for (int i = 0; i < 2; i++) {
                double a = (turn / 2.0 + 0.1) * MATH_PI / 180 + i * 1e-7, b = (rise + 0.3) * MATH_PI / 180;
                planes[i] = plane_of_normal(vec3(1, 2, 3), vec3(cos(a) * cos(b), sin(a) * cos(b), sin(b)));
            }
            assert_true(vec3_length(vec3_sub(planes[0].right, planes[1].right)) < 1e-6);
            assert_true(vec3_length(vec3_sub(planes[0].up, planes[1].up)) < 1e-6);
            assert_true(vec3_length(vec3_sub(planes[0].normal, planes[1].normal)) < 1e-6);
        }
}

static void what_lies_in_a_plane_is_not_cut_off(void **state)
{
    (void)state;
    struct plan *plan = make_plan();
    struct scene scene = scene_default;
    struct clip_plane planes[CLIP_MAX];
    scene.clip.coronal_high = (struct scene_clip_axis){ true, 12.3, true };
    size_t n = clip_planes(plan, &scene, NULL, planes);
    assert_false(clip_cuts(planes, n, vec3(1, 12.3, 2)));
    assert_false(clip_cuts(planes, n, vec3(1, 12.3 + 0.9e-6, 2)));
    assert_true(clip_cuts(planes, n, vec3(1, 12.3 + 1.1e-6, 2)));
    plan_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_axis_plane_cuts_off_its_side),
        cmocka_unit_test(all_planes_at_once_keep_their_order),
        cmocka_unit_test(a_plane_across_a_beam_cuts_off_what_the_beam_meets_first),
        cmocka_unit_test(the_free_plane_cuts_alike_in_all_orders_of_the_axes),
        cmocka_unit_test(a_plane_that_is_turned_a_little_moves_a_little),
        cmocka_unit_test(what_lies_in_a_plane_is_not_cut_off),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
