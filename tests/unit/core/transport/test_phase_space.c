/* Lists of particles: what reaches the aperture plane of a source, through its delimiter or without, in closed form. */
#include "core/transport/phase_space.h"

#include "core/transport/direction.h"
#include "tests/check.h"

/* Closed form: parallel neutrons in a hole as wide as their disk meet nothing, however far the disk is from the
 * delimiter, and the air between takes none of them. */
static void air_before_a_short_delimiter_takes_no_neutron(void **state)
{
    (void)state;
    struct beam_source source = { .name = "made", .n_cuts = 1, .radius_cm = 3, .to_aperture_cm = 50 };
    source.delimiter = (struct beam_delimiter){ 10, 3.01, 3.01, 200 };
    source.neutrons =
        (struct beam_spectrum){ 3, { 5e3, 1e3, 10, 1 }, { .5, 0, .5 }, { { 1 }, { 1 }, { 1 } }, 1e6, true };
    struct phase_space beam;
    struct error err = { 0 };
    if (!phase_space_of_source(&beam, &source, 32000, 0, 3, 2, NULL, &err))
        fail_msg("%s", err.text);
    assert_near(beam.neutrons.per_unit, 1e6 * M_PI * 9, 1e-9);
    double slow = 0, all = 0;
    for (size_t i = 0; i < beam.neutrons.n; i++) {
        const struct particle *particle = &beam.neutrons.particles[i];
        all += (double)particle->weight;
        slow += particle->energy < 20 ? (double)particle->weight : 0;
        assert_true(hypotf(particle->x_cm, particle->y_cm) <= 3.001F);
    }
    assert_near(all, (double)beam.neutrons.n, 1e-6);
    assert_close(slow / all, .5, .014); /* five standard deviations */
    phase_space_finish(&beam);
}

static void a_disk_within_its_delimiter_is_refused_with_both_lengths(void **state)
{
    (void)state;
    struct beam_source source = { .name = "made", .n_cuts = 1, .radius_cm = 3, .to_aperture_cm = 4.8 };
    source.delimiter = (struct beam_delimiter){ 5, 3, 3, 200 };
    source.neutrons = (struct beam_spectrum){ 1, { 10, 1 }, { 1 }, { { 1 } }, 1e6, true };
    struct phase_space beam;
    struct error err = { 0 };
    assert_false(phase_space_of_source(&beam, &source, 1600, 0, 3, 2, NULL, &err));
    assert_string_equal(err.text,
                        "source made: its disk is 4.8 cm from the aperture plane, within the delimiter of 5 cm");
    source.to_aperture_cm = 4.95; /* FiR 1's source is half a millimetre within its delimiter */
    assert_true(phase_space_of_source(&beam, &source, 1600, 0, 3, 2, NULL, &err));
    phase_space_finish(&beam);
    source.radius_cm = 31;
    assert_false(phase_space_of_source(&beam, &source, 1600, 0, 3, 2, NULL, &err));
    assert_string_equal(err.text, "source made: a disk of 31 cm in radius, at most 30 expected");
}

/* Closed form: slow neutrons straight ahead reach the aperture through the hole, and uncollided through the thin end of
 * a cone's wall: 10.0 per cm of polyethylene with lithium (0.0545 x 51.6 b of H, 0.0075 x 937 b of Li-6, 0.2 of C and
 * O).
 */
static void a_delimiter_lets_slow_neutrons_through_its_hole_alone(void **state)
{
    (void)state;
    for (double entrance_cm = 3; entrance_cm <= 6; entrance_cm += 3) {
        struct beam_source source = { .name = "made", .n_cuts = 1, .radius_cm = 6, .to_aperture_cm = 5 };
        source.delimiter = (struct beam_delimiter){ 5, 3, entrance_cm, 200 };
        source.neutrons = (struct beam_spectrum){ 1, { .026, .025 }, { 1 }, { { 1 } }, 1e6, true };
        struct phase_space beam;
        struct error err = { 0 };
        assert_true(phase_space_of_source(&beam, &source, 32000, 0, 5, 2, NULL, &err));
        size_t n_straight = 0;
        for (size_t i = 0; i < beam.neutrons.n; i++)
            n_straight += beam.neutrons.particles[i].direction[2] > .9999F;
        double per_cm = 10.0 * 5 / 3, wall_cm2 = entrance_cm > 3 ? 2 * M_PI * (3 / per_cm + 1 / (per_cm * per_cm)) : 0;
        assert_near(beam.neutrons.per_unit * (double)n_straight / 32000, 1e6 * (M_PI * 9 + wall_cm2), .015);
        assert_true(n_straight > (entrance_cm > 3 ? 29000 : 31500)); /* the rest was scattered at the edge */
        phase_space_finish(&beam);
    }
}

/* The slow groups of a source follow Maxwell's current, E exp(-E / kT), within their bounds: means by integration, two
 * thirds of the upper bound where that is far below kT = 0.0253 eV. */
static void slow_groups_follow_maxwells_current_within_their_bounds(void **state)
{
    (void)state;
    static const struct {
        double high_ev, low_ev, mean_ev, within;
    } rows[] = { { .11, 1e-5, .04395, 6e-3 }, { 1e-4, 1e-6, 6.665e-5, 6e-3 }, { .06, .05, .05482, 1e-3 } };
    for (size_t row = 0; row < sizeof rows / sizeof *rows; row++) {
        struct beam_source source = { .name = "made", .n_cuts = 1, .radius_cm = 3, .to_aperture_cm = 1 };
        source.neutrons =
            (struct beam_spectrum){ 1, { rows[row].high_ev, rows[row].low_ev }, { 1 }, { { 1 } }, 1, false };
        struct phase_space beam;
        struct error err = { 0 };
        assert_true(phase_space_of_source(&beam, &source, 160000, 0, 7, 2, NULL, &err));
        double sum = 0;
        for (size_t i = 0; i < beam.neutrons.n; i++) {
            double energy_ev = (double)beam.neutrons.particles[i].energy;
            assert_true(energy_ev > rows[row].low_ev * .9999 && energy_ev < rows[row].high_ev * 1.0001);
            sum += energy_ev;
        }
        assert_near(sum / (double)beam.neutrons.n, rows[row].mean_ev, rows[row].within);
        phase_space_finish(&beam);
    }
}

static void drawing_a_list_ends_when_it_is_hopeless_or_cancelled(void **state)
{
    (void)state;
    struct beam_source source = { .name = "made", .n_cuts = 1, .radius_cm = 30, .to_aperture_cm = 20 };
    source.delimiter = (struct beam_delimiter){ 20, .1, .1, 200 };
    source.neutrons = (struct beam_spectrum){ 1, { .026, .025 }, { 1 }, { { 1 } }, 1e6, true };
    struct phase_space beam;
    struct error err = { 0 };
    double before_s = cpu_s();
    assert_false(phase_space_of_source(&beam, &source, 4000000, 0, 3, 2, NULL, &err));
    assert_string_equal(err.text,
                        "source made: fewer than one of 2000 particles, or none of 100000, reaches the aperture");
    assert_null(beam.neutrons.particles);
    assert_true(cpu_s() - before_s < 30); /* 4 million entries take an hour */
    atomic_bool cancel = true;
    source.delimiter.length_cm = 0;
    assert_false(phase_space_of_source(&beam, &source, 4000000, 0, 3, 2, &cancel, &err));
    assert_int_equal(err.code, ERROR_CANCELLED);
    assert_null(beam.neutrons.particles);
}

/* Also within a tenth of a degree of an axis, where 1 - w^2 has no digits left. */
static void a_turned_direction_keeps_its_length(void **state)
{
    (void)state;
    const float azimuth[2] = { .6F, .8F };
    for (double angle = 1e-4; angle < 1.5; angle *= 1.2)
        for (float cosine = -1; cosine <= 1; cosine += .25F) {
            float direction[3] = { (float)(.8 * sin(angle)), (float)(.6 * sin(angle)), (float)cos(angle) };
            float before[3] = { direction[0], direction[1], direction[2] };
            direction_turn(direction, cosine, azimuth);
            double square = 0, along = 0;
            for (int i = 0; i < 3; i++) {
                square += (double)direction[i] * (double)direction[i];
                along += (double)direction[i] * (double)before[i];
            }
            assert_close(sqrt(square), 1, 1e-5);
            assert_close(along, cosine, angle < 2e-3 ? 2e-3 : 1e-5); /* so near the axis it counts as the axis */
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_turned_direction_keeps_its_length),
        cmocka_unit_test(air_before_a_short_delimiter_takes_no_neutron),
        cmocka_unit_test(a_disk_within_its_delimiter_is_refused_with_both_lengths),
        cmocka_unit_test(a_delimiter_lets_slow_neutrons_through_its_hole_alone),
        cmocka_unit_test(slow_groups_follow_maxwells_current_within_their_bounds),
        cmocka_unit_test(drawing_a_list_ends_when_it_is_hopeless_or_cancelled),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
