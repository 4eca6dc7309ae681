/* The neighbour fan: which voxels its triangles connect, and which way they face. */
#include <stdlib.h>
#include <string.h>

#include "tests/check.h"
#include "tests/unit/shape_help.h"

static const uint32_t sizes[][3] = { { 1, 1, 1 }, { 5, 7, 6 }, { 63, 5, 4 }, { 64, 4, 5 }, { 65, 6, 3 } };
enum { N_SIZES = sizeof sizes / sizeof *sizes };

static struct mesh *fan(const struct mask *mask, int n_threads)
{
    struct error err = { 0 };
    struct mesh *mesh = shape_fan(mask, n_threads, &err);
    assert_string_equal(err.text, "");
    assert_non_null(mesh);
    return mesh;
}

struct triple {
    uint32_t v[3];
};

static int compare_triples(const void *a, const void *b)
{
    const struct triple *x = a, *y = b;
    for (int c = 0; c < 3; c++)
        if (x->v[c] != y->v[c])
            return x->v[c] < y->v[c] ? -1 : 1;
    return 0;
}

static int compare_u32(const void *a, const void *b)
{
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return x < y ? -1 : x > y;
}

static void fan_triangles_join_three_border_voxels_that_are_neighbours_each_once(void **state)
{
    (void)state;
    for (int s = 0; s < N_SIZES; s++)
        for (uint32_t percent = 15; percent < 100; percent += 35) {
            struct mask *mask = random_mask(sizes[s][0], sizes[s][1], sizes[s][2], percent, 9, &unit_map);
            struct mesh *mesh = fan(mask, 2);
            struct point_set *set = made_points(mask, 1);
            assert_int_equal(mesh->n_vertices, set->n_points);
            assert_memory_equal(mesh->positions_lps_mm, set->positions_lps_mm, 3 * set->n_points * sizeof(float));
            struct triple *triples = calloc(mesh->n_triangles + 1, sizeof *triples);
            for (size_t t = 0; t < mesh->n_triangles; t++) {
                const uint32_t *v = mesh->indices + 3 * t;
                struct vec3 facing = vec3(0, 0, 0);
                for (int c = 0; c < 3; c++) {
                    struct vec3 side = vec3_sub(mesh_position(mesh, v[(c + 1) % 3]), mesh_position(mesh, v[c]));
                    assert_true(fabs(side.x) <= 1 && fabs(side.y) <= 1 && fabs(side.z) <= 1 && vec3_length(side) > 0);
                    facing = vec3_add(facing, load_vec3(set->normals + 3 * (size_t)v[c]));
                }
                struct vec3 a = mesh_position(mesh, v[0]);
                struct vec3 normal =
                    vec3_cross(vec3_sub(mesh_position(mesh, v[1]), a), vec3_sub(mesh_position(mesh, v[2]), a));
                assert_true(vec3_dot(normal, facing) >= 0);
                memcpy(triples[t].v, v, sizeof triples[t].v);
                qsort(triples[t].v, 3, sizeof *triples[t].v, compare_u32);
            }
            qsort(triples, mesh->n_triangles, sizeof *triples, compare_triples);
            for (size_t t = 1; t < mesh->n_triangles; t++)
                assert_true(compare_triples(&triples[t - 1], &triples[t]) < 0);
            free(triples);
            made_points_finish(set);
            mesh_unref(mesh);
            mask_destroy(mask);
        }
}

/* In a flat sheet each voxel has eight neighbours, so each square of four voxels has four triangles, each without one
 * of the corners. */
static void a_flat_sheet_has_four_triangles_in_every_square_and_a_line_has_none(void **state)
{
    (void)state;
    struct mask *sheet = mask_make(7, 6, 3, &maps[1]);
    for (uint32_t j = 0; j < 6; j++)
        for (uint32_t i = 0; i < 7; i++)
            mask_put(sheet, i, j, 1);
    struct mesh *mesh = fan(sheet, 1);
    size_t in_middle = 0;
    for (size_t t = 0; t < mesh->n_triangles; t++) {
        struct vec3 middle = vec3(0, 0, 0);
        for (int c = 0; c < 3; c++)
            middle = vec3_add(middle, vec3_scale(index_of(sheet, mesh_position(mesh, mesh->indices[3 * t + (size_t)c])),
                                                 1 / 3.0));
        in_middle += middle.x > 1 && middle.x < 5 && middle.y > 1 && middle.y < 4;
    }
    assert_int_equal(in_middle, 4 * 4 * 3);
    assert_true(mesh->n_triangles <= 4 * 6 * 5);
    mesh_unref(mesh);
    mask_destroy(sheet);
    struct mask *line = mask_make(9, 3, 3, &unit_map);
    for (uint32_t i = 1; i < 8; i++)
        mask_put(line, i, 1, 1);
    mesh = fan(line, 1);
    assert_int_equal(mesh->n_triangles, 0);
    assert_int_equal(mesh->n_vertices, 7);
    mesh_unref(mesh);
    mask_destroy(line);
}

/* Triangles face outward on all sides, which the thesis could not achieve. Some are perpendicular to the ball. */
static void a_balls_fan_faces_outward_all_around(void **state)
{
    (void)state;
    for (int m = 0; m < 3; m += 2) {
        struct mask *mask = ball_mask(11, &maps[m]);
        struct mesh *mesh = fan(mask, 1);
        struct vec3 middle = affine_point(&maps[m], vec3(14.5, 14.5, 14.5));
        double outward = 0, inward = 0;
        for (size_t t = 0; t < mesh->n_triangles; t++) {
            const uint32_t *v = mesh->indices + 3 * t;
            struct vec3 a = mesh_position(mesh, v[0]);
            struct vec3 normal =
                vec3_cross(vec3_sub(mesh_position(mesh, v[1]), a), vec3_sub(mesh_position(mesh, v[2]), a));
            double facing = vec3_dot(normal, vec3_normalize(vec3_sub(a, middle)));
            *(facing >= 0 ? &outward : &inward) += fabs(facing);
        }
        assert_true(inward < 0.01 * outward);
        mesh_unref(mesh);
        mask_destroy(mask);
    }
}

/* Neighbours directly above each other have the same angle: rounding must not decide their sequence. */
static void turning_the_grid_in_space_changes_no_triangle(void **state)
{
    (void)state;
    static const struct affine turned[] = {
        { { { 0.6, 0.8, 0 }, { -0.8, 0.6, 0 }, { 0, 0, 1 } }, { 5, 6, 7 } },
        { { { 2 / 3.0, 2 / 3.0, 1 / 3.0 }, { -2 / 3.0, 1 / 3.0, 2 / 3.0 }, { 1 / 3.0, -2 / 3.0, 2 / 3.0 } },
          { -50, 20, 3 } },
        { { { 0, 0, 1 }, { 1, 0, 0 }, { 0, 1, 0 } }, { 0, 0, 0 } },
    };
    struct mask *straight = random_mask(24, 20, 18, 45, 5, &unit_map);
    struct mesh *expected = fan(straight, 1);
    for (size_t m = 0; m < sizeof turned / sizeof *turned; m++) {
        struct mask *mask = random_mask(24, 20, 18, 45, 5, &turned[m]);
        struct mesh *mesh = fan(mask, 2);
        assert_int_equal(mesh->n_triangles, expected->n_triangles);
        for (size_t t = 0; t < mesh->n_triangles; t++) {
            uint32_t a[3], b[3];
            memcpy(a, mesh->indices + 3 * t, sizeof a);
            memcpy(b, expected->indices + 3 * t, sizeof b);
            qsort(a, 3, sizeof *a, compare_u32); /* where normals cancel, rounding may choose the winding */
            qsort(b, 3, sizeof *b, compare_u32);
            assert_memory_equal(a, b, sizeof a);
        }
        mesh_unref(mesh);
        mask_destroy(mask);
    }
    mesh_unref(expected);
    mask_destroy(straight);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fan_triangles_join_three_border_voxels_that_are_neighbours_each_once),
        cmocka_unit_test(a_flat_sheet_has_four_triangles_in_every_square_and_a_line_has_none),
        cmocka_unit_test(a_balls_fan_faces_outward_all_around),
        cmocka_unit_test(turning_the_grid_in_space_changes_no_triangle),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
