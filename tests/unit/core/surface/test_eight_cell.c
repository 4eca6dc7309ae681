/* The 8-cell algorithm: properties of its surfaces, checked without its table. */
#include "core/surface/corner_cases.h"
#include "core/surface/surface.h"
#include "tests/check.h"
#include "tests/unit/made_mask.h"

static struct mesh *extract(const struct mask *mask, int n_threads, bool close_at_border)
{
    return made_surface(SURFACE_EIGHT_CELL, mask, n_threads, close_at_border);
}

/* ---- the volume of a hull, by counting lattice points ----------------------------------------------------------- */

/* Number of points with integer coordinates in `times` the hull of a cell's inside corners, found by testing every
 * plane that touches the hull. */
static int lattice_points(int inside, int times)
{
    int n = 0;
    for (int at = 0; at < (times + 1) * (times + 1) * (times + 1); at++) {
        int p[3] = { at % (times + 1), at / (times + 1) % (times + 1), at / ((times + 1) * (times + 1)) };
        bool is_in = true;
        for (int way = 0; is_in && way < 27; way++) {
            int d[3] = { way % 3 - 1, way / 3 % 3 - 1, way / 9 - 1 }, most = -3;
            for (int c = 0; c < 8; c++) {
                int along = d[0] * (c & 1) + d[1] * (c >> 1 & 1) + d[2] * (c >> 2);
                if (inside >> c & 1 && along > most)
                    most = along;
            }
            is_in = d[0] * p[0] + d[1] * p[1] + d[2] * p[2] <= times * most;
        }
        n += is_in;
    }
    return n;
}

/* That number is a polynomial in `times` whose leading coefficient is the volume (Ehrhart), so its third difference is
 * 6 volumes. */
static double hull_volume(int inside)
{
    if (!inside)
        return 0;
    return (lattice_points(inside, 3) - 3 * lattice_points(inside, 2) + 3 * lattice_points(inside, 1) - 1) / 6.0;
}

static int case_at(const struct mask *mask, int64_t i, int64_t j, int64_t k)
{
    int inside = 0;
    for (int c = 0; c < 8; c++)
        inside |= (int)mask_has(mask, i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)) << c;
    return inside;
}

static double volume_of_hulls(const struct mask *mask)
{
    static double volumes[256];
    double sum = 0;
    for (int inside = 1; volumes[255] == 0 && inside < 256; inside++)
        volumes[inside] = hull_volume(inside);
    for (int64_t k = -1; k < mask->size[2]; k++)
        for (int64_t j = -1; j < mask->size[1]; j++)
            for (int64_t i = -1; i < mask->size[0]; i++)
                sum += volumes[case_at(mask, i, j, k)];
    return sum * fabs(affine_determinant(&mask->lps_mm_from_ijk));
}

/* ---- edges ------------------------------------------------------------------------------------------------------ */

static int compare_numbers(const void *a, const void *b)
{
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return x < y ? -1 : x > y;
}

/* Every edge is used equally often in both directions, and every vertex is used. */
static void assert_closed(const struct mesh *mesh)
{
    size_t n = 3 * mesh->n_triangles;
    uint64_t *edges = calloc(n + 1, sizeof *edges);
    uint8_t *is_used = calloc(mesh->n_vertices + 1, 1);
    assert_true(edges && is_used);
    for (size_t at = 0; at < n; at++) {
        uint64_t from = mesh->indices[at], to = mesh->indices[at % 3 == 2 ? at - 2 : at + 1];
        assert_true(from < mesh->n_vertices && from != to);
        is_used[from] = 1;
        edges[at] = from < to ? from << 33 | to << 1 : to << 33 | from << 1 | 1;
    }
    qsort(edges, n, sizeof *edges, compare_numbers);
    for (size_t first = 0, end; first < n; first = end) {
        long balance = 0;
        for (end = first; end < n && edges[end] >> 1 == edges[first] >> 1; end++)
            balance += edges[end] & 1 ? -1 : 1;
        assert_int_equal(balance, 0);
    }
    for (size_t v = 0; v < mesh->n_vertices; v++)
        assert_true(is_used[v]);
    free(edges);
    free(is_used);
}

/* ---- tests ------------------------------------------------------------------------------------------------------ */

static void every_corner_case_is_closed_and_is_the_hull_of_its_corners(void **state)
{
    (void)state;
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        struct affine map = unit_map;
        map.columns[1].y = mirrored ? -1 : 1;
        for (int inside = 1; inside < 256; inside++) {
            struct mask *mask = mask_of_corners(inside, &map);
            struct mesh *mesh = extract(mask, 1, true);
            assert_closed(mesh);
            assert_close(mesh_volume_mm3(mesh), hull_volume(inside), 1e-6);
            int n = __builtin_popcount((unsigned)inside);
            assert_int_equal(mesh->n_vertices, n < 3 ? 0 : n); /* all corners of a cube are vertices of their hull */
            if (hull_volume(inside) > 0) {
                assert_int_equal(mesh_open_edges(mesh), 0);
                assert_int_equal(mesh->n_triangles, 2 * n - 4); /* T triangles: n - 3 T / 2 + T = 2 (Euler) */
            } else {
                assert_int_equal(mesh->n_triangles, n < 3 ? 0 : 2 * (n - 2)); /* both sides of a flat hull */
            }
            mesh_unref(mesh);
            mask_destroy(mask);
        }
    }
}

static void cells_with_fewer_than_three_inside_corners_or_none_outside_give_nothing(void **state)
{
    (void)state;
    struct corner_case cases[256];
    corner_cases_make(cases, false);
    for (int inside = 0; inside < 256; inside++) {
        if (__builtin_popcount((unsigned)inside) < 3 || inside == 255)
            assert_int_equal(cases[inside].n_triangles, 0);
        assert_int_equal(cases[inside].used & ~inside, 0);
    }
    assert_int_equal(cases[0x7f].n_triangles, 1); /* one corner missing: the triangle across */
    assert_int_equal(cases[0x0f].n_triangles, 2); /* a wall */
    assert_int_equal(cases[0x3f].n_triangles, 2); /* one edge missing: the slope */
    assert_int_equal(cases[0x69].n_triangles, 4); /* every other corner: a tetrahedron inside */
}

static void the_surface_of_a_box_runs_through_its_outermost_centres(void **state)
{
    (void)state;
    static const uint32_t boxes[][3] = { { 2, 2, 2 },  { 3, 4, 5 },  { 63, 2, 3 },
                                         { 64, 3, 2 }, { 65, 2, 4 }, { 129, 3, 3 } };
    struct affine map = { { { 2, 0, 0 }, { 0, 3, 0 }, { 0, 0, 5 } }, { 10, 20, 30 } };
    for (size_t b = 0; b < sizeof boxes / sizeof *boxes; b++)
        for (uint32_t margin = 0; margin < 3; margin++) {
            const uint32_t *n = boxes[b];
            map.columns[2].z = margin & 1 ? -5 : 5;
            struct mask *mask = mask_make(n[0] + 2 * margin, n[1] + margin, n[2] + margin, &map);
            for (uint32_t at = 0; at < n[0] * n[1] * n[2]; at++)
                mask_put(mask, at % n[0] + margin, at / n[0] % n[1], at / (n[0] * n[1]));
            struct mesh *mesh = extract(mask, 2, true);
            uint32_t a = n[0] - 1, c = n[1] - 1, e = n[2] - 1;
            assert_int_equal(mesh_open_edges(mesh), 0);
            assert_int_equal(mesh_euler(mesh), 2);
            assert_int_equal(mesh->n_triangles, 4 * (a * c + a * e + c * e));
            assert_near(mesh_volume_mm3(mesh), 30.0 * a * c * e, 1e-6);
            assert_close(mesh->bounds_lps_mm.low.x, 10 + 2.0 * margin, 1e-4);
            assert_close(mesh->bounds_lps_mm.high.x, 10 + 2.0 * (margin + a), 1e-4);
            mesh_unref(mesh);
            mask_destroy(mask);
        }
}

static void a_plate_is_two_sheets_and_what_is_thinner_vanishes(void **state)
{
    (void)state;
    struct mask *mask = mask_make(70, 5, 4, &unit_map); /* a plate across the grid */
    for (uint32_t k = 0; k < 4; k++)
        for (uint32_t i = 0; i < 70; i++)
            mask_put(mask, i, 2, k);
    struct mesh *closed = extract(mask, 2, true), *open = extract(mask, 2, false);
    assert_closed(closed);
    assert_int_equal(closed->n_triangles, 2 * 2 * 69 * 3);
    assert_int_equal(closed->n_vertices, 70 * 4);
    assert_close(mesh_volume_mm3(closed), 0, 1e-9);
    assert_near(mesh_area_mm2(closed), 2 * 69 * 3, 1e-6);
    assert_same_bytes(closed, open); /* cells beyond the border have at most two inside corners in this mask */
    struct error err = { 0 };
    assert_true(mesh_make_normals(closed, 2, &err));
    for (size_t v = 0; v < closed->n_vertices;
         v++) /* the two sheets' normals cancel, but the result is still a unit vector */
        assert_close(vec3_length(vec3((double)closed->normals[3 * v], (double)closed->normals[3 * v + 1],
                                      (double)closed->normals[3 * v + 2])),
                     1, 1e-5);
    mesh_unref(closed);
    mesh_unref(open);
    mask_destroy(mask);

    struct mask *rod = mask_make(9, 9, 9, &unit_map); /* a rod, a diagonal and a single voxel */
    for (uint32_t i = 0; i < 9; i++)
        mask_put(rod, i, 1, 1);
    mask_put(rod, 4, 4, 4);
    mask_put(rod, 5, 5, 5);
    mask_put(rod, 7, 7, 1);
    struct mesh *nothing = extract(rod, 2, true);
    assert_int_equal(nothing->n_triangles, 0);
    assert_int_equal(nothing->n_vertices, 0);
    assert_true(box3_is_empty(&nothing->bounds_lps_mm));
    assert_true(mesh_make_normals(nothing, 2, &err));
    mesh_unref(nothing);
    mask_destroy(rod);
}

static void a_region_cut_by_the_scan_is_open_only_when_asked(void **state)
{
    (void)state;
    struct mask *mask = mask_make(66, 6, 3, &unit_map); /* a bar through the grid, two voxels wide and as high as it */
    for (uint32_t k = 0; k < 3; k++)
        for (uint32_t at = 0; at < 2 * 66; at++)
            mask_put(mask, at % 66, 2 + at / 66, k);
    struct mesh *closed = extract(mask, 2, true), *open = extract(mask, 2, false);
    assert_int_equal(mesh_open_edges(closed), 0);
    assert_int_equal(closed->n_triangles, 4 * (65 * 1 + 65 * 2 + 1 * 2));
    assert_int_equal(open->n_triangles, 4 * 65 * 2); /* only the two long walls face existing cells */
    assert_int_equal(mesh_open_edges(open), 2 * 2 * (65 + 2));
    mesh_unref(closed);
    mesh_unref(open);
    mask_destroy(mask);
}

static void random_blocks_are_closed_and_equal_for_any_threads(void **state)
{
    (void)state;
    static const uint32_t sides[] = { 1, 2, 5, 31, 62, 63, 64, 65, 127, 128, 130 };
    struct affine map = { { { 0.8, 0.6, 0 }, { -1.2, 1.6, 0 }, { 0, 0, -3 } },
                          { 5, 6, 7 } }; /* oblique and left-handed */
    uint64_t seed = 41;
    for (size_t s = 0; s < sizeof sides / sizeof *sides; s++)
        for (uint32_t percent = 5; percent < 100; percent += 30) {
            struct mask *mask =
                random_mask(sides[s], 1 + next_random(&seed) % 9, 1 + next_random(&seed) % 9, percent, seed, &map);
            for (int open = 0; open < 2; open++) {
                struct mesh *one = extract(mask, 1, !open);
                for (int n_threads = 2; n_threads < 4; n_threads++) {
                    struct mesh *more = extract(mask, n_threads, !open);
                    assert_same_bytes(one, more);
                    mesh_unref(more);
                }
                if (!open) {
                    assert_closed(one);
                    assert_close(mesh_volume_mm3(one), volume_of_hulls(mask), 1e-3);
                }
                mesh_unref(one);
            }
            mask_destroy(mask);
        }
}

static void vertices_are_centres_of_inside_voxels_each_once(void **state)
{
    (void)state;
    struct mask *mask = random_mask(130, 11, 9, 50, 8, &unit_map), *seen = mask_make(130, 11, 9, &unit_map);
    struct mesh *mesh = extract(mask, 2, true);
    assert_true(mesh->n_vertices > 1000);
    for (size_t v = 0; v < mesh->n_vertices; v++) {
        const float *p = mesh->positions_lps_mm + 3 * v;
        uint32_t at[3] = { (uint32_t)lrintf(p[0]), (uint32_t)lrintf(p[1]), (uint32_t)lrintf(p[2]) };
        for (int axis = 0; axis < 3; axis++)
            assert_close(p[axis], at[axis], 0);
        assert_true(mask_has(mask, at[0], at[1], at[2]));
        assert_false(mask_has(seen, at[0], at[1], at[2]));
        mask_put(seen, at[0], at[1], at[2]);
    }
    mesh_unref(mesh);
    mask_destroy(mask);
    mask_destroy(seen);
}

static void a_ball_has_normals_that_point_outward(void **state)
{
    (void)state;
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        struct affine map = unit_map;
        map.columns[0].x = mirrored ? -1 : 1;
        struct mask *mask = mask_make(40, 40, 40, &map);
        for (uint32_t at = 0; at < 40 * 40 * 40; at++) {
            double x = at % 40 - 19.5, y = at / 40 % 40 - 19.5, z = at / 1600 - 19.5;
            if (x * x + y * y + z * z < 17 * 17)
                mask_put(mask, at % 40, at / 40 % 40, at / 1600);
        }
        struct error err = { 0 };
        struct mesh *mesh = extract(mask, 2, true);
        assert_int_equal(mesh_open_edges(mesh), 0);
        assert_int_equal(mesh_euler(mesh), 2);
        assert_true(mesh_make_normals(mesh, 2, &err));
        struct vec3 middle = affine_point(&map, vec3(19.5, 19.5, 19.5));
        for (size_t v = 0; v < mesh->n_vertices; v++) {
            const float *p = mesh->positions_lps_mm + 3 * v, *n = mesh->normals + 3 * v;
            struct vec3 out = vec3_normalize(vec3_sub(vec3((double)p[0], (double)p[1], (double)p[2]), middle));
            assert_true(vec3_dot(out, vec3((double)n[0], (double)n[1], (double)n[2])) > 0.7); /* within 45 degrees */
        }
        mesh_unref(mesh);
        mask_destroy(mask);
    }
}

static void an_empty_mask_and_too_many_triangles_are_refused(void **state)
{
    (void)state;
    struct mask *mask = mask_make(4, 4, 4, &unit_map);
    struct error err = { 0 };
    assert_null(surface_eight_cell(mask, &surface_defaults, &err));
    assert_int_equal(err.code, ERROR_RANGE);
    for (uint32_t c = 0; c < 8; c++)
        mask_put(mask, 1 + (c & 1), 1 + (c >> 1 & 1), 1 + (c >> 2));
    struct surface_options options = surface_defaults;
    options.max_triangles = 11;
    err = (struct error){ 0 };
    assert_null(surface_eight_cell(mask, &options, &err));
    assert_int_equal(err.code, ERROR_LIMIT);
    assert_non_null(strstr(err.text, "12 triangles"));
    options.max_triangles = 12;
    struct mesh *mesh = surface_eight_cell(mask, &options, &err);
    assert_non_null(mesh);
    mesh_unref(mesh);
    mask_destroy(mask);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_corner_case_is_closed_and_is_the_hull_of_its_corners),
        cmocka_unit_test(cells_with_fewer_than_three_inside_corners_or_none_outside_give_nothing),
        cmocka_unit_test(the_surface_of_a_box_runs_through_its_outermost_centres),
        cmocka_unit_test(a_plate_is_two_sheets_and_what_is_thinner_vanishes),
        cmocka_unit_test(a_region_cut_by_the_scan_is_open_only_when_asked),
        cmocka_unit_test(random_blocks_are_closed_and_equal_for_any_threads),
        cmocka_unit_test(vertices_are_centres_of_inside_voxels_each_once),
        cmocka_unit_test(a_ball_has_normals_that_point_outward),
        cmocka_unit_test(an_empty_mask_and_too_many_triangles_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
