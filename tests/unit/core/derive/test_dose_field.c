/* Weighted sums of a dose by hand: which weights hold where, what is missing, where there is no value. */
#include "core/derive/dose_extremes.h"
#include "core/derive/dose_growth.h"
#include "core/scene/dose_scale.h"
#include "dose_presets.h"
#include "tests/check.h"
#include "tests/derived_of.h"
#include "tests/made_plan.h"

/* A head of radius 20 mm around the origin, in it a tumour of radius 8 mm; outside is air. */
static double label(struct vec3 p)
{
    double r = sqrt(vec3_dot(p, p));
    return r < 8 ? 2 : r < 20 ? 1 : 0;
}
static const struct made_region regions[] = { { "brain", -1, 0xffffff }, { "tumour", 0, 0xff0000 } };

static double boron(struct vec3 p)
{
    return 0.01 + 0.0001 * p.x;
}
static double nitrogen(struct vec3 p)
{
    return 0.02 + 0.0002 * p.y;
}
static double fast(struct vec3 p)
{
    return 0.03 - 0.0003 * p.z;
}
static double gamma_rays(struct vec3 p)
{
    return 0.4 + 0.001 * p.x + 0.002 * p.y;
}

static void add(struct dose *dose, enum dose_quantity quantity, const struct grid *grid, double (*value)(struct vec3))
{
    dose->components[dose->n_components++] = (struct dose_component){ .quantity = quantity,
                                                                      .is_per_ppm = quantity == DOSE_BORON,
                                                                      .values = made_volume(grid, VOXEL_F32, value) };
}

/* The dose's grid is coarse and shifted by parts of a univel against the regions'. */
static struct grid dose_grid(void)
{
    const uint32_t size[3] = { 12, 11, 10 };
    return made_grid(12, 11, 10,
                     made_affine(vec3(4, 0, 0), vec3(0, 5, 0), vec3(0, 0, -6), size, vec3(0.37, -0.81, 1.13)));
}

static struct plan *make_plan(void)
{
    struct grid grid = made_cube_grid(48), coarse = dose_grid();
    struct plan *plan = made_plan(&grid, label, regions, 2);
    struct dose *dose = &plan->doses[plan->n_doses++];
    snprintf(dose->id, sizeof dose->id, "mc");
    snprintf(dose->unit, sizeof dose->unit, "Gy");
    add(dose, DOSE_BORON, &coarse, boron);
    add(dose, DOSE_NITROGEN, &coarse, nitrogen);
    add(dose, DOSE_FAST, &coarse, fast);
    add(dose, DOSE_GAMMA, &coarse, gamma_rays);
    return plan;
}

/* The preset's weights (Barth et al. 2005) by hand. */
static double weighted(struct vec3 p, bool is_tumour, double blood_ppm)
{
    double ppm = blood_ppm * (is_tumour ? 3.5 : 1), cbe = is_tumour ? 3.8 : 1.3;
    return cbe * ppm * boron(p) + 3.2 * nitrogen(p) + 3.2 * fast(p) + gamma_rays(p);
}

static struct snapshot *show(struct plan *plan, const struct scene *wanted)
{
    struct scene scene = *wanted;
    struct view view = view_default;
    struct error err = { 0 };
    char field[128];
    struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 1, field, &err);
    assert_string_equal(err.text, "");
    return snapshot;
}

static void weights_are_those_of_the_tissue_at_the_point(void **state)
{
    (void)state;
    static const struct vec3 points[] = { { 1.3, -2.2, 3.1 }, { -12, 9.7, 4.4 }, { 7.4, 0.2, -0.3 }, { 0, 17, -5 } };
    static const double ppms[] = { 15, 0, 31.5 };
    struct plan *plan = make_plan();
    for (int p = 0; p < 3; p++) {
        struct scene scene;
        scene_for_plan(plan, &scene);
        assert_int_equal(scene.dose.quantity, SCENE_DOSE_QUANTITY_WEIGHTED);
        scene.dose.blood_ppm = ppms[p];
        struct snapshot *snapshot = show(plan, &scene);
        struct dose_scale scale;
        assert_true(dose_scale_of(snapshot, &scale));
        assert_string_equal(scale.field->unit, "Gy(w)");
        assert_int_equal(scale.field->missing, 0);
        for (size_t i = 0; i < sizeof points / sizeof *points; i++) {
            double value = 0;
            assert_true(dose_field_value(scale.field, points[i], &value));
            assert_close(value, weighted(points[i], label(points[i]) == 2, ppms[p]), 1e-6);
        }
        dose_scale_finish(&scale);
        snapshot_unref(snapshot);
    }
    plan_and_derived_destroy(plan);
}

static void one_tissue_can_hold_everywhere_also_in_air(void **state)
{
    (void)state;
    struct plan *plan = make_plan();
    struct scene scene;
    double value = 0;
    scene_for_plan(plan, &scene);
    snprintf(scene.dose.tissue, sizeof scene.dose.tissue, "brain");
    struct snapshot *snapshot = show(plan, &scene);
    struct dose_scale scale;
    assert_true(dose_scale_of(snapshot, &scale));
    const struct vec3 inside = vec3(1, 2, 3), air = vec3(21.5, 0, 0);
    assert_true(dose_field_value(scale.field, inside, &value));
    assert_close(value, weighted(inside, false, 15), 1e-6);
    assert_true(dose_field_value(scale.field, air, &value));
    assert_close(value, weighted(air, false, 15), 1e-6);
    dose_scale_finish(&scale);
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

static void there_is_no_value_in_air_outside_the_grid_and_under_the_mask(void **state)
{
    (void)state;
    struct plan *plan = make_plan();
    struct grid coarse = dose_grid();
    plan->doses[0].mask = made_volume(&coarse, VOXEL_U8, boron); /* 0 as a whole number */
    ((uint8_t *)plan->doses[0].mask->voxels)[0] = 1;
    struct scene scene;
    double value;
    scene_for_plan(plan, &scene);
    struct snapshot *snapshot = show(plan, &scene);
    struct dose_scale scale;
    assert_true(dose_scale_of(snapshot, &scale));
    assert_false(dose_field_value(scale.field, vec3(1, 2, 3), &value));
    assert_true(isnan(scale.reference));
    assert_true(scale.why_no_reference.code != ERROR_NONE);
    dose_scale_finish(&scale);
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);

    plan = make_plan();
    scene_for_plan(plan, &scene);
    snapshot = show(plan, &scene);
    assert_true(dose_scale_of(snapshot, &scale));
    assert_false(dose_field_value(scale.field, vec3(21.5, 0, 0), &value));
    assert_false(dose_field_value(scale.field, vec3(500, 0, 0), &value));
    dose_scale_finish(&scale);
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

static void a_sum_says_which_components_it_lacks(void **state)
{
    (void)state;
    struct plan *plan = make_plan();
    struct scene scene;
    volume_unref(plan->doses[0].components[1].values);
    plan->doses[0].components[1] = plan->doses[0].components[--plan->doses[0].n_components]; /* nitrogen goes */
    scene_for_plan(plan, &scene);
    struct snapshot *snapshot = show(plan, &scene);
    struct dose_scale scale;
    assert_true(dose_scale_of(snapshot, &scale));
    assert_int_equal(scale.field->missing, 1u << DOSE_NITROGEN);
    dose_scale_finish(&scale);
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

/* The largest of the univels' values, by hand over all of them. */
static void the_reference_is_what_the_scene_names(void **state)
{
    (void)state;
    struct plan *plan = make_plan();
    double body = 0, tumour = 0, sum = 0;
    size_t n = 0;
    const struct volume *labels = plan->regions.layers[0];
    for (uint32_t k = 0; k < 48; k++)
        for (uint32_t j = 0; j < 48; j++)
            for (uint32_t i = 0; i < 48; i++) {
                struct vec3 p = affine_point(&labels->grid.lps_mm_from_ijk, vec3(i, j, k));
                double value = label(p) > 0 ? weighted(p, label(p) == 2, 15) : 0;
                body = fmax(body, value);
                if (label(p) != 2)
                    continue;
                tumour = fmax(tumour, value);
                sum += value;
                n++;
            }
    const struct {
        enum scene_dose_reference_kind kind;
        double expected;
    } cases[] = { { SCENE_DOSE_REFERENCE_KIND_BODY, body },
                  { SCENE_DOSE_REFERENCE_KIND_REGION_MAX, tumour },
                  { SCENE_DOSE_REFERENCE_KIND_REGION_MEAN, sum / (double)n },
                  { SCENE_DOSE_REFERENCE_KIND_POINT, weighted(vec3(2, 3, -4), true, 15) },
                  { SCENE_DOSE_REFERENCE_KIND_VALUE, 12.5 } };
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        struct scene scene;
        scene_for_plan(plan, &scene);
        scene.dose.reference.kind = cases[c].kind;
        scene.dose.reference.point_mm = vec3(2, 3, -4);
        scene.dose.reference.value = 12.5;
        struct snapshot *snapshot = show(plan, &scene);
        struct dose_scale scale;
        assert_true(dose_scale_of(snapshot, &scale));
        assert_close(scale.reference, cases[c].expected, 2e-6 * cases[c].expected);
        assert_close(dose_level_value(&scale, SCENE_DOSE_UNIT_PERCENT, 90), 0.9 * scale.reference, 1e-12);
        assert_close(dose_level_value(&scale, SCENE_DOSE_UNIT_DOSE, 7.25), 7.25, 0);
        dose_scale_finish(&scale);
        snapshot_unref(snapshot);
    }
    plan_and_derived_destroy(plan);
}

/* Another frame of reference, or a grid that does not meet the patient: nothing is shown until it is accepted. */
static void a_dose_that_may_not_belong_waits_for_a_person(void **state)
{
    (void)state;
    for (int c = 0; c < 2; c++) {
        struct plan *plan = make_plan();
        if (c == 0) {
            plan->doses[0].has_frame = true;
            plan->doses[0].frame = DOSE_FRAME_DIFFERS;
        } else
            plan->doses[0].components[3].values->grid.lps_mm_from_ijk.origin.x += 4000;
        for (int accepted = 0; accepted < 2; accepted++) {
            struct scene scene;
            struct acceptance word = { .thing = "dose:mc", .with = "dose:mc", .by = "Anna" };
            struct acceptances words = { &word, 1 };
            struct view view = view_default;
            char field[128];
            struct error err = { 0 };
            scene_for_plan(plan, &scene);
            struct snapshot *snapshot =
                snapshot_create_accepted(derived_of(plan), &scene, &view, accepted ? &words : NULL, 1, field, &err);
            assert_non_null(snapshot);
            assert_int_equal(snapshot->has_dose_choice, accepted);
            assert_int_equal(snapshot->dose_why.code == ERROR_NONE, accepted);
            snapshot_unref(snapshot);
        }
        assert_int_equal(fit_alone(plan, (struct fit_part){ FIT_DOSE, 0 }).relation, c == 0 ? FIT_FRAME : FIT_APART);
        plan_and_derived_destroy(plan);
    }
}

/* Parts count by their factors, in the unit of the dose shown; a part whose unit does not convert is left out. */
static void doses_are_summed_with_their_factors(void **state)
{
    (void)state;
    static const struct {
        const char *unit;
        double gy;
    } cases[] = { { "Gy", 1 }, { "cGy", 0.01 }, { "MeV", 0 }, { "", 0 } };
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        struct plan *plan = make_plan();
        struct grid grid = made_cube_grid(50);
        struct dose *second = &plan->doses[plan->n_doses++];
        snprintf(second->id, sizeof second->id, "second");
        snprintf(second->unit, sizeof second->unit, "%s", cases[c].unit);
        add(second, DOSE_GAMMA, &grid, fast);
        struct scene scene;
        scene_for_plan(plan, &scene);
        scene.dose.quantity = SCENE_DOSE_QUANTITY_GAMMA;
        scene.dose.factor = 2;
        scene.dose.n_sum = 1;
        scene.dose.sum = mem_new(sizeof *scene.dose.sum);
        snprintf(scene.dose.sum[0].id, sizeof scene.dose.sum[0].id, "second");
        scene.dose.sum[0].value.factor = 30;
        struct snapshot *snapshot = show(plan, &scene);
        struct dose_scale scale;
        assert_true(dose_scale_of(snapshot, &scale));
        const struct vec3 p = vec3(3.3, -4.1, 6.6);
        double value = 0;
        assert_int_equal(scale.field->is_resampled, cases[c].gy > 0);
        assert_string_equal(scale.field->unit, "Gy");
        assert_true(dose_field_value(scale.field, p, &value));
        assert_close(value, 2 * gamma_rays(p) + 30 * cases[c].gy * fast(p), 1e-6);
        dose_scale_finish(&scale);
        snapshot_unref(snapshot);
        plan_and_derived_destroy(plan);
    }
}

/* A tissue without parameters has no isoeffective dose. In the others it is that of the physical doses at the point,
 * computed apart; cGy are not Gy. */
static void the_isoeffective_dose_is_that_of_the_physical_doses_there(void **state)
{
    (void)state;
    const struct isoeffective_set *set = &isoeffective_sets[0];
    for (int is_cgy = 0; is_cgy < 2; is_cgy++) {
        struct plan *plan = make_plan();
        double value = 0, gy = is_cgy ? 0.01 : 1;
        snprintf(plan->doses[0].unit, sizeof plan->doses[0].unit, is_cgy ? "cGy" : "Gy");
        struct scene scene;
        scene_for_plan(plan, &scene);
        scene.dose.quantity = SCENE_DOSE_QUANTITY_ISOEFFECTIVE;
        scene.dose.factor = 8;
        scene.dose.irradiation_min = 45;
        snprintf(scene.dose.weights[1].value.isoeffective, sizeof scene.dose.weights[1].value.isoeffective, "%s",
                 set->name);
        struct snapshot *snapshot = show(plan, &scene);
        struct dose_scale scale;
        assert_true(dose_scale_of(snapshot, &scale));
        assert_string_equal(scale.field->unit, is_cgy ? "cGy(IsoE)" : "Gy(IsoE)");
        const struct vec3 p = affine_point(&scale.field->rows[0]->grid.lps_mm_from_ijk, vec3(5, 5, 5));
        assert_true(label(p) == 2);
        assert_true(dose_field_value(scale.field, p, &value));
        struct isoeffective prepared;
        isoeffective_init(&prepared, set, 45);
        double expected = isoeffective_dose(&prepared, 8 * 15 * 3.5 * boron(p) * gy, 8 * nitrogen(p) * gy,
                                            8 * fast(p) * gy, 8 * gamma_rays(p) * gy);
        assert_close(value, expected / gy, 1e-5 * expected / gy);
        assert_false(dose_field_value(scale.field, vec3(0, 15, 0), &value));
        dose_scale_finish(&scale);
        snapshot_unref(snapshot);
        plan_and_derived_destroy(plan);
    }
}

/* Steep as behind a beam's edge: a factor of up to 2.7 from voxel to voxel, each component along another axis. */
static double steep_boron(struct vec3 p)
{
    return 0.02 * exp(-p.x / 4);
}
static double steep_fast(struct vec3 p)
{
    return 0.3 * exp(p.y / 9);
}
static double steep_gamma(struct vec3 p)
{
    return p.x > 16 ? NAN : 2 * exp(-fabs(p.z) / 10);
}

/* The doses of the components at a point, each tri-linear between its voxels, then as one photon dose D of equal
 * effect: alpha D + beta Gr D^2 = E by bisection, E as core/dose/isoeffective.h defines it. False: there is none. */
static bool isoeffective_by_hand(const struct plan *plan, const struct isoeffective_set *set, double ppm, double output,
                                 double minutes, struct vec3 p, double *value)
{
    double d[3]; /* boron, fast, gamma */
    for (int c = 0; c < 3; c++)
        if (!volume_sample(plan->doses[0].components[c].values, p, &d[c]))
            return false;
    d[0] *= ppm;
    for (int c = 0; c < 3; c++)
        d[c] *= output;
    double tau[2] = { set->repair_fast_min, set->repair_slow_min }, g[2], g_photon[2];
    for (int i = 0; i < 2; i++) {
        double y = minutes / tau[i], x = set->photon_min / tau[i];
        g[i] = 2 / (y * y) * (y - 1 + exp(-y));
        g_photon[i] = 2 / (x * x) * (x - 1 + exp(-x));
    }
    const struct isoeffective_response *of[3] = { &set->boron, &set->fast, &set->photon };
    double effect = 0;
    for (int i = 0; i < 3; i++) {
        effect += of[i]->alpha * d[i];
        for (int j = 0; j < 3; j++) {
            double low = (i == 2) + (j == 2),
                   part = low == 2   ? set->low_let_fast_part
                          : low == 0 ? set->high_let_fast_part
                                     : set->high_let_fast_part +
                                           (set->low_let_fast_part - set->high_let_fast_part) * d[2] / (d[i] + d[j]);
            double gij = g[1] - part * (g[1] - g[0]);
            effect += gij * sqrt(of[i]->beta * of[j]->beta) * d[i] * d[j];
        }
    }
    double beta = set->photon.beta * (g_photon[1] - set->low_let_fast_part * (g_photon[1] - g_photon[0]));
    double from = 0, to = 1e4;
    for (int i = 0; i < 100; i++) {
        double middle = (from + to) / 2;
        *(set->photon.alpha * middle + beta * middle * middle < effect ? &from : &to) = middle;
    }
    *value = from;
    return true;
}

/* Brain and tumour in a steep dose; everywhere the parameters of one set. */
static struct plan *make_steep(const struct isoeffective_set *set, struct scene *scene)
{
    struct grid grid = made_cube_grid(48), coarse = dose_grid();
    struct plan *plan = made_plan(&grid, label, regions, 2);
    struct dose *dose = &plan->doses[plan->n_doses++];
    snprintf(dose->id, sizeof dose->id, "mc");
    snprintf(dose->unit, sizeof dose->unit, "Gy");
    add(dose, DOSE_BORON, &coarse, steep_boron);
    add(dose, DOSE_FAST, &coarse, steep_fast);
    add(dose, DOSE_GAMMA, &coarse, steep_gamma);
    scene_for_plan(plan, scene);
    scene->dose.quantity = SCENE_DOSE_QUANTITY_ISOEFFECTIVE;
    for (size_t i = 0; i < scene->dose.n_weights; i++) {
        snprintf(scene->dose.weights[i].value.isoeffective, sizeof scene->dose.weights[i].value.isoeffective, "%s",
                 set->name);
        scene->dose.weights[i].value.boron_ratio = 1;
    }
    return plan;
}

static void components_are_interpolated_and_then_mapped_and_rows_differ_by_no_more_than_they_say(void **state)
{
    (void)state;
    const struct isoeffective_set *set = &isoeffective_sets[4]; /* with a beta of its own for each component */
    const struct grid coarse = dose_grid();
    struct scene scene;
    struct plan *plan = make_steep(set, &scene);
    snprintf(scene.dose.tissue, sizeof scene.dose.tissue, "brain");
    struct snapshot *snapshot = show(plan, &scene);
    struct dose_scale scale;
    assert_true(dose_scale_of(snapshot, &scale));
    const struct dose_field *field = scale.field;
    assert_true(field->row_error > 0 && field->row_error <= 0.001);
    assert_true(grid_is_same(&field->grid, &coarse));
    assert_true(grid_n_voxels(&field->rows[0]->grid) > grid_n_voxels(&coarse));
    double highest = 0, worst_coarse = 0;
    for (int pass = 0; pass < 2; pass++) {
        srand(25);
        for (int test = 0; test < 20000; test++) {
            double at[3], expected, value, of_rows, corners = 0;
            for (int axis = 0; axis < 3; axis++)
                at[axis] = (rand() / (double)RAND_MAX * 1.04 - 0.02) * coarse.size[axis] - 0.5;
            struct vec3 p = affine_point(&coarse.lps_mm_from_ijk, vec3(at[0], at[1], at[2]));
            bool is_there =
                isoeffective_by_hand(plan, set, scene.dose.blood_ppm, 1, scene.dose.irradiation_min, p, &expected);
            assert_int_equal(dose_field_value(field, p, &value), is_there);
            assert_int_equal(volume_sample(field->rows[0], p, &of_rows), is_there);
            if (!is_there)
                continue;
            if (pass == 0) {
                highest = fmax(highest, expected);
                continue;
            }
            assert_close(value, expected, 2e-6 * expected + 1e-9);
            assert_close(of_rows, expected, 0.001 * fmax(expected, 0.01 * highest));
            /* what was wrong: mapped at the corners, then interpolated */
            bool has_all = true;
            for (int corner = 0; has_all && corner < 8; corner++) {
                double part = 1, to[3], mapped;
                for (int axis = 0; axis < 3; axis++) {
                    double low = floor(at[axis]), t = at[axis] - low;
                    to[axis] = low + (corner >> axis & 1);
                    part *= corner >> axis & 1 ? t : 1 - t;
                }
                has_all =
                    isoeffective_by_hand(plan, set, scene.dose.blood_ppm, 1, scene.dose.irradiation_min,
                                         affine_point(&coarse.lps_mm_from_ijk, vec3(to[0], to[1], to[2])), &mapped);
                corners += part * mapped;
            }
            if (has_all)
                worst_coarse = fmax(worst_coarse, fabs(corners / expected - 1));
        }
    }
    assert_true(worst_coarse > 0.02);
    dose_scale_finish(&scale);
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

/* At any output: the doses at the centres of a region's univels one by one. */
static void a_growing_dose_is_counted_at_each_univel(void **state)
{
    (void)state;
    const struct isoeffective_set *set = &isoeffective_sets[4];
    static const double outputs[] = { 0.25, 1, 20, 300 };
    struct scene scene;
    struct plan *plan = make_steep(set, &scene);
    struct snapshot *snapshot = show(plan, &scene);
    const struct grid grid = made_cube_grid(48);
    struct dose_choice choice;
    struct error err = { 0 };
    assert_true(dose_choice_of(snapshot, 0, SCENE_DOSE_QUANTITY_ISOEFFECTIVE, &choice, &err));
    for (int region = 0; region < 2; region++) {
        struct dose_growth *growth =
            dose_growth_create(snapshot->derived, &choice, (size_t)region, POPULATION_OWN, &err);
        assert_non_null(growth);
        for (size_t o = 0; o < sizeof outputs / sizeof *outputs; o++) {
            struct dvh dvh;
            double n = 0, n_missing = 0, sum = 0, low = INFINITY, high = 0, minutes = 1.5 * outputs[o];
            for (uint32_t at = 0; at < 48 * 48 * 48; at++) {
                struct vec3 p = affine_point(&grid.lps_mm_from_ijk, vec3(at % 48, at / 48 % 48, at / (48 * 48)));
                double value;
                if ((int)label(p) != region + 1)
                    continue;
                if (isoeffective_by_hand(plan, set, scene.dose.blood_ppm, outputs[o], minutes, p, &value)) {
                    n++;
                    sum += value;
                    low = fmin(low, value);
                    high = fmax(high, value);
                } else {
                    n_missing++;
                }
            }
            assert_true(dose_growth_histogram(growth, outputs[o], minutes, &dvh, &err));
            assert_close(dvh.n, n, 0);
            assert_close(dvh.n_missing, n_missing, 0);
            assert_close(dvh.univel_cm3, grid_voxel_mm3(&grid) / 1000, 1e-12);
            assert_close(dvh.sum, sum, 1e-5 * sum); /* components and doses are floats */
            assert_close(dvh.low, low, 1e-5 * low);
            assert_close(dvh.high, high, 1e-5 * high);
            assert_true(region != 0 || n_missing > 100);
            dvh_finish(&dvh);
        }
        dose_growth_destroy(growth);
    }
    choice.left_out[0] = 1;
    assert_null(dose_growth_create(snapshot->derived, &choice, 0, POPULATION_OWN, &err));
    assert_int_equal(err.code, ERROR_STATE);
    err = (struct error){ 0 };
    choice.left_out[0] = 0;
    choice.row_of_region[1] = DOSE_NO_ROW;
    assert_null(dose_growth_create(snapshot->derived, &choice, 1, POPULATION_OWN, &err));
    assert_int_equal(err.code, ERROR_NOT_FOUND);
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(weights_are_those_of_the_tissue_at_the_point),
        cmocka_unit_test(one_tissue_can_hold_everywhere_also_in_air),
        cmocka_unit_test(there_is_no_value_in_air_outside_the_grid_and_under_the_mask),
        cmocka_unit_test(a_sum_says_which_components_it_lacks),
        cmocka_unit_test(the_reference_is_what_the_scene_names),
        cmocka_unit_test(a_dose_that_may_not_belong_waits_for_a_person),
        cmocka_unit_test(doses_are_summed_with_their_factors),
        cmocka_unit_test(the_isoeffective_dose_is_that_of_the_physical_doses_there),
        cmocka_unit_test(components_are_interpolated_and_then_mapped_and_rows_differ_by_no_more_than_they_say),
        cmocka_unit_test(a_growing_dose_is_counted_at_each_univel),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
