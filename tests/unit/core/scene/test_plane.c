/* Planes: those of a scene are exact, and their geometry is that of any plane. */
#include "core/scene/plane.h"
#include "tests/check.h"

static const struct plan none; /* no beams */

static void expect_vec3(struct vec3 value, double x, double y, double z)
{
    assert_point(value, x, y, z, 1e-12);
}

/* To the bit: a position that has no short binary fraction comes back unchanged. */
static void planes_square_to_the_patient_return_coordinates_unchanged(void **state)
{
    (void)state;
    static const enum scene_kind kinds[3] = { SCENE_KIND_SAGITTAL, SCENE_KIND_CORONAL, SCENE_KIND_AXIAL };
    const struct vec3 point = vec3(17.3, -4.1, 0.7);
    const double coordinates[3] = { point.x, point.y, point.z };
    for (int axis = 0; axis < 3; axis++) {
        struct plane plane = plane_of_kind(kinds[axis], 0.1);
        struct vec3 nearest = plane_nearest(&plane, point);
        const double found[3] = { nearest.x, nearest.y, nearest.z };
        for (int i = 0; i < 3; i++)
            assert_true(!(found[i] < (i == axis ? 0.1 : coordinates[i])) &&
                        !(found[i] > (i == axis ? 0.1 : coordinates[i])));
        assert_close(plane_position_mm(&plane), 0.1, 0);
        assert_close(plane_height_mm(&plane, point), coordinates[axis] - 0.1, 0);
    }
}

/* Axial from the feet towards the head, coronal from the front to the back, sagittal from the left to the right; in LPS
 * the head is +z, the back +y, the left +x. */
static void pictures_of_planes_look_the_way_the_panes_do(void **state)
{
    (void)state;
    struct plane axial = plane_of_kind(SCENE_KIND_AXIAL, 0), coronal = plane_of_kind(SCENE_KIND_CORONAL, 0),
                 sagittal = plane_of_kind(SCENE_KIND_SAGITTAL, 0);
    expect_vec3(plane_forward(&axial), 0, 0, 1);
    expect_vec3(plane_forward(&coronal), 0, 1, 0);
    expect_vec3(plane_forward(&sagittal), -1, 0, 0);
    assert_false(signbit(plane_forward(&axial).x)); /* no -0, which a matrix would carry to the page */
}

static void only_slices_that_are_visible_have_planes(void **state)
{
    (void)state;
    struct scene scene = scene_default;
    struct plane slices[PLANE_MAX_SLICES];
    scene.image.slices.axial.visible = false;
    scene.image.slices.coronal.visible = scene.image.slices.sagittal.visible = true;
    scene.image.slices.coronal.position_mm = 5;
    scene.image.slices.sagittal.position_mm = -6;
    assert_int_equal(planes_of_slices(&none, &scene, NULL, slices), 2);
    expect_vec3(slices[0].origin_lps_mm, 0, 5, 0);
    expect_vec3(slices[1].origin_lps_mm, -6, 0, 0);
    scene_finish(&scene);
}

/* A plane through the diagonal of a cube from 0 to 2: x + y = 2. Along (1, -1, 0) / sqrt 2 the cube reaches sqrt 2 to
 * both sides, along z from 0 to 2, and its corners are sqrt 2 above and below. */
static void a_box_reaches_as_far_as_its_corners(void **state)
{
    (void)state;
    const double r = sqrt(0.5);
    const struct plane plane = { vec3(1, 1, 0), vec3(r, -r, 0), vec3(0, 0, 1), vec3(r, r, 0) };
    const struct box3 box = { vec3(0, 0, 0), vec3(2, 2, 2) };
    struct plane_reach reach = plane_reach(&plane, &box);
    assert_close(reach.low_right_mm, -sqrt(2), 1e-12);
    assert_close(reach.high_right_mm, sqrt(2), 1e-12);
    assert_close(reach.low_up_mm, 0, 1e-12);
    assert_close(reach.high_up_mm, 2, 1e-12);
    assert_close(reach.low_mm, -sqrt(2), 1e-12);
    assert_close(reach.high_mm, sqrt(2), 1e-12);
    assert_true(plane_meets(&reach));
    struct plane far = plane_moved(&plane, 1.5);
    reach = plane_reach(&far, &box);
    assert_false(plane_meets(&reach));
}

static void an_upright_plane_does_not_depend_on_which_way_up_it_was(void **state)
{
    (void)state;
    const struct plane plane = { vec3(1, 2, 3), vec3(0.6, -0.8, 0), vec3(0, 0, 1), vec3(0.8, 0.6, 0) };
    const struct plane turned = { vec3(1, 2, 3), vec3(-0.6, 0.8, 0), vec3(0, 0, -1), vec3(0.8, 0.6, 0) };
    struct plane a = plane_upright(&plane), b = plane_upright(&turned);
    assert_true(plane_equal(&a, &b));
    assert_false(plane_equal(&plane, &turned));
    expect_vec3(a.right, -0.6, 0.8, 0);
}

/* A direction by two angles, of any length. */
static struct vec3 direction(double turn, double rise, double length)
{
    return vec3_scale(vec3(cos(rise) * cos(turn), cos(rise) * sin(turn), sin(rise)), length);
}

static enum scene_kind nearest_kind(struct vec3 n)
{
    double x = fabs(n.x), y = fabs(n.y), z = fabs(n.z);
    return z >= x && z >= y ? SCENE_KIND_AXIAL : y >= x ? SCENE_KIND_CORONAL : SCENE_KIND_SAGITTAL;
}

/* Every 5 degrees around and 4 up and down. The picture's axes are square to each other and to the normal, turn the
 * same way round as the nearest slice's, and its up leans no way to the side: it is the slice's up as far as that lies
 * in the plane. */
static void a_plane_of_any_direction_is_turned_like_the_nearest_slice(void **state)
{
    (void)state;
    for (int turn = 0; turn < 360; turn += 5)
        for (int rise = -88; rise <= 88; rise += 4) {
            struct vec3 n = direction(turn * MATH_PI / 180, rise * MATH_PI / 180, 3.7), unit = vec3_normalize(n);
            struct plane plane = plane_of_normal(vec3(1, 2, 3), n), near = plane_of_kind(nearest_kind(n), 0);
            assert_close(fabs(vec3_dot(plane.normal, unit)), 1, 1e-12);
            assert_true(vec3_dot(plane.normal, near.normal) > 0.57); /* the nearest of three axes: 1 / sqrt 3 */
            assert_close(vec3_dot(plane.right, plane.up), 0, 1e-12);
            assert_close(vec3_dot(plane.right, plane.normal), 0, 1e-12);
            assert_close(vec3_dot(plane.up, plane.normal), 0, 1e-12);
            assert_close(vec3_length(plane.right), 1, 1e-12);
            assert_close(vec3_length(plane.up), 1, 1e-12);
            struct vec3 cross = vec3_cross(near.right, near.up), own = vec3_cross(plane.right, plane.up);
            assert_true(vec3_dot(cross, near.normal) * vec3_dot(own, plane.normal) > 0);
            assert_close(vec3_dot(near.up, plane.right), 0, 1e-12);
            assert_true(vec3_dot(near.up, plane.up) > 0);
            assert_true(vec3_dot(near.right, plane.right) > 0);
            assert_close(plane_height_mm(&plane, vec3(1, 2, 3)), 0, 1e-9);
        }
}

static void a_plane_square_to_the_patient_is_that_slice_to_the_bit(void **state)
{
    (void)state;
    static const enum scene_kind kinds[3] = { SCENE_KIND_SAGITTAL, SCENE_KIND_CORONAL, SCENE_KIND_AXIAL };
    static const struct vec3 axes[3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
    static const double positions[3] = { 17.3, -4.1, 0.7 };
    for (int axis = 0; axis < 3; axis++)
        for (int way = -1; way <= 1; way += 2) {
            struct plane plane = plane_of_normal(vec3(17.3, -4.1, 0.7), vec3_scale(axes[axis], way * 2.5)),
                         slice = plane_of_kind(kinds[axis], positions[axis]);
            assert_true(plane_equal(&plane, &slice));
        }
}

static void an_oblique_view_shows_the_plane_that_it_names(void **state)
{
    (void)state;
    struct scene_oblique_entry obliques[2] = { { .id = "a", .value = scene_oblique_default },
                                               { .id = "b", .value = scene_oblique_default } };
    struct scene scene = scene_default;
    struct view view = view_default;
    obliques[1].value.origin_mm = vec3(1, 2, 3);
    obliques[1].value.normal = vec3(0, 1, 1);
    obliques[1].value.visible = true;
    scene.image.obliques = obliques;
    scene.image.n_obliques = 2;
    scene.image.slices.axial.position_mm = 9;
    view.kind = SCENE_KIND_OBLIQUE;
    (void)snprintf(view.plane, sizeof view.plane, "b");
    struct plane pane = plane_of_view(&none, &scene, NULL, &view),
                 expected = plane_of_normal(vec3(1, 2, 3), vec3(0, 1, 1)), slices[PLANE_MAX_SLICES],
                 axial = plane_of_kind(SCENE_KIND_AXIAL, 9);
    assert_true(plane_equal(&pane, &expected));
    scene.image.slices.axial.visible = true;
    scene.image.slices.coronal.visible = scene.image.slices.sagittal.visible = false;
    assert_int_equal(planes_of_slices(&none, &scene, NULL, slices), 2); /* "a" is not visible in space */
    assert_true(plane_equal(&slices[0], &axial) && plane_equal(&slices[1], &expected));
    (void)snprintf(view.plane, sizeof view.plane, "gone");
    pane = plane_of_view(&none, &scene, NULL, &view);
    assert_true(plane_equal(&pane, &axial));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(planes_square_to_the_patient_return_coordinates_unchanged),
        cmocka_unit_test(pictures_of_planes_look_the_way_the_panes_do),
        cmocka_unit_test(only_slices_that_are_visible_have_planes),
        cmocka_unit_test(a_box_reaches_as_far_as_its_corners),
        cmocka_unit_test(an_upright_plane_does_not_depend_on_which_way_up_it_was),
        cmocka_unit_test(a_plane_of_any_direction_is_turned_like_the_nearest_slice),
        cmocka_unit_test(a_plane_square_to_the_patient_is_that_slice_to_the_bit),
        cmocka_unit_test(an_oblique_view_shows_the_plane_that_it_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
