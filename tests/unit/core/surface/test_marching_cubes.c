/* Marching cubes: closedness, topology, area and volume, against formulas and an independent Euler number. */
#include "core/surface/marching_cubes.h"
#include "core/surface/surface.h"
#include "tests/check.h"
#include "tests/unit/made_mask.h"

static struct mesh *extract(const struct mask *mask, int n_threads, bool close_at_border)
{
    return made_surface(SURFACE_MARCHING_CUBES, mask, n_threads, close_at_border);
}

/* ---- tests ------------------------------------------------------------------------------------------------------ */

static void every_corner_case_is_closed_and_encloses_its_corners(void **state)
{
    (void)state;
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        struct affine map = unit_map;
        map.columns[0].x = mirrored ? -1 : 1;
        for (int inside = 1; inside < 256; inside++) {
            struct mask *mask = mask_of_corners(inside, &map);
            struct mesh *mesh = extract(mask, 1, true);
            assert_int_equal(mesh_open_edges(mesh), 0);
            assert_int_equal(mesh_euler(mesh), euler_of_surface(mask));
            /* every voxel keeps at least the octahedron around its centre (volume 1/6), and the surface never leaves
             * the box */
            int n = __builtin_popcount((unsigned)inside);
            assert_true(mesh_volume_mm3(mesh) >= n / 6.0 - 1e-6);
            assert_true(mesh_volume_mm3(mesh) <= 8);
            mesh_unref(mesh);
            mask_destroy(mask);
        }
    }
}

static void a_single_voxel_is_an_octahedron_that_faces_outward(void **state)
{
    (void)state;
    struct affine map = { { { 2, 0, 0 }, { 0, 3, 0 }, { 0, 0, 5 } }, { 10, 20, 30 } };
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        map.columns[2].z = mirrored ? -5 : 5;
        struct mask *mask = mask_make(3, 3, 3, &map);
        mask_put(mask, 1, 1, 1);
        struct mesh *mesh = extract(mask, 1, true);
        assert_int_equal(mesh->n_vertices, 6);
        assert_int_equal(mesh->n_triangles, 8);
        assert_int_equal(mesh_euler(mesh), 2);
        assert_close(mesh_volume_mm3(mesh), 2 * 3 * 5 / 6.0, 1e-5);
        struct vec3 centre = affine_point(&map, vec3(1, 1, 1));
        for (size_t t = 0; t < mesh->n_triangles; t++) {
            struct vec3 p[3];
            for (int c = 0; c < 3; c++) {
                const float *at = mesh->positions_lps_mm + 3 * (size_t)mesh->indices[3 * t + (size_t)c];
                p[c] = vec3((double)at[0], (double)at[1], (double)at[2]);
            }
            struct vec3 normal = vec3_cross(vec3_sub(p[1], p[0]), vec3_sub(p[2], p[0]));
            assert_true(vec3_dot(normal, vec3_sub(p[0], centre)) > 0);
        }
        assert_close(mesh->bounds_lps_mm.low.x, 11, 1e-6);
        assert_close(mesh->bounds_lps_mm.high.x, 13, 1e-6);
        assert_close(mesh->bounds_lps_mm.low.z, centre.z - 2.5, 1e-6);
        assert_close(mesh->bounds_lps_mm.high.z, centre.z + 2.5, 1e-6);
        mesh_unref(mesh);
        mask_destroy(mask);
    }
}

/* Volume of a box of a x b x c voxels: all but its 12 edges, each of whose cells loses a wedge of 1/8 (half of half x
 * half), and its 8 corner cells, of which only a tetrahedron of 1/48 is inside. */
static double box_volume(double a, double b, double c)
{
    double inner = (a - 1) * (b - 1) * (c - 1);
    double sides = (a - 1) * (b - 1) + (a - 1) * (c - 1) + (b - 1) * (c - 1); /* two each, half a voxel thick */
    double edges = 4 * (a - 1 + b - 1 + c - 1) / 8.0;
    return inner + sides + edges + 8 / 48.0;
}

static void the_volume_of_a_box_is_exact_also_where_the_scan_cuts_it(void **state)
{
    (void)state;
    static const uint32_t boxes[][3] = { { 1, 1, 1 },  { 2, 3, 4 },  { 62, 2, 2 }, { 63, 1, 2 },
                                         { 64, 3, 1 }, { 65, 2, 5 }, { 130, 4, 3 } };
    for (size_t b = 0; b < sizeof boxes / sizeof *boxes; b++)
        for (uint32_t margin = 0; margin < 3; margin++) {
            const uint32_t *n = boxes[b];
            struct mask *mask = mask_make(n[0] + 2 * margin, n[1] + margin, n[2] + margin, &unit_map);
            for (uint32_t k = 0; k < n[2]; k++)
                for (uint32_t j = 0; j < n[1]; j++)
                    for (uint32_t i = 0; i < n[0]; i++)
                        mask_put(mask, i + margin, j + margin / 2, k + margin / 2);
            struct mesh *mesh = extract(mask, 2, true);
            assert_int_equal(mesh_open_edges(mesh), 0);
            assert_int_equal(mesh_euler(mesh), 2);
            assert_near(mesh_volume_mm3(mesh), box_volume(n[0], n[1], n[2]), 1e-6);
            assert_close(mesh->bounds_lps_mm.low.x, margin - 0.5, 1e-6); /* the outer faces of the outermost voxels */
            assert_close(mesh->bounds_lps_mm.high.x, margin + n[0] - 0.5, 1e-6);
            mesh_unref(mesh);
            mask_destroy(mask);
        }
}

static void a_region_cut_by_the_scan_is_open_only_when_asked(void **state)
{
    (void)state;
    struct mask *mask = mask_make(70, 5, 4, &unit_map); /* a slab across the grid, cut on four sides */
    for (uint32_t k = 0; k < 4; k++)
        for (uint32_t i = 0; i < 70; i++)
            mask_put(mask, i, 2, k);
    struct mesh *closed = extract(mask, 2, true), *open = extract(mask, 2, false);
    assert_int_equal(mesh_open_edges(closed), 0);
    assert_int_equal(mesh_euler(closed), 2);
    /* two sheets of 69 x 3 cells with two triangles each; each open along 2 (69 + 3) cell sides */
    assert_int_equal(open->n_triangles, 2 * 2 * 69 * 3);
    assert_int_equal(open->n_vertices, 2 * 70 * 4);
    assert_int_equal(mesh_open_edges(open), 2 * 2 * (69 + 3));
    mesh_unref(closed);
    mesh_unref(open);
    mask_destroy(mask);
}

static struct mask *sphere(uint32_t n, double radius_voxels, const struct affine *map)
{
    struct mask *mask = mask_make(n, n, n, map);
    double c = (n - 1) / 2.0;
    for (uint32_t k = 0; k < n; k++)
        for (uint32_t j = 0; j < n; j++)
            for (uint32_t i = 0; i < n; i++)
                if ((i - c) * (i - c) + (j - c) * (j - c) + (k - c) * (k - c) < radius_voxels * radius_voxels)
                    mask_put(mask, i, j, k);
    return mask;
}

static void a_sphere_has_the_analytic_volume_and_nearly_the_area(void **state)
{
    (void)state;
    struct affine map = { { { 0.5, 0, 0 }, { 0, 0.5, 0 }, { 0, 0, 0.5 } }, { -100, 40, 7 } };
    struct mask *mask = sphere(90, 40, &map);
    struct mesh *mesh = extract(mask, 2, true);
    assert_int_equal(mesh_open_edges(mesh), 0);
    assert_int_equal(mesh_euler(mesh), 2);
    /* number of lattice points in a ball: well within 1 % */
    assert_near(mesh_volume_mm3(mesh), 4.0 / 3.0 * MATH_PI * 20 * 20 * 20, 0.01);
    /* midpoints leave steps that do not vanish with more voxels: the area is too large, never too small, and by less
     * than the factor 3 / 2 of bare voxel faces */
    double area = 4 * MATH_PI * 20 * 20;
    assert_true(mesh_area_mm2(mesh) > area && mesh_area_mm2(mesh) < 1.15 * area);
    struct box3 box = mesh->bounds_lps_mm;
    assert_close(box.high.x - box.low.x, 40, 0.51);
    assert_close((box.high.y + box.low.y) / 2, 40 + 0.5 * 44.5, 1e-4);
    mesh_unref(mesh);
    mask_destroy(mask);
}

static void holes_pieces_and_tunnels_have_their_euler_number(void **state)
{
    (void)state;
    /* a torus 0; a hollow ball 4; a separate ball 2; a plate with two holes -2 */
    struct mask *torus = mask_make(40, 40, 12, &unit_map), *hollow = mask_make(40, 40, 40, &unit_map);
    for (uint32_t k = 0; k < 12; k++)
        for (uint32_t j = 0; j < 40; j++)
            for (uint32_t i = 0; i < 40; i++) {
                double ring = hypot(i - 19.5, j - 19.5) - 13;
                if (ring * ring + (k - 5.5) * (k - 5.5) < 16)
                    mask_put(torus, i, j, k);
            }
    for (uint32_t k = 0; k < 40; k++)
        for (uint32_t j = 0; j < 40; j++)
            for (uint32_t i = 0; i < 40; i++) {
                double r = sqrt((i - 19.5) * (i - 19.5) + (j - 19.5) * (j - 19.5) + (k - 19.5) * (k - 19.5));
                if (r < 15 && r > 8)
                    mask_put(hollow, i, j, k);
            }
    struct mask *both = mask_make(40, 40, 40, &unit_map);
    memcpy(both->bits, hollow->bits, 40 * 40 * sizeof *both->bits);
    mask_put(both, 0, 0, 0);
    struct mask *plate = mask_make(9, 5, 1, &unit_map);
    for (uint32_t j = 0; j < 5; j++)
        for (uint32_t i = 0; i < 9; i++)
            if (j != 2 || (i != 2 && i != 6))
                mask_put(plate, i, j, 0);
    const struct {
        struct mask *mask;
        long euler;
    } shapes[] = { { torus, 0 }, { hollow, 4 }, { both, 6 }, { plate, -2 } };
    for (size_t s = 0; s < sizeof shapes / sizeof *shapes; s++) {
        struct mesh *mesh = extract(shapes[s].mask, 3, true);
        assert_int_equal(mesh_open_edges(mesh), 0);
        assert_int_equal(mesh_euler(mesh), shapes[s].euler);
        /* so that the count below can be trusted */
        assert_int_equal(euler_of_surface(shapes[s].mask), shapes[s].euler);
        mesh_unref(mesh);
        mask_destroy(shapes[s].mask);
    }
}

static void random_blocks_are_closed_and_equal_for_any_threads_and_code(void **state)
{
    (void)state;
    static const uint32_t sides[] = { 1, 2, 5, 31, 62, 63, 64, 65, 127, 128, 130 };
    uint64_t seed = 20;
    /* oblique and left-handed: nothing may depend on an upright grid */
    struct affine map = { { { 0.8, 0.6, 0 }, { -1.2, 1.6, 0 }, { 0, 0, -3 } }, { 5, 6, 7 } };
    for (size_t s = 0; s < sizeof sides / sizeof *sides; s++)
        for (uint32_t percent = 5; percent < 100; percent += 30) {
            struct mask *mask =
                random_mask(sides[s], 1 + next_random(&seed) % 9, 1 + next_random(&seed) % 9, percent, seed, &map);
            struct mesh *one = extract(mask, 1, true);
            assert_int_equal(mesh_open_edges(one), 0);
            assert_int_equal(mesh_euler(one), euler_of_surface(mask));
            assert_true(mesh_volume_mm3(one) > 0);
            for (int open = 0; open < 2; open++) {
                struct mesh *first = extract(mask, 1, !open);
                for (int n_threads = 2; n_threads < 4; n_threads++) {
                    struct mesh *more = extract(mask, n_threads, !open);
                    assert_same_bytes(first, more);
                    mesh_unref(more);
                }
                struct surface_options options = surface_defaults;
                options.close_at_border = !open;
                struct error err = { 0 };
                struct mesh *portable = marching_cubes_with(MARCHING_CUBES_PORTABLE, mask, &options, &err);
                assert_same_bytes(first, portable);
                mesh_unref(portable);
                mesh_unref(first);
            }
            mesh_unref(one);
            mask_destroy(mask);
        }
}

static void a_mask_in_a_corner_of_a_large_grid_gives_the_same_surface_as_alone(void **state)
{
    (void)state;
    struct mask *alone = random_mask(20, 7, 6, 50, 3, &unit_map);
    struct affine moved = unit_map;
    moved.origin = vec3(-101, -33, -11);
    struct mask *large = mask_make(200, 50, 40, &moved);
    for (uint32_t k = 0; k < 6; k++)
        for (uint32_t j = 0; j < 7; j++)
            for (uint32_t i = 0; i < 20; i++)
                if (mask_has(alone, i, j, k))
                    mask_put(large, i + 101, j + 33, k + 11);
    struct mesh *a = extract(alone, 2, true), *b = extract(large, 2, true);
    assert_same_bytes(a, b);
    mesh_unref(a);
    mesh_unref(b);
    mask_destroy(alone);
    mask_destroy(large);
}

static void an_empty_mask_and_too_many_triangles_are_refused(void **state)
{
    (void)state;
    struct mask *mask = mask_make(4, 4, 4, &unit_map);
    struct error err = { 0 };
    assert_null(surface_marching_cubes(mask, &surface_defaults, &err));
    assert_int_equal(err.code, ERROR_RANGE);
    mask_put(mask, 1, 1, 1);
    struct surface_options options = surface_defaults;
    options.max_triangles = 7;
    err = (struct error){ 0 };
    assert_null(surface_marching_cubes(mask, &options, &err));
    assert_int_equal(err.code, ERROR_LIMIT);
    assert_non_null(strstr(err.text, "8 triangles"));
    options.max_triangles = 8;
    struct mesh *mesh = surface_marching_cubes(mask, &options, &err);
    assert_non_null(mesh);
    mesh_unref(mesh);
    mask_destroy(mask);
}

static void a_full_grid_has_no_open_surface(void **state)
{
    (void)state;
    struct mask *mask = mask_make(3, 1, 2, &unit_map);
    for (uint32_t i = 0; i < 3; i++) {
        mask_put(mask, i, 0, 0);
        mask_put(mask, i, 0, 1);
    }
    struct mesh *open = extract(mask, 2, false);
    assert_int_equal(open->n_triangles, 0);
    assert_int_equal(open->n_vertices, 0);
    mesh_unref(open);
    mask_destroy(mask);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_corner_case_is_closed_and_encloses_its_corners),
        cmocka_unit_test(a_single_voxel_is_an_octahedron_that_faces_outward),
        cmocka_unit_test(the_volume_of_a_box_is_exact_also_where_the_scan_cuts_it),
        cmocka_unit_test(a_region_cut_by_the_scan_is_open_only_when_asked),
        cmocka_unit_test(a_sphere_has_the_analytic_volume_and_nearly_the_area),
        cmocka_unit_test(holes_pieces_and_tunnels_have_their_euler_number),
        cmocka_unit_test(random_blocks_are_closed_and_equal_for_any_threads_and_code),
        cmocka_unit_test(a_mask_in_a_corner_of_a_large_grid_gives_the_same_surface_as_alone),
        cmocka_unit_test(an_empty_mask_and_too_many_triangles_are_refused),
        cmocka_unit_test(a_full_grid_has_no_open_surface),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
