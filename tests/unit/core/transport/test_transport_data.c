/* Nuclear data, photon data and materials against tables of others. */
#include "core/transport/medium.h"
#include "core/transport/photon_data.h"
#include "tests/check.h"

/* Bound coherent and incoherent scattering of V. F. Sears, Neutron News 3 (3), 26 (1992), for free nuclei: times
 * (A / (A + 1))^2. Not phosphorus, where ENDF/B-V has a third more. */
static void slow_neutrons_scatter_as_the_table_of_sears_says(void **state)
{
    (void)state;
    static const struct {
        enum nuclide_id id;
        double bound_b, mass;
    } sears[] = { { NUCLIDE_C, 5.551, 11.898 },
                  { NUCLIDE_N_14, 11.51, 13.883 },
                  { NUCLIDE_O, 4.232, 15.858 },
                  { NUCLIDE_NA, 3.28, 22.79 },
                  { NUCLIDE_CL, 16.8, 35.15 } };
    for (size_t i = 0; i < sizeof sears / sizeof *sears; i++) {
        double free_b = sears[i].bound_b * pow(sears[i].mass / (sears[i].mass + 1), 2);
        assert_near(nuclide_scatter_b(sears[i].id, 1.0), free_b, .08); /* sodium's evaluations differ by 6 % */
        assert_near((double)nuclide_table[sears[i].id].mass, sears[i].mass, 1e-3);
    }
    assert_near(nuclide_scatter_b(NUCLIDE_H, 10.0), 82.03 * pow(.99917 / 1.99917, 2), .01);
}

/* Hydrogen: J. L. Gammel's formula (J. B. Marion and J. L. Fowler, Fast Neutron Physics, 1960), good to 1 % below 10
 * MeV. */
static void fast_neutrons_meet_hydrogen_as_gammels_formula_says(void **state)
{
    (void)state;
    for (double energy_ev = 1e4; energy_ev < 9e6; energy_ev *= 1.5) {
        double e = energy_ev * 1e-6, a = -1.86 + .09415 * e + .0001306 * e * e, b = .4223 + .13 * e;
        assert_near(nuclide_scatter_b(NUCLIDE_H, energy_ev),
                    3 * M_PI / (1.206 * e + a * a) + M_PI / (1.206 * e + b * b), .02);
    }
}

/* A neutron in water is slowed down and sped up to Maxwell's distribution: detailed balance of the matrix, group by
 * group as well as groups allow, and never less than at the free atom. */
static void bound_hydrogen_keeps_the_balance_of_a_warm_medium(void **state)
{
    (void)state;
    double flux[WATER_N_GROUPS];
    const double kt_ev = 8.617e-5 * 296;
    for (int i = 0; i < WATER_N_GROUPS; i++) { /* Maxwell's flux, E exp(-E / kT), integrated over the group */
        double high = (double)water_bounds_ev[i] / kt_ev, low = (double)water_bounds_ev[i + 1] / kt_ev;
        flux[i] = (1 + low) * exp(-low) - (1 + high) * exp(-high);
    }
    for (int i = 20; i < WATER_N_GROUPS - 1; i++) /* below 0.14 eV, where most of the flux is */
        for (int j = i + 1; j < WATER_N_GROUPS; j++) {
            double down = flux[i] * (double)water_scatter_b[i][j], up = flux[j] * (double)water_scatter_b[j][i];
            if (down > .02)
                assert_near(down, up, .12);
        }
    assert_true(nuclide_scatter_b(NUCLIDE_H, .0253) > 50 && nuclide_scatter_b(NUCLIDE_H, .0253) < 65);
}

/* J. H. Hubbell and S. M. Seltzer's own values at energies between which we interpolate: exact there. The Compton part:
 * 0.0699 of 0.0707 cm2/g at 1 MeV (XCOM, incoherent scattering of water). */
static void photons_of_1_mev_do_nearly_nothing_but_scatter(void **state)
{
    (void)state;
    assert_near(photon_attenuation_cm2_g(1), .07072, 1e-9);
    assert_near(photon_absorption_cm2_g(2), .02608, 1e-9);
    assert_near(photon_compton_share(1) * photon_attenuation_cm2_g(1), .0707, .005);
    assert_near(photon_compton_share(10) * photon_attenuation_cm2_g(10), .0171, .01);
    assert_true(photon_compton_share(.03) < .6);
}

/* Brain of ICRU 46 absorbs 0.0222 per cm without boron: 0.107 / 1.008 mol of hydrogen of 0.3326 b, ... */
static void brain_absorbs_what_its_elements_absorb(void **state)
{
    (void)state;
    struct material brain;
    struct error err = { 0 };
    static struct medium medium;
    assert_true(material_of_word("brain", &brain, &err));
    medium_init(&medium, &brain);
    double mol_b = .107 / 1.008 * .3326 + .022 / 14.007 * 1.90 + .145 / 12.011 * .0035 + .002 / 22.99 * .53 +
                   .004 / 30.974 * .172 + .002 / 32.06 * .53 + .003 / 35.45 * 33.5 + .003 / 39.098 * 2.1;
    assert_near(medium.absorption_2200_cm, mol_b * .602214 * 1.04, .003);
    /* 86 % of the captures are hydrogen's 2.22 MeV, 7 % chlorine's 8.6, 8 % make a proton and no photon */
    assert_close(medium.emitted_mev, (.03531 * 2.2246 + .003 / 35.45 * 33.1 * 8.58) / mol_b, .25);
    brain.boron_ppm = 30;
    double without = medium.absorption_2200_cm;
    medium_init(&medium, &brain);
    assert_near(medium.absorption_2200_cm - without, 30e-6 * 1.04 / 10.0129 * .602214 * 3835, 1e-3);
    /* 0.55238 mol of electrons in a gram (.107 / 1.008 + .145 x 6 / 12.011 + ...), 10 / 18.0153 in water's */
    assert_near((double)medium.electrons, 1.04 * .55238 * 1.80153, 1e-4);
    static struct particle_tables tables;
    particle_tables_init(&tables);
    double mev = photon_bin_mev(photon_bin(1.F));
    assert_near((double)tables.photon_gy_cm2[photon_bin(1.F)],
                photon_absorption_cm2_g(mev) * .55238 * 1.80153 * mev * 1.602177e-10, 1e-4);
}

/* The kerma of fast neutrons in brain: 1.1e-12 Gy cm2 at 11 keV, 6.7e-12 at 98 keV, 2.5e-11 at 1 MeV (ICRU 46 brain,
 * all nuclei; hydrogen brings about 95 %). */
static void fast_kerma_is_hydrogens_part_of_that_of_brain(void **state)
{
    (void)state;
    static struct particle_tables tables;
    particle_tables_init(&tables);
    assert_near((double)tables.recoil_gy_cm2[neutron_bin(11e3F)], 1.1e-12, .10);
    assert_near((double)tables.recoil_gy_cm2[neutron_bin(98e3F)], 6.7e-12, .10);
    assert_close((double)tables.recoil_gy_cm2[neutron_bin(1e6F)] / 2.5e-11, .9, .06); /* the rest is oxygen's */
    assert_true(tables.recoil_gy_cm2[neutron_bin(8e3F)] <= 0);
    for (int bin = 0; bin < NEUTRON_N_BINS; bin++)
        assert_int_equal(neutron_bin((float)neutron_bin_ev(bin)), bin);
    for (int bin = 0; bin < PHOTON_N_BINS; bin++)
        assert_int_equal(photon_bin((float)photon_bin_mev(bin)), bin);
}

static void a_region_is_given_the_material_its_name_says(void **state)
{
    (void)state;
    assert_string_equal(material_word_of_region("Scalp"), "skin");
    assert_string_equal(material_word_of_region("skull"), "cranium");
    assert_string_equal(material_word_of_region("GTV_70"), "brain");
    assert_string_equal(material_word_of_region("left maxillary sinus"), "air");
    assert_string_equal(material_word_of_region("Mandible"), "cranium");
    assert_string_equal(material_word_of_region("OpticNerve_L"), "brain");
    assert_string_equal(material_word_of_region("cranial nerve"), "brain");
    assert_string_equal(material_word_of_region("Air"), "air");
    assert_string_equal(material_word_of_region("airways"), "air");
    assert_string_equal(material_word_of_region("outside"), "air");
    assert_string_equal(material_word_of_region("Sinuses, sphenoidal"), "air");
    assert_string_equal(material_word_of_region("Head"), "soft-tissue");
    assert_string_equal(material_word_of_region("Fat"), "adipose");
    assert_null(material_word_of_region("thyroid"));
    assert_null(material_word_of_region(""));
}

/* Letters within a word say nothing, nor does what a name takes away. */
static void a_name_is_not_taken_for_what_it_does_not_say(void **state)
{
    (void)state;
    static const char *const tell_nothing[] = { "Hair",           "cavernous sinus", "sinus", "FemoralHead",
                                                "Femoral Head L", "vertebral body",  "avid",  "vena cava, left atrium",
                                                "Father",         "Devoid" };
    for (size_t i = 0; i < sizeof tell_nothing / sizeof *tell_nothing; i++)
        if (material_word_of_region(tell_nothing[i]))
            fail_msg("'%s' is taken for %s", tell_nothing[i], material_word_of_region(tell_nothing[i]));
    static const char *const helpers[] = { "PTV_avoid", "Avoidance",     "PTVavoid", "outside PTV",
                                           "Ring_PTV",  "PTV shell 2cm", "not PTV",  "without brain" };
    for (size_t i = 0; i < sizeof helpers / sizeof *helpers; i++)
        assert_string_equal(material_word_of_region(helpers[i]), "");
    assert_string_equal(material_word_of_region("Lungs-PTV"), "lung");
    assert_string_equal(material_word_of_region("Brain minus PTV"), "brain");
    assert_string_equal(material_word_of_region("Lung not GTV"), "lung");
    char longest[512];
    for (size_t i = 0; i < sizeof longest; i++)
        longest[i] = "a "[i % 2];
    longest[sizeof longest - 1] = '\0';
    assert_null(material_word_of_region(longest));
}

static void a_lung_is_full_of_air_unless_it_is_said_to_be_empty(void **state)
{
    (void)state;
    struct material full, empty;
    struct error err = { 0 };
    assert_true(material_of_word(material_word_of_region("Lung_L"), &full, &err));
    assert_true(material_of_word("lung-deflated", &empty, &err));
    assert_near(full.g_cm3, .26, 1e-9); /* ICRU 46 */
    assert_near(empty.g_cm3, 1.05, 1e-9);
    assert_memory_equal(full.weight, empty.weight, sizeof full.weight);
}

static void a_material_beyond_its_limits_is_refused_by_name(void **state)
{
    (void)state;
    struct material brain;
    struct error err = { 0 };
    assert_false(material_of_word("cheese", &brain, &err));
    assert_non_null(strstr(err.text, "'cheese' is no material; there are air, brain, skin"));
    assert_true(material_of_word("BRAIN", &brain, &err));
    assert_true(material_check(&brain, &err));
    struct material bad = brain;
    bad.g_cm3 = 0;
    assert_false(material_check(&bad, &err));
    assert_string_equal(err.text, "material brain: density 0 g/cm3, above 0 to 20 expected");
    bad = brain;
    bad.weight[ELEMENT_C] = .5;
    assert_false(material_check(&bad, &err));
    assert_string_equal(err.text, "material brain: weight fractions add up to 1.355, 0.98 to 1.02 expected");
    bad = brain;
    bad.weight[ELEMENT_O] = .712 - .03;
    assert_false(material_check(&bad, &err));
    assert_string_equal(err.text, "material brain: weight fractions add up to 0.97, 0.98 to 1.02 expected");
    memset(bad.weight, 0, sizeof bad.weight);
    assert_false(material_check(&bad, &err));
    bad.boron_ppm = 1e5;
    assert_true(material_check(&bad, &err)); /* boron alone */
    bad = brain;
    bad.boron_ppm = NAN;
    assert_false(material_check(&bad, &err));
    bad = brain;
    bad.weight[ELEMENT_H] = -.1;
    assert_false(material_check(&bad, &err));
    assert_string_equal(err.text, "material brain: weight fraction -0.1 of H, 0 to 1 expected");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slow_neutrons_scatter_as_the_table_of_sears_says),
        cmocka_unit_test(fast_neutrons_meet_hydrogen_as_gammels_formula_says),
        cmocka_unit_test(bound_hydrogen_keeps_the_balance_of_a_warm_medium),
        cmocka_unit_test(photons_of_1_mev_do_nearly_nothing_but_scatter),
        cmocka_unit_test(brain_absorbs_what_its_elements_absorb),
        cmocka_unit_test(fast_kerma_is_hydrogens_part_of_that_of_brain),
        cmocka_unit_test(a_region_is_given_the_material_its_name_says),
        cmocka_unit_test(a_name_is_not_taken_for_what_it_does_not_say),
        cmocka_unit_test(a_lung_is_full_of_air_unless_it_is_said_to_be_empty),
        cmocka_unit_test(a_material_beyond_its_limits_is_refused_by_name),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
