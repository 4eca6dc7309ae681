/* Isosurfaces of fields against spheres, boxes and planes in closed form, VTK, and the field without gaps. */
#include <unistd.h>

#include "core/surface/isosurface_bits.h"
#include "tests/check.h"
#include "tests/made_plan.h"
#include "tests/unit/made_mask.h"
#include "tests/unit/oracle.h"

static struct volume *field_of(uint32_t nx, uint32_t ny, uint32_t nz, struct affine map,
                               double (*value)(struct vec3 lps_mm))
{
    struct grid grid = made_grid(nx, ny, nz, map);
    return made_volume(&grid, VOXEL_F32, value);
}

static struct mesh *extract_as(enum surface_algorithm algorithm, enum marching_cubes_code code,
                               const struct volume *field, double iso, int n_threads, bool has_bricks)
{
    struct surface_options options = surface_defaults;
    struct error err = { 0 };
    options.n_threads = n_threads;
    struct iso_bricks *bricks = has_bricks ? iso_bricks_create(field, n_threads, &err) : NULL;
    struct mesh *mesh = isosurface_with(code, algorithm, field, bricks, iso, &options, &err);
    iso_bricks_destroy(bricks);
    assert_string_equal(err.text, "");
    assert_non_null(mesh);
    return mesh;
}

static struct mesh *extract(const struct volume *field, double iso)
{
    return extract_as(SURFACE_MARCHING_CUBES, MARCHING_CUBES_BEST, field, iso, 2, true);
}

static struct vec3 vertex_at(const float *p)
{
    return vec3((double)p[0], (double)p[1], (double)p[2]);
}

static void every_vertex_is_used(const struct mesh *mesh)
{
    uint8_t *used = calloc(mesh->n_vertices + 1, 1);
    for (size_t at = 0; at < 3 * mesh->n_triangles; at++) {
        assert_true(mesh->indices[at] < mesh->n_vertices);
        used[mesh->indices[at]] = 1;
    }
    for (size_t v = 0; v < mesh->n_vertices; v++)
        assert_true(used[v]);
    free(used);
}

/* ---- spheres ----------------------------------------------------------------------------------------------------- */

static struct vec3 centre;

static double cone(struct vec3 p)
{
    return 100 - vec3_length(vec3_sub(p, centre));
} /* linear along rays from the centre */

static double gauss(struct vec3 p)
{
    struct vec3 d = vec3_sub(p, centre);
    return 100 * exp(-vec3_dot(d, d) / (2 * 12.0 * 12.0));
}

/* Grids of anisotropic, mirrored, turned and sheared voxels. */
static const struct {
    struct vec3 columns[3];
    double longest_mm;
} grids[] = {
    { { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, 1 },
    { { { 1.1, 0, 0 }, { 0, 0.9, 0 }, { 0, 0, 2 } }, 2 },
    { { { -1, 0, 0 }, { 0, 1, 0 }, { 0, 0, -1.5 } }, 1.5 },
    { { { 0, 0.8, 0.6 }, { 1, 0, 0 }, { 0, 0.72, -0.96 } }, 1.2 },
    { { { 1, 0.2, 0 }, { 0, 1, 0.3 }, { 0.1, 0, 1.4 } }, 1.44 },
};

static void spheres_are_exact_on_every_grid_at_random_offsets(void **state)
{
    (void)state;
    uint64_t seed = 7;
    const double radius = 17.5, area = 4 * MATH_PI * radius * radius, volume = radius * area / 3;
    const double level = 100 * exp(-radius * radius / (2 * 12.0 * 12.0));
    for (size_t g = 0; g < sizeof grids / sizeof *grids; g++)
        for (int shape = 0; shape < 2; shape++) {
            const uint32_t size[3] = { 53, 49, 47 };
            centre = vec3(next_random(&seed) % 1000 / 1000.0, next_random(&seed) % 1000 / 1000.0,
                          next_random(&seed) % 1000 / 1000.0);
            struct affine map =
                made_affine(grids[g].columns[0], grids[g].columns[1], grids[g].columns[2], size, vec3(0, 0, 0));
            struct volume *field = field_of(53, 49, 47, map, shape ? gauss : cone);
            struct mesh *mesh = extract(field, shape ? level : 100 - radius);
            assert_int_equal(mesh_open_edges(mesh), 0);
            assert_int_equal(mesh_euler(mesh), 2);
            /* along an edge of h mm, linear interpolation errs by h^2 / 8 of the second derivative over the first: 1 /
             * r for the cone; r / sigma^2 - 1 / r in all for the Gaussian. Chords of triangles lose as much again. */
            double h = grids[g].longest_mm, bound = h * h / 8 * (shape ? 0.122 : 0.058);
            for (size_t v = 0; v < mesh->n_vertices; v++) {
                struct vec3 out = vec3_sub(vertex_at(mesh->positions_lps_mm + 3 * v), centre);
                assert_close(vec3_length(out), radius, bound * 1.1 + 1e-5);
                /* central differences over 2 h err by h^2 / 6 of the third derivative */
                struct vec3 normal = vertex_at(mesh->normals + 3 * v);
                assert_close(vec3_length(normal), 1, 1e-5);
                assert_true(vec3_dot(normal, out) / vec3_length(out) > 1 - 2e-4);
            }
            assert_near(mesh_area_mm2(mesh), area, 0.004 * h * h);
            assert_near(mesh_volume_mm3(mesh), volume, 0.004 * h * h);
            mesh_unref(mesh);
            volume_unref(field);
        }
}

/* ---- boxes and planes -------------------------------------------------------------------------------------------- */

static double box(struct vec3 p)
{
    return p.x >= 3 && p.x <= 12 && p.y >= 2 && p.y <= 6 && p.z >= 4 && p.z <= 10 ? 10 : 0;
}

static void a_box_of_constant_value_has_chamfers_of_half_a_voxel(void **state)
{
    (void)state;
    struct volume *field = field_of(20, 12, 14, unit_map, box);
    struct mesh *mesh = extract(field, 5);
    assert_int_equal(mesh_open_edges(mesh), 0);
    assert_int_equal(mesh_euler(mesh), 2);
    /* 10 x 5 x 7 voxels less a prism of 1/8 mm2 along each edge and less a tetrahedron at each corner */
    double edges = 9 + 4 + 6;
    assert_close(mesh_volume_mm3(mesh), 350 - 4 * edges / 8 - 8 * (1 / 8.0 - 1 / 48.0), 1e-4);
    assert_close(mesh_area_mm2(mesh), 2 * (9 * 4 + 9 * 6 + 4 * 6) + 4 * edges * sqrt(0.5) + 8 * sqrt(3) / 8, 1e-4);
    mesh_unref(mesh);
    mesh = extract(field, 7.5); /* a quarter of the way from inside to outside */
    assert_close(mesh->bounds_lps_mm.low.x, 2.75, 1e-6);
    assert_close(mesh->bounds_lps_mm.high.z, 10.25, 1e-6);
    mesh_unref(mesh);
    mesh = extract_as(SURFACE_EIGHT_CELL, MARCHING_CUBES_BEST, field, 5, 2, true);
    assert_int_equal(mesh_open_edges(mesh), 0);
    assert_close(mesh_volume_mm3(mesh), 9 * 4 * 6, 1e-4); /* between the centres of the outermost voxels */
    assert_close(mesh_area_mm2(mesh), 2 * (9 * 4 + 9 * 6 + 4 * 6), 1e-4);
    assert_non_null(mesh->normals);
    mesh_unref(mesh);
    volume_unref(field);
}

static double slope(struct vec3 p)
{
    return p.x + 0.25;
}

static void a_surface_is_open_where_the_grid_ends(void **state)
{
    (void)state;
    struct volume *field = field_of(8, 5, 4, unit_map, slope);
    struct mesh *mesh = extract(field, 3);
    assert_int_equal(mesh_open_edges(mesh), 2 * (4 + 3)); /* the rim of a wall of 4 x 3 cells */
    assert_close(mesh->bounds_lps_mm.low.x, 2.75, 1e-6);
    assert_close(mesh->bounds_lps_mm.high.x, 2.75, 1e-6);
    assert_near(mesh_area_mm2(mesh), 4 * 3, 1e-6);
    for (size_t v = 0; v < mesh->n_vertices; v++) { /* also at the border, where differences are one-sided */
        assert_close(mesh->normals[3 * v], -1, 1e-6);
        assert_close(mesh->normals[3 * v + 1], 0, 1e-6);
    }
    mesh_unref(mesh);
    volume_unref(field);
}

static void a_level_on_voxel_values_puts_the_surface_through_their_centres(void **state)
{
    (void)state;
    struct volume *field = field_of(8, 5, 4, unit_map, slope);
    struct mesh *mesh = extract(field, 3.25);
    assert_close(mesh->bounds_lps_mm.low.x, 3, 1e-6);
    assert_close(mesh->bounds_lps_mm.high.x, 3, 1e-6);
    assert_near(mesh_area_mm2(mesh), 4 * 3, 1e-6);
    mesh_unref(mesh);
    /* iso between two floats: what is below it is outside */
    mesh = extract(field, 3.25 + 1e-9);
    assert_close(mesh->bounds_lps_mm.high.x, 3, 1e-6);
    assert_near(mesh_area_mm2(mesh), 4 * 3, 1e-6);
    mesh_unref(mesh);
    volume_unref(field);
}

/* ---- voxels without a value -------------------------------------------------------------------------------------- */

static double waves(struct vec3 p)
{
    return sin(p.x / 3.1) + cos(p.y / 2.3 + p.z / 4) + sin(p.z / 2.7 - p.x / 5) +
           0.8 * sin(p.x * 1.9 + p.y * 2.3 + p.z * 1.7);
}

static bool cell_is_valued(const struct volume *field, const struct mesh *mesh, size_t triangle)
{
    uint32_t cell[3];
    for (size_t axis = 0; axis < 3; axis++) {
        double sum = 0;
        for (size_t corner = 0; corner < 3; corner++)
            sum += (double)mesh->positions_lps_mm[3 * mesh->indices[3 * triangle + corner] + axis];
        cell[axis] = (uint32_t)floor(sum / 3);
    }
    for (uint32_t c = 0; c < 8; c++)
        if (!isfinite(volume_value(field, cell[0] + (c & 1), cell[1] + (c >> 1 & 1), cell[2] + (c >> 2))))
            return false;
    return true;
}

/* Gaps of voxels at random, of blocks, of all but a ball, and of nearly all. */
static void make_gaps(struct volume *field, int kind, uint64_t seed)
{
    static const float none[3] = { NAN, INFINITY, -INFINITY };
    const uint32_t *size = field->grid.size;
    float *value = field->voxels;
    for (uint32_t k = 0; k < size[2]; k++)
        for (uint32_t j = 0; j < size[1]; j++)
            for (uint32_t i = 0; i < size[0]; i++, value++) {
                double x = i - size[0] / 2.0, y = j - size[1] / 2.0, z = k - size[2] / 2.0;
                uint32_t random = next_random(&seed);
                bool is_gap = kind == 0   ? random % 100 < 3
                              : kind == 1 ? i / 7 % 3 == 1 && j / 5 % 2 && k / 6 % 2
                              : kind == 2 ? x * x + y * y + z * z > 196
                                          : random % 100 < 60;
                if (is_gap)
                    *value = none[random / 128 % 3];
            }
}

static void cells_with_a_gap_give_nothing_and_all_others_what_they_give_without_gaps(void **state)
{
    (void)state;
    const uint32_t widths[2] = { 41, 131 }; /* one word of cells, and three */
    for (int wide = 0; wide < 2; wide++)
        for (int kind = 0; kind < 4; kind++) {
            struct volume *whole = field_of(widths[wide], 37, 29, unit_map, waves),
                          *gapped = field_of(widths[wide], 37, 29, unit_map, waves);
            make_gaps(gapped, kind, (uint64_t)(17 + kind));
            struct mesh *all = extract(whole, 0.3), *mesh = extract(gapped, 0.3);
            size_t t = 0;
            for (size_t a = 0; a < all->n_triangles; a++) {
                if (!cell_is_valued(gapped, all, a))
                    continue;
                assert_true(t < mesh->n_triangles);
                for (size_t corner = 0; corner < 3; corner++)
                    assert_memory_equal(mesh->positions_lps_mm + 3 * (size_t)mesh->indices[3 * t + corner],
                                        all->positions_lps_mm + 3 * (size_t)all->indices[3 * a + corner],
                                        3 * sizeof(float));
                t++;
            }
            assert_int_equal(t, mesh->n_triangles);
            assert_true(t > 20 && t < all->n_triangles);
            every_vertex_is_used(mesh);
            for (size_t v = 0; v < mesh->n_vertices; v++)
                assert_close(vec3_length(vertex_at(mesh->normals + 3 * v)), 1, 1e-5);
            mesh_unref(all);
            mesh_unref(mesh);
            volume_unref(whole);
            volume_unref(gapped);
        }
}

/* ---- equal bytes, VTK, refusals ---------------------------------------------------------------------------------- */

static double noise(struct vec3 p)
{
    bool is_rim = p.x < 1 || p.y < 1 || p.z < 1 || p.x > 68 || p.y > 38 || p.z > 28;
    uint64_t seed = (uint64_t)(p.x + 512) << 40 ^ (uint64_t)(p.y + 512) << 20 ^ (uint64_t)(p.z + 512);
    return is_rim ? 0 : next_random(&seed) % 9; /* often exactly the iso value */
}

static void assert_same_mesh(const struct mesh *a, const struct mesh *b)
{
    assert_same_bytes(a, b);
    assert_memory_equal(a->normals, b->normals, 3 * a->n_vertices * sizeof(float));
}

static void noise_is_closed_and_equal_for_any_threads_and_code_and_without_bricks(void **state)
{
    (void)state;
    for (int gapped = 0; gapped < 2; gapped++) {
        struct volume *field = field_of(70, 40, 30, unit_map, noise);
        if (gapped)
            make_gaps(field, 0, 3);
        for (int iso = 1; iso < 9; iso += 2)
            for (int algorithm = 0; algorithm < 2; algorithm++) {
                struct mesh *one =
                    extract_as((enum surface_algorithm)algorithm, MARCHING_CUBES_PORTABLE, field, iso, 1, true);
                assert_true(gapped || algorithm == SURFACE_EIGHT_CELL || mesh_open_edges(one) == 0);
                assert_true(mesh_volume_mm3(one) > 0);
                if (algorithm == SURFACE_MARCHING_CUBES)
                    every_vertex_is_used(one);
                for (int way = 0; way < 4; way++) {
                    struct mesh *more = extract_as((enum surface_algorithm)algorithm, MARCHING_CUBES_BEST, field, iso,
                                                   1 + way, way % 2 == 1);
                    assert_same_mesh(one, more);
                    mesh_unref(more);
                }
                mesh_unref(one);
            }
        volume_unref(field);
    }
}

static void bricks_leave_out_all_that_the_surface_does_not_touch(void **state)
{
    (void)state;
    const uint32_t size[3] = { 90, 70, 60 };
    centre = vec3(20, -10, 5); /* a small sphere in a corner of the grid */
    struct affine map = made_affine(vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1), size, vec3(0, 0, 0));
    struct volume *field = field_of(90, 70, 60, map, cone);
    struct mesh *with = extract(field, 94),
                *without = extract_as(SURFACE_MARCHING_CUBES, MARCHING_CUBES_BEST, field, 94, 2, false);
    assert_int_equal(mesh_open_edges(with), 0);
    assert_near(mesh_volume_mm3(with), 4 / 3.0 * MATH_PI * 216, 0.02);
    assert_same_mesh(with, without);
    mesh_unref(with);
    mesh_unref(without);
    volume_unref(field);
}

static void write_floats(char *path, const float *values, size_t n)
{
    int file = mkstemp(path);
    assert_true(file >= 0);
    FILE *to = fdopen(file, "w");
    assert_int_equal(fwrite(values, sizeof *values, n, to), n);
    fclose(to);
}

static void triangles_and_vertices_equal_vtk_on_a_wavy_field(void **state)
{
    (void)state;
    struct volume *field = field_of(41, 37, 29, unit_map, waves); /* positions equal voxel indices */
    for (int i = 0; i < 3; i++) {
        const double levels[3] = { 0, 0.7, -1.3 };
        char field_path[] = "/tmp/beamroom-test-XXXXXX", vertex_path[] = "/tmp/beamroom-test-XXXXXX", level[32],
             out[256], *rest;
        struct mesh *mesh = extract(field, levels[i]);
        write_floats(field_path, field->voxels, 41 * 37 * 29);
        write_floats(vertex_path, mesh->positions_lps_mm, 3 * mesh->n_vertices);
        snprintf(level, sizeof level, "%.17g", levels[i]);
        char *arguments[] = {
            oracle_python(), "tests/oracle/vtk_field.py", field_path, vertex_path, "41", "37", "29", level, NULL
        };
        int status = oracle_run(arguments, out, sizeof out);
        unlink(field_path);
        unlink(vertex_path);
        size_t n_triangles = mesh->n_triangles, n_vertices = mesh->n_vertices;
        mesh_unref(mesh);
        if (status == ORACLE_MISSING) {
            print_message("no VTK for Python here\n");
            volume_unref(field);
            skip();
        }
        assert_int_equal(status, 0);
        assert_int_equal(strtoul(out, &rest, 10), n_triangles);
        assert_int_equal(strtoul(rest, &rest, 10), n_vertices);
        assert_true(n_triangles > 5000);
        assert_close(strtod(rest, &rest), 0, 1e-5); /* floats of up to 41 */
        assert_close(strtod(rest, &rest), 0, 1e-5);
    }
    volume_unref(field);
}

static void nothing_inside_gives_no_triangle_and_no_level_is_refused(void **state)
{
    (void)state;
    centre = vec3(0, 0, 0);
    struct volume *field = field_of(5, 4, 4, unit_map, cone), *flat = field_of(5, 4, 1, unit_map, cone);
    struct error err = { 0 };
    for (int algorithm = 0; algorithm < SURFACE_N_ALGORITHMS; algorithm++)
        for (int has_bricks = 0; has_bricks < 2; has_bricks++) {
            struct mesh *mesh =
                extract_as((enum surface_algorithm)algorithm, MARCHING_CUBES_BEST, field, 101, 2, has_bricks);
            assert_int_equal(mesh->n_triangles, 0);
            assert_non_null(mesh->normals);
            mesh_unref(mesh);
            mesh = extract_as((enum surface_algorithm)algorithm, MARCHING_CUBES_BEST, flat, 98, 2,
                              has_bricks); /* one slice: no cell */
            assert_int_equal(mesh->n_triangles, 0);
            mesh_unref(mesh);
        }
    assert_null(isosurface_make(SURFACE_MARCHING_CUBES, field, NULL, (double)NAN, &surface_defaults, &err));
    assert_int_equal(err.code, ERROR_RANGE);
    struct surface_options options = surface_defaults;
    options.max_triangles = 3;
    err = (struct error){ 0 };
    assert_null(isosurface_make(SURFACE_MARCHING_CUBES, field, NULL, 97, &options, &err));
    assert_int_equal(err.code, ERROR_LIMIT);
    volume_unref(field);
    volume_unref(flat);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spheres_are_exact_on_every_grid_at_random_offsets),
        cmocka_unit_test(a_box_of_constant_value_has_chamfers_of_half_a_voxel),
        cmocka_unit_test(a_surface_is_open_where_the_grid_ends),
        cmocka_unit_test(a_level_on_voxel_values_puts_the_surface_through_their_centres),
        cmocka_unit_test(cells_with_a_gap_give_nothing_and_all_others_what_they_give_without_gaps),
        cmocka_unit_test(noise_is_closed_and_equal_for_any_threads_and_code_and_without_bricks),
        cmocka_unit_test(bricks_leave_out_all_that_the_surface_does_not_touch),
        cmocka_unit_test(triangles_and_vertices_equal_vtk_on_a_wavy_field),
        cmocka_unit_test(nothing_inside_gives_no_triangle_and_no_level_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
