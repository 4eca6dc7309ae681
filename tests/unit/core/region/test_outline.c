/* Outlines: small pictures with hand-written lines, and properties of any mask. */
#include <stdlib.h>
#include <string.h>

#include "core/region/boundary.h"
#include "core/region/outline.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/made_mask.h"
#include "tests/unit/oracle.h"
#include "tests/unit/sera_head.h"

enum { MAX_TEXT = 2000 };

/* One slice from rows of characters, lowest y first; '#' is inside. */
static struct mask *art(const char *const *rows, uint32_t n_rows)
{
    struct mask *mask = mask_make((uint32_t)strlen(rows[0]), n_rows, 1, &unit_map);
    for (uint32_t y = 0; y < n_rows; y++)
        for (uint32_t x = 0; rows[y][x]; x++)
            if (rows[y][x] == '#')
                mask_put(mask, x, y, 0);
    return mask;
}

static struct outline_set *stack(const struct mask *mask, int axis, enum outline_method method, int n_threads)
{
    struct error err = { 0 };
    struct outline_set *set = outline_stack(mask, axis, method, n_threads, &err);
    assert_string_equal(err.text, "");
    assert_non_null(set);
    return set;
}

/* Writes "x,y x,y ..." per line, lines separated by " / ". */
static void write_lines(const struct outline_set *set, char *text)
{
    size_t length = 0;
    text[0] = 0;
    for (size_t l = 0; l < set->n_lines; l++)
        for (uint32_t at = set->line[l]; at < set->line[l + 1]; at++) {
            const float *p = set->points_ijk + 3 * (size_t)set->walk[at];
            length += (size_t)snprintf(text + length, MAX_TEXT - length, "%s%g,%g",
                                       at > set->line[l] ? " "
                                       : l > 0           ? " / "
                                                         : "",
                                       (double)p[0], (double)p[1]);
        }
}

static void assert_lines(const char *const *rows, uint32_t n_rows, enum outline_method method, const char *expected)
{
    struct mask *mask = art(rows, n_rows);
    struct outline_set *set = stack(mask, 2, method, 1);
    char text[MAX_TEXT];
    write_lines(set, text);
    assert_string_equal(text, expected);
    outline_set_destroy(set);
    mask_destroy(mask);
}

#define ART(...) (const char *const[]){ __VA_ARGS__ }, sizeof((const char *const[]){ __VA_ARGS__ }) / sizeof(char *)

static void a_block_is_traced_counter_clockwise_through_its_border_pixels(void **state)
{
    (void)state;
    assert_lines(ART("#####", "#####", "#####"), OUTLINE_TRACED, "0,0 1,0 2,0 3,0 4,0 4,1 4,2 3,2 2,2 1,2 0,2 0,1");
}

/* The case that stopped the thesis's first tracer: at the end of a line of pixels it could not turn back. */
static void a_spike_one_pixel_wide_is_walked_out_and_back(void **state)
{
    (void)state;
    assert_lines(ART("##...", "#####", "##..."), OUTLINE_TRACED, "0,0 1,0 2,1 3,1 4,1 3,1 2,1 1,2 0,2 0,1");
    assert_lines(ART("####"), OUTLINE_TRACED, "0,0 1,0 2,0 3,0 2,0 1,0");
    assert_lines(ART("#...", ".#..", "..#."), OUTLINE_TRACED, "0,0 1,1 2,2 1,1"); /* pixels connected by corners */
}

static void a_sharp_corner_is_walked_round(void **state)
{
    (void)state;
    assert_lines(ART("#....", "##...", "###.."), OUTLINE_TRACED, "0,0 1,1 2,2 1,2 0,2 0,1");
}

static void a_pixel_alone_is_a_line_of_one_point(void **state)
{
    (void)state;
    assert_lines(ART("#"), OUTLINE_TRACED, "0,0");
    assert_lines(ART("...", ".#.", "..."), OUTLINE_TRACED, "1,1");
    assert_lines(ART("...", ".#.", "..."), OUTLINE_MARCHING_SQUARES, "1,0.5 1.5,1 1,1.5 0.5,1");
}

static void separate_pieces_have_a_line_each(void **state)
{
    (void)state;
    assert_lines(ART("##..#", "##...", "...##"), OUTLINE_TRACED, "0,0 1,0 1,1 0,1 / 4,0 / 3,2 4,2");
}

static void a_hole_has_a_line_the_other_way_round(void **state)
{
    (void)state;
    assert_lines(ART("####", "#..#", "####"), OUTLINE_TRACED,
                 "0,0 1,0 2,0 3,0 3,1 3,2 2,2 1,2 0,2 0,1 / 1,2 2,2 3,1 2,0 1,0 0,1");
    assert_lines(
        ART("###", "#.#", "###"), OUTLINE_MARCHING_SQUARES,
        "0,-0.5 1,-0.5 2,-0.5 2.5,0 2.5,1 2.5,2 2,2.5 1,2.5 0,2.5 -0.5,2 -0.5,1 -0.5,0 / 1,1.5 1.5,1 1,0.5 0.5,1");
}

/* The spike is one pixel wide here, so no point is passed twice. */
static void squares_go_round_a_spike_and_cut_corners_apart(void **state)
{
    (void)state;
    assert_lines(ART("##"), OUTLINE_MARCHING_SQUARES, "0,-0.5 1,-0.5 1.5,0 1,0.5 0,0.5 -0.5,0");
    assert_lines(ART("#.", ".#"), OUTLINE_MARCHING_SQUARES, "0,-0.5 0.5,0 0,0.5 -0.5,0 / 1,0.5 1.5,1 1,1.5 0.5,1");
}

/* ---- any mask --------------------------------------------------------------------------------------------------- */

static const uint32_t sizes[][3] = {
    { 1, 1, 1 }, { 7, 5, 4 }, { 63, 9, 3 }, { 64, 8, 5 }, { 65, 12, 7 }, { 130, 6, 2 }
};
static const uint32_t percents[] = { 8, 35, 50, 65, 92 };

struct made {
    size_t at;
    struct mask *mask;
};

static bool next_mask(struct made *made)
{
    const size_t n_sizes = sizeof sizes / sizeof *sizes, n_percents = sizeof percents / sizeof *percents;
    mask_destroy(made->mask);
    made->mask = NULL;
    if (made->at == n_sizes * n_percents)
        return false;
    const uint32_t *size = sizes[made->at % n_sizes];
    made->mask = random_mask(size[0], size[1], size[2], percents[made->at / n_sizes], made->at, &unit_map);
    made->at++;
    return true;
}

/* The pixel (x, y) of a slice. */
static bool has_pixel(const struct mask *mask, int axis, int64_t slice, int64_t x, int64_t y)
{
    int64_t ijk[3];
    ijk[axis] = slice;
    ijk[axis == 0 ? 1 : 0] = x;
    ijk[axis == 2 ? 1 : 2] = y;
    return mask_has(mask, ijk[0], ijk[1], ijk[2]);
}

static void every_border_pixel_is_one_point_and_each_step_goes_to_a_neighbour(void **state)
{
    (void)state;
    for (struct made made = { 0 }; next_mask(&made);)
        for (int axis = 0; axis < 3; axis++) {
            struct outline_set *set = stack(made.mask, axis, OUTLINE_TRACED, 2);
            int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
            size_t n = 0;
            for (int64_t s = 0; s < made.mask->size[axis]; s++)
                for (int64_t y = 0; y < made.mask->size[v]; y++)
                    for (int64_t x = 0; x < made.mask->size[u]; x++)
                        n += has_pixel(made.mask, axis, s, x, y) &&
                             !(has_pixel(made.mask, axis, s, x - 1, y) && has_pixel(made.mask, axis, s, x + 1, y) &&
                               has_pixel(made.mask, axis, s, x, y - 1) && has_pixel(made.mask, axis, s, x, y + 1));
            assert_int_equal(set->n_points, n);
            bool *seen = calloc(n, 1);
            for (size_t p = 0; p < n;
                 p++) { /* different points, all inside, and as many as there are border pixels: so exactly those */
                const float *at = set->points_ijk + 3 * p;
                assert_true(mask_has(made.mask, (int64_t)at[0], (int64_t)at[1], (int64_t)at[2]));
                for (size_t q = p > 40 ? p - 40 : 0; q < p; q++)
                    assert_true(memcmp(at, set->points_ijk + 3 * q, 3 * sizeof *at) != 0);
            }
            for (size_t l = 0; l < set->n_lines; l++)
                for (uint32_t at = set->line[l]; at < set->line[l + 1]; at++) {
                    uint32_t next = at + 1 < set->line[l + 1] ? at + 1 : set->line[l];
                    const float *a = set->points_ijk + 3 * (size_t)set->walk[at],
                                *b = set->points_ijk + 3 * (size_t)set->walk[next];
                    assert_true(fabsf(a[u] - b[u]) <= 1 && fabsf(a[v] - b[v]) <= 1 && a[axis] == b[axis]);
                    assert_true(next == at || set->walk[at] != set->walk[next]);
                    seen[set->walk[at]] = true;
                }
            for (size_t p = 0; p < n; p++)
                assert_true(seen[p]);
            free(seen);
            outline_set_destroy(set);
        }
}

/* Twice the area enclosed by the lines of a slice, without the holes. */
static double twice_area(const struct outline_set *set, uint32_t first, uint32_t end, int axis)
{
    int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
    double twice = 0;
    for (uint32_t l = first; l < end; l++)
        for (uint32_t at = set->line[l]; at < set->line[l + 1]; at++) {
            uint32_t next = at + 1 < set->line[l + 1] ? at + 1 : set->line[l];
            const float *a = set->points_ijk + 3 * (size_t)set->walk[at],
                        *b = set->points_ijk + 3 * (size_t)set->walk[next];
            twice += (double)(a[u] * b[v] - a[v] * b[u]);
        }
    return twice;
}

/* Counts over the cells between four pixels: area in eighths, Euler number in quarters (S. B. Gray, Local properties of
 * binary images in two dimensions, IEEE Trans. Computers C-20, 1971). */
static void count_cells(const struct mask *mask, int axis, int64_t slice, bool is_joined, long *eighths,
                        long *euler_quarters)
{
    static const int of_count[5] = { 0, 1, 4, 7, 8 };
    int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
    *eighths = *euler_quarters = 0;
    for (int64_t y = -1; y < mask->size[v]; y++)
        for (int64_t x = -1; x < mask->size[u]; x++) {
            bool a = has_pixel(mask, axis, slice, x, y), b = has_pixel(mask, axis, slice, x + 1, y);
            bool c = has_pixel(mask, axis, slice, x, y + 1), d = has_pixel(mask, axis, slice, x + 1, y + 1);
            bool is_diagonal = a == d && b == c && a != b;
            *eighths += is_diagonal ? (is_joined ? 6 : 2) : of_count[a + b + c + d];
            *euler_quarters += is_diagonal          ? (is_joined ? -2 : 2)
                               : a + b + c + d == 1 ? 1
                               : a + b + c + d == 3 ? -1
                                                    : 0;
        }
}

static void lines_enclose_the_area_and_have_the_euler_number_of_the_cells(void **state)
{
    (void)state;
    for (struct made made = { 0 }; next_mask(&made);)
        for (int way = 0; way < 6; way++) {
            int axis = way % 3;
            struct outline_rule rule = { .is_joined = way >= 3, .is_between = true };
            struct error err = { 0 };
            struct outline_set *set = outline_walk(made.mask, axis, rule, 1, &err);
            assert_non_null(set);
            assert_int_equal(set->n_points, set->n_walk); /* each point once */
            for (uint32_t s = 0; s < made.mask->size[axis]; s++) {
                long eighths, quarters, euler = 0;
                count_cells(made.mask, axis, s, rule.is_joined, &eighths, &quarters);
                assert_true(twice_area(set, set->slice[s], set->slice[s + 1], axis) == (double)eighths / 4);
                for (uint32_t l = set->slice[s]; l < set->slice[s + 1]; l++) {
                    double area = twice_area(set, l, l + 1, axis);
                    assert_true(area != 0);
                    euler += area > 0 ? 1 : -1;
                }
                assert_int_equal(4 * euler, quarters);
            }
            outline_set_destroy(set);
        }
}

struct segment {
    float from[2], to[2];
};

static int compare_segments(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(struct segment));
}

static void sort_segment(struct segment *s, const float *a, const float *b)
{
    bool swap = a[0] > b[0] || (a[0] == b[0] && a[1] > b[1]);
    memcpy(s->from, swap ? b : a, sizeof s->from);
    memcpy(s->to, swap ? a : b, sizeof s->to);
    for (int x = 0; x < 2; x++) { /* no -0, for memcmp */
        s->from[x] += 0.0f;
        s->to[x] += 0.0f;
    }
}

/* Section of the surface with a slice of voxel centres: both cells at a face give the same line, so each segment is
 * there four times. */
static void squares_are_the_sections_of_the_marching_cubes_surface(void **state)
{
    (void)state;
    struct mask *mask = random_mask(19, 17, 5, 50, 77, &unit_map);
    struct mesh *mesh = made_surface(SURFACE_MARCHING_CUBES, mask, 1, true);
    struct outline_set *set = stack(mask, 2, OUTLINE_MARCHING_SQUARES, 1);
    for (uint32_t k = 0; k < 5; k++) {
        struct segment *cut = calloc(3 * mesh->n_triangles, sizeof *cut), *drawn = calloc(set->n_walk, sizeof *drawn);
        size_t n_cut = 0, n_drawn = 0;
        for (size_t at = 0; at < 3 * mesh->n_triangles; at++) {
            const float *a = mesh->positions_lps_mm + 3 * (size_t)mesh->indices[at];
            const float *b = mesh->positions_lps_mm + 3 * (size_t)mesh->indices[at % 3 == 2 ? at - 2 : at + 1];
            if (a[2] == (float)k && b[2] == (float)k)
                sort_segment(&cut[n_cut++], a, b);
        }
        for (uint32_t l = set->slice[k]; l < set->slice[k + 1]; l++)
            for (uint32_t at = set->line[l]; at < set->line[l + 1]; at++) {
                uint32_t next = at + 1 < set->line[l + 1] ? at + 1 : set->line[l];
                sort_segment(&drawn[n_drawn++], set->points_ijk + 3 * (size_t)set->walk[at],
                             set->points_ijk + 3 * (size_t)set->walk[next]);
            }
        qsort(cut, n_cut, sizeof *cut, compare_segments);
        qsort(drawn, n_drawn, sizeof *drawn, compare_segments);
        assert_int_equal(n_cut, 2 * n_drawn);
        for (size_t s = 0; s < n_drawn; s++)
            assert_memory_equal(&cut[2 * s], &drawn[s], sizeof *drawn);
        free(cut);
        free(drawn);
    }
    outline_set_destroy(set);
    mesh_unref(mesh);
    mask_destroy(mask);
}

/* Counts and lengths by VTK, slice by slice. */
static void squares_have_the_points_and_the_length_of_vtks(void **state)
{
    (void)state;
    struct mask *mask = random_mask(70, 41, 6, 55, 21, &unit_map);
    char folder[256], path[512], out[1024], *at = out, *program = "tests/oracle/vtk_squares.py";
    uint8_t voxels[70 * 41 * 6];
    for (size_t v = 0; v < sizeof voxels; v++)
        voxels[v] = mask_has(mask, (int64_t)(v % 70), (int64_t)(v / 70 % 41), (int64_t)(v / 70 / 41));
    folder_make(folder);
    folder_put(folder, "mask", voxels, sizeof voxels);
    snprintf(path, sizeof path, "%s/mask", folder);
    int status = oracle_run((char *[]){ oracle_python(), program, path, "70", "41", "6", NULL }, out, sizeof out);
    folder_remove(folder);
    struct outline_set *set = stack(mask, 2, OUTLINE_MARCHING_SQUARES, 1);
    for (uint32_t k = 0; status == 0 && k < 6; k++) {
        uint32_t first = set->line[set->slice[k]], end = set->line[set->slice[k + 1]];
        double length = 0;
        for (uint32_t l = set->slice[k]; l < set->slice[k + 1]; l++)
            for (uint32_t w = set->line[l]; w < set->line[l + 1]; w++) {
                const float *a = set->points_ijk + 3 * (size_t)set->walk[w];
                const float *b =
                    set->points_ijk + 3 * (size_t)set->walk[w + 1 < set->line[l + 1] ? w + 1 : set->line[l]];
                length += hypot((double)(a[0] - b[0]), (double)(a[1] - b[1]));
            }
        assert_int_equal(end - first, strtoul(at, &at, 10));
        assert_int_equal(end - first, strtoul(at, &at, 10));
        assert_close(length, strtod(at, &at), 1e-4 * length); /* VTK's are floats */
    }
    outline_set_destroy(set);
    mask_destroy(mask);
    if (status == ORACLE_MISSING)
        skip();
    assert_int_equal(status, 0);
}

static void assert_same_set(const struct outline_set *a, const struct outline_set *b)
{
    assert_int_equal(a->n_points, b->n_points);
    assert_int_equal(a->n_walk, b->n_walk);
    assert_int_equal(a->n_lines, b->n_lines);
    assert_memory_equal(a->points_ijk, b->points_ijk, 3 * a->n_points * sizeof *a->points_ijk);
    assert_memory_equal(a->walk, b->walk, a->n_walk * sizeof *a->walk);
    assert_memory_equal(a->line, b->line, (a->n_lines + 1) * sizeof *a->line);
}

static void any_number_of_threads_and_slices_alone_give_the_same(void **state)
{
    (void)state;
    struct mask *mask = random_mask(70, 33, 9, 45, 5, &unit_map);
    for (int way = 0; way < 6; way++) {
        enum outline_method method = way < 3 ? OUTLINE_TRACED : OUTLINE_MARCHING_SQUARES;
        int axis = way % 3;
        struct outline_set *one = stack(mask, axis, method, 1);
        for (int n = 2; n <= 3; n++) {
            struct outline_set *more = stack(mask, axis, method, n);
            assert_same_set(one, more);
            outline_set_destroy(more);
        }
        size_t walked = 0;
        for (uint32_t s = 0; s < mask->size[axis]; s++) {
            struct error err = { 0 };
            struct outline_set *slice = outline_slice(mask, axis, s, method, &err);
            assert_non_null(slice);
            for (size_t at = 0; at < slice->n_walk; at++)
                assert_memory_equal(slice->points_ijk + 3 * (size_t)slice->walk[at],
                                    one->points_ijk + 3 * (size_t)one->walk[walked + at], 3 * sizeof(float));
            walked += slice->n_walk;
            outline_set_destroy(slice);
        }
        assert_int_equal(walked, one->n_walk);
        outline_set_destroy(one);
    }
    mask_destroy(mask);
}

static void an_empty_mask_has_no_line_and_a_wrong_axis_or_slice_is_refused(void **state)
{
    (void)state;
    struct mask *mask = mask_make(8, 4, 2, &unit_map);
    struct outline_set *set = stack(mask, 1, OUTLINE_TRACED, 2);
    assert_int_equal(set->n_lines, 0);
    assert_int_equal(set->slice[4], 0);
    outline_set_destroy(set);
    struct error err = { 0 };
    assert_null(outline_stack(mask, 3, OUTLINE_TRACED, 1, &err));
    assert_int_equal(err.code, ERROR_RANGE);
    err = (struct error){ 0 };
    assert_null(outline_slice(mask, 2, 2, OUTLINE_TRACED, &err));
    assert_string_equal(err.text, "an outline on slice 2: axis 2 has 2");
    mask_destroy(mask);
}

/* A chequered block whose pixels are all separate by one rule, with 4 points each: more than the limit. */
static void noise_is_refused_before_it_fills_the_memory(void **state)
{
    (void)state;
    struct mask *mask = mask_make(512, 512, 140, &unit_map);
    for (uint32_t k = 0; k < 140; k++)
        for (uint32_t j = 0; j < 512; j++)
            for (uint32_t w = 0; w < 8; w++)
                mask->bits[((size_t)k * 512 + j) * 8 + w] = (j + k) % 2 ? 0x5555555555555555u : 0xaaaaaaaaaaaaaaaau;
    struct error err = { 0 };
    assert_null(outline_stack(mask, 2, OUTLINE_MARCHING_SQUARES, 2, &err));
    assert_int_equal(err.code, ERROR_LIMIT);
    assert_string_equal(err.text, "outlines of more than 67108864 points");
    mask_destroy(mask);
}

/* ---- other planes ----------------------------------------------------------------------------------------------- */

static void a_cut_across_an_oblique_grid_shows_the_voxels_it_goes_through(void **state)
{
    (void)state;
    /* a grid of 1 x 2 x 3 mm rotated by 30 degrees about S, cut by a plane across L */
    double c = cos(MATH_PI / 6), s = sin(MATH_PI / 6);
    struct affine map = { { { c, s, 0 }, { -2 * s, 2 * c, 0 }, { 0, 0, 3 } }, { 5, -7, 11 } };
    struct mask *mask = random_mask(40, 20, 12, 50, 3, &map);
    struct affine plane = { { { 0, 0.5, 0 }, { 0, 0, 0.5 }, { 1, 0, 0 } }, { 8, -10, 5 } };
    struct error err = { 0 };
    struct mask *cut = mask_cut(mask, &plane, (uint32_t[2]){ 100, 90 }, &err);
    assert_non_null(cut);
    size_t n = 0;
    for (uint32_t y = 0; y < 90; y++)
        for (uint32_t x = 0; x < 100; x++) {
            double dp[3] = { 8 - 5, -10 + 0.5 * x + 7, 5 + 0.5 * y - 11 };
            double i = dp[0] * c + dp[1] * s, j = (-dp[0] * s + dp[1] * c) / 2, k = dp[2] / 3;
            if (fabs(i - floor(i) - 0.5) < 1e-9 || fabs(j - floor(j) - 0.5) < 1e-9 || fabs(k - floor(k) - 0.5) < 1e-9)
                continue; /* between two voxels either is right */
            bool expected = mask_has(mask, (int64_t)floor(i + 0.5), (int64_t)floor(j + 0.5), (int64_t)floor(k + 0.5));
            assert_int_equal(mask_has(cut, x, y, 0), expected);
            n += expected;
        }
    assert_true(n > 500);
    mask_destroy(cut);
    plane.columns[1] = plane.columns[0];
    assert_null(mask_cut(mask, &plane, (uint32_t[2]){ 100, 90 }, &err));
    assert_int_equal(err.code, ERROR_RANGE);
    assert_null(mask_cut(mask, &plane, (uint32_t[2]){ 0, 90 }, &err));
    mask_destroy(mask);
}

/* ---- SERA's head ------------------------------------------------------------------------------------------------ */

/* Counts that the original Sera3d reports for its outlines: border pixels by 4 neighbours, slice by slice. */
static void point_counts_equal_the_original_sera3d_on_its_own_head(void **state)
{
    (void)state;
    static const size_t with_hierarchy[] = { 21451, 9267, 977 }, alone[] = { 30822, 10276, 977 };
    struct volume *layer = sera_head_read();
    if (!layer)
        skip();
    struct region_set *set = sera_head_regions(layer);
    for (size_t r = 0; r < 3; r++)
        for (int is_own = 0; is_own < 2; is_own++) {
            struct mask *mask = sera_head_mask(set, r, is_own);
            struct outline_set *lines = stack(mask, 2, OUTLINE_TRACED, 2);
            assert_int_equal(lines->n_points, (is_own ? alone : with_hierarchy)[r]);
            outline_set_destroy(lines);
            mask_destroy(mask);
        }
    sera_head_destroy(set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_block_is_traced_counter_clockwise_through_its_border_pixels),
        cmocka_unit_test(a_spike_one_pixel_wide_is_walked_out_and_back),
        cmocka_unit_test(a_sharp_corner_is_walked_round),
        cmocka_unit_test(a_pixel_alone_is_a_line_of_one_point),
        cmocka_unit_test(separate_pieces_have_a_line_each),
        cmocka_unit_test(a_hole_has_a_line_the_other_way_round),
        cmocka_unit_test(squares_go_round_a_spike_and_cut_corners_apart),
        cmocka_unit_test(every_border_pixel_is_one_point_and_each_step_goes_to_a_neighbour),
        cmocka_unit_test(lines_enclose_the_area_and_have_the_euler_number_of_the_cells),
        cmocka_unit_test(squares_are_the_sections_of_the_marching_cubes_surface),
        cmocka_unit_test(squares_have_the_points_and_the_length_of_vtks),
        cmocka_unit_test(any_number_of_threads_and_slices_alone_give_the_same),
        cmocka_unit_test(an_empty_mask_has_no_line_and_a_wrong_axis_or_slice_is_refused),
        cmocka_unit_test(noise_is_refused_before_it_fills_the_memory),
        cmocka_unit_test(a_cut_across_an_oblique_grid_shows_the_voxels_it_goes_through),
        cmocka_unit_test(point_counts_equal_the_original_sera3d_on_its_own_head),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
