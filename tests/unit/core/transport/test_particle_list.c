/* Lists of particles that another program wrote down: place, direction, weight, and what is left out. */
#include "core/transport/particle_list.h"

#include "tests/check.h"

enum { N_LIST = 16000 };

static struct beam_particles make(size_t n_neutrons, size_t n_photons)
{
    struct beam_particles particles;
    struct error err = { 0 };
    assert_true(beam_particles_init(&particles, n_neutrons, n_photons, "made", &err));
    particles.n_neutrons = n_neutrons;
    particles.n_photons = n_photons;
    for (size_t i = 0; i < n_neutrons; i++)
        particles.neutrons[i] = (struct beam_particle){ { 3, 4, 5 }, { 0, 1, 0 }, 1e-6F, 1 };
    for (size_t i = 0; i < n_photons; i++)
        particles.photons[i] = (struct beam_particle){ { 3, 4, 5 }, { 0, 1, 0 }, 2, 1 };
    return particles;
}

static struct particle_frame frame_of(double turn_rad)
{
    struct particle_frame frame;
    struct error err = { 0 };
    assert_true(particle_frame_init(&frame, (double[]){ 1, 1, 1 }, (double[]){ 0, 2, 0 }, (double[]){ 0, 1, 1 }, &err));
    frame.turn_rad = turn_rad;
    return frame;
}

struct listed {
    struct phase_space space;
    struct particle_weights neutrons, photons;
};

static struct listed list(const struct beam_particles *particles, double turn_rad, uint64_t seed)
{
    struct listed listed;
    struct particle_frame frame = frame_of(turn_rad);
    struct error err = { 0 };
    if (!phase_space_of_particles(&listed.space, particles, &frame, 10, N_LIST, N_LIST, seed, &listed.neutrons,
                                  &listed.photons, &err))
        fail_msg("%s", err.text);
    return listed;
}

/* The beam goes to the file's +y; its x is the file's z, so that its y is the file's x. */
static void a_particle_lies_in_the_beams_axes_at_the_aperture_plane(void **state)
{
    (void)state;
    struct beam_particles particles = make(16, 16);
    struct listed listed = list(&particles, 0, 1);
    const struct particle *p = &listed.space.neutrons.particles[7];
    assert_close(p->x_cm, 4, 1e-6);
    assert_close(p->y_cm, 2, 1e-6);
    assert_close(p->direction[2], 1, 1e-6);
    assert_close(p->energy, 1, 1e-6); /* eV */
    assert_close(listed.space.photons.particles[7].energy, 2, 1e-6);
    phase_space_finish(&listed.space);
    for (size_t i = 0; i < 16; i++) { /* 3 cm before the plane, on a slope of 3 to 4 towards the file's z */
        particles.neutrons[i].position_cm[1] = -2;
        particles.neutrons[i].direction[1] = .8F;
        particles.neutrons[i].direction[2] = .6F;
    }
    listed = list(&particles, 0, 1);
    p = &listed.space.neutrons.particles[15];
    assert_close(p->x_cm, 4 + 2.25, 1e-5);
    assert_close(p->y_cm, 2, 1e-5);
    assert_close(p->direction[0], .6, 1e-6);
    phase_space_finish(&listed.space);
    listed = list(&particles, M_PI / 2, 1); /* x to y, y to -x */
    p = &listed.space.neutrons.particles[15];
    assert_close(p->x_cm, -2, 1e-5);
    assert_close(p->y_cm, 6.25, 1e-5);
    assert_close(p->direction[1], .6, 1e-6);
    phase_space_finish(&listed.space);
    beam_particles_finish(&particles);
}

static double sum_above(const struct particle_list *list, float energy)
{
    double sum = 0;
    for (size_t i = 0; i < list->n; i++)
        sum += list->particles[i].energy > energy ? (double)list->particles[i].weight : 0;
    return sum * list->per_unit / (double)list->n;
}

/* Weights over six decades and two energies: as many real particles of each as the file has, at 10 for a weight of 1.
 */
static void a_list_stands_for_as_many_particles_as_the_weights_say(void **state)
{
    (void)state;
    struct beam_particles particles = make(4000, 4000);
    double all = 0, fast = 0, photons = 0;
    for (size_t i = 0; i < 4000; i++) {
        particles.neutrons[i].weight = (float)pow(10, -6 + 6 * (double)(i * 7919 % 4000) / 4000);
        particles.photons[i].weight = particles.neutrons[i].weight;
        if (i % 5 == 0)
            particles.neutrons[i].energy_mev = 1;
        all += (double)particles.neutrons[i].weight;
        photons += (double)particles.photons[i].weight;
        fast += i % 5 == 0 ? (double)particles.neutrons[i].weight : 0;
    }
    struct listed listed = list(&particles, 0, 3);
    assert_int_equal(listed.space.neutrons.n, N_LIST);
    assert_near(listed.neutrons.all, all, 1e-9);
    assert_near(listed.space.neutrons.per_unit, 10 * all, 1e-6);
    assert_near(sum_above(&listed.space.neutrons, 0), 10 * all, .06);
    assert_near(sum_above(&listed.space.neutrons, 1e5F), 10 * fast, .02);
    assert_near(sum_above(&listed.space.photons, 0), 10 * photons, .002);
    size_t n_fast = 0;
    for (size_t i = 0; i < N_LIST; i++)
        n_fast += listed.space.neutrons.particles[i].energy > 1e5F;
    assert_true((double)n_fast > 4 * N_LIST * fast / all * .2); /* drawn more often than their share */
    struct listed again = list(&particles, 0, 3), other = list(&particles, 0, 4);
    const size_t bytes = N_LIST * sizeof *listed.space.neutrons.particles;
    assert_memory_equal(again.space.neutrons.particles, listed.space.neutrons.particles, bytes);
    assert_true(memcmp(other.space.neutrons.particles, listed.space.neutrons.particles, bytes) != 0);
    phase_space_finish(&listed.space);
    phase_space_finish(&again.space);
    phase_space_finish(&other.space);
    beam_particles_finish(&particles);
}

/* A lane has its own part of the file: what is in the last sixteenth alone comes in the last lane alone. */
static void lanes_share_no_particles(void **state)
{
    (void)state;
    struct beam_particles particles = make(1600, 0);
    for (size_t i = 1500; i < 1600; i++)
        particles.neutrons[i].energy_mev = 2e-6F;
    struct listed listed = list(&particles, 0, 1);
    for (size_t i = 0; i < N_LIST; i++)
        assert_close(listed.space.neutrons.particles[i].energy, i % PHASE_SPACE_LANES == 15 ? 2 : 1, 1e-6);
    phase_space_finish(&listed.space);
    beam_particles_finish(&particles);
}

static void what_does_not_go_through_the_aperture_is_left_out_and_counted(void **state)
{
    (void)state;
    struct beam_particles particles = make(100, 10);
    for (size_t i = 0; i < 10; i++)
        particles.neutrons[i].direction[1] = -1; /* back */
    for (size_t i = 10; i < 30; i++)
        particles.neutrons[i].position_cm[0] = 32; /* 31 cm off the axis */
    struct listed listed = list(&particles, 0, 1);
    assert_close(listed.neutrons.all, 100, 1e-9);
    assert_close(listed.neutrons.backward, 10, 1e-9);
    assert_close(listed.neutrons.beside, 20, 1e-9);
    assert_int_equal(listed.neutrons.n_used, 70);
    assert_near(listed.space.neutrons.per_unit, 700, 1e-9);
    assert_int_equal(listed.space.photons.n, 0); /* ten are too few for sixteen lanes */
    phase_space_finish(&listed.space);
    struct particle_frame frame = frame_of(0);
    struct phase_space space;
    struct error err = { 0 };
    particles.n_neutrons = 45;
    assert_false(
        phase_space_of_particles(&space, &particles, &frame, 1, 16, 16, 1, &listed.neutrons, &listed.photons, &err));
    assert_string_equal(err.text, "of 45 neutrons 15 go through the aperture plane, 16 or more expected");
    beam_particles_finish(&particles);
}

/* A photon of no energy is in the file of a program that lists what it killed; it would scatter for ever. */
static void photons_too_soft_to_be_followed_are_left_out_and_counted(void **state)
{
    (void)state;
    struct beam_particles particles = make(16, 64);
    for (size_t i = 0; i < 64; i++)
        particles.photons[i].energy_mev = i % 4 == 0 ? 0 : i % 4 == 1 ? .0299F : .0301F;
    struct listed listed = list(&particles, 0, 1);
    assert_close(listed.photons.soft, 32, 1e-9);
    assert_int_equal(listed.photons.n_used, 32);
    assert_near(listed.space.photons.per_unit, 320, 1e-9);
    for (size_t i = 0; i < N_LIST; i++)
        assert_true(listed.space.photons.particles[i].energy > .03F);
    assert_close(listed.neutrons.soft, 0, 0);
    phase_space_finish(&listed.space);
    beam_particles_finish(&particles);
}

static void axes_without_length_or_parallel_ones_are_refused(void **state)
{
    (void)state;
    struct particle_frame frame;
    struct error err = { 0 };
    const double zero[3] = { 0 }, z[3] = { 0, 0, 1 }, back[3] = { 0, 0, -3 };
    assert_false(particle_frame_init(&frame, zero, zero, z, &err));
    assert_false(particle_frame_init(&frame, zero, z, zero, &err));
    assert_non_null(strstr(err.text, "no length"));
    assert_false(particle_frame_init(&frame, zero, z, back, &err));
    assert_non_null(strstr(err.text, "parallel"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_particle_lies_in_the_beams_axes_at_the_aperture_plane),
        cmocka_unit_test(a_list_stands_for_as_many_particles_as_the_weights_say),
        cmocka_unit_test(lanes_share_no_particles),
        cmocka_unit_test(what_does_not_go_through_the_aperture_is_left_out_and_counted),
        cmocka_unit_test(photons_too_soft_to_be_followed_are_left_out_and_counted),
        cmocka_unit_test(axes_without_length_or_parallel_ones_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
