/* A field that is combined where it is read: each part equals the sums by hand, whatever is asked for first and by how
 * many threads; and dragging a value keeps no old fields. */
#include "core/base/parallel.h"
#include "core/derive/dose_field.h"
#include "tests/check.h"
#include "tests/derived_of.h"
#include "tests/made_plan.h"

static double chance(void)
{
    static uint32_t state = 99;
    state = state * 1664525u + 1013904223u;
    return (double)(state >> 8) / (1 << 24);
}

/* Whole numbers, so that an image of integers holds them exactly. */
static double boron(struct vec3 p)
{
    return floor(50 + 20 * sin(0.3 * p.x) * cos(0.2 * p.y));
}
static double nitrogen(struct vec3 p)
{
    return floor(90 + 40 * cos(0.25 * p.z) + p.x);
}
static double fast(struct vec3 p)
{
    return floor(40 + p.y + 10 * sin(0.2 * p.z));
}
static double label(struct vec3 p)
{
    return vec3_length(p) < 22 ? 2 : fabs(p.x) < 55 && fabs(p.y) < 30 && fabs(p.z) < 30 ? 1 : 0;
}
static double valid(struct vec3 p)
{
    return p.x + p.y < 40;
}
static const struct made_region regions[] = { { "body", -1, 0xffffff }, { "core", 0, 0xff0000 } };

/* Components of three types of voxel, one with a scale; the dose's grid is turned against the regions'. */
static struct plan *make_plan(bool has_mask)
{
    const uint32_t sizes[2][3] = { { 120, 70, 66 }, { 150, 61, 53 } };
    struct grid labels =
        made_grid(120, 70, 66, made_affine(vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1), sizes[0], vec3(0, 0, 0)));
    struct grid grid = made_grid(150, 61, 53,
                                 made_affine(vec3(0.8, 0.1, 0), vec3(-0.1, 1.1, 0), vec3(0, 0.1, -1.2), sizes[1],
                                             vec3(0.3, 0.2, -0.4)));
    struct plan *plan = made_plan(&labels, label, regions, 2);
    struct dose *dose = &plan->doses[plan->n_doses++];
    snprintf(dose->id, sizeof dose->id, "d");
    snprintf(dose->unit, sizeof dose->unit, "Gy");
    dose->components[0] = (struct dose_component){ .quantity = DOSE_BORON,
                                                   .is_per_ppm = true,
                                                   .values = made_volume(&grid, VOXEL_F32, boron) };
    dose->components[1] =
        (struct dose_component){ .quantity = DOSE_NITROGEN, .values = made_volume(&grid, VOXEL_I16, nitrogen) };
    dose->components[2] =
        (struct dose_component){ .quantity = DOSE_FAST, .values = made_volume(&grid, VOXEL_U8, fast) };
    dose->components[1].values->slope = 0.5;
    dose->components[1].values->offset = 3;
    dose->n_components = 3;
    if (has_mask)
        dose->mask = made_volume(&grid, VOXEL_U8, valid);
    return plan;
}

enum { CBE_A = 2, CBE_B = 3, FAST_B = 4 };
static struct dose_choice choice_of(double blood_ppm)
{
    struct dose_choice choice;
    memset(&choice, 0, sizeof choice);
    choice.parts[0].factor = 1;
    choice.n_parts = 1;
    choice.shown = DOSE_SHOWN_WEIGHTED;
    choice.blood_ppm = blood_ppm;
    choice.n_rows = 2;
    choice.rows[0] = (struct tissue_weights){ 1, CBE_A, 1, 1, 1, 1 };
    choice.rows[1] = (struct tissue_weights){ 1, CBE_B, 1, FAST_B, 1, 1 };
    memset(choice.row_of_region, DOSE_NO_ROW, sizeof choice.row_of_region);
    choice.row_of_region[0] = 0;
    choice.row_of_region[1] = 1;
    return choice;
}

/* The sum at a voxel, calculated here; not a number where the mask is 0. */
static double sum_at(const struct plan *plan, double ppm, size_t row, const uint32_t at[3])
{
    const struct dose *dose = &plan->doses[0];
    double parts[3];
    for (size_t c = 0; c < 3; c++)
        parts[c] = volume_value(dose->components[c].values, at[0], at[1], at[2]);
    if (dose->mask && volume_label(dose->mask, at[0], at[1], at[2]) == 0)
        return NAN;
    return row == 0 ? CBE_A * ppm * parts[0] + parts[1] + parts[2]
                    : CBE_B * ppm * parts[0] + parts[1] + FAST_B * parts[2];
}

static void the_whole_is_the_sum_of_its_components_at_each_voxel(void **state)
{
    (void)state;
    for (int has_mask = 0; has_mask < 2; has_mask++) {
        struct plan *plan = make_plan(has_mask);
        struct error err = { 0 };
        struct dose_choice choice = choice_of(7);
        struct dose_field *field = dose_field_get(derived_of(plan), &choice, &err);
        assert_string_equal(err.text, "");
        const struct grid *grid = &field->rows[0]->grid;
        for (size_t row = 0; row < 2; row++) {
            double low = INFINITY, high = -INFINITY;
            for (uint32_t k = 0; k < grid->size[2]; k++)
                for (uint32_t j = 0; j < grid->size[1]; j++)
                    for (uint32_t i = 0; i < grid->size[0]; i++) {
                        double found = volume_value(field->rows[row], i, j, k),
                               expected = sum_at(plan, 7, row, (uint32_t[3]){ i, j, k });
                        if (isnan(expected) != isnan(found) || fabs(found - expected) > 1e-3)
                            fail_msg("voxel %u %u %u of row %zu is %g, expected %g", i, j, k, row, found, expected);
                        low = fmin(low, found);
                        high = fmax(high, found);
                    }
            assert_close(field->rows[row]->low, low, 0);
            assert_close(field->rows[row]->high, high, 0);
        }
        derive_result_unref(&field->base);
        plan_and_derived_destroy(plan);
    }
}

/* The value at a point of a tissue, from the sums at its voxels by hand. */
static void expect_sum(const struct plan *plan, const struct dose_field *field, double ppm, struct vec3 p)
{
    uint8_t row = dose_field_row(field, p);
    const struct grid *grid = &field->rows[0]->grid;
    struct vec3 at = affine_point(&grid->ijk_from_lps_mm, p);
    const double index[3] = { at.x, at.y, at.z };
    double expected = 0, found;
    for (int axis = 0; axis < 3; axis++)
        if (!(index[axis] > -0.5 && index[axis] < grid->size[axis] - 0.5) || row == DOSE_NO_ROW)
            return;
    for (int corner = 0; corner < 8; corner++) {
        double share = 1;
        uint32_t voxel[3];
        for (int axis = 0; axis < 3; axis++) {
            double inside = fmin(fmax(index[axis], 0), grid->size[axis] - 1.0), low = floor(inside);
            bool is_high = corner >> axis & 1;
            share *= is_high ? inside - low : 1 - (inside - low);
            voxel[axis] = (uint32_t)fmin(low + is_high, grid->size[axis] - 1.0);
        }
        expected += share > 0 ? share * sum_at(plan, ppm, row, voxel) : 0;
    }
    bool has_value = volume_sample(field->rows[row], p, &found);
    if (isnan(expected))
        assert_false(has_value);
    else if (!has_value || fabs(found - expected) > 2e-3)
        fail_msg("(%g, %g, %g): %g, expected %g", p.x, p.y, p.z, has_value ? found : NAN, expected);
}

static struct vec3 any_point(double half_mm)
{
    return vec3(half_mm * (2 * chance() - 1), half_mm * (2 * chance() - 1), half_mm * (2 * chance() - 1));
}

static void parts_that_are_needed_are_there_in_any_order(void **state)
{
    (void)state;
    for (int round = 0; round < 12; round++) {
        struct plan *plan = make_plan(round % 2);
        for (int drag = 0; drag < 4; drag++) { /* on memory of older fields, which hold other values */
            struct error err = { 0 };
            struct dose_choice choice = choice_of(3 + drag);
            struct dose_field *field = dose_field_begin(derived_of(plan), &choice, &err);
            assert_string_equal(err.text, "");
            for (int part = 0; part < 4; part++) {
                struct vec3 point = any_point(20), normal = part == 0 ? vec3(0, 0, 1) : vec3_normalize(any_point(1));
                struct vec3 right = vec3_normalize(vec3_cross(normal, vec3(0.3, 0.9, 0.1))),
                            up = vec3_cross(normal, right);
                struct box3 box = { vec3_sub(point, vec3(9, 7, 5)), vec3_add(point, vec3(9, 7, 5)) };
                bool is_plane = part < 3;
                if (is_plane)
                    dose_field_need_plane(field, point, normal);
                else
                    dose_field_need_box(field, &box);
                for (int n = 0; n < 150; n++) {
                    double a = 120 * chance() - 60, b = 120 * chance() - 60;
                    struct vec3 on_plane = vec3_add(point, vec3_add(vec3_scale(right, a), vec3_scale(up, b)));
                    struct vec3 in_box =
                        vec3_add(point, vec3(9 * (2 * chance() - 1), 7 * (2 * chance() - 1), 5 * (2 * chance() - 1)));
                    expect_sum(plan, field, 3 + drag, is_plane ? on_plane : in_box);
                }
            }
            for (int n = 0; n < 50; n++) { /* without a call before */
                struct vec3 p = any_point(60);
                double value;
                if (dose_field_value(field, p, &value))
                    expect_sum(plan, field, 3 + drag, p);
            }
            derive_result_unref(&field->base);
        }
        plan_and_derived_destroy(plan);
    }
}

struct asking {
    struct plan *plan;
    struct dose_field *field;
    struct vec3 points[4], normals[4];
};

static void ask(void *context, int part, int n_parts)
{
    const struct asking *asking = context;
    (void)n_parts;
    for (int i = 0; i < 4; i++)
        dose_field_need_plane(asking->field, asking->points[(part + i) % 4], asking->normals[(part + i) % 4]);
}

static void several_threads_may_need_the_same_parts(void **state)
{
    (void)state;
    struct plan *plan = make_plan(false);
    for (int round = 0; round < 10; round++) {
        struct error err = { 0 };
        struct dose_choice choice = choice_of(5 + round);
        struct asking asking = { .plan = plan };
        asking.field = dose_field_begin(derived_of(plan), &choice, &err);
        for (int i = 0; i < 4; i++) {
            asking.points[i] = any_point(10);
            asking.normals[i] = vec3_normalize(any_point(1));
        }
        parallel_run(4, ask, &asking);
        for (int i = 0; i < 4; i++)
            expect_sum(plan, asking.field, 5 + round, asking.points[i]);
        struct dose_field *whole = dose_field_get(derived_of(plan), &choice, &err);
        assert_ptr_equal(whole, asking.field);
        for (int n = 0; n < 200; n++)
            expect_sum(plan, whole, 5 + round, any_point(60));
        derive_result_unref(&whole->base);
        derive_result_unref(&asking.field->base);
    }
    plan_and_derived_destroy(plan);
}

static void a_value_that_is_dragged_leaves_two_fields(void **state)
{
    (void)state;
    struct plan *plan = make_plan(false);
    struct once_cache_usage before = { 0 }, usage;
    struct error err = { 0 };
    uint64_t of_field = 0;
    for (int i = 0; i < 20; i++) {
        struct dose_choice choice = choice_of(i);
        struct dose_field *field = dose_field_get(derived_of(plan), &choice, &err);
        of_field = field->base.n_bytes;
        derive_result_unref(&field->base);
        derive_usage(derived_of(plan), &usage);
        if (i == 0)
            before = usage;
    }
    assert_int_equal(usage.n_results, before.n_results + 1);
    assert_int_equal(usage.n_bytes, before.n_bytes + of_field);
    /* another quantity takes the place of none */
    struct dose_choice choice = choice_of(19);
    choice.shown = DOSE_SHOWN_QUANTITY;
    choice.quantity = DOSE_BORON;
    struct dose_field *field = dose_field_get(derived_of(plan), &choice, &err);
    derive_usage(derived_of(plan), &usage);
    assert_int_equal(usage.n_results, before.n_results + 2);
    derive_result_unref(&field->base);
    plan_and_derived_destroy(plan);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_whole_is_the_sum_of_its_components_at_each_voxel),
        cmocka_unit_test(parts_that_are_needed_are_there_in_any_order),
        cmocka_unit_test(several_threads_may_need_the_same_parts),
        cmocka_unit_test(a_value_that_is_dragged_leaves_two_fields),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
