/* Shapes other than surfaces and splines (univels, points, outlines), and every representation through shape_make. */
#include <stdlib.h>
#include <string.h>

#include "core/surface/shape_make.h"
#include "tests/check.h"
#include "tests/made_ragged.h"
#include "tests/unit/shape_help.h"

static const uint32_t sizes[][3] = { { 1, 1, 1 }, { 5, 7, 6 }, { 63, 5, 4 }, { 64, 4, 5 }, { 65, 6, 3 } };
enum { N_SIZES = sizeof sizes / sizeof *sizes };

static double voxel_mm3(const struct mask *mask)
{
    return fabs(affine_determinant(&mask->lps_mm_from_ijk));
}

static bool has_at(const struct mask *mask, struct vec3 ijk)
{
    return mask_has(mask, (int64_t)floor(ijk.x + 0.5), (int64_t)floor(ijk.y + 0.5), (int64_t)floor(ijk.z + 0.5));
}

/* ---- univels ---------------------------------------------------------------------------------------------------- */

static struct mesh *univels(const struct mask *mask, int n_threads)
{
    struct error err = { 0 };
    struct mesh *mesh = shape_univels(mask, n_threads, &err);
    assert_string_equal(err.text, "");
    assert_non_null(mesh);
    return mesh;
}

static int compare_u64(const void *a, const void *b)
{
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return x < y ? -1 : x > y;
}

/* Every edge is used equally often in both directions: the surface is closed. */
static void assert_closed(const struct mesh *mesh)
{
    size_t n = 3 * mesh->n_triangles;
    uint64_t *one = calloc(n + 1, sizeof *one), *other = calloc(n + 1, sizeof *other);
    for (size_t at = 0; at < n; at++) {
        uint64_t from = mesh->indices[at], to = mesh->indices[at % 3 == 2 ? at - 2 : at + 1];
        one[at] = from << 32 | to;
        other[at] = to << 32 | from;
    }
    qsort(one, n, sizeof *one, compare_u64);
    qsort(other, n, sizeof *other, compare_u64);
    assert_memory_equal(one, other, n * sizeof *one);
    free(one);
    free(other);
}

static void univels_enclose_exactly_their_volume_with_every_face_between_inside_and_outside(void **state)
{
    (void)state;
    for (int s = 0; s < N_SIZES; s++)
        for (int m = 0; m < N_MAPS; m++)
            for (uint32_t percent = 10; percent < 100; percent += 42) {
                struct mask *mask = random_mask(sizes[s][0], sizes[s][1], sizes[s][2], percent, percent, &maps[m]);
                struct mesh *mesh = univels(mask, 1);
                size_t faces[3] = { 0 };
                for (int64_t k = 0; k < mask->size[2]; k++)
                    for (int64_t j = 0; j < mask->size[1]; j++)
                        for (int64_t i = 0; i < mask->size[0]; i++)
                            if (mask_has(mask, i, j, k)) {
                                faces[0] += (size_t)!mask_has(mask, i - 1, j, k) + !mask_has(mask, i + 1, j, k);
                                faces[1] += (size_t)!mask_has(mask, i, j - 1, k) + !mask_has(mask, i, j + 1, k);
                                faces[2] += (size_t)!mask_has(mask, i, j, k - 1) + !mask_has(mask, i, j, k + 1);
                            }
                size_t corners = 0; /* corners whose eight voxels are not all alike */
                for (int64_t k = 0; k <= mask->size[2]; k++)
                    for (int64_t j = 0; j <= mask->size[1]; j++)
                        for (int64_t i = 0; i <= mask->size[0]; i++) {
                            int n = 0;
                            for (int c = 0; c < 8; c++)
                                n += mask_has(mask, i - (c & 1), j - (c >> 1 & 1), k - (c >> 2));
                            corners += n > 0 && n < 8;
                        }
                assert_int_equal(mesh->n_vertices, corners);
                double area = 0;
                for (int axis = 0; axis < 3; axis++)
                    area += (double)faces[axis] *
                            vec3_length(vec3_cross(maps[m].columns[(axis + 1) % 3], maps[m].columns[(axis + 2) % 3]));
                assert_int_equal(mesh->n_triangles, 2 * (faces[0] + faces[1] + faces[2]));
                /* positions are floats of up to 130 mm: 1e-5 mm */
                assert_near(mesh_area_mm2(mesh), area, m == 0 ? 0 : 2e-5);
                double volume = (double)mask_count(mask) * voxel_mm3(mask);
                assert_close(mesh_volume_mm3(mesh), volume, m == 0 ? 0 : 1e-5 * area);
                assert_closed(mesh);
                mesh_unref(mesh);
                mask_destroy(mask);
            }
}

static void each_univel_face_has_the_inside_behind_it_and_the_outside_before_it(void **state)
{
    (void)state;
    for (int m = 0; m < N_MAPS; m++) {
        struct mask *mask = random_mask(65, 6, 5, 50, 3, &maps[m]);
        struct mesh *mesh = univels(mask, 2);
        double side = affine_determinant(&maps[m]) < 0 ? -1 : 1; /* index space may be mirrored */
        for (size_t t = 0; t < mesh->n_triangles; t++) {
            struct vec3 p[3];
            for (int c = 0; c < 3; c++) {
                p[c] = index_of(mask, mesh_position(mesh, mesh->indices[3 * t + (size_t)c]));
                assert_close(p[c].x + 0.5, floor(p[c].x + 1), 1e-4); /* corners of voxels */
                assert_close(p[c].y + 0.5, floor(p[c].y + 1), 1e-4);
                assert_close(p[c].z + 0.5, floor(p[c].z + 1), 1e-4);
            }
            struct vec3 normal = vec3_scale(vec3_cross(vec3_sub(p[1], p[0]), vec3_sub(p[2], p[0])), side * 0.5);
            struct vec3 middle = vec3_scale(vec3_add(p[0], vec3_add(p[1], p[2])), 1 / 3.0);
            assert_true(has_at(mask, vec3_sub(middle, normal)));
            assert_false(has_at(mask, vec3_add(middle, normal)));
        }
        mesh_unref(mesh);
        mask_destroy(mask);
    }
}

static void one_univel_alone_is_a_box(void **state)
{
    (void)state;
    for (int m = 0; m < N_MAPS; m++) {
        struct mask *mask = mask_make(1, 1, 1, &maps[m]);
        mask_put(mask, 0, 0, 0);
        struct mesh *mesh = univels(mask, 3);
        assert_int_equal(mesh->n_triangles, 12);
        assert_int_equal(mesh->n_vertices, 8);
        assert_int_equal(mesh_open_edges(mesh), 0);
        assert_int_equal(mesh_euler(mesh), 2);
        assert_near(mesh_volume_mm3(mesh), voxel_mm3(mask), 1e-5);
        mesh_unref(mesh);
        mask_destroy(mask);
    }
}

/* ---- points ----------------------------------------------------------------------------------------------------- */

static void there_is_a_point_at_the_centre_of_every_border_voxel(void **state)
{
    (void)state;
    for (int s = 0; s < N_SIZES; s++)
        for (int m = 0; m < N_MAPS; m++) {
            struct mask *mask = random_mask(sizes[s][0], sizes[s][1], sizes[s][2], 70, 4, &maps[m]);
            struct point_set *set = made_points(mask, 2);
            assert_int_equal(set->n_points, count_border(mask));
            struct vec3 before = vec3(-1, -1, -1);
            for (size_t at = 0; at < set->n_points; at++) {
                struct vec3 ijk = index_of(mask, load_vec3(set->positions_lps_mm + 3 * at));
                ijk = vec3(floor(ijk.x + 0.5), floor(ijk.y + 0.5), floor(ijk.z + 0.5));
                struct vec3 off = vec3_sub(affine_point(&maps[m], ijk), load_vec3(set->positions_lps_mm + 3 * at));
                assert_true(vec3_length(off) < 1e-4);
                assert_true(is_border(mask, (int64_t)ijk.x, (int64_t)ijk.y, (int64_t)ijk.z));
                /* ascending, so no two are equal */
                assert_true(ijk.z > before.z || ijk.y > before.y || ijk.x > before.x);
                before = ijk;
                double length = vec3_length(load_vec3(set->normals + 3 * at));
                assert_true(length == 0 || fabs(length - 1) < 1e-6);
            }
            assert_memory_equal(set->edge_lps_mm, maps[m].columns, sizeof set->edge_lps_mm);
            made_points_finish(set);
            mask_destroy(mask);
        }
}

static void points_face_the_way_that_leads_out_on_average(void **state)
{
    (void)state;
    struct mask *mask = random_mask(130, 6, 5, 60, 31, &unit_map);
    struct point_set *set = made_points(mask, 2);
    for (size_t at = 0; at < set->n_points; at++) {
        const float *p = set->positions_lps_mm + 3 * at;
        struct vec3 sum = vec3(0, 0, 0);
        for (int way = 0; way < 27; way++) {
            int d[3] = { way % 3 - 1, way / 3 % 3 - 1, way / 9 - 1 };
            if (!mask_has(mask, (int64_t)p[0] + d[0], (int64_t)p[1] + d[1], (int64_t)p[2] + d[2]))
                sum = vec3_add(sum, vec3_normalize(vec3(d[0], d[1], d[2])));
        }
        struct vec3 expected = vec3_length(sum) > 1e-6 ? vec3_normalize(sum) : vec3(0, 0, 0);
        assert_true(vec3_length(vec3_sub(expected, load_vec3(set->normals + 3 * at))) < 1e-5);
    }
    made_points_finish(set);
    mask_destroy(mask);
}

/* The directions to 26 neighbours are up to 55 degrees apart, so an estimate from them may be off by 27 at worst. */
static void points_on_a_ball_face_away_from_its_middle(void **state)
{
    (void)state;
    for (int m = 0; m < 3; m++) {
        struct mask *mask = ball_mask(m == 0 ? 12 : m == 1 ? 14 : 13, &maps[m]);
        struct point_set *set = made_points(mask, 1);
        struct vec3 middle = affine_point(&maps[m], vec3(14.5, 14.5, 14.5));
        double sum = 0, worst = 0;
        for (size_t at = 0; at < set->n_points; at++) {
            struct vec3 out = vec3_normalize(vec3_sub(load_vec3(set->positions_lps_mm + 3 * at), middle));
            double angle = acos(fmin(1, vec3_dot(out, load_vec3(set->normals + 3 * at)))) * 180 / MATH_PI;
            sum += angle;
            worst = angle > worst ? angle : worst;
        }
        if (m == 0) {
            assert_true(worst < 27);
            assert_true(sum / (double)set->n_points < 10);
        } else { /* on steps wider than the 26-neighbourhood no slope can be seen */
            assert_true(worst < 90);
        }
        made_points_finish(set);
        mask_destroy(mask);
    }
}

static void points_on_flat_faces_face_square_to_them_on_any_grid(void **state)
{
    (void)state;
    for (int m = 0; m < N_MAPS; m++) {
        struct mask *mask = mask_make(9, 9, 9, &maps[m]);
        for (uint32_t k = 2; k < 7; k++)
            for (uint32_t j = 2; j < 7; j++)
                for (uint32_t i = 2; i < 7; i++)
                    mask_put(mask, i, j, k);
        struct point_set *set = made_points(mask, 1);
        size_t n_flat = 0;
        for (size_t at = 0; at < set->n_points; at++) {
            struct vec3 ijk = index_of(mask, load_vec3(set->positions_lps_mm + 3 * at));
            double x[3] = { ijk.x - 4, ijk.y - 4, ijk.z - 4 };
            for (int axis = 0; axis < 3; axis++) {
                if (fabs(x[(axis + 1) % 3]) > 1.01 || fabs(x[(axis + 2) % 3]) > 1.01)
                    continue; /* near an edge */
                const struct vec3 *c = maps[m].columns;
                struct vec3 square = vec3_normalize(vec3_cross(c[(axis + 1) % 3], c[(axis + 2) % 3]));
                double out = x[axis] * vec3_dot(square, c[axis]) > 0 ? 1 : -1;
                assert_close(vec3_dot(load_vec3(set->normals + 3 * at), square), out, 1e-5);
                n_flat++;
            }
        }
        assert_int_equal(n_flat, 6 * 9);
        made_points_finish(set);
        mask_destroy(mask);
    }
}

static void a_point_is_lit_by_the_way_it_faces_and_one_that_faces_no_way_lies_between(void **state)
{
    (void)state;
    struct mask *mask = mask_make(5, 5, 9, &unit_map);
    for (uint32_t k = 0; k < 3; k++)
        for (uint32_t j = 0; j < 5; j++)
            for (uint32_t i = 0; i < 5; i++)
                mask_put(mask, i, j, k);
    mask_put(mask, 2, 2, 6); /* a single voxel */
    struct point_set *set = made_points(mask, 1);
    /* light from (0.4, -0.7, 0.6) / 1.00499: facing S, (1 + 0.59702) / 2 of the light; ambient 1/4 */
    size_t top = SIZE_MAX, alone = SIZE_MAX, front = SIZE_MAX, back = SIZE_MAX;
    for (size_t at = 0; at < set->n_points; at++) {
        const float *p = set->positions_lps_mm + 3 * at;
        top = p[0] == 2 && p[1] == 2 && p[2] == 2 ? at : top;
        alone = p[2] == 6 ? at : alone;
        front = p[0] == 2 && p[1] == 0 && p[2] == 1 ? at : front;
        back = p[0] == 2 && p[1] == 4 && p[2] == 1 ? at : back;
    }
    assert_int_equal(set->shade[top], 216); /* 255 (0.25 + 0.75 x 0.79851) = 216.5, minus the rounding of the normal */
    assert_int_equal(set->shade[alone], 159); /* 255 (0.25 + 0.375) = 159.4 */
    assert_int_equal(set->shade[front], 226); /* 255 (0.25 + 0.75 x 0.84826) = 226.0 */
    assert_int_equal(set->shade[back], 93);   /* 255 (0.25 + 0.75 x 0.15174) = 92.8 */
    assert_true(set->normals[3 * alone] == 0 && set->normals[3 * alone + 1] == 0 && set->normals[3 * alone + 2] == 0);
    made_points_finish(set);
    mask_destroy(mask);
}

/* ---- shape_make ------------------------------------------------------------------------------------------------- */

static struct shape *make(const struct region_set *set, size_t region, struct shape_key key, int n_threads)
{
    struct error err = { 0 };
    shape_key_normalise(&key);
    struct shape *shape = shape_make(&key, set, region, n_threads, &err);
    assert_string_equal(err.text, "");
    assert_non_null(shape);
    return shape;
}

static struct shape_key key_of(enum region_representation representation)
{
    return (struct shape_key){ .representation = representation, .nurbs_order = 4, .nurbs_bins = 36 };
}

static void a_ragged_region_has_every_shape_the_same_for_any_number_of_threads(void **state)
{
    (void)state;
    struct plan *plan = ragged_plan();
    struct error err = { 0 };
    struct mask *mask = mask_from_region(&plan->regions, 0, 1, &err);
    assert_non_null(mask);
    for (enum region_representation r = 0; r < REPRESENTATION_N; r++) {
        struct shape *one = make(&plan->regions, 0, key_of(r), 1);
        struct box3 box = one->bounds_lps_mm; /* within the univels, except where a spline or a surface draws nothing */
        assert_true(box.low.x >= -0.5 && box.low.y >= -0.5 && box.low.z >= -1.25);
        assert_true(box.high.x <= 47.5 && box.high.y <= 39.5 && box.high.z <= 58.75);
        assert_true(one->n_bytes > 1000);
        for (int n = 2; n <= 3; n++) {
            struct shape *more = make(&plan->regions, 0, key_of(r), n);
            assert_int_equal(more->kind, one->kind);
            if (one->kind == SHAPE_TRIANGLES) {
                assert_same_bytes(one->mesh, more->mesh);
                assert_memory_equal(one->mesh->normals, more->mesh->normals, 3 * one->mesh->n_vertices * sizeof(float));
            } else if (one->kind == SHAPE_LINES) {
                assert_int_equal(one->lines->n_vertices, more->lines->n_vertices);
                assert_memory_equal(one->lines->positions_lps_mm, more->lines->positions_lps_mm,
                                    3 * one->lines->n_vertices * sizeof(float));
                assert_memory_equal(one->lines->indices, more->lines->indices,
                                    2 * one->lines->n_segments * sizeof(uint32_t));
            } else {
                assert_int_equal(one->points->n_points, more->points->n_points);
                assert_memory_equal(one->points->positions_lps_mm, more->points->positions_lps_mm,
                                    3 * one->points->n_points * sizeof(float));
                assert_memory_equal(one->points->normals, more->points->normals,
                                    3 * one->points->n_points * sizeof(float));
                assert_memory_equal(one->points->shade, more->points->shade, one->points->n_points);
            }
            shape_unref(more);
        }
        if (r == REPRESENTATION_UNIVELS) { /* cut by the scan on three sides, and closed there */
            assert_true(one->is_faceted);
            assert_closed(one->mesh);
            assert_true(mesh_volume_mm3(one->mesh) == 2.5 * (double)mask_count(mask));
        }
        if (r == REPRESENTATION_POINTS || r == REPRESENTATION_SOLID)
            assert_int_equal(one->points->n_points, count_border(mask));
        shape_unref(one);
    }
    mask_destroy(mask);
    plan_destroy(plan);
}

static void inner_boundaries_are_points_too_when_asked_for(void **state)
{
    (void)state;
    struct plan *plan = ragged_plan();
    struct error err = { 0 };
    uint16_t body = 1;
    struct mask *own = mask_from_labels(plan->regions.layers[0], &body, 1, 1, &err);
    struct mask *all = mask_from_region(&plan->regions, 0, 1, &err);
    for (int inner = 0; inner < 2; inner++) {
        struct shape_key key = key_of(REPRESENTATION_POINTS);
        key.has_inner_boundary = inner;
        struct shape *shape = make(&plan->regions, 0, key, 2);
        assert_int_equal(shape->points->n_points, count_border(inner ? own : all));
        shape_unref(shape);
    }
    assert_true(count_border(own) > count_border(all));
    mask_destroy(own);
    mask_destroy(all);
    plan_destroy(plan);
}

/* A grid whose first index runs along S: outlines are on the slices across that axis. */
static void outlines_lie_across_the_axis_nearest_s_and_a_lone_pixel_is_a_diamond(void **state)
{
    (void)state;
    struct mask *mask = mask_make(4, 5, 6, &maps[3]);
    mask_put(mask, 2, 3, 4);
    struct error err = { 0 };
    for (int method = 0; method < 2; method++) {
        struct line_set *lines = shape_outline(mask, (enum outline_method)method, 1, &err);
        assert_non_null(lines);
        assert_int_equal(lines->n_lines, 1);
        assert_int_equal(lines->n_segments, 4);
        assert_int_equal(lines->n_vertices, method == 0 ? 5 : 4); /* a traced outline also has the pixel's own point */
        struct vec3 sum = vec3(0, 0, 0);
        for (size_t at = 0; at < 8; at++) {
            struct vec3 ijk = index_of(mask, load_vec3(lines->positions_lps_mm + 3 * (size_t)lines->indices[at]));
            assert_close(ijk.x, 2, 1e-4);
            assert_close(fabs(ijk.y - 3) + fabs(ijk.z - 4), method == 0 ? 0.25 : 0.5, 1e-4);
            sum = vec3_add(sum, ijk);
        }
        assert_true(vec3_length(vec3_sub(vec3_scale(sum, 1 / 8.0), vec3(2, 3, 4))) < 1e-4);
        for (size_t s = 0; s < 4; s++)
            assert_int_equal(lines->indices[2 * s + 1], lines->indices[2 * ((s + 1) % 4)]);
        free(lines->positions_lps_mm);
        free(lines->indices);
        free(lines);
    }
    mask_destroy(mask);
}

static void what_cannot_be_made_is_refused_with_a_reason(void **state)
{
    (void)state;
    struct plan *plan = ragged_plan();
    struct region *core = &plan->regions.regions[1];
    core->label = 9; /* no voxel has it */
    for (enum region_representation r = 0; r < REPRESENTATION_N; r++) {
        struct shape_key key = key_of(r);
        struct error err = { 0 };
        assert_null(shape_make(&key, &plan->regions, 1, 1, &err));
        assert_int_equal(err.code, ERROR_RANGE);
        assert_string_equal(err.text, "region core has no voxel");
        assert_null(shape_make(&key, &plan->regions, 2, 1, &err));
        assert_int_equal(err.code, ERROR_RANGE);
    }
    static const int wrong[][2] = { { 1, 36 }, { 5, 36 }, { 3, 7 }, { 3, 361 } };
    for (size_t w = 0; w < 4; w++) {
        struct shape_key key = key_of(REPRESENTATION_NURBS);
        struct error err = { 0 };
        key.nurbs_order = wrong[w][0];
        key.nurbs_bins = wrong[w][1];
        assert_null(shape_make(&key, &plan->regions, 0, 1, &err));
        assert_int_equal(err.code, ERROR_RANGE);
    }
    plan_destroy(plan);
}

static void keys_forget_what_does_not_matter_to_their_representation(void **state)
{
    (void)state;
    struct shape_key a = {
        REPRESENTATION_POINTS, SURFACE_EIGHT_CELL, OUTLINE_MARCHING_SQUARES, true, 3, NURBS_DEGREE_BINS, 40
    };
    struct shape_key b = { .representation = REPRESENTATION_POINTS, .has_inner_boundary = true };
    assert_false(shape_key_equal(&a, &b));
    shape_key_normalise(&a);
    shape_key_normalise(&b);
    assert_true(shape_key_equal(&a, &b));
    b.has_inner_boundary = false;
    assert_false(shape_key_equal(&a, &b));
    for (enum region_representation r = 0; r < REPRESENTATION_N; r++) {
        enum region_representation back = REPRESENTATION_N;
        assert_true(region_representation_from_word(region_representation_word(r), &back));
        assert_int_equal(back, r);
    }
    enum region_representation unchanged = REPRESENTATION_FAN;
    assert_false(region_representation_from_word("Fan", &unchanged));
    assert_int_equal(unchanged, REPRESENTATION_FAN);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(univels_enclose_exactly_their_volume_with_every_face_between_inside_and_outside),
        cmocka_unit_test(each_univel_face_has_the_inside_behind_it_and_the_outside_before_it),
        cmocka_unit_test(one_univel_alone_is_a_box),
        cmocka_unit_test(there_is_a_point_at_the_centre_of_every_border_voxel),
        cmocka_unit_test(points_face_the_way_that_leads_out_on_average),
        cmocka_unit_test(points_on_a_ball_face_away_from_its_middle),
        cmocka_unit_test(points_on_flat_faces_face_square_to_them_on_any_grid),
        cmocka_unit_test(a_point_is_lit_by_the_way_it_faces_and_one_that_faces_no_way_lies_between),
        cmocka_unit_test(a_ragged_region_has_every_shape_the_same_for_any_number_of_threads),
        cmocka_unit_test(inner_boundaries_are_points_too_when_asked_for),
        cmocka_unit_test(outlines_lie_across_the_axis_nearest_s_and_a_lone_pixel_is_a_diamond),
        cmocka_unit_test(what_cannot_be_made_is_refused_with_a_reason),
        cmocka_unit_test(keys_forget_what_does_not_matter_to_their_representation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
