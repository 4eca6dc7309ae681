/* Histograms of a plan's regions: each univel in the weights of its own tissue, regions inside others, on one layer or
 * on several, against sums over all univels by dose_field_value. */
#include "core/derive/dose_histogram.h"
#include "core/dose/dvh_metrics.h"
#include "core/scene/dose_scale.h"
#include "tests/check.h"
#include "tests/derived_of.h"
#include "tests/made_plan.h"

/* A head of radius 20 mm around the origin, in it a tumour of radius 8 mm. */
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

/* The dose ends at about x = 13 mm: part of the head has none. */
static struct plan *make_plan(void)
{
    const uint32_t size[3] = { 10, 12, 10 };
    struct grid grid = made_cube_grid(48),
                coarse =
                    made_grid(10, 12, 10,
                              made_affine(vec3(0, 4, 0), vec3(-3, 0, 0), vec3(0, 0, 6), size, vec3(-5, -0.8, 1.1)));
    struct plan *plan = made_plan(&grid, label, regions, 2);
    struct dose *dose = &plan->doses[plan->n_doses++];
    snprintf(dose->id, sizeof dose->id, "mc");
    snprintf(dose->unit, sizeof dose->unit, "Gy");
    add(dose, DOSE_BORON, &coarse, boron);
    add(dose, DOSE_GAMMA, &coarse, gamma_rays);
    return plan;
}

/* The tumour on a layer of its own, where the first layer is brain too. */
static void move_tumour(struct plan *plan)
{
    struct region_set *set = &plan->regions;
    struct error err = { 0 };
    set->layers[1] = volume_create(&set->layers[0]->grid, VOXEL_U8, &err);
    set->n_layers = 2;
    uint8_t *brain = set->layers[0]->voxels, *tumour = set->layers[1]->voxels;
    for (size_t i = 0; i < 48 * 48 * 48; i++)
        if (brain[i] == 2) {
            brain[i] = i % 3 ? 1 : 0; /* the brain holds only a part of it */
            tumour[i] = 7;
        }
    set->regions[1].layer = 1;
    set->regions[1].label = 7;
    region_set_measure(set);
}

static struct snapshot *show(struct plan *plan)
{
    struct scene scene;
    struct view view = view_default;
    struct error err = { 0 };
    char field[128];
    scene_for_plan(plan, &scene);
    struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 1, field, &err);
    assert_string_equal(err.text, "");
    assert_true(snapshot->has_dose_choice);
    return snapshot;
}

/* Over the univels that have one of the two, by hand. */
static void assert_histogram(struct plan *plan, const struct snapshot *snapshot, size_t region, bool with_inside)
{
    const struct region_set *set = &plan->regions;
    const struct grid *grid = &set->layers[0]->grid;
    double sum = 0, low = INFINITY, high = -INFINITY;
    size_t n = 0, n_missing = 0;
    struct dvh dvh;
    struct error err = { 0 };
    struct dose_field *field = dose_field_get(snapshot->derived, &snapshot->dose_choice, &err);
    assert_non_null(field);
    for (size_t i = 0; i < 48 * 48 * 48; i++) {
        bool is_in = false;
        for (size_t r = 0; r < 2; r++)
            is_in |= (r == region || (with_inside && region == 0)) &&
                     ((const uint8_t *)set->layers[set->regions[r].layer]->voxels)[i] == set->regions[r].label;
        double value;
        if (!is_in)
            continue;
        if (!dose_field_value(field,
                              affine_point(&grid->lps_mm_from_ijk,
                                           vec3((double)(i % 48), (double)(i / 48 % 48), (double)(i / 48 / 48))),
                              &value)) {
            n_missing++;
            continue;
        }
        n++;
        sum += value;
        low = fmin(low, value);
        high = fmax(high, value);
    }
    assert_true(n > 0);
    if (!dose_histogram_get(snapshot->derived, &snapshot->dose_choice, region, with_inside, 1, &dvh, &err))
        fail_msg("%s", err.text);
    assert_close(dvh.n, (double)n, 1e-9);
    assert_close(dvh.n_missing, (double)n_missing, 1e-9);
    assert_near(dvh.sum, sum, 1e-6);
    assert_near(dvh.low, low, 1e-6);
    assert_near(dvh.high, high, 1e-6);
    assert_close(dvh_univels_from(&dvh, 0), (double)n, 1e-6);
    dvh_finish(&dvh);
    derive_result_unref(&field->base);
}

static void each_univel_counts_with_the_weights_of_its_tissue(void **state)
{
    (void)state;
    struct plan *plan = make_plan();
    struct snapshot *snapshot = show(plan);
    for (size_t region = 0; region < 2; region++)
        for (int inside = 0; inside < 2; inside++)
            assert_histogram(plan, snapshot, region, inside);
    struct dvh body;
    struct error err = { 0 };
    size_t layer = 7;
    assert_true(dose_histogram_of_body(snapshot->derived, &snapshot->dose_choice, &body, &layer, &err));
    assert_int_equal(layer, 0);
    assert_close(body.n + body.n_missing,
                 (double)(plan->regions.regions[0].n_voxels + plan->regions.regions[1].n_voxels), 1e-6);
    dvh_finish(&body);
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

static void univels_that_two_layers_share_count_once(void **state)
{
    (void)state;
    struct plan *plan = make_plan();
    move_tumour(plan);
    struct snapshot *snapshot = show(plan);
    assert_histogram(plan, snapshot, 0, false);
    assert_histogram(plan, snapshot, 1, false);
    assert_histogram(plan, snapshot, 0, true);
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_univel_counts_with_the_weights_of_its_tissue),
        cmocka_unit_test(univels_that_two_layers_share_count_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
