/* Isodose lines against closed forms: linear and Gaussian doses on rotated grids and oblique planes, jumps at borders
 * of tissues, saddles, missing values. */
#include "core/dose/isolines.h"

#include <stdlib.h>
#include <string.h>

#include "core/derive/dose_plane.h"
#include "core/render/visible/isoline_scene.h"
#include "tests/check.h"

static double random_part(void) /* 0..1, from a fixed sequence */
{
    static uint64_t state = 88172645463325252u;
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return (double)(state >> 11) * 0x1p-53;
}

static struct vec3 random_direction(void)
{
    double z = 2 * random_part() - 1, turn = 2 * MATH_PI * random_part(), r = sqrt(1 - z * z);
    return vec3(r * cos(turn), r * sin(turn), z);
}

/* A grid around the origin with spacings of 1 to 3 mm, turned and moved at random, of either handedness. */
static struct grid random_grid(uint32_t side)
{
    struct vec3 a = random_direction(), b = vec3_normalize(vec3_cross(a, random_direction())), c = vec3_cross(a, b);
    struct affine map = { { vec3_scale(a, 1 + 2 * random_part()), vec3_scale(b, 1 + 2 * random_part()),
                            vec3_scale(c, (random_part() < 0.5 ? -1 : 1) * (1 + 2 * random_part())) },
                          vec3(0, 0, 0) };
    struct vec3 middle =
        affine_vector(&map, vec3((side - 1) / 2.0 + random_part(), (side - 1) / 2.0 + random_part(), (side - 1) / 2.0));
    map.origin = vec3_scale(middle, -1);
    struct grid grid;
    struct error err = { 0 };
    assert_true(grid_init(&grid, (uint32_t[]){ side, side, side }, &map, &err));
    return grid;
}

typedef double function(struct vec3 p);

static struct volume *volume_of(const struct grid *grid, function *value)
{
    struct error err = { 0 };
    struct volume *volume = volume_create(grid, VOXEL_F32, &err);
    float *voxel = volume->voxels;
    for (uint32_t k = 0; k < grid->size[2]; k++)
        for (uint32_t j = 0; j < grid->size[1]; j++)
            for (uint32_t i = 0; i < grid->size[0]; i++)
                *voxel++ = (float)value(affine_point(&grid->lps_mm_from_ijk, vec3(i, j, k)));
    volume_measure(volume);
    return volume;
}

struct drawn {
    struct dose_lattice lattice;
    struct isolines lines;
};

/* Lines of a field on a plane, at so many mm per pixel. */
static struct drawn draw(const struct dose_field *field, const struct plane *plane, double mm_per_px, double level)
{
    struct drawn drawn = { .lines = { 0 } };
    struct isoline_lattice lattice;
    struct isoline_window all = isoline_window_of_plane();
    struct error err = { 0 };
    assert_true(isoline_lattice_of(&field->rows[0]->grid, plane, &all, mm_per_px, &lattice));
    drawn.lattice = isoline_lattice_samples(&lattice);
    struct dose_plane *values = dose_plane_create(field, &drawn.lattice, &err);
    assert_non_null(values);
    assert_true(dose_plane_trace(values, field, level, &drawn.lines, &err));
    dose_plane_destroy(values);
    return drawn;
}

static struct vec3 point_of(const struct drawn *drawn, size_t i)
{
    return affine_point(&drawn->lattice.lps_mm_from_uv, vec3(drawn->lines.points[i][0], drawn->lines.points[i][1], 0));
}

/* True if the value there is not one beyond the outermost centres of the grid. */
static bool is_between_centres(const struct grid *grid, struct vec3 p, double margin)
{
    struct vec3 at = affine_point(&grid->ijk_from_lps_mm, p);
    const double ijk[3] = { at.x, at.y, at.z };
    for (int i = 0; i < 3; i++)
        if (ijk[i] < margin || ijk[i] > grid->size[i] - 1 - margin)
            return false;
    return true;
}

/* The steps of the lattice, which corners of its cells are off the grid's centres at most. */
static double cell_mm(const struct drawn *drawn)
{
    return vec3_length(drawn->lattice.lps_mm_from_uv.columns[0]) +
           vec3_length(drawn->lattice.lps_mm_from_uv.columns[1]);
}

static struct vec3 slope;
static double linear(struct vec3 p)
{
    return 50 + vec3_dot(slope, p);
}

static void a_linear_dose_has_straight_lines_at_their_exact_place(void **state)
{
    (void)state;
    size_t n_compared = 0;
    for (int trial = 0; trial < 40; trial++) {
        struct grid grid = random_grid(24);
        slope = random_direction();
        struct dose_field field = { .rows = { volume_of(&grid, linear) }, .n_rows = 1 };
        /* slices of the grid itself, and any plane */
        struct vec3 normal =
            trial % 2 ? vec3_normalize(grid.lps_mm_from_ijk.columns[trial / 2 % 3]) : random_direction();
        struct plane plane = plane_of_normal(vec3_scale(random_direction(), 4), normal);
        struct drawn drawn = draw(&field, &plane, 0.2 + 2 * random_part(), 48);
        double steepness = vec3_length(vec3_sub(slope, vec3_scale(plane.normal, vec3_dot(slope, plane.normal))));
        for (size_t i = 0; i < drawn.lines.n_points; i++) {
            struct vec3 p = point_of(&drawn, i);
            assert_close(plane_height_mm(&plane, p), 0, 1e-9);
            if (!is_between_centres(&grid, p, cell_mm(&drawn))) /* a spacing is at least 1 mm */
                continue;
            n_compared++;
            /* values near 50 are rounded by 4e-6 at most */
            assert_close((linear(p) - 48) / steepness, 0, 2e-5 / steepness);
        }
        isolines_finish(&drawn.lines);
        volume_unref(field.rows[0]);
    }
    assert_true(n_compared > 1000);
}

static const double sigma_mm = 12;
static double gaussian(struct vec3 p)
{
    return exp(-vec3_dot(p, p) / (2 * sigma_mm * sigma_mm));
}

static void a_gaussian_dose_has_one_closed_circle_of_its_radius_on_any_plane(void **state)
{
    (void)state;
    for (int trial = 0; trial < 40; trial++) {
        struct grid grid = random_grid(40);
        struct dose_field field = { .rows = { volume_of(&grid, gaussian) }, .n_rows = 1 };
        struct vec3 normal =
            trial % 2 ? vec3_normalize(grid.lps_mm_from_ijk.columns[trial / 2 % 3]) : random_direction();
        double height = 5 * random_part(), ball_mm = 12, level = exp(-ball_mm * ball_mm / (2 * sigma_mm * sigma_mm));
        struct plane plane = plane_of_normal(vec3_scale(normal, height), normal);
        struct drawn drawn = draw(&field, &plane, 0.25, level);
        double radius = sqrt(ball_mm * ball_mm - height * height), length = 0;
        /* Linear interpolation over h is off by h^2 / 8 |f''| at most, |f''| <= 1 / sigma^2; along the grid's three
         * axes and the lattice's two; and the radius by that over the slope in the plane */
        struct vec3 h = grid_spacing_mm(&grid);
        double step = cell_mm(&drawn), steepness = level * radius / (sigma_mm * sigma_mm),
               tolerance = (vec3_dot(h, h) + step * step) / 8 / (sigma_mm * sigma_mm) / steepness;
        assert_int_equal(drawn.lines.n_lines, 1);
        assert_memory_equal(drawn.lines.points[0], drawn.lines.points[drawn.lines.n_points - 1], 2 * sizeof(double));
        for (size_t i = 0; i < drawn.lines.n_points; i++) {
            struct vec3 p = point_of(&drawn, i), from = vec3_sub(p, vec3_scale(normal, height));
            assert_close(vec3_length(from), radius, tolerance);
            if (i > 0)
                length += vec3_length(vec3_sub(p, point_of(&drawn, i - 1)));
        }
        assert_close(length, 2 * MATH_PI * radius, 2 * MATH_PI * radius * 0.05 + 2 * MATH_PI * tolerance);
        isolines_finish(&drawn.lines);
        volume_unref(field.rows[0]);
    }
}

static void lattices_of_windows_lie_on_each_other(void **state)
{
    (void)state;
    struct grid grid = random_grid(40);
    struct plane plane = plane_of_normal(vec3(1, 2, 3), random_direction());
    struct isoline_window small = { { -5, -4 }, { 7, 3 } }, moved = { { -3, -4.5 }, { 9, 2.5 } },
                          all = isoline_window_of_plane();
    struct isoline_lattice a, b, whole;
    assert_true(isoline_lattice_of(&grid, &plane, &small, 0.3, &a));
    assert_true(isoline_lattice_of(&grid, &plane, &moved, 0.3, &b));
    assert_true(isoline_lattice_of(&grid, &plane, &all, 0.3, &whole));
    assert_memory_equal(&a.lps_mm_from_uv, &b.lps_mm_from_uv, sizeof a.lps_mm_from_uv);
    assert_true(isoline_lattice_holds(&whole, &a) && isoline_lattice_holds(&whole, &b));
    assert_false(isoline_lattice_holds(&a, &b) || isoline_lattice_holds(&b, &a));
}

static struct isolines trace(const float *values, uint32_t width, uint32_t height, double level)
{
    struct isolines lines = { 0 };
    struct error err = { 0 };
    assert_true(
        isolines_trace(&(struct isoline_samples){ .values = values, .size = { width, height } }, level, &lines, &err));
    return lines;
}

/* The number of lines that keep (u, v) and (2, 2) apart is odd: by the crossings of the way between them. */
static bool is_parted(const struct isolines *lines, double u, double v)
{
    int n = 0;
    for (size_t l = 0, at = 0; l < lines->n_lines; at = lines->ends[l++])
        for (size_t i = at + 1; i < lines->ends[l]; i++) {
            const double *a = lines->points[i - 1], *b = lines->points[i];
            double x = 2 - u, y = 2 - v, sa = x * (a[1] - v) - y * (a[0] - u), sb = x * (b[1] - v) - y * (b[0] - u),
                   dx = b[0] - a[0], dy = b[1] - a[1], ta = dx * (v - a[1]) - dy * (u - a[0]),
                   tb = dx * (2 - a[1]) - dy * (2 - a[0]);
            n += (sa < 0) != (sb < 0) && (ta < 0) != (tb < 0);
        }
    return n % 2 == 1;
}

static void a_saddle_joins_the_sides_that_its_bilinear_value_joins(void **state)
{
    (void)state;
    /* the saddle of the middle cell, of corners 4 0 6 1, has the value (4 * 6 - 0 * 1) / (4 + 6 - 0 - 1) = 2.67 */
    const float values[16] = { 4, 4, 0, 0, 4, 4, 0, 0, 1, 1, 6, 6, 1, 1, 6, 6 };
    struct isolines below = trace(values, 4, 4, 2.6), above = trace(values, 4, 4, 2.7);
    assert_int_equal(below.n_lines, 2);
    assert_int_equal(above.n_lines, 2);
    assert_false(is_parted(&below, 1, 1)); /* the corners of 4 and 6 are joined */
    assert_true(is_parted(&below, 2, 1));
    assert_true(is_parted(&above, 1, 1) == false && above.n_points == below.n_points); /* parted by two lines */
    /* above the saddle's value the lines go around the high corners: each stays on its side of the diagonal u + v = 3
     */
    for (size_t l = 0, at = 0; l < above.n_lines; at = above.ends[l++])
        for (size_t i = at; i < above.ends[l]; i++)
            assert_true((above.points[i][0] + above.points[i][1] < 3) ==
                        (above.points[at][0] + above.points[at][1] < 3));
    isolines_finish(&below);
    isolines_finish(&above);
}

static void cells_beside_a_missing_value_have_no_line_and_the_others_do(void **state)
{
    (void)state;
    float values[9 * 9];
    for (int i = 0; i < 81; i++)
        values[i] = (float)(i / 9);
    values[4 + 9 * 4] = NAN;
    struct isolines lines = trace(values, 9, 9, 4.5);
    assert_int_equal(lines.n_lines, 2);
    for (size_t i = 0; i < lines.n_points; i++) {
        assert_true(lines.points[i][0] <= 3 || lines.points[i][0] >= 5);
        assert_close(lines.points[i][1], 4.5, 0);
    }
    assert_int_equal(lines.n_points, 8);
    isolines_finish(&lines);
    for (int i = 0; i < 81; i++)
        values[i] = NAN;
    lines = trace(values, 9, 9, 4.5);
    assert_int_equal(lines.n_points, 0);
    isolines_finish(&lines);
    for (int i = 0; i < 81; i++)
        values[i] = 4.5f; /* all is at the level: no border */
    lines = trace(values, 9, 9, 4.5);
    assert_int_equal(lines.n_points, 0);
    isolines_finish(&lines);
}

static double one(struct vec3 p)
{
    return 1 + 0 * p.x;
}
static double three(struct vec3 p)
{
    return 3 + 0 * p.x;
}

static void a_jump_between_tissues_is_on_the_border_of_their_univels(void **state)
{
    (void)state;
    for (int trial = 0; trial < 10; trial++) {
        struct grid dose = random_grid(20), univels;
        struct error err = { 0 };
        double spacing = 0.7 + random_part(), shift = random_part();
        struct affine map = { { vec3(spacing, 0, 0), vec3(0, spacing, 0), vec3(0, 0, spacing) },
                              vec3(-40 * spacing - shift, -40 * spacing, -40 * spacing) };
        assert_true(grid_init(&univels, (uint32_t[]){ 80, 80, 80 }, &map, &err));
        struct tissue_rows tissue = { .rows = volume_create(&univels, VOXEL_U8, &err) };
        for (size_t i = 0; i < 80 * 80 * 80; i++) /* a step: univels of i >= 40, of i >= 44 from j 40 on, are row 1 */
            ((uint8_t *)tissue.rows->voxels)[i] = i % 80 >= (i / 80 % 80 >= 40 ? 44u : 40u);
        struct dose_field field = { .rows = { volume_of(&dose, one), volume_of(&dose, three) },
                                    .n_rows = 2,
                                    .tissue = &tissue };
        struct plane plane = plane_of_kind(SCENE_KIND_AXIAL, 0.3);
        struct drawn drawn = draw(&field, &plane, 0.1, 2);
        double step = cell_mm(&drawn), border[2] = { map.origin.x + 39.5 * spacing, map.origin.x + 43.5 * spacing },
               side = map.origin.y + 39.5 * spacing;
        assert_int_equal(drawn.lines.n_lines, 1);
        for (size_t i = 0; i < drawn.lines.n_points; i++) {
            struct vec3 p = point_of(&drawn, i);
            bool is_at_step = fabs(p.y - side) < step;
            double off = p.y < side ? fabs(p.x - border[0]) : fabs(p.x - border[1]);
            /* the border is found to 1 / 4096 of a step along each edge of the lattice */
            if (!is_at_step)
                assert_close(off, 0, step / 2000);
            else
                assert_true(p.x > border[0] - step && p.x < border[1] + step);
        }
        isolines_finish(&drawn.lines);
        volume_unref(field.rows[0]);
        volume_unref(field.rows[1]);
        volume_unref(tissue.rows);
    }
}

static void a_univel_without_weights_has_no_line(void **state)
{
    (void)state;
    struct grid dose = random_grid(20), univels;
    struct error err = { 0 };
    struct affine map = { { vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1) }, vec3(-30, -30, -30) };
    assert_true(grid_init(&univels, (uint32_t[]){ 60, 60, 60 }, &map, &err));
    struct tissue_rows tissue = { .rows = volume_create(&univels, VOXEL_U8, &err) };
    for (size_t i = 0; i < 60 * 60 * 60; i++)
        ((uint8_t *)tissue.rows->voxels)[i] = i % 60 < 30 ? DOSE_NO_ROW : 0;
    slope = vec3(0, 1, 0);
    struct dose_field field = { .rows = { volume_of(&dose, linear) }, .n_rows = 1, .tissue = &tissue };
    struct plane plane = plane_of_kind(SCENE_KIND_AXIAL, 0);
    struct drawn drawn = draw(&field, &plane, 0.2, 50);
    double least = INFINITY;
    for (size_t i = 0; i < drawn.lines.n_points; i++)
        least = fmin(least, point_of(&drawn, i).x);
    assert_true(least >= -0.5 && least < -0.5 + 2 * cell_mm(&drawn));
    isolines_finish(&drawn.lines);
    volume_unref(field.rows[0]);
    volume_unref(tissue.rows);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_linear_dose_has_straight_lines_at_their_exact_place),
        cmocka_unit_test(a_gaussian_dose_has_one_closed_circle_of_its_radius_on_any_plane),
        cmocka_unit_test(lattices_of_windows_lie_on_each_other),
        cmocka_unit_test(a_saddle_joins_the_sides_that_its_bilinear_value_joins),
        cmocka_unit_test(cells_beside_a_missing_value_have_no_line_and_the_others_do),
        cmocka_unit_test(a_jump_between_tissues_is_on_the_border_of_their_univels),
        cmocka_unit_test(a_univel_without_weights_has_no_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
