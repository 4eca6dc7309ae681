/* Simulations of a made head of ellipsoids in 2 mm (J. T. Goorley, W. S. Kiger, R. G. Zamenhof, Med. Phys. 29, 145,
 * 2002) in their beam, on two threads: one of 100,000 histories from its input to its doses, histories a second of a
 * long one, and how long a cancelled one goes on. */
#include <stdio.h>
#include <stdlib.h>

#include "core/base/clock.h"
#include "core/transport/transport.h"

enum { NX = 74, NY = 104, NZ = 90, N_LIST = 400000, REPEATS = 7, N_LONG = 2000000 };

static _Noreturn void die(const struct error *err)
{
    fprintf(stderr, "bench_transport: %s\n", err->text);
    exit(1);
}

static uint8_t material_at(double x, double y, double z)
{
    static const double axes[3][4] = { { 60, 90, 65, 10 }, { 68, 98, 83, 0 }, { 73, 103, 88, 0 } };
    for (int i = 0; i < 3; i++) {
        double u = x / axes[i][0], v = y / axes[i][1], w = (z - axes[i][3]) / axes[i][2];
        if (u * u + v * v + w * w <= 1)
            return (uint8_t)(3 - i);
    }
    return 0;
}

struct cancelling {
    atomic_bool cancel;
    int64_t asked_us;
};
static void cancel_at_a_tenth(void *context, double share)
{
    struct cancelling *cancelling = context;
    if (share > .1 && !atomic_exchange(&cancelling->cancel, true))
        cancelling->asked_us = clock_now_us();
}

static double run(const struct transport_input *input)
{
    struct transport_result result;
    struct error err = { 0 };
    int64_t began_us = clock_now_us();
    if (!transport_run(input, &result, &err))
        die(&err);
    transport_result_finish(&result);
    return (double)(clock_now_us() - began_us) / 1000;
}

static int by_size(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* A preview's update: another pose, histories, doses. */
static double update(struct transport_run *run, const struct transport_input *input)
{
    struct transport_result result;
    struct error err = { 0 };
    int64_t began_us = clock_now_us();
    if (!transport_run_aim(run, input->aperture_lps_mm, input->direction_lps, &err) ||
        !transport_run_step(run, input->n_histories, &err) || !transport_run_read(run, &result, &err))
        die(&err);
    transport_result_finish(&result);
    return (double)(clock_now_us() - began_us) / 1000;
}

static void measure_updates(struct transport_input input)
{
    double ms[REPEATS];
    struct error err = { 0 };
    input.mode = TRANSPORT_HYBRID;
    struct transport_run *run = transport_run_create(&input, &err);
    if (!run)
        die(&err);
    update(run, &input);
    for (int i = 0; i < REPEATS; i++)
        ms[i] = update(run, &input);
    transport_run_destroy(run);
    qsort(ms, REPEATS, sizeof *ms, by_size);
    printf(
        "{\"name\":\"an update of 100,000 histories in hybrid mode\",\"value\":%.0f,\"unit\":\"ms\",\"note\":\"least "
        "%.0f; at most 100 asked for\"}\n",
        ms[REPEATS / 2], ms[0]);
}

int main(void)
{
    static uint8_t voxels[NX * NY * NZ];
    struct grid grid;
    struct error err = { 0 };
    struct affine map = { { { 2, 0, 0 }, { 0, 2, 0 }, { 0, 0, 2 } }, { 1 - NX, 1 - NY, 1 - NZ } };
    struct material materials[3];
    if (!grid_init(&grid, (uint32_t[]){ NX, NY, NZ }, &map, &err) || !material_of_word("skin", &materials[0], &err) ||
        !material_of_word("cranium", &materials[1], &err) || !material_of_word("brain", &materials[2], &err))
        die(&err);
    for (int i = 0; i < NX * NY * NZ; i++)
        voxels[i] = material_at(2 * (i % NX) + 1 - NX, 2 * (i / NX % NY) + 1 - NY, 2 * (double)(i / NX / NY) + 1 - NZ);
    struct beam_source source = { .name = "Goorley", .n_cuts = 1, .radius_cm = 5, .to_aperture_cm = .01 };
    source.neutrons =
        (struct beam_spectrum){ 3, { 2e6, 1e4, .5, 1e-3 }, { .01, .89, .10 }, { { 1 }, { 1 }, { 1 } }, 6e11, true };
    struct phase_space beam;
    if (!phase_space_of_source(&beam, &source, N_LIST, 0, 1, 2, NULL, &err))
        die(&err);
    struct transport_input input = { .grid = &grid,
                                     .voxels = voxels,
                                     .materials = materials,
                                     .n_materials = 3,
                                     .beam = &beam,
                                     .aperture_lps_mm = { 0, 0, 150 },
                                     .direction_lps = { 0, 0, -1 },
                                     .n_histories = 100000,
                                     .seed = 1,
                                     .cell_mm = 5,
                                     .n_threads = 2 };
    double ms[REPEATS];
    for (int i = 0; i < REPEATS; i++)
        ms[i] = run(&input);
    qsort(ms, REPEATS, sizeof *ms, by_size);
    printf("{\"name\":\"a simulation of 100,000 histories\",\"value\":%.0f,\"unit\":\"ms\",\"note\":\"least %.0f\"}\n",
           ms[REPEATS / 2], ms[0]);
    measure_updates(input);
    input.n_histories = N_LONG;
    double long_ms = run(&input);
    printf("{\"name\":\"histories of a long simulation\",\"value\":%.0f,\"unit\":\"1/s\",\"note\":\"at least 400,000 "
           "asked for\"}\n",
           N_LONG / long_ms * 1000);
    struct cancelling cancelling = { 0 };
    struct transport_result result;
    input.cancel = &cancelling.cancel;
    input.progress = cancel_at_a_tenth;
    input.context = &cancelling;
    if (transport_run(&input, &result, &err) || err.code != ERROR_CANCELLED)
        die(&err);
    printf("{\"name\":\"a cancelled simulation goes on\",\"value\":%.1f,\"unit\":\"ms\",\"note\":\"at most 20 asked "
           "for\"}\n",
           (double)(clock_now_us() - cancelling.asked_us) / 1000);
    phase_space_finish(&beam);
    return 0;
}
