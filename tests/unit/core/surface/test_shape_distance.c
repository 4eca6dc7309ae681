/* Distances to a region's exact border, compared with the distance to every face computed another way. */
#include "core/surface/shape_distance.h"
#include "tests/check.h"
#include "tests/unit/made_mask.h"

static const struct affine maps[] = {
    { { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, { 0, 0, 0 } },
    { { { 1.5, 0, 0 }, { 0, -0.8, 0 }, { 0, 0, 5 } }, { 3, -2, 40 } },
    { { { 0.3, 0.4, 2 }, { 1.2, -0.9, 0 }, { 0.72, 0.96, -0.3 } }, { 11, -12, 13 } }, /* rotated, perpendicular axes */
    { { { 1, 0, 0 }, { 0.2, 1.1, 0 }, { 0, 0.7, 2.4 } }, { -5, 1, 2 } },     /* sheared, as by a tilted gantry */
    { { { 0.5, 0, 0 }, { 0, 0.5, 0 }, { 0, 0, 75 } }, { -100, -50, -150 } }, /* thick slices */
    { { { 40, 0, 0 }, { 0, 0, 0.25 }, { 0, 8, 0.1 } }, { 1, 2, 3 } },        /* thick along a row, and sheared */
};
enum { N_MAPS = 6 };

static struct shape_distance measure(const struct mask *mask, const float *positions, size_t n, int n_threads)
{
    struct shape_distance distance;
    struct error err = { 0 };
    assert_true(shape_distance(mask, positions, n, n_threads, &distance, &err));
    assert_int_equal(distance.n_positions, n);
    return distance;
}

/* Distance to a parallelogram by alternating projection: steps along one side and then the other, each to its nearest
 * point, converge because the distance is convex. */
static double descend(struct vec3 p, struct vec3 corner, struct vec3 u, struct vec3 v)
{
    double s = 0.5, t = 0.5;
    struct vec3 off = vec3_sub(p, corner);
    for (int step = 0; step < 200; step++) {
        s = vec3_dot(vec3_sub(off, vec3_scale(v, t)), u) / vec3_dot(u, u);
        s = s < 0 ? 0 : s > 1 ? 1 : s;
        t = vec3_dot(vec3_sub(off, vec3_scale(u, s)), v) / vec3_dot(v, v);
        t = t < 0 ? 0 : t > 1 ? 1 : t;
    }
    return vec3_length(vec3_sub(off, vec3_add(vec3_scale(u, s), vec3_scale(v, t))));
}

static double nearest_face(const struct mask *mask, struct vec3 p)
{
    double least = INFINITY;
    for (int64_t k = 0; k < mask->size[2]; k++)
        for (int64_t j = 0; j < mask->size[1]; j++)
            for (int64_t i = 0; i < mask->size[0]; i++)
                for (int way = 0; way < 6 && mask_has(mask, i, j, k); way++) {
                    int axis = way / 2, side = way % 2;
                    int64_t n[3] = { i, j, k };
                    n[axis] += side ? 1 : -1;
                    if (mask_has(mask, n[0], n[1], n[2]))
                        continue;
                    double c[3] = { (double)i - 0.5, (double)j - 0.5, (double)k - 0.5 };
                    c[axis] += side;
                    struct vec3 corner = affine_point(&mask->lps_mm_from_ijk, vec3(c[0], c[1], c[2]));
                    const struct vec3 *columns = mask->lps_mm_from_ijk.columns;
                    double d = descend(p, corner, columns[(axis + 1) % 3], columns[(axis + 2) % 3]);
                    least = d < least ? d : least;
                }
    return least;
}

static void distances_are_those_to_the_nearest_face_of_all(void **state)
{
    (void)state;
    uint64_t seed = 8;
    for (int m = 0; m < N_MAPS; m++)
        for (uint32_t percent = 1; percent < 100; percent += 24) {
            struct mask *mask = random_mask(9, 6, 5, percent, percent, &maps[m]);
            for (int n = 0; n < 60; n++) {
                double at[3];
                for (int axis = 0; axis < 3; axis++) /* from one grid width before the grid to one after it */
                    at[axis] = (next_random(&seed) % 30000 / 10000.0 - 1) * (double)mask->size[axis];
                struct vec3 p = affine_point(&maps[m], vec3(at[0], at[1], at[2]));
                float position[3] = { (float)p.x, (float)p.y, (float)p.z };
                double expected =
                    nearest_face(mask, vec3((double)position[0], (double)position[1], (double)position[2]));
                struct shape_distance distance = measure(mask, position, 1, 1);
                assert_close(distance.max_mm, expected, 1e-6 * (1 + expected));
                assert_true(distance.mean_mm == distance.max_mm);
            }
            mask_destroy(mask);
        }
}

static void on_the_border_it_is_0_and_within_a_voxel_to_its_nearest_face(void **state)
{
    (void)state;
    struct mask *mask = mask_make(3, 3, 3, &maps[1]);
    mask_put(mask, 1, 1, 1);
    struct vec3 centre = affine_point(&maps[1], vec3(1, 1, 1)), side = affine_point(&maps[1], vec3(1.5, 1.25, 0.75));
    float positions[6] = { (float)centre.x, (float)centre.y, (float)centre.z,
                           (float)side.x,   (float)side.y,   (float)side.z };
    struct shape_distance distance = measure(mask, positions, 2, 2);
    assert_close(distance.max_mm, 0.4, 1e-5); /* half of 0.8 mm; positions are floats */
    assert_close(distance.mean_mm, 0.2, 1e-5);
    mask_destroy(mask);
}

static void what_the_scan_cuts_is_border(void **state)
{
    (void)state;
    struct mask *mask = mask_make(4, 70, 4, &unit_map);
    for (uint32_t k = 0; k < 4; k++)
        for (uint32_t j = 0; j < 70; j++)
            for (uint32_t i = 0; i < 4; i++)
                mask_put(mask, i, j, k);
    float inside[3] = { 1.5f, 30, 1.75f }, far[3] = { 1.5f, 1000, 1.5f };
    assert_close(measure(mask, inside, 1, 1).max_mm, 1.75, 1e-6);
    assert_close(measure(mask, far, 1, 1).max_mm, 1000 - 69.5, 1e-3);
    mask_destroy(mask);
}

static void threads_do_not_matter_and_no_position_has_no_distance(void **state)
{
    (void)state;
    struct mask *mask = random_mask(40, 30, 20, 40, 6, &maps[2]);
    struct mesh *mesh = made_surface(SURFACE_EIGHT_CELL, mask, 1, true);
    struct shape_distance one = measure(mask, mesh->positions_lps_mm, mesh->n_vertices, 1);
    for (int n = 2; n <= 3; n++) {
        struct shape_distance more = measure(mask, mesh->positions_lps_mm, mesh->n_vertices, n);
        assert_true(more.mean_mm == one.mean_mm && more.max_mm == one.max_mm);
    }
    assert_true(mesh->n_vertices > 2000 && one.mean_mm > 0);
    struct shape_distance none = measure(mask, mesh->positions_lps_mm, 0, 2);
    assert_true(none.mean_mm == 0 && none.max_mm == 0);
    mesh_unref(mesh);
    mask_destroy(mask);
}

/* Three slices of a disc, 64 mm in radius and 75 mm apart: in the middle of an end slice the nearest face is 37.5 mm
 * above, which is 75 voxels along the other axes; some pi x 75^2 = 18000 faces are as near in voxels, all of which a
 * search by voxels would look at. */
static void thick_slices_cost_no_more_than_cubes(void **state)
{
    (void)state;
    enum { SIDE = 260, RADIUS = 128 };
    struct mask *mask = mask_make(SIDE, SIDE, 3, &maps[4]);
    for (uint32_t k = 0; k < 3; k++)
        for (int j = -RADIUS; j <= RADIUS; j++)
            for (int i = -RADIUS; i <= RADIUS; i++)
                if (i * i + j * j <= RADIUS * RADIUS)
                    mask_put(mask, (uint32_t)(SIDE / 2 + i), (uint32_t)(SIDE / 2 + j), k);
    struct mesh *mesh = made_surface(SURFACE_EIGHT_CELL, mask, 2, true);
    struct shape_distance distance = measure(mask, mesh->positions_lps_mm, mesh->n_vertices, 0);
    assert_true(mesh->n_vertices > 100000);
    /* the centre of a voxel in an end slice, at least 37.5 mm from the disc's rim */
    assert_close(distance.max_mm, 37.5, 1e-3);
    assert_true(distance.n_measured < 300 * distance.n_positions);
    mesh_unref(mesh);
    mask_destroy(mask);
}

static void a_position_far_from_the_region_costs_little_too(void **state)
{
    (void)state;
    struct mask *mask = random_mask(200, 150, 100, 2, 3, &maps[2]);
    float far[3] = { 4000, -9000, 5000 };
    assert_true(measure(mask, far, 1, 1).n_measured < 2000);
    mask_destroy(mask);
}

static void an_empty_region_and_a_position_that_is_no_number_are_refused(void **state)
{
    (void)state;
    struct mask *mask = mask_make(4, 4, 4, &unit_map);
    float positions[6] = { 1, 1, 1, NAN, 1, 1 };
    struct shape_distance distance;
    struct error err = { 0 };
    assert_false(shape_distance(mask, positions, 1, 1, &distance, &err));
    assert_string_equal(err.text, "the distance to a region without a voxel");
    mask_put(mask, 2, 2, 2);
    err = (struct error){ 0 };
    assert_false(shape_distance(mask, positions, 2, 1, &distance, &err));
    assert_int_equal(err.code, ERROR_RANGE);
    mask_destroy(mask);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(distances_are_those_to_the_nearest_face_of_all),
        cmocka_unit_test(on_the_border_it_is_0_and_within_a_voxel_to_its_nearest_face),
        cmocka_unit_test(what_the_scan_cuts_is_border),
        cmocka_unit_test(threads_do_not_matter_and_no_position_has_no_distance),
        cmocka_unit_test(thick_slices_cost_no_more_than_cubes),
        cmocka_unit_test(a_position_far_from_the_region_costs_little_too),
        cmocka_unit_test(an_empty_region_and_a_position_that_is_no_number_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
