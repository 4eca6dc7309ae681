/* The outlines of cut shapes are made once for each shape and plane: dragging another plane cuts nothing again. */
#include "core/render/visible/cap_cache.h"
#include "tests/check.h"
#include "tests/derived_of.h"
#include "tests/made_plan.h"

static const struct made_region regions[] = { { "ball", -1, 0xd0a080 } };

static double ball(struct vec3 p)
{
    return vec3_length(p) < 9;
}

static struct plan *make_plan(void)
{
    struct grid grid = made_cube_grid(24);
    return made_plan(&grid, ball, regions, 1);
}

static const struct shape_want want = { { SUBJECT_REGION, 0, 0 },
                                        { .representation = REPRESENTATION_UNIVELS },
                                        SURFACE_FULL };

/* In use until the next call. */
static const struct cut_lines *cut(struct cap_cache *cache, struct plan *plan, const struct plane *plane)
{
    struct error err = { 0 };
    const struct cut_lines *lines = cap_cache_lines(cache, derived_of(plan), &want, plane, &err);
    assert_string_equal(err.text, "");
    cap_cache_release(lines);
    return lines;
}

static void a_plane_that_stays_is_not_cut_again(void **state)
{
    (void)state;
    struct plan *plan = make_plan();
    struct cap_cache *cache = cap_cache_create();
    struct plane still = plane_of_kind(SCENE_KIND_AXIAL, 1.5);
    const struct cut_lines *first = cut(cache, plan, &still);
    const double(*ends)[2][3] = (const double(*)[2][3])first->ends_lps_mm;
    assert_true(first->n > 30);
    for (int i = 0; i < 100; i++) { /* another one is dragged */
        struct plane dragged = plane_of_normal(vec3(0, 0, 0.1 * i), vec3(1, 2, 3));
        (void)cut(cache, plan, &dragged);
        cap_cache_trim(cache);
        assert_ptr_equal(cut(cache, plan, &still)->ends_lps_mm, ends);
    }
    still.origin_lps_mm.z = 2.5;
    assert_ptr_not_equal(cut(cache, plan, &still)->ends_lps_mm, ends);
    cap_cache_destroy(cache);
    plan_and_derived_destroy(plan);
}

/* In the ball of radius 9 the slice from S 1 to 2 mm has the univels (i, j) with i^2 + j^2 + 1.5^2 < 81: the outline of
 * these unit squares is as long as there are sides between inside and outside. */
static void the_outline_is_that_of_the_univels(void **state)
{
    (void)state;
    struct plan *plan = make_plan();
    struct cap_cache *cache = cap_cache_create();
    struct plane plane = plane_of_kind(SCENE_KIND_AXIAL, 1.5);
    const struct cut_lines *lines = cut(cache, plan, &plane);
    double length_mm = 0;
    int n_sides = 0;
    for (size_t i = 0; i < lines->n; i++)
        length_mm += hypot(lines->ends_lps_mm[i][1][0] - lines->ends_lps_mm[i][0][0],
                           lines->ends_lps_mm[i][1][1] - lines->ends_lps_mm[i][0][1]);
    for (int j = -12; j < 12; j++)
        for (int i = -12; i < 12; i++) {
            double here = ball(vec3(i + 0.5, j + 0.5, 1.5));
            n_sides += here != ball(vec3(i + 1.5, j + 0.5, 1.5));
            n_sides += here != ball(vec3(i + 0.5, j + 1.5, 1.5));
        }
    assert_close(length_mm, n_sides, 1e-3);
    cap_cache_destroy(cache);
    plan_and_derived_destroy(plan);
}

static void lines_in_use_are_kept_and_those_of_a_closed_plan_go(void **state)
{
    (void)state;
    struct plan *plan = make_plan(), *other = make_plan();
    struct cap_cache *cache = cap_cache_create();
    struct plane plane = plane_of_kind(SCENE_KIND_CORONAL, 0.5);
    struct error err = { 0 };
    const struct cut_lines *used = cap_cache_lines(cache, derived_of(plan), &want, &plane, &err);
    size_t n = used->n;
    for (int i = 0; i < 5000; i++) { /* more than are kept */
        struct plane dragged = plane_of_kind(SCENE_KIND_AXIAL, -9 + 0.003 * i);
        (void)cut(cache, other, &dragged);
    }
    cap_cache_trim(cache);
    assert_int_equal(used->n, n);
    assert_close(used->ends_lps_mm[n - 1][0][1], 0.5, 1e-5);
    cap_cache_release(used);
    cap_cache_forget(cache, plan);
    plan_and_derived_destroy(plan);
    (void)cut(cache, other, &plane);
    cap_cache_destroy(cache);
    plan_and_derived_destroy(other);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_plane_that_stays_is_not_cut_again),
        cmocka_unit_test(the_outline_is_that_of_the_univels),
        cmocka_unit_test(lines_in_use_are_kept_and_those_of_a_closed_plan_go),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
