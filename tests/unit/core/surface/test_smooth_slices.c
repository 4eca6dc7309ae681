/* Shape-based interpolation between slices in the smooth surface: against exact ellipsoids, and against smoothing
 * without it. */
#include "core/surface/smooth.h"
#include "tests/check.h"
#include "tests/unit/ellipsoid.h"
#include "tests/unit/made_mask.h"

static struct mesh *extract(const struct mask *mask, const struct smooth_options *smoothing, int n_threads)
{
    struct error err = { 0 };
    struct surface_options options = surface_defaults;
    options.n_threads = n_threads;
    struct mesh *mesh = smooth_with(smoothing, mask, &options, &err);
    assert_string_equal(err.text, "");
    return mesh;
}

static struct smooth_options without_interpolation(void)
{
    struct smooth_options smoothing = smooth_defaults;
    smoothing.slice_ratio = INFINITY;
    return smoothing;
}

/* Figures with and without interpolation, each the mean over three places of the body between the univels. */
static void measure(const struct ellipsoid *body, int slice_axis, struct ellipsoid_error *with,
                    struct ellipsoid_error *without)
{
    enum { N_PLACES = 3, N_FIGURES = sizeof *with / sizeof(double) };
    struct smooth_options before = without_interpolation();
    double sums[2][N_FIGURES] = { { 0 } };
    for (int place = 0; place < N_PLACES; place++) {
        struct mask *mask = ellipsoid_mask(body, place);
        struct mesh *meshes[2] = { extract(mask, &smooth_defaults, 2), extract(mask, &before, 2) };
        assert_int_equal(meshes[0]->n_triangles, meshes[1]->n_triangles);
        assert_int_equal(mesh_open_edges(meshes[0]), 0);
        for (int way = 0; way < 2; way++) {
            struct ellipsoid_error error = ellipsoid_error_of(meshes[way], body, slice_axis);
            double figures[N_FIGURES];
            memcpy(figures, &error, sizeof error);
            for (int f = 0; f < N_FIGURES; f++)
                sums[way][f] += figures[f] / N_PLACES;
            mesh_unref(meshes[way]);
        }
        mask_destroy(mask);
    }
    memcpy(with, sums[0], sizeof *with);
    memcpy(without, sums[1], sizeof *without);
}

static void print_figures(const struct ellipsoid *body, const char *way, const struct ellipsoid_error *e)
{
    const double *s = body->spacing_mm, *r = body->radius_mm;
    print_message("| %g x %g x %g | %g, %g, %g, %.2f | %s | %.2f | %.2f | %.2f | %.2f | %.3f | %.2f | %+.3f |\n", s[0],
                  s[1], s[2], r[0], r[1], r[2], body->tilt_rad, way, e->shown_deg, e->pole_shown_deg, e->normal_deg,
                  e->pole_normal_deg, e->rms_mm, e->max_mm, 100 * e->volume);
}

static void normals_are_twice_as_exact_where_slices_are_far_apart(void **state)
{
    (void)state;
    /* overall: limits relative to smoothing alone, for vertex normals and for triangles. Triangles from slice to slice
     * are flat however exact their corners are: with ten slices in the body or fewer they cannot get twice as exact. On
     * the last grid, pixels limit what smoothing alone reaches on steep walls, and they still do */
    static const struct {
        struct ellipsoid body;
        double shown, faces;
    } cases[] = {
        { { { 1, 1, 5.5 }, { 80, 80, 80 }, 0 }, 0.5, 0.5 },
        { { { 1, 1, 5.5 }, { 90, 60, 70 }, 0.3 }, 0.5, 0.5 },
        { { { 1, 1, 5.5 }, { 60, 40, 30 }, 0.35 }, 0.5, 0.5 },
        { { { 1, 1, 5.5 }, { 25, 18, 30 }, 0.6 }, 0.5, 0.7 },
        { { { 0.94, 0.94, 3 }, { 80, 65, 70 }, 0 }, 0.5, 0.5 },
        { { { 0.94, 0.94, 3 }, { 90, 60, 70 }, 0.3 }, 0.5, 0.5 },
        { { { 0.94, 0.94, 3 }, { 40, 25, 30 }, 0.8 }, 0.5, 0.6 },
        { { { 0.6, 0.6, 1.5 }, { 40, 30, 35 }, 0.2 }, 0.75, 0.6 },
    };
    /* the table of docs/surfaces.md */
    print_message("| Spacing (mm) | Radii (mm), tilt (rad) | | Vertex normals | near poles | Triangles | near poles | "
                  "RMS (mm) | Most (mm) | Volume (%%) |\n");
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        const struct ellipsoid *body = &cases[c].body;
        struct ellipsoid_error with, without;
        measure(body, 2, &with, &without);
        print_figures(body, "smoothing alone", &without);
        print_figures(body, "interpolated", &with);
        assert_true(with.pole_shown_deg < without.pole_shown_deg / 2);
        assert_true(with.pole_normal_deg < without.pole_normal_deg / 2);
        assert_true(with.shown_deg < without.shown_deg * cases[c].shown);
        assert_true(with.normal_deg < without.normal_deg * cases[c].faces);
        assert_true(with.rms_mm < without.rms_mm * 0.75);
        assert_true(with.max_mm < without.max_mm);
        assert_true(fabs(with.volume) < 0.005); /* of the univels: how many centres are inside is not exact */
    }
}

static void slices_may_be_across_any_axis(void **state)
{
    (void)state;
    for (int axis = 0; axis < 3; axis++) {
        struct ellipsoid body = { { 1, 1, 1 }, { 60, 50, 55 }, 0.3 };
        body.spacing_mm[axis] = 4;
        struct ellipsoid_error with, without;
        measure(&body, axis, &with, &without);
        assert_true(with.pole_shown_deg < without.pole_shown_deg / 2);
        assert_true(with.pole_normal_deg < without.pole_normal_deg / 2);
        assert_true(with.shown_deg < without.shown_deg / 2);
    }
}

static void equal_spacings_are_smoothed_as_without_interpolation(void **state)
{
    (void)state;
    static const struct ellipsoid bodies[] = { { { 2, 2, 2 }, { 50, 40, 30 }, 0.3 },
                                               { { 1, 1, 1.15 }, { 25, 20, 18 }, 0.3 },
                                               { { 1, 2, 2 }, { 25, 20, 18 }, 0.3 } };
    struct smooth_options before = without_interpolation();
    for (size_t b = 0; b < sizeof bodies / sizeof *bodies; b++) {
        struct mask *mask = ellipsoid_mask(&bodies[b], 0);
        struct mesh *with = extract(mask, &smooth_defaults, 1), *without = extract(mask, &before, 1);
        assert_same_bytes(with, without);
        assert_memory_equal(with->normals, without->normals, 3 * with->n_vertices * sizeof *with->normals);
        mesh_unref(with);
        mesh_unref(without);
        mask_destroy(mask);
    }
}

enum { N_AXES = CHECK_THREADED(3) };

static void random_blocks_are_equal_for_any_threads_across_any_axis(void **state)
{
    (void)state;
    for (int axis = 0; axis < N_AXES; axis++) {
        struct affine map = { { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, { 5, 6, 7 } };
        struct vec3 *columns = map.columns;
        columns[axis] = vec3_scale(columns[axis], -3);
        struct mask *mask = random_mask(90, 80, 40, 20, 9, &map);
        struct mesh *one = extract(mask, &smooth_defaults, 1);
        assert_int_equal(mesh_open_edges(one), 0);
        assert_int_equal(mesh_euler(one), euler_of_surface(mask));
        for (int n_threads = 2; n_threads < 5; n_threads++) {
            struct mesh *more = extract(mask, &smooth_defaults, n_threads);
            assert_same_bytes(one, more);
            assert_memory_equal(one->normals, more->normals, 3 * one->n_vertices * sizeof *one->normals);
            mesh_unref(more);
        }
        mesh_unref(one);
        mask_destroy(mask);
    }
}

/* Least and greatest z of the vertices within 3 mm of the axis through (x, y) = (30, 30), in slices. */
static void extent_at_the_middle(const struct mesh *mesh, double slice_mm, double *low, double *high)
{
    *low = INFINITY;
    *high = -INFINITY;
    for (size_t v = 0; v < mesh->n_vertices; v++) {
        const float *p = mesh->positions_lps_mm + 3 * v;
        if (hypot((double)p[0] - 30, (double)p[1] - 30) > 3)
            continue;
        *low = fmin(*low, (double)p[2] / slice_mm);
        *high = fmax(*high, (double)p[2] / slice_mm);
    }
}

static void flat_ends_stay_flat_and_half_a_slice_beyond_the_last(void **state)
{
    (void)state;
    /* a cylinder of radius 20 mm: free ends, ends where the scan ends, and one slice alone */
    static const uint32_t slices[3][2] = { { 3, 8 }, { 0, 11 }, { 5, 5 } };
    struct affine map = unit_map;
    map.columns[2].z = 5;
    for (int c = 0; c < 3; c++) {
        struct mask *mask = mask_make(61, 61, 12, &map);
        for (uint32_t k = slices[c][0]; k <= slices[c][1]; k++)
            for (uint32_t j = 0; j < 61; j++)
                for (uint32_t i = 0; i < 61; i++)
                    if (hypot(i - 30.0, j - 30.0) < 20.3)
                        mask_put(mask, i, j, k);
        struct mesh *mesh = extract(mask, &smooth_defaults, 1);
        double low, high;
        extent_at_the_middle(mesh, 5, &low, &high);
        assert_close(low, slices[c][0] - 0.5, 0.1);
        assert_close(high, slices[c][1] + 0.5, 0.1);
        assert_near(mesh_volume_mm3(mesh), (double)mask_count(mask) * 5, 0.0015);
        mesh_unref(mesh);
        mask_destroy(mask);
    }
}

/* A paraboloid with its top anywhere between two slices: the cap over the last slice reaches the top. */
static void the_top_of_a_paraboloid_is_found_between_slices(void **state)
{
    (void)state;
    struct affine map = unit_map;
    map.columns[2].z = 5;
    for (int step = 1; step < 8; step++) {
        double top = 8 + step / 8.0; /* in slices */
        struct mask *mask = mask_make(61, 61, 12, &map);
        for (uint32_t k = 2; k < 12; k++)
            for (uint32_t j = 0; j < 61; j++)
                for (uint32_t i = 0; i < 61; i++) /* radii of 21 mm and 26 mm four slices below the top */
                    if (pow((i - 30.2) / 10.5, 2) + pow((j - 29.9) / 13, 2) < top - k)
                        mask_put(mask, i, j, k);
        struct mesh *mesh = extract(mask, &smooth_defaults, 1);
        double low, high;
        extent_at_the_middle(mesh, 5, &low, &high);
        assert_close(high, top, 0.15); /* 0.5 without interpolation */
        mesh_unref(mesh);
        mask_destroy(mask);
    }
}

/* A corridor of 3 pixels winds around a core that alone goes on into the next slice. The corridor is a terrace, however
 * many turns it has: its height is that of the near contour, far from the core. Taken for a cap, it would be higher. */
static void a_terrace_may_wind_as_it_likes(void **state)
{
    (void)state;
    struct affine map = unit_map;
    map.columns[2].z = 5;
    struct mask *mask = mask_make(61, 61, 4, &map);
    for (uint32_t k = 1; k < 3; k++)
        for (uint32_t j = 27; j < 34; j++)
            for (uint32_t i = 27; i < 34; i++)
                mask_put(mask, i, j, k);
    static const int way[4][2] = { { 1, 0 }, { 0, 1 }, { -1, 0 }, { 0, -1 } };
    int at[2] = { 30, 30 };
    for (int leg = 0; leg < 16; leg++) /* of 5, 5, 10, 10, ... pixels */
        for (int step = 0; step < 5 * (leg / 2 + 1) && at[0] < 59 && at[1] < 59 && at[0] > 1 && at[1] > 1; step++) {
            for (int j = -1; j < 2; j++)
                for (int i = -1; i < 2; i++)
                    mask_put(mask, (uint32_t)(at[0] + i), (uint32_t)(at[1] + j), 1);
            at[0] += way[leg % 4][0];
            at[1] += way[leg % 4][1];
        }
    struct smooth_options smoothing = smooth_defaults;
    smoothing.n_volume_steps = 0; /* would raise everything, to give the corridor its volume back */
    struct mesh *mesh = extract(mask, &smoothing, 1);
    for (size_t v = 0; v < mesh->n_vertices; v++) {
        const float *p = mesh->positions_lps_mm + 3 * v;
        /* 15 pixels from the core: at most 2 / (2 + 15) of the way to the next slice */
        if (hypot((double)p[0] - 30, (double)p[1] - 30) > 20)
            assert_true((double)p[2] / 5 < 1.25);
    }
    assert_int_equal(mesh_open_edges(mesh), 0);
    mesh_unref(mesh);
    mask_destroy(mask);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(normals_are_twice_as_exact_where_slices_are_far_apart),
        cmocka_unit_test(slices_may_be_across_any_axis),
        cmocka_unit_test(equal_spacings_are_smoothed_as_without_interpolation),
        cmocka_unit_test(random_blocks_are_equal_for_any_threads_across_any_axis),
        cmocka_unit_test(flat_ends_stay_flat_and_half_a_slice_beyond_the_last),
        cmocka_unit_test(the_top_of_a_paraboloid_is_found_between_slices),
        cmocka_unit_test(a_terrace_may_wind_as_it_likes),
    };
#ifdef __SANITIZE_THREAD__
    cmocka_set_test_filter("*any_threads*"); /* the others have one */
#endif
    return cmocka_run_group_tests(tests, NULL, NULL);
}
