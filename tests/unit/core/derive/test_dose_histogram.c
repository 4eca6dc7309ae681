/* Histograms of a plan's regions: each with its own weights, regions inside others, on one layer or on several, against
 * sums over all univels by hand. */
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

/* True if a univel belongs to the population, by the labels of the two layers. */
static bool is_in(const struct region_set *set, size_t i, size_t region, enum region_population population)
{
    bool has[2];
    for (size_t r = 0; r < 2; r++)
        has[r] = ((const uint8_t *)set->layers[set->regions[r].layer]->voxels)[i] == set->regions[r].label;
    if (region == 1)
        return has[1];
    return population == POPULATION_WHOLE ? has[0] || (has[1] && set->regions[1].layer == 0) : has[0] && !has[1];
}

/* Boron and photons at a point, tri-linear in doses that are linear; with the weights that a region has in the scene.
 */
static double dose_by_hand(const struct snapshot *snapshot, const struct plan *plan, size_t region, struct vec3 p)
{
    const struct scene_tissue_weights *w = scene_weights_of(plan, &snapshot->scene, region);
    return boron(p) * w->boron_ratio * snapshot->scene.dose.blood_ppm * w->cbe + gamma_rays(p) * w->gamma;
}

static void assert_histogram(struct plan *plan, const struct snapshot *snapshot, size_t region,
                             enum region_population population)
{
    const struct region_set *set = &plan->regions;
    const struct volume *dose = plan->doses[0].components[0].values;
    double sum = 0, high = -INFINITY;
    size_t n = 0, n_missing = 0;
    struct dose_choice choice;
    struct dvh dvh;
    struct error err = { 0 };
    for (size_t i = 0; i < 48 * 48 * 48; i++) {
        struct vec3 p = affine_point(&set->layers[0]->grid.lps_mm_from_ijk,
                                     vec3((double)(i % 48), (double)(i / 48 % 48), (double)(i / 48 / 48)));
        double any;
        if (!is_in(set, i, region, population))
            continue;
        if (!volume_sample(dose, p, &any)) {
            n_missing++;
            continue;
        }
        /* beyond the outermost centres the outermost values hold */
        struct vec3 at = affine_point(&dose->grid.ijk_from_lps_mm, p);
        at = vec3(fmin(fmax(at.x, 0), 9), fmin(fmax(at.y, 0), 11), fmin(fmax(at.z, 0), 9));
        double value = dose_by_hand(snapshot, plan, region, affine_point(&dose->grid.lps_mm_from_ijk, at));
        n++;
        sum += value;
        high = fmax(high, value);
    }
    assert_true(n > 0);
    assert_true(dose_choice_in(snapshot, 0, SCENE_DOSE_QUANTITY_WEIGHTED, "", &choice, &err));
    if (!dose_histogram_get(snapshot->derived, &choice, region, population, DOSE_BY_REGION, 1, &dvh, &err))
        fail_msg("%s", err.text);
    assert_close(dvh.n, (double)n, 1e-9);
    assert_close(dvh.n_missing, (double)n_missing, 1e-9);
    assert_near(dvh.sum, sum, 1e-5);
    assert_near(dvh.high, high, 1e-5);
    assert_close(dvh_univels_from(&dvh, 0), (double)n, 1e-6);
    dvh_finish(&dvh);
}

static void each_univel_counts_with_the_weights_of_the_region(void **state)
{
    (void)state;
    struct plan *plan = make_plan();
    struct snapshot *snapshot = show(plan);
    assert_int_equal(population_usual(&plan->regions), POPULATION_OWN);
    for (size_t region = 0; region < 2; region++)
        for (int whole = 0; whole < 2; whole++)
            assert_histogram(plan, snapshot, region, whole ? POPULATION_WHOLE : POPULATION_OWN);
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

static void of_regions_that_lie_over_each_other_the_whole_one_is_its_own_and_the_outer_one_can_do_without_the_inner(
    void **state)
{
    (void)state;
    struct plan *plan = make_plan();
    move_tumour(plan);
    struct snapshot *snapshot = show(plan);
    assert_int_equal(population_usual(&plan->regions), POPULATION_WHOLE);
    for (size_t region = 0; region < 2; region++)
        for (int whole = 0; whole < 2; whole++)
            assert_histogram(plan, snapshot, region, whole ? POPULATION_WHOLE : POPULATION_OWN);
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

static void masks_that_share_no_univel_but_lie_in_each_other_are_whole_together(void **state)
{
    (void)state;
    struct plan *plan = make_plan();
    move_tumour(plan);
    struct region_set *set = &plan->regions;
    struct error err = { 0 };
    uint8_t *brain = set->layers[0]->voxels;
    const uint8_t *tumour = set->layers[1]->voxels;
    for (size_t i = 0; i < 48 * 48 * 48; i++)
        brain[i] = tumour[i] ? 0 : brain[i];
    region_set_measure(set);
    for (int whole = 0; whole < 2; whole++) {
        struct volume *labels = population_labels(set, 0, whole ? POPULATION_WHOLE : POPULATION_OWN, &err);
        assert_non_null(labels);
        for (size_t i = 0; i < 48 * 48 * 48; i++)
            assert_int_equal(((const uint8_t *)labels->voxels)[i], brain[i] == 1 || (whole && tumour[i] == 7));
        volume_unref(labels);
    }
    assert_null(population_labels(set, 2, POPULATION_OWN, &err));
    assert_int_equal(err.code, ERROR_RANGE);
    plan_and_derived_destroy(plan);
}

/* Changes at random how the dose is drawn. */
static void draw_anyhow(struct scene *scene)
{
    struct scene_dose_style *dose = &scene->dose;
    snprintf(dose->tissue, sizeof dose->tissue, "%s", (const char *[]){ "", "brain", "tumour" }[rand() % 3]);
    dose->quantity = rand() % 2 ? SCENE_DOSE_QUANTITY_WEIGHTED : SCENE_DOSE_QUANTITY_GAMMA;
    dose->interpolation = rand() % 2 ? SCENE_DOSE_INTERPOLATION_LINEAR : SCENE_DOSE_INTERPOLATION_SLICE;
    dose->wash.visible = rand() % 2;
    dose->lines.visible = rand() % 2;
    dose->surfaces.visible = rand() % 2;
    dose->error = rand() % 2;
    dose->reference.kind = (enum scene_dose_reference_kind)(rand() % 4);
    snprintf(dose->reference.region, sizeof dose->reference.region, "%s", rand() % 2 ? "brain" : "");
    dose->n_levels = (size_t)(rand() % 3) < dose->n_levels ? (size_t)(rand() % 3) : 0;
}

static void nothing_of_how_a_dose_is_drawn_changes_the_figures_of_its_regions(void **state)
{
    (void)state;
    struct plan *plan = make_plan();
    struct snapshot *first = show(plan);
    struct dose_choice expected, choice;
    struct error err = { 0 };
    assert_true(dose_choice_in(first, 0, SCENE_DOSE_QUANTITY_WEIGHTED, "", &expected, &err));
    srand(25);
    for (int test = 0; test < 200; test++) {
        struct snapshot other = *first; /* borrows all but the values of its scene */
        struct scene scene = first->scene;
        draw_anyhow(&scene);
        other.scene = scene;
        assert_true(dose_choice_in(&other, 0, SCENE_DOSE_QUANTITY_WEIGHTED, "", &choice, &err));
        assert_memory_equal(&choice, &expected, sizeof choice);
        assert_int_equal(scene_population(plan, &scene), POPULATION_OWN);
    }
    char words[96];
    assert_string_equal(dose_basis_words(plan, &expected, "", words), "each region's own weights");
    assert_string_equal(dose_basis_words(plan, &expected, "tumour", words), "weights of tumour");
    assert_true(dose_choice_in(first, 0, SCENE_DOSE_QUANTITY_GAMMA, "", &choice, &err));
    assert_null(dose_basis_words(plan, &choice, "", words));
    snapshot_unref(first);
    plan_and_derived_destroy(plan);
}

static void a_region_without_weights_has_no_figures_but_says_so(void **state)
{
    (void)state;
    struct plan *plan = make_plan();
    plan->regions.regions[1].parent = -1; /* the tumour has no region around it whose weights it could have */
    struct snapshot *snapshot = show(plan);
    struct dose_choice choice;
    struct error err = { 0 };
    struct dvh dvh;
    snapshot->scene.dose.n_weights = 1;
    snprintf(snapshot->scene.dose.weights[0].id, sizeof snapshot->scene.dose.weights[0].id, "brain");
    assert_true(dose_choice_in(snapshot, 0, SCENE_DOSE_QUANTITY_WEIGHTED, "", &choice, &err));
    assert_true(dose_histogram_get(snapshot->derived, &choice, 0, POPULATION_OWN, DOSE_BY_REGION, 1, &dvh, &err));
    dvh_finish(&dvh);
    assert_false(dose_histogram_get(snapshot->derived, &choice, 1, POPULATION_OWN, DOSE_BY_REGION, 1, &dvh, &err));
    assert_string_equal(err.text, "no weights for tumour");
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_univel_counts_with_the_weights_of_the_region),
        cmocka_unit_test(
            of_regions_that_lie_over_each_other_the_whole_one_is_its_own_and_the_outer_one_can_do_without_the_inner),
        cmocka_unit_test(masks_that_share_no_univel_but_lie_in_each_other_are_whole_together),
        cmocka_unit_test(nothing_of_how_a_dose_is_drawn_changes_the_figures_of_its_regions),
        cmocka_unit_test(a_region_without_weights_has_no_figures_but_says_so),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
