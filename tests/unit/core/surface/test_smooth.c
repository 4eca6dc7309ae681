/* The smooth surface: bounds, volume and smoothness, against exact normals and VTK's filter. */
#include "core/surface/smooth.h"
#include "tests/check.h"
#include "tests/unit/ellipsoid.h"
#include "tests/unit/made_mask.h"
#include "tests/unit/oracle.h"

#include <unistd.h>

static struct mesh *extract(const struct mask *mask, int n_threads, bool close_at_border)
{
    return made_surface(SURFACE_SMOOTH, mask, n_threads, close_at_border);
}

static struct vec3 vertex(const struct mesh *mesh, size_t v)
{
    const float *p = mesh->positions_lps_mm + 3 * v;
    return vec3((double)p[0], (double)p[1], (double)p[2]);
}

/* ---- bodies whose normals are known ----------------------------------------------------------------------------- */

struct deviation {
    double normal_deg, distance_mm; /* root mean squares over the area */
    double shown_deg;               /* root mean square error of the vertex normals */
};

/* Deviation of the triangles' normals and centres from the ellipsoid's. */
static struct deviation deviation_of(const struct mesh *mesh, const struct ellipsoid *body)
{
    double area = 0, angles = 0, distances = 0;
    for (size_t t = 0; t < mesh->n_triangles; t++) {
        const uint32_t *v = mesh->indices + 3 * t;
        struct vec3 a = vertex(mesh, v[0]), b = vertex(mesh, v[1]), c = vertex(mesh, v[2]);
        struct vec3 cross = vec3_cross(vec3_sub(b, a), vec3_sub(c, a));
        double twice = vec3_length(cross);
        if (!(twice > 0))
            continue;
        struct vec3 p = ellipsoid_to_body(body, vec3_scale(vec3_add(a, vec3_add(b, c)), 1 / 3.0));
        struct vec3 gradient =
            vec3(p.x / pow(body->radius_mm[0], 2), p.y / pow(body->radius_mm[1], 2), p.z / pow(body->radius_mm[2], 2));
        double distance = (vec3_dot(p, gradient) - 1) / (2 * vec3_length(gradient));
        double cosine = vec3_dot(ellipsoid_from_body(body, gradient), cross) / (vec3_length(gradient) * twice);
        double angle = acos(fmax(-1, fmin(1, cosine))) * 180 / MATH_PI;
        area += twice;
        angles += twice * angle * angle;
        distances += twice * distance * distance;
    }
    double shown = 0;
    for (size_t v = 0; mesh->normals && v < mesh->n_vertices; v++) {
        struct vec3 p = ellipsoid_to_body(body, vertex(mesh, v));
        struct vec3 gradient =
            vec3(p.x / pow(body->radius_mm[0], 2), p.y / pow(body->radius_mm[1], 2), p.z / pow(body->radius_mm[2], 2));
        struct vec3 n =
            vec3((double)mesh->normals[3 * v], (double)mesh->normals[3 * v + 1], (double)mesh->normals[3 * v + 2]);
        assert_close(vec3_length(n), 1, 1e-5);
        double angle =
            acos(fmax(-1, fmin(1, vec3_dot(ellipsoid_from_body(body, gradient), n) / vec3_length(gradient)))) * 180 /
            MATH_PI;
        shown += angle * angle;
    }
    return (struct deviation){ sqrt(angles / area), sqrt(distances / area), sqrt(shown / (double)mesh->n_vertices) };
}

/* The deviation of VTK's discrete surface with its windowed sinc filter; false without VTK. */
static bool deviation_of_vtk(const struct mask *mask, const struct ellipsoid *body, struct deviation *deviation)
{
    char path[] = "/tmp/beamroom-test-XXXXXX", words[16][32], out[256], *rest;
    char *arguments[16] = { oracle_python(), "tests/oracle/vtk_sinc.py", path };
    int file = mkstemp(path);
    assert_true(file >= 0);
    FILE *to = fdopen(file, "w");
    for (uint32_t k = 0; k < mask->size[2]; k++)
        for (uint32_t j = 0; j < mask->size[1]; j++)
            for (uint32_t i = 0; i < mask->size[0]; i++)
                fputc(mask_has(mask, i, j, k), to);
    fclose(to);
    struct vec3 origin = mask->lps_mm_from_ijk.origin;
    double numbers[10] = {
        body->spacing_mm[0], body->spacing_mm[1], body->spacing_mm[2], origin.x,      origin.y, origin.z,
        body->radius_mm[0],  body->radius_mm[1],  body->radius_mm[2],  body->tilt_rad
    };
    for (int n = 0; n < 13; n++) {
        arguments[3 + n] = words[n];
        if (n < 3)
            snprintf(words[n], sizeof words[n], "%u", mask->size[n]);
        else
            snprintf(words[n], sizeof words[n], "%.17g", numbers[n - 3]);
        if (n == 12)
            break;
    }
    char *all[18];
    memcpy(all, arguments, sizeof arguments);
    all[16] = NULL;
    int status = oracle_run(all, out, sizeof out);
    unlink(path);
    if (status == ORACLE_MISSING)
        return false;
    assert_int_equal(status, 0);
    deviation->normal_deg = strtod(out, &rest);
    deviation->distance_mm = strtod(rest, NULL);
    return true;
}

static void no_stair_steps_however_thick_the_slices(void **state)
{
    (void)state;
    /* most: limit on the root mean square deviation of normals, in degrees. Slice steps on a shallow slope can be told
     * from the slope only if they follow each other within some ten pixels; above the last slice nothing is known */
    static const struct {
        struct ellipsoid body;
        double most_deg;
    } cases[] = {
        { { { 1, 1, 4 }, { 40, 40, 40 }, 0 }, 6 },     { { { 1, 1, 4 }, { 60, 40, 30 }, 0.35 }, 6.5 },
        { { { 1, 1, 5.5 }, { 80, 80, 80 }, 0 }, 6 },   { { { 1, 1, 5.5 }, { 90, 60, 70 }, 0.3 }, 6.5 },
        { { { 1, 1, 1 }, { 40, 30, 20 }, 0.4 }, 2.5 }, { { { 0.5, 0.5, 1 }, { 40, 30, 20 }, 0.4 }, 3 },
    };
    bool has_vtk = true;
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        const struct ellipsoid *body = &cases[c].body;
        struct mask *mask = ellipsoid_mask(body, 0);
        struct mesh *smooth = extract(mask, 2, true), *cubes = made_surface(SURFACE_MARCHING_CUBES, mask, 2, true);
        struct deviation ours = deviation_of(smooth, body), plain = deviation_of(cubes, body), vtk;
        if (!(ours.normal_deg < cases[c].most_deg))
            fail_msg("case %zu: normals %.2f degrees off, expected below %.2f", c, ours.normal_deg, cases[c].most_deg);
        assert_true(ours.normal_deg < plain.normal_deg / 5);
        if (!(ours.shown_deg < cases[c].most_deg))
            fail_msg("case %zu: vertex normals %.2f degrees off, expected below %.2f", c, ours.shown_deg,
                     cases[c].most_deg);
        assert_true(ours.distance_mm < plain.distance_mm / 1.9);
        has_vtk = has_vtk && deviation_of_vtk(mask, body, &vtk);
        if (has_vtk) { /* 20 iterations, pass band 0.1: VTK's defaults */
            assert_true(ours.normal_deg < vtk.normal_deg / 2);
            assert_true(ours.distance_mm < vtk.distance_mm / 1.5);
        }
        mesh_unref(smooth);
        mesh_unref(cubes);
        mask_destroy(mask);
    }
    if (!has_vtk)
        print_message("no VTK for Python here: not compared with its filter\n");
}

/* ---- bounds ----------------------------------------------------------------------------------------------------- */

/* Asserts the triangles of marching cubes, with each vertex moved along one axis only, at most as far as allowed. */
static void assert_within_bounds(const struct mask *mask, const struct mesh *smooth, const struct mesh *cubes)
{
    const struct vec3 *edges = mask->lps_mm_from_ijk.columns;
    double least_mm = fmin(vec3_length(edges[0]), fmin(vec3_length(edges[1]), vec3_length(edges[2])));
    struct affine ijk_from_lps_mm;
    assert_true(affine_invert(&mask->lps_mm_from_ijk, &ijk_from_lps_mm));
    assert_int_equal(smooth->n_vertices, cubes->n_vertices);
    assert_int_equal(smooth->n_triangles, cubes->n_triangles);
    assert_memory_equal(smooth->indices, cubes->indices, 3 * cubes->n_triangles * sizeof *cubes->indices);
    for (size_t v = 0; v < cubes->n_vertices; v++) {
        struct vec3 at = affine_point(&ijk_from_lps_mm, vertex(cubes, v));
        struct vec3 moved = affine_vector(&ijk_from_lps_mm, vec3_sub(vertex(smooth, v), vertex(cubes, v)));
        double place[3] = { at.x, at.y, at.z }, by[3] = { moved.x, moved.y, moved.z };
        for (int axis = 0; axis < 3; axis++) {
            bool is_own =
                fabs(place[axis] - floor(place[axis]) - 0.5) < 0.01; /* a half-integer: this edge runs along the axis */
            double margin = SURFACE_SMOOTH_MARGIN * least_mm / vec3_length(edges[axis]);
            assert_true(fabs(by[axis]) <= (is_own ? 0.5 - margin : 0) + 1e-4); /* positions are floats */
        }
    }
}

/* Winding number of a closed mesh around a point (A. Van Oosterom, J. Strackee, The Solid Angle of a Plane Triangle,
 * 1983). */
static double winding(const struct mesh *mesh, struct vec3 at)
{
    double sum = 0;
    for (size_t t = 0; t < mesh->n_triangles; t++) {
        struct vec3 p[3];
        double length[3];
        for (int c = 0; c < 3; c++) {
            p[c] = vec3_sub(vertex(mesh, mesh->indices[3 * t + (size_t)c]), at);
            length[c] = vec3_length(p[c]);
        }
        double below = length[0] * length[1] * length[2] + vec3_dot(p[0], p[1]) * length[2] +
                       vec3_dot(p[1], p[2]) * length[0] + vec3_dot(p[2], p[0]) * length[1];
        sum += 2 * atan2(vec3_dot(p[0], vec3_cross(p[1], p[2])), below);
    }
    return sum / (4 * MATH_PI);
}

static void the_centre_of_every_univel_stays_on_its_side(void **state)
{
    (void)state;
    struct affine map = { { { 0.8, 0.6, 0 }, { -1.2, 1.6, 0 }, { 0, 0, -4 } },
                          { 5, 6, 7 } }; /* oblique and left-handed */
    for (uint64_t seed = 1; seed <= 12; seed++) {
        struct mask *mask = random_mask(7, 6, 5, (uint32_t)(8 * seed), seed, &map);
        struct mesh *mesh = extract(mask, 1, true);
        for (int64_t k = -1; k <= 5; k++)
            for (int64_t j = -1; j <= 6; j++)
                for (int64_t i = -1; i <= 7; i++) {
                    double turns = winding(mesh, affine_point(&map, vec3((double)i, (double)j, (double)k)));
                    assert_close(turns, mask_has(mask, i, j, k), 1e-3);
                }
        mesh_unref(mesh);
        mask_destroy(mask);
    }
}

static void every_corner_case_is_closed_and_within_bounds(void **state)
{
    (void)state;
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        struct affine map = unit_map;
        map.columns[0].x = mirrored ? -1 : 1;
        map.columns[2].z = 4;
        for (int inside = 1; inside < 256; inside++) {
            struct mask *mask = mask_make(2, 2, 2, &map);
            for (uint32_t c = 0; c < 8; c++)
                if (inside >> c & 1)
                    mask_put(mask, c & 1, c >> 1 & 1, c >> 2);
            struct mesh *mesh = extract(mask, 1, true), *cubes = made_surface(SURFACE_MARCHING_CUBES, mask, 1, true);
            assert_int_equal(mesh_open_edges(mesh), 0);
            assert_int_equal(mesh_euler(mesh), euler_of_surface(mask));
            assert_within_bounds(mask, mesh, cubes);
            /* so small that edges end before the whole volume is recovered */
            assert_near(mesh_volume_mm3(mesh), 4 * __builtin_popcount((unsigned)inside), 0.1);
            mesh_unref(mesh);
            mesh_unref(cubes);
            mask_destroy(mask);
        }
    }
}

static void random_blocks_are_closed_within_bounds(void **state)
{
    (void)state;
    static const uint32_t sides[] = { 1, 2, 5, 31, 62, 63, 64, 65, 127, 128, 130 };
    struct affine map = { { { 0.8, 0.6, 0 }, { -1.2, 1.6, 0 }, { 0, 0, -3 } }, { 5, 6, 7 } };
    uint64_t seed = 77;
    for (size_t s = 0; s < sizeof sides / sizeof *sides; s++)
        for (uint32_t percent = 5; percent < 100; percent += 15) {
            struct mask *mask =
                random_mask(sides[s], 1 + next_random(&seed) % 9, 1 + next_random(&seed) % 9, percent, seed, &map);
            for (int open = 0; open < 2; open++) {
                struct mesh *mesh = extract(mask, 1, !open),
                            *cubes = made_surface(SURFACE_MARCHING_CUBES, mask, 1, !open);
                assert_within_bounds(mask, mesh, cubes);
                if (!open) {
                    assert_int_equal(mesh_open_edges(mesh), 0);
                    assert_int_equal(mesh_euler(mesh), euler_of_surface(mask));
                    assert_true(mesh_volume_mm3(mesh) > 0);
                }
                mesh_unref(mesh);
                mesh_unref(cubes);
            }
            mask_destroy(mask);
        }
}

enum { N_SHARED = CHECK_THREADED(4) };

static void random_blocks_are_equal_for_any_threads(void **state)
{
    (void)state;
    struct affine map = { { { 0.8, 0.6, 0 }, { -1.2, 1.6, 0 }, { 0, 0, -3 } }, { 5, 6, 7 } };
    /* large enough for three threads; few pieces, then very many; and fewer slices than threads can share */
    static const uint32_t sizes[][3] = { { 130, 70, 40 }, { 300, 200, 6 } };
    for (uint32_t each = 0; each < N_SHARED; each++) {
        uint32_t percent = each % 2 ? 53 : 3;
        const uint32_t *size = sizes[each / 2];
        struct mask *mask = random_mask(size[0], size[1], size[2], percent, percent, &map);
        struct mesh *one = extract(mask, 1, true);
        assert_true(one->n_vertices > 3 * 8192);
        for (int n_threads = 2; n_threads < 4; n_threads++) {
            struct mesh *more = extract(mask, n_threads, true);
            assert_same_bytes(one, more);
            assert_memory_equal(one->normals, more->normals, 3 * one->n_vertices * sizeof *one->normals);
            mesh_unref(more);
        }
        mesh_unref(one);
        mask_destroy(mask);
    }
}

static void vertex_normals_are_unit_and_outward_also_on_mirrored_oblique_grids(void **state)
{
    (void)state;
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        struct affine map = { { { 0.8, 0.6, 0 }, { -1.2, 1.6, 0 }, { 0, 0, mirrored ? -3 : 3 } }, { 5, 6, 7 } };
        struct mask *mask = mask_make(40, 30, 20, &map);
        for (uint32_t at = 0; at < 40 * 30 * 20; at++)
            if (pow((at % 40 - 19.5) / 17, 2) + pow((at / 40 % 30 - 14.5) / 12, 2) + pow((at / 1200 - 9.5) / 8, 2) < 1)
                mask_put(mask, at % 40, at / 40 % 30, at / 1200);
        struct mesh *mesh = extract(mask, 2, true);
        struct error err = { 0 };
        float *shown = mesh->normals;
        mesh->normals = NULL;
        assert_true(mesh_make_normals(mesh, 1, &err)); /* those of the triangles */
        for (size_t v = 0; v < mesh->n_vertices; v++) {
            const float *a = shown + 3 * v, *b = mesh->normals + 3 * v;
            assert_close(a[0] * a[0] + a[1] * a[1] + a[2] * a[2], 1, 1e-5);
            assert_true(a[0] * b[0] + a[1] * b[1] + a[2] * b[2] > 0.9f);
        }
        free(shown);
        mesh_unref(mesh);
        mask_destroy(mask);
    }
}

/* ---- volume ----------------------------------------------------------------------------------------------------- */

static void each_piece_keeps_the_volume_of_its_univels(void **state)
{
    (void)state;
    /* bodies from some ten univels across down to four: the filters alone would shrink the small ones by half */
    static const struct ellipsoid bodies[] = {
        { { 1, 1, 4 }, { 60, 40, 30 }, 0.35 }, { { 1, 1, 4 }, { 20, 5, 12 }, 0.5 },
        { { 1, 1, 5.5 }, { 80, 80, 80 }, 0 },  { { 1, 1, 1 }, { 5, 5, 5 }, 0.4 },
        { { 1, 1, 4 }, { 8, 8, 8 }, 0.4 },     { { 1, 1, 1 }, { 2.2, 2.2, 2.2 }, 0.4 },
    };
    for (size_t b = 0; b < sizeof bodies / sizeof *bodies; b++) {
        struct mask *mask = ellipsoid_mask(&bodies[b], 0);
        struct mesh *mesh = extract(mask, 2, true);
        double univels_mm3 = (double)mask_count(mask) * affine_determinant(&mask->lps_mm_from_ijk);
        assert_near(mesh_volume_mm3(mesh), univels_mm3, 0.0015);
        mesh_unref(mesh);
        mask_destroy(mask);
    }
}

static void a_hollow_and_a_lone_univel_beside_it_keep_theirs_too(void **state)
{
    (void)state;
    struct mask *mask = mask_make(40, 40, 40, &unit_map), *ball = mask_make(40, 40, 40, &unit_map);
    uint64_t n_hollow = 0;
    for (uint32_t k = 0; k < 40; k++)
        for (uint32_t j = 0; j < 40; j++)
            for (uint32_t i = 0; i < 40; i++) {
                double r = sqrt((i - 19.5) * (i - 19.5) + (j - 19.5) * (j - 19.5) + (k - 19.5) * (k - 19.5));
                if (r < 12)
                    mask_put(ball, i, j, k);
                if (r < 12 && r >= 4)
                    mask_put(mask, i, j, k);
                n_hollow += r < 4;
            }
    mask_put(mask, 1, 1, 1);
    struct mesh *hollow = extract(mask, 1, true), *full = extract(ball, 1, true);
    assert_int_equal(mesh_euler(hollow), 6);
    assert_near(mesh_volume_mm3(hollow), (double)mask_count(mask), 0.0015);
    /* equal on the outside: the cavity and the single univel change the volume by their own univels */
    assert_close(mesh_volume_mm3(full) - mesh_volume_mm3(hollow), (double)n_hollow - 1, 0.004 * (double)n_hollow);
    mesh_unref(hollow);
    mesh_unref(full);
    mask_destroy(mask);
    mask_destroy(ball);
}

static void a_plate_of_one_univel_keeps_its_two_sides(void **state)
{
    (void)state;
    struct mask *mask = mask_make(30, 30, 5, &unit_map);
    for (uint32_t at = 0; at < 30 * 30; at++)
        mask_put(mask, at % 30, at / 30, 2);
    struct mesh *mesh = extract(mask, 2, true), *open = extract(mask, 2, false);
    assert_int_equal(mesh_open_edges(mesh), 0); /* cut by the border of the grid on four sides */
    assert_int_equal(mesh_euler(mesh), 2);
    for (size_t v = 0; v < mesh->n_vertices; v++) {
        struct vec3 p = vertex(mesh, v);
        /* far from the rims nothing pulls; the loss at the rims is spread over all vertices */
        if (p.x > 14 && p.x < 16 && p.y > 14 && p.y < 16)
            assert_close(fabs(p.z - 2), 0.5, 0.1);
    }
    assert_int_equal(mesh_open_edges(open), 2 * 4 * 29);
    mesh_unref(mesh);
    mesh_unref(open);
    mask_destroy(mask);
}

static void without_normals_the_surface_is_the_same(void **state)
{
    (void)state;
    struct affine map = { { { 0.8, 0.6, 0 }, { -1.2, 1.6, 0 }, { 0, 0, -3 } }, { 5, 6, 7 } };
    struct mask *mask = random_mask(12, 11, 10, 40, 5, &map);
    struct error err = { 0 };
    struct surface_options options = surface_defaults;
    struct mesh *with = surface_smooth(mask, &options, &err);
    options.without_normals = true;
    struct mesh *bare = surface_smooth(mask, &options, &err);
    assert_non_null(with);
    assert_non_null(bare);
    assert_non_null(with->normals);
    assert_null(bare->normals);
    assert_int_equal(bare->n_vertices, with->n_vertices);
    assert_memory_equal(bare->positions_lps_mm, with->positions_lps_mm, 3 * with->n_vertices * sizeof(float));
    assert_memory_equal(bare->indices, with->indices, 3 * with->n_triangles * sizeof(uint32_t));
    mesh_unref(with);
    mesh_unref(bare);
    mask_destroy(mask);
}

static void an_empty_mask_and_too_many_triangles_are_refused(void **state)
{
    (void)state;
    struct mask *mask = mask_make(4, 4, 4, &unit_map);
    struct error err = { 0 };
    assert_null(surface_smooth(mask, &surface_defaults, &err));
    assert_int_equal(err.code, ERROR_RANGE);
    mask_put(mask, 1, 1, 1);
    struct surface_options options = surface_defaults;
    options.max_triangles = 7;
    assert_null(surface_smooth(mask, &options, &err));
    assert_int_equal(err.code, ERROR_LIMIT);
    mask_destroy(mask);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_stair_steps_however_thick_the_slices),
        cmocka_unit_test(the_centre_of_every_univel_stays_on_its_side),
        cmocka_unit_test(every_corner_case_is_closed_and_within_bounds),
        cmocka_unit_test(random_blocks_are_closed_within_bounds),
        cmocka_unit_test(random_blocks_are_equal_for_any_threads),
        cmocka_unit_test(vertex_normals_are_unit_and_outward_also_on_mirrored_oblique_grids),
        cmocka_unit_test(each_piece_keeps_the_volume_of_its_univels),
        cmocka_unit_test(a_hollow_and_a_lone_univel_beside_it_keep_theirs_too),
        cmocka_unit_test(a_plate_of_one_univel_keeps_its_two_sides),
        cmocka_unit_test(without_normals_the_surface_is_the_same),
        cmocka_unit_test(an_empty_mask_and_too_many_triangles_are_refused),
    };
#ifdef __SANITIZE_THREAD__
    cmocka_set_test_filter("*any_threads*"); /* the others have one */
#endif
    return cmocka_run_group_tests(tests, NULL, NULL);
}
