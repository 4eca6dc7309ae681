/* The photon-isoeffective dose and the presets of dose. */
#include "core/dose/isoeffective.h"
#include "dose_presets.h"
#include "tests/check.h"

static const struct isoeffective_set *set_named(const char *name)
{
    for (size_t i = 0; i < n_isoeffective_sets; i++)
        if (strcmp(isoeffective_sets[i].name, name) == 0)
            return &isoeffective_sets[i];
    fail_msg("no set %s", name);
    return NULL;
}

static void the_lea_catcheside_factor_has_its_closed_form_and_its_limits(void **state)
{
    (void)state;
    /* 2/y^2 (y - 1 + e^-y): y = 1 gives 2/e, y = 1/2 gives 8 (e^-1/2 - 1/2) */
    assert_close(lea_catcheside(60, 60), 2 * exp(-1), 1e-12);
    assert_close(lea_catcheside(60, 30), 8 * (exp(-0.5) - 0.5), 1e-12);
    assert_close(lea_catcheside(60, 0), 1, 0);                                  /* an instant: no repair */
    assert_close(lea_catcheside(1, 1e6), 2e-6, 1e-11);                          /* very long: 2/y */
    assert_close(lea_catcheside(60, 0.0599), lea_catcheside(60, 0.0601), 2e-6); /* the series joins the closed form */
}

static void with_one_repair_time_the_dose_solves_the_equation_of_the_paper(void **state)
{
    (void)state;
    struct isoeffective prepared;
    isoeffective_init(&prepared, set_named("Gliosarcoma (Gonzalez 2012)"), 60);
    double dose = isoeffective_dose(&prepared, 4, 1, 0.5, 2);
    /* by hand: sums of a d and of sqrt(b) d, repair 60 min, irradiation 60 min, photons in 30 min */
    double linear = 0.9091 * 4 + 0.4972 * 1.5 + 0.2008 * 2,
           root = sqrt(0.0019) * 4 + sqrt(0.088) * 1.5 + sqrt(0.0078) * 2;
    double effect = linear + 2 * exp(-1) * root * root;
    assert_close(0.2008 * dose + 0.0078 * 8 * (exp(-0.5) - 0.5) * dose * dose, effect, 1e-9);
    assert_close(dose, 16.800733788268513, 1e-9);
}

static void with_two_repair_times_each_pair_of_components_has_its_own_factor(void **state)
{
    (void)state;
    /* 40 min; 3 Gy boron, 0.6 nitrogen, 0.4 fast, 2.5 gamma: the ten terms of isodose.m written out in Python */
    const struct {
        const char *name;
        double dose;
    } known[] = {
        { "Mucosa (Gonzalez 2017)", 15.87260641217641 },
        { "Brain (Dattoli Viegas 2024)", 15.313174819306635 },
        { "H&N tumour, in vivo (Perotti 2022)", 18.85484209717011 },
        { "H&N tumour, in vitro (Perotti 2022)", 20.01515713667906 },
        { "Glioblastoma, U87 cells (Marcaccio)", 20.1507634006551 },
    };
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        struct isoeffective prepared;
        isoeffective_init(&prepared, set_named(known[i].name), 40);
        assert_close(isoeffective_dose(&prepared, 3, 0.6, 0.4, 2.5), known[i].dose, 1e-9);
    }
}

static void photons_alone_given_in_the_reference_time_are_worth_themselves(void **state)
{
    (void)state;
    for (size_t i = 0; i < n_isoeffective_sets; i++) {
        struct isoeffective prepared;
        isoeffective_init(&prepared, &isoeffective_sets[i], isoeffective_sets[i].photon_min);
        for (double gy = 0; gy < 40; gy += 2.5)
            assert_close(isoeffective_dose(&prepared, 0, 0, 0, gy), gy, 1e-9);
        /* twice the time: repair lowers the effect */
        isoeffective_init(&prepared, &isoeffective_sets[i], 2 * isoeffective_sets[i].photon_min);
        assert_true(isoeffective_dose(&prepared, 0, 0, 0, 10) < 10);
    }
}

static void many_points_are_each_one_and_what_has_no_value_has_no_dose(void **state)
{
    (void)state;
    struct isoeffective prepared;
    isoeffective_init(&prepared, set_named("Mucosa (Gonzalez 2017)"), 50);
    const float boron[] = { 0.1f, 0.2f, NAN, 0 }, fast[] = { 0.5f, 0, 1, 0 }, gamma[] = { 1, 2, 3, 0 };
    const float *components[] = { boron, NULL, fast, gamma };
    float doses[4];
    isoeffective_doses(&prepared, components, (const double[]){ 15, 1, 2, 1 }, 4, doses);
    for (int i = 0; i < 2; i++)
        assert_close(doses[i],
                     isoeffective_dose(&prepared, 15.0 * (double)boron[i], 0, 2.0 * (double)fast[i], (double)gamma[i]),
                     1e-5);
    assert_true(isnan(doses[2]));
    assert_close(doses[3], 0, 0);
}

static void the_presets_hold_the_published_numbers(void **state)
{
    (void)state;
    /* Barth et al. 2005, table 1: brain 1.0 and 1.3, skin 1.5 and 2.5, tumour 3.5 and 3.8, 3.2 for protons */
    const struct weights_preset *trials = &weights_presets[0];
    assert_string_equal(trials->name, "BPA trials (USA)");
    const struct {
        const char *tissue;
        double ratio, cbe;
    } table[] = { { "tumour", 3.5, 3.8 }, { "brain", 1, 1.3 }, { "skin", 1.5, 2.5 } };
    for (size_t i = 0; i < 3; i++) {
        const struct tissue_preset *row = &trials->tissues[i];
        assert_string_equal(row->tissue, table[i].tissue);
        assert_close(row->boron_ratio, table[i].ratio, 0);
        assert_close(row->cbe, table[i].cbe, 0);
        assert_close(row->nitrogen, 3.2, 0);
        assert_close(row->fast, 3.2, 0);
        assert_close(row->gamma, 1, 0);
    }
    /* the thesis: 95 red, 90 green, 80 blue, 70 yellow, 60 magenta, 50 cyan */
    const struct level_preset thesis[] = { { 95, 0xff0000 }, { 90, 0x00ff00 }, { 80, 0x0000ff },
                                           { 70, 0xffff00 }, { 60, 0xff00ff }, { 50, 0x00ffff } };
    assert_int_equal(level_tables[0].n_levels, 6);
    for (size_t i = 0; i < 6; i++) {
        assert_close(level_tables[0].levels[i].value, thesis[i].value, 0);
        assert_int_equal(level_tables[0].levels[i].color_rgb, thesis[i].color_rgb);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_lea_catcheside_factor_has_its_closed_form_and_its_limits),
        cmocka_unit_test(with_one_repair_time_the_dose_solves_the_equation_of_the_paper),
        cmocka_unit_test(with_two_repair_times_each_pair_of_components_has_its_own_factor),
        cmocka_unit_test(photons_alone_given_in_the_reference_time_are_worth_themselves),
        cmocka_unit_test(many_points_are_each_one_and_what_has_no_value_has_no_dose),
        cmocka_unit_test(the_presets_hold_the_published_numbers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
