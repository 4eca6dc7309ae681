/* SERA's numbers of a beam, and its card; gantry and couch of a direction. */
#include "core/beam/beam.h"
#include "core/beam/sera_angles.h"
#include "tests/check.h"
#include "tests/unit/made_mask.h"

static double random_part(uint64_t *seed)
{
    return (double)next_random(seed) / 4294967296.0;
}

static struct vec3 random_direction(uint64_t *seed)
{
    for (;;) {
        struct vec3 v = vec3(2 * random_part(seed) - 1, 2 * random_part(seed) - 1, 2 * random_part(seed) - 1);
        double length = vec3_length(v);
        if (length > 0.1 && length < 1)
            return vec3_scale(v, 1 / length);
    }
}

/* The field of SERA's sample head, as seraMC wrote it into head1.rst (cm; PA, RL, IS). */
static const struct sera_angles head_field = { { -3.84, 2.49, -6.49 }, 10.45, 55, -140 };
static const struct vec3 head_entry_lps_mm = { 52.81099, 61.82010, -39.38779 };
static const struct vec3 head_direction_lps = { -0.6275069, -0.5265408, -0.5735764 };

static void angles_of_seras_own_field_give_its_target_its_vector_and_back(void **state)
{
    (void)state;
    struct vec3 target = sera_angles_target_lps_mm(&head_field), entry = sera_angles_entry_lps_mm(&head_field);
    assert_point(target, 24.9, 38.4, -64.9, 1e-12);
    struct vec3 direction = vec3_scale(vec3_sub(target, entry), 1 / 104.5);
    assert_point(direction, head_direction_lps.x, head_direction_lps.y, head_direction_lps.z,
                 1e-7);                                                   /* 7 digits there */
    struct sera_angles again = sera_angles_of(head_entry_lps_mm, target); /* the resolved entry, on the skin */
    assert_close(again.phi_deg, 55, 1e-5);
    assert_close(again.theta_deg, -140, 1e-5); /* the file's 1e-6 cm at 4.4 cm */
}

static void angles_and_lines_turn_into_each_other_in_every_direction(void **state)
{
    (void)state;
    uint64_t seed = 3;
    for (int i = 0; i < 1000; i++) {
        struct vec3 target = vec3_scale(random_direction(&seed), 300 * random_part(&seed));
        double phi = 180 * random_part(&seed), theta = 360 * random_part(&seed) - 180;
        struct sera_angles made = {
            { -target.y / 10, target.x / 10, target.z / 10 }, 50 * random_part(&seed) + 1, phi, theta
        };
        struct vec3 entry = sera_angles_entry_lps_mm(&made);
        struct sera_angles found = sera_angles_of(entry, target);
        assert_close(found.z_cm, made.z_cm, 1e-12);
        assert_close(found.phi_deg, phi, 1e-9);
        assert_close(found.theta_deg, theta, 1e-6); /* phi may be small */
        struct vec3 again = sera_angles_entry_lps_mm(&found);
        assert_point(again, entry.x, entry.y, entry.z, 1e-10);
    }
}

static void the_four_sides_and_both_poles_have_the_angles_of_the_convention(void **state)
{
    (void)state;
    const struct {
        struct vec3 from;
        double phi, theta;
    } cases[] = { { { -1, 0, 0 }, 90, 0 },  /* from the patient's right */
                  { { 0, -1, 0 }, 90, 90 }, /* from anterior */
                  { { 1, 0, 0 }, 90, 180 }, /* from the left */
                  { { 0, 1, 0 }, 90, -90 }, /* from posterior */
                  { { 0, 0, 1 }, 0, 0 },    /* from superior */
                  { { 0, 0, -1 }, 180, 0 } };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct vec3 target = vec3(7, -8, 9);
        struct sera_angles angles = sera_angles_of(vec3_add(target, vec3_scale(cases[i].from, 100)), target);
        assert_close(angles.phi_deg, cases[i].phi, 1e-12);
        assert_close(angles.theta_deg, cases[i].theta, 1e-12);
        assert_close(angles.z_cm, 10, 1e-12);
        struct vec3 towards = sera_angles_towards_source(cases[i].phi, cases[i].theta);
        assert_point(towards, cases[i].from.x, cases[i].from.y, cases[i].from.z, 1e-15);
    }
}

static void the_card_has_the_numbers_of_seramcs_input_in_their_places(void **state)
{
    (void)state;
    char text[SERA_CARD_SIZE];
    double values[6];
    int n = 0;
    (void)sera_card(&(struct sera_angles){ { -3.84, 2.49, -6.49 }, 20, 55, -140 }, text);
    /* lines 3 and 4 of head1.input, without which seraMC would not have run */
    assert_non_null(strstr(text, "\n      -3.8400000E+00       2.4900000E+00      -6.4900000E+00\n"));
    assert_non_null(strstr(text, "\n       2.0000000E+01       5.5000000E+01      -1.4000000E+02\n"));
    for (char *line = text, *end; *line; line = end + 1) {
        end = strchr(line, '\n');
        assert_non_null(end);
        *end = 0;
        if (line[0] == '#')
            continue;
        char *rest = line, *behind;
        for (double value = strtod(rest, &behind); behind > rest; value = strtod(rest, &behind), n++) {
            assert_true(n < 6);
            values[n] = value;
            rest = behind;
        }
    }
    assert_int_equal(n, 6);
    assert_close(values[5], -140, 0);
}

static void gantry_and_couch_of_a_direction_are_those_that_a_beam_comes_from(void **state)
{
    (void)state;
    uint64_t seed = 21;
    for (int i = 0; i < 2000; i++) {
        struct beam_angles angles = { .gantry_deg = 360 * random_part(&seed), .couch_deg = 360 * random_part(&seed) };
        enum patient_position position = (enum patient_position)(PATIENT_HFS + i % 8);
        struct vec3 towards = beam_patient_from_gantry(vec3(0, 0, 1), &angles, position);
        struct beam_angles near = { .gantry_deg = angles.gantry_deg + 20, .couch_deg = angles.couch_deg - 20 };
        struct beam_angles found = beam_angles_from_direction(towards, position, &near);
        assert_close(sin((found.gantry_deg - angles.gantry_deg) * MATH_PI / 360), 0, 1e-9);
        if (fabs(sin(angles.gantry_deg * MATH_PI / 180)) > 1e-3)
            assert_close(sin((found.couch_deg - angles.couch_deg) * MATH_PI / 360), 0, 1e-9);
        assert_true(found.gantry_deg >= 0 && found.gantry_deg < 360 && found.couch_deg >= 0 && found.couch_deg < 360);
        struct beam_angles far = { .gantry_deg = -angles.gantry_deg, .couch_deg = angles.couch_deg + 180 };
        found = beam_angles_from_direction(towards, position, &far);
        struct vec3 again = beam_patient_from_gantry(vec3(0, 0, 1), &found, position);
        assert_point(again, towards.x, towards.y, towards.z, 1e-12);
        assert_close(sin((found.gantry_deg - far.gantry_deg) * MATH_PI / 360), 0, 1e-9);
    }
    struct beam_angles turned = { .gantry_deg = 10, .couch_deg = 30 };
    struct beam_angles above = beam_angles_from_direction(vec3(0, -1, 0), PATIENT_HFS, &turned); /* from the ceiling */
    assert_close(above.gantry_deg, 0, 1e-12);
    assert_close(above.couch_deg, 30, 1e-12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(angles_of_seras_own_field_give_its_target_its_vector_and_back),
        cmocka_unit_test(angles_and_lines_turn_into_each_other_in_every_direction),
        cmocka_unit_test(the_four_sides_and_both_poles_have_the_angles_of_the_convention),
        cmocka_unit_test(the_card_has_the_numbers_of_seramcs_input_in_their_places),
        cmocka_unit_test(gantry_and_couch_of_a_direction_are_those_that_a_beam_comes_from),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
