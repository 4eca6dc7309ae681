/* Measures of meshes: volume, area, open edges, Euler number, normals. */
#include "core/surface/mesh.h"
#include "core/surface/mesh_slabs.h"
#include "tests/check.h"

/* The corners of a box with its 12 triangles, counter-clockwise as seen from outside. */
static struct mesh *box_mesh(double x, double y, double z, struct vec3 at)
{
    static const uint32_t triangles[12][3] = { { 0, 4, 6 }, { 0, 6, 2 }, { 1, 3, 7 }, { 1, 7, 5 },
                                               { 0, 1, 5 }, { 0, 5, 4 }, { 2, 6, 7 }, { 2, 7, 3 },
                                               { 0, 2, 3 }, { 0, 3, 1 }, { 4, 5, 7 }, { 4, 7, 6 } };
    struct error err = { 0 };
    struct mesh *mesh = mesh_create(8, 12, &err);
    assert_non_null(mesh);
    for (size_t c = 0; c < 8; c++) {
        mesh->positions_lps_mm[3 * c] = (float)(at.x + (c & 1 ? x : 0));
        mesh->positions_lps_mm[3 * c + 1] = (float)(at.y + (c & 2 ? y : 0));
        mesh->positions_lps_mm[3 * c + 2] = (float)(at.z + (c & 4 ? z : 0));
    }
    memcpy(mesh->indices, triangles, sizeof triangles);
    mesh_measure_bounds(mesh);
    return mesh;
}

static void swap_winding(struct mesh *mesh, size_t triangle)
{
    uint32_t *v = mesh->indices + 3 * triangle, first = v[0];
    v[0] = v[1];
    v[1] = first;
}

static void a_box_has_its_area_volume_bounds_and_euler_number(void **state)
{
    (void)state;
    struct mesh *mesh = box_mesh(2, 3, 4, vec3(1000, -2000, 512));
    assert_close(mesh_area_mm2(mesh), 2 * (6 + 8 + 12), 1e-9);
    assert_close(mesh_volume_mm3(mesh), 24, 1e-9);
    assert_int_equal(mesh_open_edges(mesh), 0);
    assert_int_equal(mesh_euler(mesh), 2);
    assert_close(mesh->bounds_lps_mm.low.y, -2000, 0);
    assert_close(mesh->bounds_lps_mm.high.z, 516, 0);
    for (size_t t = 0; t < 12; t++)
        swap_winding(mesh, t);
    assert_close(mesh_volume_mm3(mesh), -24, 1e-9);
    mesh_unref(mesh);
}

static void a_missing_turned_doubled_or_degenerate_triangle_shows_as_open_edges(void **state)
{
    (void)state;
    struct mesh *mesh = box_mesh(1, 1, 1, vec3(0, 0, 0));
    mesh->n_triangles = 11;
    assert_int_equal(mesh_open_edges(mesh), 3);
    assert_int_equal(mesh_euler(mesh), 1);
    mesh->n_triangles = 12;
    swap_winding(mesh, 5);
    assert_int_equal(mesh_open_edges(mesh), 6); /* three edges used twice in one direction and never in the other */
    swap_winding(mesh, 5);
    /* the last triangle is now a copy of the one before */
    memcpy(mesh->indices + 33, mesh->indices + 30, 3 * sizeof(uint32_t));
    assert_true(mesh_open_edges(mesh) > 0);
    mesh->indices[33] = mesh->indices[34] = mesh->indices[35] = 0;
    assert_true(mesh_open_edges(mesh) >= 3);
    mesh_unref(mesh);
}

static void edges_are_counted_right_around_a_vertex_of_many_triangles(void **state)
{
    (void)state;
    enum { N = 500 }; /* two fans over one rim: a closed double cone */
    struct error err = { 0 };
    struct mesh *mesh = mesh_create(N + 3, 2 * N, &err); /* and one unused vertex */
    memset(mesh->positions_lps_mm, 0, 3 * mesh->n_vertices * sizeof(float));
    for (uint32_t i = 0; i < N; i++) {
        uint32_t next = (i + 1) % N;
        uint32_t *v = mesh->indices + 6 * (size_t)i;
        v[0] = N, v[1] = i, v[2] = next;
        v[3] = N + 1, v[4] = next, v[5] = i;
        mesh->positions_lps_mm[3 * (size_t)i] = (float)cos(2 * MATH_PI * i / N);
        mesh->positions_lps_mm[3 * (size_t)i + 1] = (float)sin(2 * MATH_PI * i / N);
    }
    mesh->positions_lps_mm[3 * N + 2] = 1;
    mesh->positions_lps_mm[3 * (N + 1) + 2] = -1;
    assert_int_equal(mesh_open_edges(mesh), 0);
    assert_int_equal(mesh_euler(mesh), 2);
    assert_near(mesh_volume_mm3(mesh), 2 * MATH_PI / 3, 1e-4); /* two cones of height 1; 500 sides lose 3e-5 */
    assert_near(mesh_area_mm2(mesh), 2 * MATH_PI * sqrt(2), 1e-4);
    assert_true(mesh_make_normals(mesh, 2, &err));
    assert_close((double)mesh->normals[3 * N + 2], 1, 1e-6);
    assert_close((double)mesh->normals[3 * (N + 1) + 2], -1, 1e-6);
    assert_close((double)mesh->normals[3 * (N + 2) + 2], 1, 0); /* still a unit vector */
    mesh_unref(mesh);
}

static void normals_are_area_weighted_unit_and_outward(void **state)
{
    (void)state;
    struct error err = { 0 };
    struct mesh *mesh = box_mesh(2, 3, 4, vec3(-1, -1, -1));
    assert_true(mesh_make_normals(mesh, 1, &err));
    /* vertex 0 is in two triangles on each of its faces x = -1 (area 12), y = -1 (8) and z = -1 (6) */
    double length = sqrt(12.0 * 12 + 8.0 * 8 + 6.0 * 6);
    assert_close((double)mesh->normals[0], -12 / length, 1e-6);
    assert_close((double)mesh->normals[1], -8 / length, 1e-6);
    assert_close((double)mesh->normals[2], -6 / length, 1e-6);
    for (size_t v = 0; v < 8; v++) {
        const float *n = mesh->normals + 3 * v;
        assert_close((double)(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]), 1, 1e-6);
        for (size_t axis = 0; axis < 3; axis++)
            assert_true((v >> axis & 1) == (n[axis] > 0));
    }
    mesh_unref(mesh);
}

/* A closed tube bent to a ring: any number of vertices, all with a known outward direction. */
static struct mesh *torus_mesh(uint32_t n, uint32_t m)
{
    struct error err = { 0 };
    struct mesh *mesh = mesh_create((size_t)n * m, (size_t)2 * n * m, &err);
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < m; j++) {
            double a = 2 * MATH_PI * i / n, b = 2 * MATH_PI * j / m;
            float *p = mesh->positions_lps_mm + 3 * (size_t)(i * m + j);
            p[0] = (float)((10 + 3 * cos(b)) * cos(a));
            p[1] = (float)((10 + 3 * cos(b)) * sin(a));
            p[2] = (float)(3 * sin(b));
            uint32_t right = (i + 1) % n, up = (j + 1) % m;
            uint32_t *v = mesh->indices + 6 * (size_t)(i * m + j);
            v[0] = i * m + j, v[1] = right * m + j, v[2] = right * m + up;
            v[3] = i * m + j, v[4] = right * m + up, v[5] = i * m + up;
        }
    return mesh;
}

static void normals_are_the_same_bytes_for_any_threads(void **state)
{
    (void)state;
    enum { N = 200, M = 60 };
    struct error err = { 0 };
    struct mesh *one = torus_mesh(N, M), *more = torus_mesh(N, M);
    assert_int_equal(mesh_open_edges(one), 0);
    assert_int_equal(mesh_euler(one), 0);
    assert_near(mesh_volume_mm3(one), 2 * MATH_PI * MATH_PI * 10 * 9, 0.005);
    assert_true(mesh_make_normals(one, 1, &err));
    for (int n_threads = 2; n_threads < 9; n_threads++) {
        assert_true(mesh_make_normals(more, n_threads, &err)); /* made again: replaces the former normals */
        assert_memory_equal(one->normals, more->normals, 3 * one->n_vertices * sizeof(float));
    }
    for (uint32_t i = 0; i < N; i++)
        for (uint32_t j = 0; j < M; j++) {
            double a = 2 * MATH_PI * i / N, b = 2 * MATH_PI * j / M;
            const float *n = one->normals + 3 * (size_t)(i * M + j);
            double cosine = (double)n[0] * cos(b) * cos(a) + (double)n[1] * cos(b) * sin(a) + (double)n[2] * sin(b);
            assert_true(cosine > 0.995);
        }
    mesh_unref(one);
    mesh_unref(more);
}

static void references_are_counted_and_absurd_sizes_refused(void **state)
{
    (void)state;
    struct error err = { 0 };
    struct mesh *mesh = mesh_create(0, 0, &err);
    assert_int_equal(mesh_open_edges(mesh), 0);
    assert_int_equal(mesh_euler(mesh), 0);
    assert_close(mesh_volume_mm3(mesh), 0, 0);
    assert_true(mesh_make_normals(mesh, 2, &err));
    mesh_measure_bounds(mesh);
    assert_true(box3_is_empty(&mesh->bounds_lps_mm));
    struct mesh *same = mesh_ref(mesh);
    mesh_unref(mesh);
    assert_int_equal(same->n_vertices, 0);
    mesh_unref(same);
    mesh_unref(NULL);
    assert_null(mesh_create((size_t)1 << 33, 1, &err));
    assert_int_equal(err.code, ERROR_LIMIT);
    assert_null(mesh_create(1, SIZE_MAX / 2, &err));
    assert_int_equal(err.code, ERROR_LIMIT);
}

/* Triangles of up to 1 mm in a box of 100 mm: every one that crosses a position is found, and few others are. */
static void slabs_find_every_triangle_that_crosses_a_position(void **state)
{
    (void)state;
    enum { N = 20000 };
    struct error err = { 0 };
    struct mesh *mesh = mesh_create((size_t)3 * N, N, &err);
    uint32_t seed = 1;
    for (size_t i = 0; i < (size_t)9 * N; i++) {
        seed = seed * 1664525u + 1013904223u;
        float share = (float)(seed >> 8) / 16777216.0f;
        mesh->positions_lps_mm[i] = i % 9 < 3 ? 100 * share - 30 : mesh->positions_lps_mm[i - i % 9 + i % 3] + share;
    }
    for (uint32_t i = 0; i < 3u * N; i++)
        mesh->indices[i] = i;
    mesh_measure_bounds(mesh);
    for (int axis = 0; axis < 3; axis++) {
        struct mesh_slabs *slabs = mesh_slabs_create(mesh, axis, &err);
        bool *is_found = calloc(N, sizeof *is_found);
        assert_true(slabs && is_found);
        for (double at = -31; at <= 73; at += 1.37) {
            size_t first, end, n_crossing = 0;
            memset(is_found, 0, N * sizeof *is_found);
            mesh_slabs_find(slabs, (float)at, &first, &end);
            assert_true(first <= end && end <= N);
            for (size_t i = first; i < end; i++)
                is_found[slabs->triangles[i]] = true;
            for (size_t t = 0; t < N; t++) {
                const float *p = &mesh->positions_lps_mm[9 * t + (size_t)axis];
                bool has_below = p[0] < (float)at || p[3] < (float)at || p[6] < (float)at,
                     has_above = p[0] >= (float)at || p[3] >= (float)at || p[6] >= (float)at;
                n_crossing += has_below && has_above;
                assert_true(is_found[t] || !(has_below && has_above));
            }
            assert_true(end - first <= 400 + 3 * n_crossing); /* lowest within 1 mm and a few slabs: of 200 per mm */
        }
        free(is_found);
        mesh_slabs_destroy(slabs);
    }
    mesh_unref(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_box_has_its_area_volume_bounds_and_euler_number),
        cmocka_unit_test(a_missing_turned_doubled_or_degenerate_triangle_shows_as_open_edges),
        cmocka_unit_test(edges_are_counted_right_around_a_vertex_of_many_triangles),
        cmocka_unit_test(normals_are_area_weighted_unit_and_outward),
        cmocka_unit_test(normals_are_the_same_bytes_for_any_threads),
        cmocka_unit_test(slabs_find_every_triangle_that_crosses_a_position),
        cmocka_unit_test(references_are_counted_and_absurd_sizes_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
