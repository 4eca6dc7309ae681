/* Simulations whose answer is known: closed forms, balances, laws of chance. */
#include "core/transport/transport.h"

#include "core/base/parallel.h"
#include "core/transport/medium.h"
#include "tests/unit/core/transport/made_world.h"

/* Fluence times volume of the layers of cells that begin at each depth: what a tally of path lengths adds up to. */
static double layer_cm(const struct transport_result *result, enum transport_quantity quantity, uint32_t from_mm)
{
    const struct volume *values = result->values[quantity];
    double sum = 0;
    for (uint32_t k = 0; k < values->grid.size[2]; k++) {
        struct vec3 at = affine_point(&values->grid.lps_mm_from_ijk, vec3(0, 0, k));
        if (fabs(at.z - from_mm - 5) > 1)
            continue;
        for (uint32_t j = 0; j < values->grid.size[1]; j++)
            for (uint32_t i = 0; i < values->grid.size[0]; i++)
                sum += volume_value(values, i, j, k);
    }
    return sum;
}

static void a_beam_falls_through_a_slab_by_the_exponential_law(void **state)
{
    (void)state;
    double energy_ev = neutron_bin_ev(neutron_bin(1.F)), sigma_cm = .5;
    struct world_made *world = make(2, energy_ev, 640000, 3);
    make_absorber(world, sigma_cm / sqrt(.0253 / energy_ev));
    fill(world, NULL);
    struct transport_result result = run(world);
    double through = 1e6 * M_PI * 4;
    for (uint32_t depth = 0; depth < 8; depth++) { /* 3.5 %: three standard deviations of the deepest */
        double expected = through * (exp(-sigma_cm * depth) - exp(-sigma_cm * (depth + 1))) / sigma_cm;
        assert_near(layer_cm(&result, TRANSPORT_EPITHERMAL_FLUENCE, depth * 10), expected, .035);
    }
    assert_near(result.balance.leaked, exp(-8 * sigma_cm), .05);
    assert_close(result.balance.leaked + result.balance.absorbed + result.balance.dropped, 1, 1e-4);
    transport_result_finish(&result);
    drop(world);
}

/* A wide beam through a ball: the mean of exp(-sigma chord) over its disk. */
static void a_ball_lets_through_what_its_chords_do(void **state)
{
    (void)state;
    double energy_ev = neutron_bin_ev(neutron_bin(1.F)), sigma_cm = .3, twice = 2 * sigma_cm * 3;
    struct world_made *world = make(3, energy_ev, 160000, 5);
    make_absorber(world, sigma_cm / sqrt(.0253 / energy_ev));
    fill(world, in_sphere);
    struct transport_result result = run(world);
    double expected = 2 * (1 - (1 + twice) * exp(-twice)) / (twice * twice);
    assert_near(result.balance.leaked, expected, .02); /* cubes of 2 mm for a ball of 30 mm: 1 % */
    transport_result_finish(&result);
    drop(world);
}

/* The integral of the photon dose of brain. */
static double photon_mev(const struct transport_result *result)
{
    double gy_cm3 = 0;
    const struct volume *gamma = result->values[TRANSPORT_GAMMA];
    for (size_t i = 0; i < grid_n_voxels(&gamma->grid); i++)
        gy_cm3 += (double)((float *)gamma->voxels)[i];
    return gy_cm3 * 1.04 / 1.602177e-10;
}

/* Each neutron ends in one of three ways, each photon's energy in one of two. */
static void particles_and_energy_are_neither_lost_nor_made(void **state)
{
    (void)state;
    struct world_made *world = make(3, 1000, 32000, 7);
    fill(world, NULL);
    struct transport_result result = run(world);
    const struct transport_balance *balance = &result.balance;
    assert_close(balance->leaked + balance->absorbed + balance->dropped, 1, 1e-4);
    assert_close(balance->dropped, 0, .002);
    assert_true(balance->absorbed > .05 && balance->absorbed < .6 && balance->missed < 1e-6);
    assert_close(balance->photon_leaked + balance->photon_left, 1, 1e-3);
    /* The integral of the photon dose is the energy left, but for what pairs and bremsstrahlung carry off: it counts as
     * left and not as dose. */
    struct medium *medium = calloc(1, sizeof *medium);
    assert_non_null(medium);
    medium_init(medium, &world->material);
    double emitted_mev = 1e6 * M_PI * 9 * balance->absorbed * medium->emitted_mev;
    assert_near(photon_mev(&result), emitted_mev * balance->photon_left, .06);
    free(medium);
    transport_result_finish(&result);
    drop(world);
}

static void four_times_the_histories_halve_the_error(void **state)
{
    (void)state;
    struct world_made *world = make(3, 1000, 64000, 9);
    fill(world, NULL);
    double mean[2] = { 0 };
    for (int i = 0; i < 2; i++) {
        world->input.n_histories = i ? 64000 : 16000;
        struct transport_result result = run(world);
        const float *value = result.values[TRANSPORT_THERMAL_FLUENCE]->voxels,
                    *error = result.errors[TRANSPORT_THERMAL_FLUENCE]->voxels;
        double n = 0;
        for (size_t c = 0; c < grid_n_voxels(&result.mask->grid); c++)
            if (value[c] > .3F * (float)result.values[TRANSPORT_THERMAL_FLUENCE]->high) {
                mean[i] += (double)(error[c] / value[c]);
                n++;
            }
        mean[i] /= n;
        transport_result_finish(&result);
    }
    assert_near(mean[0] / mean[1], 2, .1);
    drop(world);
}

/* (a - b)^2 over the sum of variances, mean over cells that got a third of the maximum. Both variances are of 16 lanes:
 * the mean of its inverse is 15 / 13 of the inverse of the mean, for the sum of two 30 / 28. */
static double chi_square(const struct volume *a, const struct volume *a_error, const struct volume *b,
                         const struct volume *b_error)
{
    double sum = 0, n = 0;
    for (uint32_t k = 0; k < a->grid.size[2]; k++)
        for (uint32_t j = 0; j < a->grid.size[1]; j++)
            for (uint32_t i = 0; i < a->grid.size[0]; i++) {
                double value = volume_value(a, i, j, k), variance = pow(volume_value(a_error, i, j, k), 2);
                if (value < .3 * a->high)
                    continue;
                variance += pow(volume_value(b_error, i, j, k), 2);
                sum += pow(value - volume_value(b, i, j, k), 2) / variance;
                n++;
            }
    assert_true(n > 50);
    return sum / n * 28 / 30;
}

static void another_seed_agrees_within_the_errors(void **state)
{
    (void)state;
    double sum = 0;
    enum { PAIRS = 4 };
    for (uint64_t pair = 0; pair < PAIRS; pair++) {
        struct transport_result results[2];
        for (uint64_t i = 0; i < 2; i++) {
            struct world_made *world = make(3, 1000, 32000, 100 + 2 * pair + i);
            world->input.cell_mm = 5;
            fill(world, NULL);
            results[i] = run(world);
            drop(world);
        }
        sum += chi_square(results[0].values[TRANSPORT_THERMAL_FLUENCE], results[0].errors[TRANSPORT_THERMAL_FLUENCE],
                          results[1].values[TRANSPORT_THERMAL_FLUENCE], results[1].errors[TRANSPORT_THERMAL_FLUENCE]);
        transport_result_finish(&results[0]);
        transport_result_finish(&results[1]);
    }
    assert_close(sum / PAIRS, 1, .1);
}

static void the_number_of_threads_changes_no_byte(void **state)
{
    (void)state;
    struct world_made *world = make(3, 1000, 8000, 11);
    fill(world, in_sphere);
    struct transport_result first = run(world);
    for (int threads = 1; threads <= 7; threads += 3) {
        world->input.n_threads = threads;
        struct transport_result other = run(world);
        for (int i = 0; i < TRANSPORT_N_QUANTITIES; i++) {
            size_t size = grid_n_voxels(&first.mask->grid) * sizeof(float);
            assert_memory_equal(first.values[i]->voxels, other.values[i]->voxels, size);
            assert_memory_equal(first.errors[i]->voxels, other.errors[i]->voxels, size);
        }
        transport_result_finish(&other);
    }
    transport_result_finish(&first);
    drop(world);
}

/* Head and beam turned together, the voxels also stored in another order of axes: the same doses at the same places. */
static void head_and_beam_turned_together_give_the_same(void **state)
{
    (void)state;
    enum { PAIRS = 8 };
    struct affine turned = { .origin = { 50, -20, 7 } };
    turned.columns[0] = vec3(2 * cos(.6), 2 * sin(.6), 0);
    turned.columns[1] = vec3(-2 * sin(.6), 2 * cos(.6), 0);
    turned.columns[2] = vec3(0, 0, 2);
    double boron = 0, thermal = 0;
    for (uint64_t pair = 0; pair < PAIRS; pair++) {
        struct transport_result results[2];
        for (uint64_t i = 0; i < 2; i++) {
            struct world_made *world = make(2, 1000, 16000, 200 + 2 * pair + i);
            struct error err = { 0 };
            fill(world, in_odd_shape);
            world->input.cell_mm = 5;
            if (i == 1) {
                assert_true(grid_init(&world->grid, (uint32_t[]){ SIDE, SIDE, SIDE }, &turned, &err));
                world->input.aperture_lps_mm = affine_point(&turned, vec3(19.5, 19.5, -15.5));
                world->input.direction_lps = vec3_normalize(affine_vector(&turned, vec3(0, 0, 1)));
            }
            results[i] = run(world);
            drop(world);
        }
        boron += chi_square(results[0].values[TRANSPORT_BORON], results[0].errors[TRANSPORT_BORON],
                            results[1].values[TRANSPORT_BORON], results[1].errors[TRANSPORT_BORON]);
        thermal +=
            chi_square(results[0].values[TRANSPORT_THERMAL_FLUENCE], results[0].errors[TRANSPORT_THERMAL_FLUENCE],
                       results[1].values[TRANSPORT_THERMAL_FLUENCE], results[1].errors[TRANSPORT_THERMAL_FLUENCE]);
        transport_result_finish(&results[0]);
        transport_result_finish(&results[1]);
    }
    assert_close(boron / PAIRS, 1, .1);
    assert_close(thermal / PAIRS, 1, .1);
}

static void a_cancelled_run_stops_and_leaves_nothing(void **state)
{
    (void)state;
    struct cancelling cancelling = { .at = .002 };
    struct world_made *world = make(3, 1000, 8000, 15);
    fill(world, NULL);
    world->input.n_histories = 40000000;
    world->input.cancel = &cancelling.cancel;
    world->input.progress = cancel_there;
    world->input.context = &cancelling;
    struct transport_result result;
    struct error err = { 0 };
    double before_s = cpu_s();
    assert_false(transport_run(&world->input, &result, &err));
    assert_int_equal(err.code, ERROR_CANCELLED);
    assert_null(result.mask);
    assert_true(cancelling.cancelled_us > 0);
    assert_true(cpu_s() - before_s < 20); /* all of the work takes minutes; how soon, make bench measures */
    drop(world);
}

/* ---- a run that goes on ------------------------------------------------------------------------------------------- */

/* Equal histories, added up in another order: sums in single precision differ in their last digits. */
static void histories_in_steps_give_what_they_give_at_once(void **state)
{
    (void)state;
    struct world_made *world = make(3, 1000, 16000, 19);
    fill(world, in_sphere);
    struct transport_result whole = run(world);
    struct transport_run *run = begin(world);
    for (uint64_t n = 1000; n <= 8000; n *= 2)
        step(run, n);
    step(run, 999);
    step(run, 1);
    assert_true(transport_run_histories(run) == 16000);
    struct transport_result steps = look(run);
    assert_true(steps.n_histories == 16000 && steps.seconds > 0);
    for (int i = 0; i < TRANSPORT_N_QUANTITIES; i++)
        for (size_t c = 0; c < grid_n_voxels(&whole.mask->grid); c++) {
            double value = (double)((float *)whole.values[i]->voxels)[c];
            assert_close(((float *)steps.values[i]->voxels)[c], value, 1e-4 * value + 1e-9 * whole.values[i]->high);
        }
    assert_close(steps.balance.absorbed, whole.balance.absorbed, 1e-9);
    transport_result_finish(&steps);
    transport_result_finish(&whole);
    transport_run_destroy(run);
    drop(world);
}

static void another_pose_begins_anew(void **state)
{
    (void)state;
    struct world_made *world = make(2, 1000, 8000, 23);
    fill(world, in_odd_shape);
    struct transport_run *run = begin(world);
    step(run, 5000);
    struct error err = { 0 };
    assert_false(transport_run_aim(run, vec3(40, 40, -30), vec3(0, 0, 2), &err));
    assert_true(transport_run_histories(run) == 5000); /* refused: the run is as it was */
    world->input.aperture_lps_mm = vec3(-30, 45, 40);
    world->input.direction_lps = vec3(1, 0, 0);
    assert_true(transport_run_aim(run, world->input.aperture_lps_mm, world->input.direction_lps, &err));
    assert_true(transport_run_histories(run) == 0);
    struct transport_result moved;
    assert_false(transport_run_read(run, &moved, &err));
    assert_int_equal(err.code, ERROR_STATE);
    step(run, 8000);
    moved = look(run);
    struct transport_run *fresh = begin(world);
    step(fresh, 8000);
    struct transport_result expected = look(fresh);
    assert_same_bytes(&moved, &expected);
    assert_true(moved.values[TRANSPORT_BORON]->high > 0);
    transport_result_finish(&moved);
    transport_result_finish(&expected);
    transport_run_destroy(run);
    transport_run_destroy(fresh);
    drop(world);
}

/* A cancelled step is undone to the last whole batch, here to what was there before, and the run goes on as if it had
 * never been. */
static void a_cancelled_step_leaves_the_run_as_it_was(void **state)
{
    (void)state;
    struct cancelling cancelling = { .at = .1 };
    struct world_made *world = make(3, 1000, 8000, 25);
    fill(world, NULL);
    struct transport_run *undisturbed = begin(world);
    step(undisturbed, 8000);
    struct transport_result before = look(undisturbed);
    step(undisturbed, 8000);
    struct transport_result after = look(undisturbed);
    world->input.cancel = &cancelling.cancel;
    world->input.progress = cancel_there;
    world->input.context = &cancelling;
    atomic_store(&cancelling.cancel, true);
    struct error err = { 0 };
    assert_null(transport_run_create(&world->input, &err)); /* while it is set up */
    assert_int_equal(err.code, ERROR_CANCELLED);
    atomic_store(&cancelling.cancel, false);
    world->input.progress = NULL;
    struct transport_run *run = begin(world);
    step(run, 8000);
    atomic_store(&cancelling.cancel, true);
    assert_false(transport_run_step(run, 4000000, &err));
    atomic_store(&cancelling.cancel, false);
    assert_int_equal(err.code, ERROR_CANCELLED);
    struct transport_result result = look(run);
    assert_same_bytes(&result, &before);
    transport_result_finish(&result);
    step(run, 8000);
    result = look(run);
    assert_same_bytes(&result, &after);
    transport_result_finish(&result);
    transport_result_finish(&before);
    transport_result_finish(&after);
    transport_run_destroy(undisturbed);
    transport_run_destroy(run);
    drop(world);
}

/* Histories of a lane that were under way when the step was cancelled count for nothing. */
static void a_step_that_is_cancelled_at_work_leaves_nothing_of_it(void **state)
{
    (void)state;
    struct cancelling cancelling = { .at = .1 };
    struct world_made *world = make(3, 1000, 8000, 27);
    fill(world, NULL);
    world->input.cancel = &cancelling.cancel;
    world->input.progress = cancel_there;
    world->input.context = &cancelling;
    struct transport_run *run = begin(world);
    struct error err = { 0 };
    assert_false(transport_run_step(run, 40000, &err));
    assert_true(cancelling.cancelled_us > 0 && transport_run_histories(run) == 0);
    world->input.progress = NULL;
    world->input.cancel = NULL;
    struct transport_run *fresh = begin(world);
    step(fresh, 4000);
    struct transport_result expected = look(fresh);
    atomic_store(&cancelling.cancel, false);
    cancelling.is_spent = true;
    step(run, 4000);
    struct transport_result result = look(run);
    assert_same_bytes(&result, &expected);
    transport_result_finish(&result);
    transport_result_finish(&expected);
    transport_run_destroy(run);
    transport_run_destroy(fresh);
    drop(world);
}

/* A beam of photons brings the energy of its photons, whatever few neutrons come with it. */
static void photons_of_the_beam_bring_their_energy(void **state)
{
    (void)state;
    struct world_made *world = make(3, 1000, 1600, 31);
    phase_space_finish(&world->beam);
    struct error err = { 0 };
    world->source.neutrons.per_cm2 = 1;
    world->source.photons = (struct beam_spectrum){ 1, { 1.01e6, .99e6 }, { 1 }, { { 1 } }, 1e6, false };
    assert_true(phase_space_of_source(&world->beam, &world->source, 1600, 16000, 3, 2, NULL, &err));
    world->input.n_histories = 128000;
    fill(world, NULL);
    struct transport_result result = run(world);
    assert_close(result.balance.photon_leaked + result.balance.photon_left, 1, 1e-3);
    assert_true(result.balance.photon_left > .2 && result.balance.photon_left < .8);
    assert_near(photon_mev(&result), 1e6 * M_PI * 9 * result.balance.photon_left, .03);
    transport_result_finish(&result);
    drop(world);
}

/* Cells of a dose of others that reach beyond the box in which particles are followed have no dose, and not one of 0.
 * The ball of 3 cm in the middle of 8 cm has a box from -1 to 9 cm along each axis. */
static void whole_cells_count_where_particles_are_followed(void **state)
{
    (void)state;
    struct world_made *world = make(3, 1000, 16000, 29);
    fill(world, in_sphere);
    struct grid cells;
    struct error err = { 0 };
    struct affine map = { { { -10, 0, 0 }, { 0, 10, 0 }, { 0, 0, 8 } }, { 104.5, -15.5, -46 } };
    assert_true(grid_init(&cells, (uint32_t[]){ 12, 14, 19 }, &map, &err));
    world->input.cells = &cells;
    world->input.is_whole_cells = true;
    struct transport_result result = run(world);
    for (uint32_t k = 0; k < 19; k++)
        for (uint32_t j = 0; j < 14; j++)
            for (uint32_t i = 0; i < 12; i++) {
                struct vec3 at = affine_point(&map, vec3(i, j, k));
                bool is_within = at.x > -5.1 && at.x < 85.1 && at.y > -5.1 && at.y < 85.1 && at.z > -6.1 && at.z < 86.1;
                assert_true((volume_value(result.mask, i, j, k) > 0) == is_within);
                bool is_beam = is_within && hypot(at.x - 40, at.y - 40) < 20;
                assert_true((volume_value(result.values[TRANSPORT_EPITHERMAL_FLUENCE], i, j, k) > 0) || !is_beam);
                assert_true(is_within || volume_value(result.values[TRANSPORT_BORON], i, j, k) <= 0);
            }
    transport_result_finish(&result);
    drop(world);
}

static struct error refused(const struct world_made *world)
{
    struct transport_result result;
    struct error err = { 0 };
    assert_false(transport_run(&world->input, &result, &err));
    assert_null(result.mask);
    return err;
}

static void input_beyond_its_limits_is_refused_with_what_was_expected(void **state)
{
    (void)state;
    struct world_made *world = make(3, 1000, 1600, 17);
    assert_string_equal(refused(world).text, "no voxel holds matter: every region is air");
    fill(world, NULL);
    world->voxels[5] = 2;
    assert_string_equal(refused(world).text, "voxel 5 has material 2, at most 1 expected");
    world->voxels[5] = 1;
    struct transport_input good = world->input;
    world->input.n_histories = 3;
    assert_non_null(strstr(refused(world).text, "3 histories, 16 to"));
    world->input = good;
    world->input.direction_lps = vec3(0, 0, 2);
    assert_string_equal(refused(world).text, "the beam's direction is 0, 0, 2, of length 2, 1 expected");
    world->input = good;
    world->input.aperture_lps_mm = vec3(0, 3e9, 0);
    assert_non_null(strstr(refused(world).text, "the aperture is at 0, 3e+09, 0 mm, at most"));
    world->input = good;
    world->input.cell_mm = .5;
    assert_string_equal(refused(world).text, "cells of 0.5 mm, 1 to 50 expected");
    world->input.cell_mm = 1;
    assert_int_equal(refused(world).code, ERROR_LIMIT);
    world->input = good;
    struct grid cells;
    struct error err = { 0 };
    struct affine oblique = { { { 4, 4, 0 }, { -4, 4, 0 }, { 0, 0, 5 } }, { 0, 0, 0 } };
    assert_true(grid_init(&cells, (uint32_t[]){ 9, 9, 9 }, &oblique, &err));
    world->input.cells = &cells;
    assert_string_equal(refused(world).text, "the cells' grid does not have the axes of the regions' grid");
    drop(world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_beam_falls_through_a_slab_by_the_exponential_law),
        cmocka_unit_test(a_ball_lets_through_what_its_chords_do),
        cmocka_unit_test(particles_and_energy_are_neither_lost_nor_made),
        cmocka_unit_test(four_times_the_histories_halve_the_error),
        cmocka_unit_test(another_seed_agrees_within_the_errors),
        cmocka_unit_test(the_number_of_threads_changes_no_byte),
        cmocka_unit_test(head_and_beam_turned_together_give_the_same),
        cmocka_unit_test(a_cancelled_run_stops_and_leaves_nothing),
        cmocka_unit_test(histories_in_steps_give_what_they_give_at_once),
        cmocka_unit_test(another_pose_begins_anew),
        cmocka_unit_test(a_cancelled_step_leaves_the_run_as_it_was),
        cmocka_unit_test(a_step_that_is_cancelled_at_work_leaves_nothing_of_it),
        cmocka_unit_test(photons_of_the_beam_bring_their_energy),
        cmocka_unit_test(whole_cells_count_where_particles_are_followed),
        cmocka_unit_test(input_beyond_its_limits_is_refused_with_what_was_expected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
