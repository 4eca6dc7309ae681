/* Contours of one plane: repeated, nested, overlapping ones. Expected voxels come from a ray cast through each contour
 * alone and from how the contours were made. */
#include "tests/check.h"
#include "tests/unit/made_contours.h"
#include "tests/unit/made_mask.h"

enum { N = 48 };

static uint32_t state_of_random;

/* Uniform in low..high. */
static double random_in(double low, double high)
{
    state_of_random = state_of_random * 1664525u + 1013904223u;
    return low + (high - low) * (state_of_random >> 8) / (double)(1 << 24);
}

/* A polygon around a centre whose radius changes from point to point: simple, but not convex. */
struct star {
    double xy[2 * N], x, y;
};

static struct star star_make(double x, double y, double least_mm, double most_mm)
{
    struct star star = { .x = x, .y = y };
    for (int i = 0; i < N; i++) {
        double r = random_in(least_mm, most_mm), turn = 2 * MATH_PI * i / N;
        star.xy[2 * i] = x + r * cos(turn);
        star.xy[2 * i + 1] = y + r * sin(turn);
    }
    return star;
}

static struct star star_scaled(const struct star *from, double factor)
{
    struct star star = { .x = from->x, .y = from->y };
    for (int i = 0; i < N; i++) {
        star.xy[2 * i] = from->x + factor * (from->xy[2 * i] - from->x);
        star.xy[2 * i + 1] = from->y + factor * (from->xy[2 * i + 1] - from->y);
    }
    return star;
}

static double star_mm2(const struct star *star)
{
    double sum = 0;
    for (int i = 0, last = N - 1; i < N; last = i++)
        sum += star->xy[2 * last] * star->xy[2 * i + 1] - star->xy[2 * i] * star->xy[2 * last + 1];
    return fabs(sum) / 2;
}

static void add_star(struct contour_set *set, const struct star *star)
{
    contours_add(set, star->xy, N, 0);
}

enum copy { ROTATED, REVERSED, SHIFTED, RESAMPLED, N_COPIES };

static void add_copy(struct contour_set *set, const struct star *star, enum copy copy)
{
    double xy[4 * N];
    int first = (int)random_in(1, N - 1);
    for (int i = 0; i < N; i++) {
        int from = copy == ROTATED ? (i + first) % N : copy == REVERSED ? N - 1 - i : i;
        xy[2 * i] = star->xy[2 * from] + (copy == SHIFTED ? 0.02 : 0);
        xy[2 * i + 1] = star->xy[2 * from + 1];
    }
    if (copy != RESAMPLED) {
        contours_add(set, xy, N, 0);
        return;
    }
    for (int i = 0; i < N; i++) { /* a point more on each edge */
        int next = (i + 1) % N;
        double t = random_in(0.2, 0.8);
        xy[4 * i] = star->xy[2 * i];
        xy[4 * i + 1] = star->xy[2 * i + 1];
        xy[4 * i + 2] = star->xy[2 * i] + t * (star->xy[2 * next] - star->xy[2 * i]);
        xy[4 * i + 3] = star->xy[2 * i + 1] + t * (star->xy[2 * next + 1] - star->xy[2 * i + 1]);
    }
    contours_add(set, xy, 2 * N, 0);
}

static bool has(const struct star *star, double x, double y)
{
    struct contour_set set = { 0 };
    add_star(&set, star);
    bool is_in = contours_enclose(&set, vec3(0, 0, 1), vec3(1, 0, 0), 1, vec3(x, y, 0));
    contour_set_finish(&set);
    return is_in;
}

static struct grid plane_grid(void)
{
    return grid_make(90, 70, 1, 1, 1, 1, vec3(-40.137, -35.211, 0));
}

/* Fills and compares every voxel; expected is called with its place. */
static struct contour_facts assert_fills(const struct contour_set *set,
                                         bool (*expected)(const struct star *stars, double x, double y),
                                         const struct star *stars)
{
    struct grid grid = plane_grid();
    struct contour_facts facts;
    struct mask *mask = contours_fill(set, &grid, &facts);
    for (uint32_t j = 0; j < grid.size[1]; j++)
        for (uint32_t i = 0; i < grid.size[0]; i++)
            assert_int_equal(mask_has(mask, i, j, 0), expected(stars, i - 40.137, j - 35.211));
    mask_destroy(mask);
    return facts;
}

static bool first_alone(const struct star *stars, double x, double y)
{
    return has(&stars[0], x, y);
}

static bool first_less_second(const struct star *stars, double x, double y)
{
    return has(&stars[0], x, y) && !has(&stars[1], x, y);
}

static bool nested(const struct star *stars, double x, double y)
{
    return first_less_second(stars, x, y) || has(&stars[2], x, y);
}

static bool either(const struct star *stars, double x, double y)
{
    return has(&stars[0], x, y) || has(&stars[1], x, y);
}

static void a_contour_given_again_fills_the_same_voxels(void **state)
{
    (void)state;
    for (state_of_random = 1; state_of_random < 6; state_of_random++)
        for (int copy = 0; copy < N_COPIES; copy++) {
            uint32_t seed = state_of_random;
            struct star star = star_make(0, 0, 15, 30);
            struct contour_set set = { 0 };
            add_star(&set, &star);
            add_copy(&set, &star, (enum copy)copy);
            add_copy(&set, &star, (enum copy)((copy + 1) % N_COPIES));
            struct contour_facts facts = assert_fills(&set, first_alone, &star);
            assert_int_equal(facts.n_repeated, 2);
            assert_int_equal(facts.n_overlap_planes, 0);
            assert_near(facts.polygon_cm3, star_mm2(&star) / 1000, 1e-9);
            assert_near(facts.outlines_cm3, star_mm2(&star) / 1000, 1e-9);
            contour_set_finish(&set);
            state_of_random = seed;
        }
}

static void holes_and_islands_stay_whatever_is_given_again(void **state)
{
    (void)state;
    for (state_of_random = 1; state_of_random < 6; state_of_random++) {
        uint32_t seed = state_of_random;
        struct star stars[3] = { star_make(0, 0, 20, 34) };
        stars[1] = star_scaled(&stars[0], 0.6);
        stars[2] = star_scaled(&stars[0], 0.3);
        double ring_mm2 = star_mm2(&stars[0]) - star_mm2(&stars[1]);
        struct contour_set set = { 0 };
        add_copy(&set, &stars[1], REVERSED); /* the hole first */
        add_star(&set, &stars[1]);
        add_star(&set, &stars[0]);
        add_copy(&set, &stars[0], RESAMPLED);
        struct contour_facts facts = assert_fills(&set, first_less_second, stars);
        assert_near(facts.polygon_cm3, ring_mm2 / 1000, 1e-9);
        assert_near(facts.outlines_cm3, ring_mm2 / 1000, 1e-9);
        add_star(&set, &stars[2]);
        facts = assert_fills(&set, nested, stars);
        assert_near(facts.outlines_cm3, (ring_mm2 + star_mm2(&stars[2])) / 1000, 1e-9);
        assert_int_equal(facts.n_overlap_planes, 0);
        contour_set_finish(&set);
        state_of_random = seed;
    }
}

static void contours_that_partly_overlap_are_a_union(void **state)
{
    (void)state;
    for (state_of_random = 1; state_of_random < 6; state_of_random++) {
        uint32_t seed = state_of_random;
        struct star stars[2] = { star_make(-10, 0, 14, 24), star_make(12, 3, 14, 24) };
        struct contour_set set = { 0 };
        add_star(&set, &stars[0]);
        add_star(&set, &stars[1]);
        add_copy(&set, &stars[1], REVERSED);
        struct contour_facts facts = assert_fills(&set, either, stars);
        assert_int_equal(facts.n_overlap_planes, 1);
        assert_int_equal(facts.n_repeated, 1);
        assert_near(facts.polygon_cm3, facts.filled_cm3, 0.02); /* 1 mm voxels: 100 mm of outline, 1500 mm2 */
        assert_near(facts.outlines_cm3, (star_mm2(&stars[0]) + star_mm2(&stars[1])) / 1000, 1e-9);
        contour_set_finish(&set);
        state_of_random = seed;
    }
}

static bool ring_and_neighbour(const struct star *stars, double x, double y)
{
    return first_less_second(stars, x, y) || has(&stars[2], x, y);
}

static void a_hole_stays_beside_an_overlap(void **state)
{
    (void)state;
    state_of_random = 7;
    struct star stars[3] = { star_make(-12, 0, 22, 26), star_make(-14, 2, 4, 8), star_make(14, 0, 12, 16) };
    struct contour_set set = { 0 };
    for (int i = 0; i < 3; i++)
        add_star(&set, &stars[i]);
    struct contour_facts facts = assert_fills(&set, ring_and_neighbour, stars);
    assert_int_equal(facts.n_overlap_planes, 1);
    assert_near(facts.polygon_cm3, facts.filled_cm3, 0.02);
    contour_set_finish(&set);
}

/* Radii of the second circle, and whether it is a hole: a copy 0.3 mm off is none; a wall of 1 mm is. */
static void a_thin_wall_is_a_wall_and_a_copy_that_is_off_is_a_copy(void **state)
{
    (void)state;
    static const struct {
        double r, shift_mm;
        size_t n;
        bool is_hole;
    } others[] = { { 24.7, 0, 60, false }, { 25, 0.3, 60, false }, { 25, 0, 12, false }, { 25.3, 0.1, 60, false },
                   { 24, 0, 60, true },    { 23, 0.5, 60, true },  { 12, 13, 60, true } };
    struct grid grid = plane_grid();
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        struct contour_set set = { 0 };
        contours_add_circle(&set, 0, 0, 25, 60, 0);
        contours_add_circle(&set, others[i].shift_mm, 0, others[i].r, others[i].n, 0);
        struct contour_facts facts;
        mask_destroy(contours_fill(&set, &grid, &facts));
        double hole_mm2 = others[i].is_hole ? circle_mm2(others[i].r, others[i].n) : 0;
        assert_near(facts.polygon_cm3, (circle_mm2(25, 60) - hole_mm2) / 1000, 1e-6);
        assert_int_equal(facts.n_repeated, !others[i].is_hole);
        contour_set_finish(&set);
    }
}

static void a_keyhole_given_twice_keeps_its_hole(void **state)
{
    (void)state;
    const double xy[] = { -30, -30, 30, -29, 28, 30, -29, 28, -30, -30, -10, -10, -12, 12, 11, 10, 12, -11, -10, -10 };
    struct contour_set once = { 0 }, twice = { 0 };
    contours_add(&once, xy, 10, 0);
    contours_add(&twice, xy, 10, 0);
    double turned[20];
    for (int i = 0; i < 20; i++)
        turned[i] = xy[(i + 6) % 20];
    contours_add(&twice, turned, 10, 0);
    struct grid grid = plane_grid();
    struct contour_facts facts;
    struct mask *a = contours_fill(&once, &grid, NULL), *b = contours_fill(&twice, &grid, &facts);
    assert_memory_equal(a->bits, b->bits, (size_t)a->words * a->size[1] * sizeof *a->bits);
    assert_int_equal(facts.n_repeated, 1);
    assert_near(facts.outlines_cm3, facts.filled_cm3, 0.02);
    mask_destroy(a);
    mask_destroy(b);
    contour_set_finish(&once);
    contour_set_finish(&twice);
}

static void exclusive_or_contours_are_combined_as_they_say(void **state)
{
    (void)state;
    struct grid grid = plane_grid();
    for (int n_xor = 1; n_xor <= 2; n_xor++) {
        struct contour_set set = { 0 };
        contours_add_box(&set, -20, -15, 5, 15, 0);
        contours_add_box(&set, -5, -15, 20, 15, 0);
        for (int i = 0; i < n_xor; i++)
            set.contours[i].is_xor = true;
        struct contour_facts facts;
        mask_destroy(contours_fill(&set, &grid, &facts));
        assert_near(facts.polygon_cm3, n_xor == 2 ? 0.9 : 1.2, 1e-9); /* 2 x 15 x 30, or 40 x 30 */
        contour_set_finish(&set);
    }
}

static void a_tilted_plane_combines_as_an_axial_one(void **state)
{
    (void)state;
    struct affine turn = rotation_of(0.3, -0.2, 0.4);
    struct contour_set set = { 0 };
    for (int k = 0; k < 8; k++) {
        contours_add_circle(&set, 0, 0, 20, 60, 2 * k);
        contours_add_circle(&set, 0.01, 0, 20, 70, 2 * k);
        contours_add_circle(&set, 0, 5, 8, 60, 2 * k);
    }
    contours_move(&set, &turn);
    struct grid grid = grid_make(60, 60, 60, 1, 1, 1, vec3(-30, -30, -20));
    struct contour_facts facts;
    mask_destroy(contours_fill(&set, &grid, &facts));
    assert_int_equal(facts.n_repeated, 8);
    assert_near(facts.polygon_cm3, (circle_mm2(20, 60) - circle_mm2(8, 60)) * 16 / 1000, 1e-6);
    assert_near(facts.filled_cm3, facts.outlines_cm3, 0.01);
    contour_set_finish(&set);
}

/* Some slices are doubled, and the copies lie 0.3 mm beside them along the normal. */
static void copies_beside_their_plane_are_moved_into_it(void **state)
{
    (void)state;
    struct grid grid = grid_make(60, 60, 20, 1, 1, 4, vec3(-30, -30, 0));
    for (int every = 1; every <= 3; every++) {
        struct contour_set set = { 0 };
        for (int k = 2; k < 16; k++) {
            contours_add_circle(&set, 0, 0, 20, 60, 4 * k);
            if (k % every == 0)
                contours_add_circle(&set, 0, 0, 20, 60, 4 * k + 0.3);
        }
        struct contour_facts facts;
        mask_destroy(contours_fill(&set, &grid, &facts));
        assert_int_equal(facts.n_planes, 14);
        assert_true(facts.n_close_planes > 0);
        assert_int_equal(facts.n_gaps, 0);
        assert_near(facts.filled_cm3, circle_mm2(20, 60) * 14 * 4 / 1000, 0.02);
        contour_set_finish(&set);
    }
}

static void planes_beside_the_slices_are_counted(void **state)
{
    (void)state;
    struct grid grid = grid_make(60, 60, 20, 1, 1, 3, vec3(-30, -30, 0));
    struct contour_set set = { 0 };
    for (int k = 2; k < 12; k++)
        contours_add_circle(&set, 0, 0, 20, 60, 3 * k + (k % 2 ? 1.2 : 0));
    struct contour_facts facts;
    mask_destroy(contours_fill(&set, &grid, &facts));
    assert_int_equal(facts.n_moved_planes, 5);
    assert_near(facts.moved_mm, 1.2, 1e-6);
    contour_set_finish(&set);
}

static void the_check_does_not_share_the_rule(void **state)
{
    (void)state;
    struct grid grid = plane_grid();
    struct contour_set set = { 0 };
    contours_add(&set, (double[]){ -20, -15, 20, 15, 20, -15, -20, 15 }, 4, 0); /* loops that turn against each other */
    struct contour_facts facts;
    mask_destroy(contours_fill(&set, &grid, &facts));
    assert_near(facts.filled_cm3, 0.6, 0.02);
    assert_close(facts.outlines_cm3, 0, 1e-9);
    contour_set_finish(&set);
}

static void too_many_to_compare_is_a_limit(void **state)
{
    (void)state;
    struct grid grid = plane_grid();
    struct contour_set set = { 0 };
    for (int i = 0; i < 1500; i++)
        contours_add_circle(&set, 0.004 * i, 0.003 * i, 10 + 0.012 * i, 40, 0);
    struct error err = { 0 };
    struct mask *mask = contour_fill(&set, &grid, &contour_defaults, NULL, &err);
    assert_null(mask);
    assert_int_equal(err.code, ERROR_LIMIT);
    contour_set_finish(&set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_contour_given_again_fills_the_same_voxels),
        cmocka_unit_test(holes_and_islands_stay_whatever_is_given_again),
        cmocka_unit_test(contours_that_partly_overlap_are_a_union),
        cmocka_unit_test(a_hole_stays_beside_an_overlap),
        cmocka_unit_test(a_thin_wall_is_a_wall_and_a_copy_that_is_off_is_a_copy),
        cmocka_unit_test(a_keyhole_given_twice_keeps_its_hole),
        cmocka_unit_test(exclusive_or_contours_are_combined_as_they_say),
        cmocka_unit_test(a_tilted_plane_combines_as_an_axial_one),
        cmocka_unit_test(copies_beside_their_plane_are_moved_into_it),
        cmocka_unit_test(planes_beside_the_slices_are_counted),
        cmocka_unit_test(the_check_does_not_share_the_rule),
        cmocka_unit_test(too_many_to_compare_is_a_limit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
