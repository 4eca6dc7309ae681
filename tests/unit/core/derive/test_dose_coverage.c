/* The univels of a region with a dose within limits: numbers and volumes against closed forms, at random offsets of the
 * grids. */
#include "core/derive/dose_coverage.h"
#include "core/scene/dose_coverage_choice.h"
#include "tests/check.h"
#include "tests/derived_of.h"
#include "tests/made_plan.h"

static struct vec3 centre_mm; /* of the ball and the box */
static struct vec3 gradient;  /* of the dose, per mm */
static const double level = 40, radius_mm = 20, inner_radius_mm = 8;
static const struct vec3 half_mm = { 13, 17, 11 }; /* of the box */

static double random_number(double low, double high)
{
    static uint32_t state = 20260;
    state = state * 1664525u + 1013904223u;
    return low + (high - low) * (state >> 8) / (double)(1 << 24);
}

static struct vec3 random_vector(double size)
{
    return vec3(random_number(-size, size), random_number(-size, size), random_number(-size, size));
}

static double linear_dose(struct vec3 p)
{
    return level + vec3_dot(gradient, vec3_sub(p, centre_mm));
}

static double ball_label(struct vec3 p)
{
    double distance = vec3_length(vec3_sub(p, centre_mm));
    return distance <= inner_radius_mm ? 2 : distance <= radius_mm ? 1 : 0;
}

static double box_label(struct vec3 p)
{
    struct vec3 d = vec3_sub(p, centre_mm);
    return fabs(d.x) <= half_mm.x && fabs(d.y) <= half_mm.y && fabs(d.z) <= half_mm.z;
}

/* A dose of one component, on a grid of its own. */
static void add_dose(struct plan *plan, const struct grid *grid, double (*value)(struct vec3))
{
    struct dose *dose = &plan->doses[plan->n_doses++];
    snprintf(dose->id, sizeof dose->id, "dose");
    snprintf(dose->unit, sizeof dose->unit, "Gy");
    dose->components[dose->n_components++] =
        (struct dose_component){ .quantity = DOSE_TOTAL, .values = made_volume(grid, VOXEL_F32, value) };
}

/* A turned grid of `side` voxels a side around the middle. */
static struct grid turned_grid(uint32_t side, double voxel_mm)
{
    const uint32_t size[3] = { side, side, side };
    double angle = random_number(0, 6), c = voxel_mm * cos(angle), s = voxel_mm * sin(angle);
    return made_grid(side, side, side,
                     made_affine(vec3(c, s, 0), vec3(s, -c, 0), vec3(0, 0, 1.1 * voxel_mm), size,
                                 random_vector(voxel_mm)));
}

static struct grid straight_grid(uint32_t side, double voxel_mm)
{
    const uint32_t size[3] = { side, side, side };
    return made_grid(side, side, side,
                     made_affine(vec3(voxel_mm, 0, 0), vec3(0, voxel_mm, 0), vec3(0, 0, voxel_mm), size,
                                 random_vector(voxel_mm)));
}

static const struct made_region ball_regions[] = { { "ball", -1, 0xff0000 }, { "core", 0, 0x00ff00 } };
static const struct made_region box_region = { "box", -1, 0xff0000 };

/* The shown quantity of the file's own dose, everywhere. */
static struct dose_coverage_choice choice_of(size_t region, double low, double high)
{
    struct dose_coverage_choice choice;
    memset(&choice, 0, sizeof choice);
    choice.dose.n_parts = 1;
    choice.dose.parts[0].factor = 1;
    choice.dose.shown = DOSE_SHOWN_QUANTITY;
    choice.dose.quantity = DOSE_TOTAL;
    choice.dose.n_rows = 1;
    choice.dose.is_everywhere = true;
    choice.region = region;
    choice.population = POPULATION_WHOLE;
    choice.low = low;
    choice.high = high;
    return choice;
}

static struct dose_coverage *coverage_of(const struct plan *plan, const struct dose_coverage_choice *choice)
{
    struct error err = { 0 };
    struct dose_coverage *coverage = dose_coverage_get(derived_of(plan), choice, &err);
    if (!coverage)
        fail_msg("%s", err.text);
    return coverage;
}

/* Volume of the part of a ball that lies farther than h from its middle along one direction, h -radius .. radius. */
static double cap_mm3(double h)
{
    h = fmin(fmax(h, -radius_mm), radius_mm);
    return M_PI * (radius_mm - h) * (radius_mm - h) * (2 * radius_mm + h) / 3;
}

static void of_a_ball_in_a_linear_dose_a_layer_between_two_planes_is_within_limits(void **state)
{
    (void)state;
    for (int test = 0; test < 6; test++) {
        centre_mm = random_vector(3);
        gradient = random_vector(2);
        struct grid grid = test % 2 ? turned_grid(52, 1) : straight_grid(52, 1), doses = turned_grid(40, 2.3);
        struct plan *plan = made_plan(&grid, ball_label, ball_regions, 2);
        add_dose(plan, &doses, linear_dose);
        double slope = vec3_length(gradient), near_mm = random_number(-25, 15), far_mm = random_number(near_mm, 25);
        struct dose_coverage_choice choice = choice_of(0, test == 4 ? -INFINITY : level + slope * near_mm,
                                                       test == 5 ? INFINITY : level + slope * far_mm);
        struct dose_coverage *coverage = coverage_of(plan, &choice);
        double expected_mm3 = cap_mm3(test == 4 ? -radius_mm : near_mm) - cap_mm3(test == 5 ? radius_mm : far_mm);
        double ball_mm3 = cap_mm3(-radius_mm);
        /* the child's univels count; a univel on each side of the surface is taken or left by its centre */
        assert_near((double)coverage->n_region * grid_voxel_mm3(&grid), ball_mm3, 0.005);
        assert_close(coverage->volume_cm3 * 1000, expected_mm3, 0.005 * ball_mm3);
        assert_close(coverage->share, expected_mm3 / ball_mm3, 0.005);
        assert_int_equal(coverage->n_without, 0);
        derive_result_unref(&coverage->base);
        plan_and_derived_destroy(plan);
    }
}

/* The dose changes along one axis, so the part within limits is a box with known univels. */
static void of_a_box_the_univels_within_limits_are_known_one_by_one(void **state)
{
    (void)state;
    for (int test = 0; test < 4; test++) {
        centre_mm = random_vector(3);
        gradient = vec3(0, 0, 0.5 + test);
        struct grid grid = straight_grid(44, 0.9), doses = turned_grid(40, 1.7);
        struct plan *plan = made_plan(&grid, box_label, &box_region, 1);
        add_dose(plan, &doses, linear_dose);
        const double low = level + gradient.z * -4.2, high = level + gradient.z * 6.7;
        struct dose_coverage_choice choice = choice_of(0, low, high);
        struct dose_coverage *coverage = coverage_of(plan, &choice);
        uint64_t n = 0, n_region = 0;
        for (uint32_t k = 0; k < 44; k++)
            for (uint32_t j = 0; j < 44; j++)
                for (uint32_t i = 0; i < 44; i++) {
                    struct vec3 p = affine_point(&grid.lps_mm_from_ijk, vec3(i, j, k));
                    double z = p.z - centre_mm.z;
                    bool is_in = box_label(p) > 0, is_within = is_in && z >= -4.2 && z < 6.7;
                    uint32_t at[3];
                    bool is_held = volume_voxel_at(coverage->labels, p, at);
                    assert_true(is_held || !is_in);
                    assert_int_equal(is_held && volume_label(coverage->labels, at[0], at[1], at[2]), is_within);
                    n += is_within;
                    n_region += is_in;
                }
        assert_int_equal(coverage->n, n);
        assert_int_equal(coverage->n_region, n_region);
        assert_near(coverage->volume_cm3, (double)n * 0.9 * 0.9 * 0.9 / 1000, 1e-9);
        assert_near(coverage->share, (double)n / (double)n_region, 1e-12);
        derive_result_unref(&coverage->base);
        plan_and_derived_destroy(plan);
    }
}

static double half_a_dose(struct vec3 p)
{
    return p.x < centre_mm.x ? linear_dose(p) : NAN;
}

/* Under a hole of the dose's grid and beside the grid there is no value, which no limit holds, not even none. */
static void univels_without_a_value_are_counted_apart(void **state)
{
    (void)state;
    centre_mm = vec3(0.3, -0.2, 0.1);
    gradient = vec3(0, 1, 0);
    const double voxel_mm = 0.8;
    struct grid grid = straight_grid(60, voxel_mm);
    const uint32_t size[3] = { 50, 50, 10 };
    struct grid doses = made_grid(50, 50, 10,
                                  made_affine(vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1), size,
                                              vec3(0.25, -0.15, 0.4))); /* z: -4.6 .. 5.4 */
    struct plan *plan = made_plan(&grid, box_label, &box_region, 1);
    add_dose(plan, &doses, half_a_dose);
    struct dose_coverage_choice choice = choice_of(0, -INFINITY, INFINITY);
    struct dose_coverage *all = coverage_of(plan, &choice);
    choice.low = level; /* half of what has a value */
    struct dose_coverage *upper = coverage_of(plan, &choice);
    /* The last dose voxel with a value is centred at x = -0.25: a univel has a value up to there. */
    uint64_t n_with = 0, n_upper = 0, n_region = 0;
    for (uint32_t k = 0; k < 60; k++)
        for (uint32_t j = 0; j < 60; j++)
            for (uint32_t i = 0; i < 60; i++) {
                struct vec3 p = affine_point(&grid.lps_mm_from_ijk, vec3(i, j, k));
                bool is_with = box_label(p) > 0 && p.x <= -0.25 && p.z >= -4.6 && p.z < 5.4;
                n_region += box_label(p) > 0;
                n_with += is_with;
                n_upper += is_with && p.y >= centre_mm.y;
            }
    assert_true(n_with > 1000 && n_with < n_region / 3);
    assert_int_equal(all->n, n_with);
    assert_int_equal(all->n_without, n_region - n_with);
    assert_near(all->share, 1, 1e-12);
    assert_int_equal(upper->n, n_upper);
    assert_int_equal(upper->n_without, n_region - n_with);
    assert_near(upper->share, (double)n_upper / (double)n_with, 1e-12);
    assert_near(upper->least_share, (double)n_upper / (double)n_region, 1e-12);
    assert_near(upper->most_share, (double)(n_upper + n_region - n_with) / (double)n_region, 1e-12);
    derive_result_unref(&all->base);
    derive_result_unref(&upper->base);
    plan_and_derived_destroy(plan);
}

static void a_value_equal_to_the_lower_limit_is_within_and_to_the_upper_one_is_not(void **state)
{
    (void)state;
    centre_mm = gradient = vec3(0, 0, 0); /* the dose is `level` everywhere; on one grid nothing is interpolated */
    struct grid grid = made_cube_grid(31);
    struct plan *plan = made_plan(&grid, ball_label, ball_regions, 2);
    add_dose(plan, &grid, linear_dose);
    const double limits[3][2] = { { level, INFINITY }, { 0, level }, { level, level } };
    for (int i = 0; i < 3; i++) {
        struct dose_coverage_choice choice = choice_of(1, limits[i][0], limits[i][1]);
        struct dose_coverage *coverage = coverage_of(plan, &choice);
        assert_int_equal(coverage->n, i == 0 ? coverage->n_region : 0);
        derive_result_unref(&coverage->base);
    }
    plan_and_derived_destroy(plan);
}

static void what_cannot_be_counted_is_refused(void **state)
{
    (void)state;
    centre_mm = vec3(500, 0, 0); /* both regions are empty */
    gradient = vec3(0, 0, 1);
    struct grid grid = straight_grid(20, 1);
    struct plan *plan = made_plan(&grid, ball_label, ball_regions, 2);
    add_dose(plan, &grid, linear_dose);
    struct error err = { 0 };
    struct dose_coverage_choice choice = choice_of(0, 1, 2);
    assert_null(dose_coverage_get(derived_of(plan), &choice, &err));
    assert_int_equal(err.code, ERROR_NOT_FOUND);
    assert_non_null(strstr(err.text, "ball"));
    choice.low = NAN;
    assert_null(dose_coverage_get(derived_of(plan), &choice, &err));
    assert_int_equal(err.code, ERROR_RANGE);
    choice = choice_of(2, 1, 2);
    assert_null(dose_coverage_get(derived_of(plan), &choice, &err));
    assert_int_equal(err.code, ERROR_RANGE);
    plan_and_derived_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(of_a_ball_in_a_linear_dose_a_layer_between_two_planes_is_within_limits),
        cmocka_unit_test(of_a_box_the_univels_within_limits_are_known_one_by_one),
        cmocka_unit_test(univels_without_a_value_are_counted_apart),
        cmocka_unit_test(a_value_equal_to_the_lower_limit_is_within_and_to_the_upper_one_is_not),
        cmocka_unit_test(what_cannot_be_counted_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
