/* Two doses compared: difference, gamma index and their washes, in linear doses by closed forms. */
#include "core/render/visible/draw_compare.h"
#include "core/scene/dose_compare.h"
#include "tests/check.h"
#include "tests/derived_of.h"
#include "tests/made_plan.h"

static double label(struct vec3 p)
{
    return sqrt(vec3_dot(p, p)) < 20;
}
static const struct made_region regions[] = { { "body", -1, 0xffffff } };

/* Both doses rise by 2 Gy/mm along x; the second is shifted by 1.5 mm and has 0.03 Gy/mm more along y. */
static const double gradient = 2, shift = 1.5, slope = 0.03;
static double first_dose(struct vec3 p)
{
    return 60 + gradient * p.x;
}
static double second_dose(struct vec3 p)
{
    return 60 + gradient * (p.x - shift) + slope * p.y;
}

/* True if the univel that holds the point, of 1 mm with its centre at x.5, is one of the body. */
static bool is_in_body(struct vec3 p)
{
    return label(vec3(floor(p.x) + 0.5, floor(p.y) + 0.5, floor(p.z) + 0.5)) > 0;
}

/* Far off outside the body, as beside a couch or in air. */
static double wild_dose(struct vec3 p)
{
    double far_mm = sqrt(vec3_dot(p, p));
    return second_dose(p) + (far_mm > 26 ? 1000 : 0); /* the second dose's voxels are up to 2.5 mm apart */
}

static void add_dose(struct plan *plan, const char *id, const struct grid *grid, double (*value)(struct vec3))
{
    struct dose *dose = &plan->doses[plan->n_doses++];
    snprintf(dose->id, sizeof dose->id, "%s", id);
    snprintf(dose->unit, sizeof dose->unit, "Gy");
    dose->components[dose->n_components++] =
        (struct dose_component){ .quantity = DOSE_TOTAL, .values = made_volume(grid, VOXEL_F32, value) };
}

static struct plan *make_plan(void)
{
    const uint32_t sizes[2][3] = { { 14, 12, 10 }, { 33, 29, 31 } };
    struct grid univels = made_cube_grid(48);
    struct grid coarse =
        made_grid(14, 12, 10,
                  made_affine(vec3(3, 0, 0), vec3(0, 3.5, 0), vec3(0, 0, -4), sizes[0], vec3(0.37, -0.81, 1.13)));
    struct grid fine =
        made_grid(33, 29, 31,
                  made_affine(vec3(0, 2, 0), vec3(-2.5, 0, 0), vec3(0, 0, 2), sizes[1], vec3(-0.4, 0.6, 0.2)));
    struct plan *plan = made_plan(&univels, label, regions, 1);
    add_dose(plan, "one", &coarse, first_dose);
    add_dose(plan, "two", &fine, second_dose);
    return plan;
}

/* The plan's scene with dose "one" against "two", 100 % of 80 Gy. */
static struct snapshot *compare(struct plan *plan, enum scene_dose_comparison mode, const char *with)
{
    struct scene scene;
    struct view view = view_default;
    struct error err = { 0 };
    char field[128];
    scene_for_plan(plan, &scene);
    scene.dose.reference.kind = SCENE_DOSE_REFERENCE_KIND_VALUE;
    scene.dose.reference.value = 80;
    scene.dose.wash.opacity = 0.5;
    snprintf(scene.dose.compare.id, sizeof scene.dose.compare.id, "%s", with);
    scene.dose.compare.mode = mode;
    scene.dose.compare.span_percent = 5; /* 4 Gy */
    scene.dose.compare.distance_mm = 3;
    scene.dose.compare.dose_percent = 2.5; /* 2 Gy */
    struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 1, field, &err);
    assert_string_equal(err.text, "");
    return snapshot;
}

static struct dose_comparison *comparison_of(const struct snapshot *snapshot, bool is_gamma)
{
    struct dose_scale scale;
    struct dose_comparison_choice choice;
    struct error err = { 0 };
    assert_true(dose_scale_of(snapshot, &scale));
    assert_true(dose_compare_of(snapshot, &scale, is_gamma, &choice, &err));
    dose_scale_finish(&scale);
    struct dose_comparison *comparison = dose_comparison_get(snapshot->derived, &choice, &err);
    assert_string_equal(err.text, "");
    return comparison;
}

/* A linear dose on a grid and on another one that ends between its last two centres: equal wherever both are known.
 * Between the last centre and the outer face the second would be half a voxel of its gradient off: 2 Gy here. */
static void a_difference_has_no_edge_where_a_grid_ends(void **state)
{
    (void)state;
    const uint32_t sizes[2][3] = { { 21, 9, 9 }, { 10, 9, 9 } };
    struct grid univels = made_cube_grid(48);
    struct grid wide =
        made_grid(21, 9, 9, made_affine(vec3(1, 0, 0), vec3(0, 4, 0), vec3(0, 0, 4), sizes[0], vec3(0, 0, 0)));
    struct grid narrow =
        made_grid(10, 9, 9, made_affine(vec3(2, 0, 0), vec3(0, 4, 0), vec3(0, 0, 4), sizes[1], vec3(0, 0, 0)));
    struct plan *plan = made_plan(&univels, label, regions, 1);
    add_dose(plan, "one", &wide, first_dose);
    add_dose(plan, "two", &narrow, first_dose);
    struct snapshot *snapshot = compare(plan, SCENE_DOSE_COMPARISON_DIFFERENCE, "two");
    snapshot->scene.dose.compare.domain = SCENE_COMPARE_DOMAIN_GRID;
    snapshot->scene.dose.compare.threshold_percent = 0;
    struct dose_comparison *difference = comparison_of(snapshot, false);
    assert_close(difference->low, 0, 2e-5);
    assert_close(difference->high, 0, 2e-5);
    assert_int_equal(difference->n, 19 * 9 * 9); /* x from -9 to 9 mm */
    assert_int_equal(difference->n_without, 2 * 9 * 9);
    derive_result_unref(&difference->base);
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

/* The second dose is written in hundredths; the difference stays what it is, in the first one's unit. */
static void doses_of_two_units_are_compared_in_that_of_the_first(void **state)
{
    (void)state;
    double low[3], high[3];
    for (int i = 0; i < 3; i++) { /* both in Gy; the second in cGy; the first in cGy */
        struct plan *plan = make_plan();
        for (int d = 0; d < 2; d++) {
            struct volume *values = plan->doses[d].components[0].values;
            bool is_cgy = (i == 1 && d == 1) || (i == 2 && d == 0);
            if (!is_cgy)
                continue;
            snprintf(plan->doses[d].unit, sizeof plan->doses[d].unit, "cGy");
            for (size_t v = 0; v < grid_n_voxels(&values->grid); v++)
                ((float *)values->voxels)[v] *= 100;
            volume_measure(values);
        }
        struct snapshot *snapshot = compare(plan, SCENE_DOSE_COMPARISON_DIFFERENCE, "two");
        struct dose_comparison *difference = comparison_of(snapshot, false);
        assert_string_equal(difference->unit, i == 2 ? "cGy" : "Gy");
        low[i] = difference->low;
        high[i] = difference->high;
        derive_result_unref(&difference->base);
        snapshot_unref(snapshot);
        plan_and_derived_destroy(plan);
    }
    assert_close(low[1], low[0], 1e-4);
    assert_close(high[1], high[0], 1e-4);
    assert_close(low[2], 100 * low[0], 1e-2);
    assert_close(high[2], 100 * high[0], 1e-2);
}

static void a_difference_is_second_less_first_at_the_voxels_of_the_first(void **state)
{
    (void)state;
    struct plan *plan = make_plan();
    struct snapshot *snapshot = compare(plan, SCENE_DOSE_COMPARISON_DIFFERENCE, "two");
    struct dose_comparison *difference = comparison_of(snapshot, false);
    const struct volume *values = difference->values;
    double sum = 0;
    int n = 0, n_body = 0;
    assert_true(grid_is_same(&values->grid, &plan->doses[0].components[0].values->grid));
    assert_string_equal(difference->unit, "Gy");
    for (uint32_t at = 0; at < 14 * 12 * 10; at++) {
        struct vec3 p =
            affine_point(&values->grid.lps_mm_from_ijk, vec3(at % 14, (double)(at / 14 % 12), (double)(at / 168)));
        double expected = -gradient * shift + slope * p.y, found = (double)((const float *)values->voxels)[at];
        n_body += is_in_body(p);
        if (!is_in_body(p) || first_dose(p) < 8) {
            assert_true(isnan(found));
            continue;
        }
        assert_close(found, expected, 2e-5);
        sum += found;
        n++;
    }
    assert_int_equal(difference->n, n);
    assert_int_equal(difference->n_domain, n_body);
    assert_int_equal(difference->n_outside, 14 * 12 * 10 - n_body);
    assert_int_equal(difference->n_without, 0);
    assert_close(difference->mean, sum / n, 1e-6);
    derive_result_unref(&difference->base);
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

static void a_gamma_index_has_the_closed_form_of_a_shifted_gradient(void **state)
{
    (void)state;
    struct plan *plan = make_plan();
    struct snapshot *snapshot = compare(plan, SCENE_DOSE_COMPARISON_GAMMA, "two");
    struct dose_comparison *gamma = comparison_of(snapshot, true);
    size_t n = 0;
    for (uint32_t at = 0; at < 14 * 12 * 10; at++) {
        struct vec3 p = affine_point(&gamma->values->grid.lps_mm_from_ijk,
                                     vec3(at % 14, (double)(at / 14 % 12), (double)(at / 168)));
        double found = (double)((const float *)gamma->values->voxels)[at];
        if (!is_in_body(p) || first_dose(p) < 8) { /* 10 % of 80 */
            assert_true(isnan(found));
            continue;
        }
        n++;
        /* |D2 - D1| / sqrt(dD^2 + g^2 dr^2) of the second dose's gradient */
        double expected = fabs(-gradient * shift + slope * p.y) / hypot(2, hypot(gradient, slope) * 3);
        assert_true(found > expected - 1e-4 && found < expected + 0.0055);
    }
    assert_int_equal(gamma->gamma.n, n);
    assert_int_equal(gamma->gamma.n_passed, n);
    derive_result_unref(&gamma->base);
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

static void outside_the_body_nothing_is_compared_unless_asked(void **state)
{
    (void)state;
    struct plan *plan = make_plan();
    const struct grid fine = plan->doses[1].components[0].values->grid;
    add_dose(plan, "wild", &fine, wild_dose);
    for (int is_gamma = 0; is_gamma < 2; is_gamma++) {
        struct snapshot *snapshots[2] = { compare(plan, SCENE_DOSE_COMPARISON_DIFFERENCE, "two"),
                                          compare(plan, SCENE_DOSE_COMPARISON_DIFFERENCE, "wild") };
        struct dose_comparison *same = comparison_of(snapshots[0], is_gamma),
                               *wild = comparison_of(snapshots[1], is_gamma);
        assert_int_equal(wild->n, same->n);
        assert_int_equal(wild->gamma.n, same->gamma.n);
        assert_int_equal(wild->gamma.n_passed, same->gamma.n_passed);
        if (!is_gamma)
            assert_close(wild->root_mean_square, same->root_mean_square, 1e-9);
        derive_result_unref(&same->base);
        derive_result_unref(&wild->base);
        snapshot_unref(snapshots[0]);
        snapshots[1]->scene.dose.compare.domain = SCENE_COMPARE_DOMAIN_GRID;
        struct dose_comparison *all = comparison_of(snapshots[1], is_gamma);
        assert_int_equal(all->n_domain, 14 * 12 * 10);
        assert_int_equal(all->n_outside, 0);
        if (!is_gamma)
            assert_true(all->root_mean_square > 100);
        derive_result_unref(&all->base);
        snapshot_unref(snapshots[1]);
    }
    plan_and_derived_destroy(plan);
}

static void the_body_is_the_largest_region_with_those_inside_or_all_of_a_layer_of_organs(void **state)
{
    (void)state;
    struct region regions_of[4] = { { .name = "scalp", .parent = -1, .label = 1, .volume_cm3 = 300 },
                                    { .name = "brain", .parent = 0, .label = 2, .volume_cm3 = 1400 },
                                    { .name = "couch", .parent = -1, .label = 3, .volume_cm3 = 500 },
                                    { .name = "target", .parent = 1, .layer = 1, .label = 1, .volume_cm3 = 40 } };
    struct region_set set = { .n_layers = 2, .regions = regions_of, .n_regions = 4 };
    struct body body;
    char words[REGION_NAME_SIZE + 32];
    assert_true(body_find(&set, &body));
    assert_int_equal(body.layer, 0);
    assert_int_equal(body.region, 0);
    body_words(&set, &body, words);
    assert_string_equal(words, "scalp with the regions inside");
    for (int r = 0; r < 3; r++) {
        regions_of[r].parent = -1;
        regions_of[r].volume_cm3 = 100;
    }
    assert_true(body_find(&set, &body));
    assert_int_equal(body.region, -1);
    body_words(&set, &body, words);
    assert_string_equal(words, "all regions of the label layer");
    set.n_regions = 0;
    assert_false(body_find(&set, &body));
}

static void a_wash_of_differences_diverges_and_one_of_indices_parts_at_one(void **state)
{
    (void)state;
    struct plan *plan = make_plan();
    for (int is_gamma = 0; is_gamma < 2; is_gamma++) {
        struct snapshot *snapshot =
            compare(plan, is_gamma ? SCENE_DOSE_COMPARISON_GAMMA : SCENE_DOSE_COMPARISON_DIFFERENCE, "two");
        struct draw_wash wash = { 0 };
        struct dose_scale scale;
        struct error err = { 0 };
        float color[4];
        assert_true(draw_compare_is_asked(&snapshot->scene.dose));
        assert_true(dose_scale_of(snapshot, &scale));
        assert_true(draw_compare_fill(&wash, snapshot, &scale, &err));
        assert_true(draw_wash_at(&wash, vec3(1, 2, 3), color));
        /* the difference is -2.94 of 4 Gy: from 0xf7f7f7 (opacity 0.1) towards 0x2166ac (1); opacity 0.5 of the wash */
        double part = is_gamma ? 2.94 / hypot(2, hypot(gradient, slope) * 3) : 2.94 / 4;
        double red = is_gamma ? 0x21 + part * (0x92 - 0x21) : 0xf7 + part * (0x21 - 0xf7),
               opacity = is_gamma ? 0.35 + part * 0.65 : 0.1 + part * 0.9;
        assert_close(color[0], red / 255, 0.005);
        assert_close(color[3], 0.5 * opacity, 0.005);
        assert_false(draw_wash_at(&wash, vec3(80, 0, 0), color)); /* beyond the grid */
        derive_result_unref(wash.source);
        dose_scale_finish(&scale);
        snapshot_unref(snapshot);
    }
    plan_and_derived_destroy(plan);
}

static double half_a_gray(struct vec3 p)
{
    (void)p;
    return 0.5;
}

static void the_wash_of_an_error_shows_it_in_percent_of_the_value(void **state)
{
    (void)state;
    struct plan *plan = make_plan();
    for (int has_error = 0; has_error < 2; has_error++) {
        struct dose_component *component = &plan->doses[0].components[0];
        if (has_error)
            component->error = made_volume(&component->values->grid, VOXEL_F32, half_a_gray);
        struct snapshot *snapshot = compare(plan, SCENE_DOSE_COMPARISON_NONE, "");
        struct draw_wash wash = { 0 };
        struct error err = { 0 };
        float color[4];
        assert_int_equal(draw_error_fill(&wash, snapshot, &err), has_error);
        assert_int_equal(err.code, has_error ? ERROR_NONE : ERROR_NOT_FOUND);
        if (has_error) {
            /* 0.5 Gy of 50 Gy: 1 %, a fifth of the way from 0xffffcc to 0xfecc5c; the percentage is tri-linear */
            assert_true(draw_wash_at(&wash, vec3(-5, 2, 3), color));
            assert_close(color[1], (0xff + 0.2 * (0xcc - 0xff)) / 255, 0.002);
            assert_close(color[3], 0.5, 1e-6);
            derive_result_unref(wash.source);
        }
        snapshot_unref(snapshot);
    }
    plan_and_derived_destroy(plan);
}

static void without_a_second_dose_there_is_a_sentence(void **state)
{
    (void)state;
    struct plan *plan = make_plan();
    struct snapshot *snapshot = compare(plan, SCENE_DOSE_COMPARISON_GAMMA, "");
    struct dose_scale scale;
    struct dose_comparison_choice choice;
    struct error err = { 0 };
    assert_false(draw_compare_is_asked(&snapshot->scene.dose));
    assert_true(dose_scale_of(snapshot, &scale));
    assert_false(dose_compare_of(snapshot, &scale, true, &choice, &err));
    assert_string_equal(err.text, "no second dose is chosen");
    dose_scale_finish(&scale);
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_difference_has_no_edge_where_a_grid_ends),
        cmocka_unit_test(doses_of_two_units_are_compared_in_that_of_the_first),
        cmocka_unit_test(a_difference_is_second_less_first_at_the_voxels_of_the_first),
        cmocka_unit_test(a_gamma_index_has_the_closed_form_of_a_shifted_gradient),
        cmocka_unit_test(a_wash_of_differences_diverges_and_one_of_indices_parts_at_one),
        cmocka_unit_test(the_wash_of_an_error_shows_it_in_percent_of_the_value),
        cmocka_unit_test(outside_the_body_nothing_is_compared_unless_asked),
        cmocka_unit_test(the_body_is_the_largest_region_with_those_inside_or_all_of_a_layer_of_organs),
        cmocka_unit_test(without_a_second_dose_there_is_a_sentence),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
