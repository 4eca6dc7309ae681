/* Normals for shading voxel surfaces. */
#include "core/render/visible/shading.h"
#include "tests/check.h"
#include "tests/derived_of.h"
#include "tests/made_plan.h"

static double ball(struct vec3 p)
{
    return vec3_length(p) < 20;
}
static double box(struct vec3 p)
{
    return fabs(p.x) < 20 && fabs(p.y) < 20 && fabs(p.z) < 20;
}
static const struct made_region one[] = { { "one", -1, 0xffffff } };

static struct mesh *mesh_of(double (*label)(struct vec3 p))
{
    struct grid grid = made_cube_grid(50);
    struct plan *plan = made_plan(&grid, label, one, 1);
    struct shape_facts facts;
    struct error err = { 0 };
    struct mesh *mesh = surface_of(plan, 0, SURFACE_MARCHING_CUBES, SURFACE_FULL, &facts, &err);
    assert_non_null(mesh);
    plan_and_derived_destroy(plan);
    return mesh;
}

/* Mean angle between the normals and the directions away from the ball's middle. */
static double mean_error_deg(const struct mesh *mesh, const float *normals)
{
    double sum = 0;
    for (size_t v = 0; v < mesh->n_vertices; v++) {
        const float *p = &mesh->positions_lps_mm[3 * v], *n = &normals[3 * v];
        struct vec3 away = vec3_normalize(vec3(p[0], p[1], p[2]));
        sum += acos(fmin(fmax(vec3_dot(away, vec3(n[0], n[1], n[2])), -1), 1)) * 180 / MATH_PI;
    }
    return sum / (double)mesh->n_vertices;
}

static void the_normals_of_a_voxel_ball_come_to_point_away_from_its_middle(void **state)
{
    (void)state;
    struct mesh *mesh = mesh_of(ball);
    struct error err = { 0 };
    float *none = shading_normals(mesh, 0, &err), *many = shading_normals(mesh, 12, &err);
    assert_memory_equal(none, mesh->normals, mesh->n_vertices * 3 * sizeof *none);
    double before_deg = mean_error_deg(mesh, none), after_deg = mean_error_deg(mesh, many);
    assert_true(before_deg > 6); /* terraces of one voxel at 20 voxels of radius */
    assert_true(after_deg < before_deg / 3);
    for (size_t v = 0; v < mesh->n_vertices; v++) {
        const float *n = &many[3 * v];
        assert_close(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1, 1e-4);
    }
    free(none);
    free(many);
    mesh_unref(mesh);
}

static void a_flat_face_keeps_its_normal_beyond_the_reach_of_its_edges(void **state)
{
    (void)state;
    struct mesh *mesh = mesh_of(box);
    struct error err = { 0 };
    float *normals = shading_normals(mesh, 12, &err);
    size_t n_checked = 0;
    for (size_t v = 0; v < mesh->n_vertices; v++) {
        const float *p = &mesh->positions_lps_mm[3 * v];
        if (fabsf(p[0] - 20) > 1e-3f || fabsf(p[1]) > 6 ||
            fabsf(p[2]) > 6) /* 14 mm from the edges: more than 12 triangles */
            continue;
        n_checked++;
        assert_close(normals[3 * v], 1, 1e-5);
    }
    assert_true(n_checked > 100);
    free(normals);
    mesh_unref(mesh);
}

static void equal_meshes_have_equal_shading(void **state)
{
    (void)state;
    struct mesh *mesh = mesh_of(ball);
    struct error err = { 0 };
    float *a = shading_normals(mesh, 5, &err), *b = shading_normals(mesh, 5, &err);
    assert_memory_equal(a, b, mesh->n_vertices * 3 * sizeof *a);
    free(a);
    free(b);
    mesh_unref(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_normals_of_a_voxel_ball_come_to_point_away_from_its_middle),
        cmocka_unit_test(a_flat_face_keeps_its_normal_beyond_the_reach_of_its_edges),
        cmocka_unit_test(equal_meshes_have_equal_shading),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
