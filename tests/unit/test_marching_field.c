/* Isosurfaces of fields, against the exact sphere and VTK. */
#include <unistd.h>

#include "core/surface/surface.h"
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

static struct mesh *extract(const struct volume *field, double iso, int n_threads, bool close_at_border)
{
    struct surface_options options = surface_defaults;
    struct error err = { 0 };
    options.n_threads = n_threads;
    options.close_at_border = close_at_border;
    struct mesh *mesh = surface_marching_cubes_field(field, iso, &options, &err);
    assert_string_equal(err.text, "");
    assert_non_null(mesh);
    return mesh;
}

static double from_middle(struct vec3 p)
{
    return 100 - vec3_length(p);
} /* linear along rays from the centre */

static void a_sphere_is_where_it_is_to_a_hundredth_of_a_voxel(void **state)
{
    (void)state;
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        const uint32_t size[3] = { 48, 48, 24 };
        struct affine map =
            made_affine(vec3(mirrored ? -1 : 1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 2), size, vec3(0.2, -0.3, 0.4));
        struct volume *field = field_of(48, 48, 24, map, from_middle);
        struct mesh *mesh = extract(field, 82.5, 2, true); /* radius 17.5 */
        assert_int_equal(mesh_open_edges(mesh), 0);
        assert_int_equal(mesh_euler(mesh), 2);
        for (size_t v = 0; v < mesh->n_vertices; v++) {
            const float *p = mesh->positions_lps_mm + 3 * v;
            /* linear interpolation along an edge of h mm is short by at most h^2 / (8 r), here 0.029 for 2 mm */
            assert_close(vec3_length(vec3((double)p[0], (double)p[1], (double)p[2])), 17.5, 0.03);
        }
        assert_near(mesh_volume_mm3(mesh), 4 / 3.0 * MATH_PI * pow(17.5, 3), 0.006);
        /* no voxel steps: with midpoints the area is 9 % too large */
        assert_near(mesh_area_mm2(mesh), 4 * MATH_PI * 17.5 * 17.5, 0.006);
        mesh_unref(mesh);
        volume_unref(field);
    }
}

static double waves(struct vec3 p)
{
    return sin(p.x / 3.1) + cos(p.y / 2.3 + p.z / 4) + sin(p.z / 2.7 - p.x / 5) +
           0.8 * sin(p.x * 1.9 + p.y * 2.3 + p.z * 1.7);
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
        struct mesh *mesh = extract(field, levels[i], 2, false);
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

static double cut(struct vec3 p)
{
    return p.x + 0.25;
}

static void a_field_cut_by_its_grid_is_closed_half_a_voxel_behind_it(void **state)
{
    (void)state;
    struct volume *field = field_of(8, 5, 4, unit_map, cut);
    struct mesh *closed = extract(field, 3, 1, true), *open = extract(field, 3, 1, false);
    assert_int_equal(mesh_open_edges(closed), 0);
    assert_close(closed->bounds_lps_mm.low.x, 2.75, 1e-6);
    assert_close(closed->bounds_lps_mm.high.x, 7.5, 1e-6);
    assert_close(closed->bounds_lps_mm.high.y, 4.5, 1e-6);
    assert_true(mesh_open_edges(open) > 0);
    assert_close(open->bounds_lps_mm.low.x, 2.75, 1e-6); /* a flat wall across the grid */
    assert_close(open->bounds_lps_mm.high.x, 2.75, 1e-6);
    assert_near(mesh_area_mm2(open), 4 * 3, 1e-6);
    mesh_unref(closed);
    mesh_unref(open);
    volume_unref(field);
}

static double holed(struct vec3 p)
{
    return vec3_length(vec3_sub(p, vec3(5, 5, 5))) < 1.5 ? (double)NAN : p.x > 8.5 ? (double)INFINITY : 10;
}

static void what_has_no_value_is_outside_and_its_edges_are_cut_in_the_middle(void **state)
{
    (void)state;
    struct volume *field = field_of(11, 11, 11, unit_map, holed);
    struct mesh *mesh = extract(field, 5, 2, true);
    assert_int_equal(mesh_open_edges(mesh), 0);
    assert_int_equal(mesh_euler(mesh), 4); /* a box with a cavity */
    for (size_t at = 0; at < 3 * mesh->n_vertices; at++) {
        double place = (double)mesh->positions_lps_mm[at];
        assert_close(2 * place, round(2 * place), 1e-5);
    }
    assert_close(mesh->bounds_lps_mm.high.x, 8.5, 1e-6);
    mesh_unref(mesh);
    volume_unref(field);
}

static double noise(struct vec3 p)
{
    uint64_t seed = (uint64_t)(p.x + 512) << 40 ^ (uint64_t)(p.y + 512) << 20 ^ (uint64_t)(p.z + 512);
    return next_random(&seed) % 9; /* often exactly the iso value */
}

static void noise_is_closed_and_equal_for_any_threads(void **state)
{
    (void)state;
    struct volume *field = field_of(70, 40, 30, unit_map, noise);
    for (int iso = 1; iso < 9; iso += 2) {
        struct mesh *one = extract(field, iso, 1, true);
        assert_int_equal(mesh_open_edges(one), 0);
        assert_true(mesh_volume_mm3(one) > 0);
        for (int n_threads = 2; n_threads < 4; n_threads++) {
            struct mesh *more = extract(field, iso, n_threads, true);
            assert_same_bytes(one, more);
            mesh_unref(more);
        }
        mesh_unref(one);
    }
    volume_unref(field);
}

static void nothing_inside_and_no_level_are_refused(void **state)
{
    (void)state;
    struct volume *field = field_of(4, 4, 4, unit_map, from_middle);
    struct error err = { 0 };
    assert_null(surface_marching_cubes_field(field, 101, &surface_defaults, &err));
    assert_int_equal(err.code, ERROR_RANGE);
    err = (struct error){ 0 };
    assert_null(surface_marching_cubes_field(field, (double)NAN, &surface_defaults, &err));
    assert_int_equal(err.code, ERROR_RANGE);
    struct surface_options options = surface_defaults;
    options.max_triangles = 3;
    err = (struct error){ 0 };
    assert_null(surface_marching_cubes_field(field, 97, &options, &err));
    assert_int_equal(err.code, ERROR_LIMIT);
    volume_unref(field);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sphere_is_where_it_is_to_a_hundredth_of_a_voxel),
        cmocka_unit_test(triangles_and_vertices_equal_vtk_on_a_wavy_field),
        cmocka_unit_test(a_field_cut_by_its_grid_is_closed_half_a_voxel_behind_it),
        cmocka_unit_test(what_has_no_value_is_outside_and_its_edges_are_cut_in_the_middle),
        cmocka_unit_test(noise_is_closed_and_equal_for_any_threads),
        cmocka_unit_test(nothing_inside_and_no_level_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
