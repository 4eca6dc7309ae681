/* Histories in lanes, lanes over threads, batch by batch. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/transport/run.h"

/* A batch is what a lane can add up in single precision without loss; a photon of the beam for each eight neutrons. */
enum { CHUNK = 256, NEUTRONS_PER_PHOTON = 8, PHOTONS_PER_NEUTRON = 8 };
#define PHOTON_STREAM (UINT64_C(1) << 62) /* random numbers of the beam's photons, beyond all neutrons' */

static bool check_pose(struct vec3 aperture_lps_mm, struct vec3 direction_lps, struct error *err)
{
    if (!vec3_is_finite(aperture_lps_mm) || vec3_length(aperture_lps_mm) > GRID_FARTHEST_MM)
        return error_set(err, ERROR_RANGE, "the aperture is at %g, %g, %g mm, at most %g from the origin expected",
                         aperture_lps_mm.x, aperture_lps_mm.y, aperture_lps_mm.z, GRID_FARTHEST_MM);
    if (!vec3_is_finite(direction_lps) || !(fabs(vec3_length(direction_lps) - 1) < 1e-3))
        return error_set(err, ERROR_RANGE, "the beam's direction is %g, %g, %g, of length %g, 1 expected",
                         direction_lps.x, direction_lps.y, direction_lps.z, vec3_length(direction_lps));
    return true;
}

static bool say_cancelled(struct error *err)
{
    return error_set(err, ERROR_CANCELLED, "the simulation was cancelled");
}

static bool check_voxels(const struct transport_input *input, struct error *err)
{
    if (input->n_materials < 1 || input->n_materials > MATERIAL_MAX)
        return error_set(err, ERROR_LIMIT, "%zu materials, 1 to %d expected", input->n_materials, MATERIAL_MAX);
    for (size_t i = 0; i < input->n_materials; i++)
        if (!material_check(&input->materials[i], err))
            return false;
    size_t n = grid_n_voxels(input->grid), slice = (size_t)input->grid->size[0] * input->grid->size[1];
    for (size_t i = 0; i < n; i++) {
        if (i % slice == 0 && input->cancel && atomic_load(input->cancel))
            return say_cancelled(err);
        if (input->voxels[i] > input->n_materials)
            return error_set(err, ERROR_RANGE, "voxel %zu has material %d, at most %zu expected", i, input->voxels[i],
                             input->n_materials);
    }
    return true;
}

static bool check(const struct transport_input *input, struct error *err)
{
    if (!check_pose(input->aperture_lps_mm, input->direction_lps, err))
        return false;
    if (input->beam->neutrons.n == 0)
        return error_set(err, ERROR_RANGE, "the beam has no neutrons");
    if (input->mode == TRANSPORT_HYBRID &&
        (input->cells || input->is_whole_cells || input->cell_mm != GEOMETRY_BLOCK_CM * 10))
        return error_set(err, ERROR_RANGE, "in hybrid mode other cells than %g mm of its own, in what is not air",
                         GEOMETRY_BLOCK_CM * 10);
    return check_voxels(input, err);
}

static bool make_lanes(struct transport_run *run, struct error *err)
{
    size_t n = run->n_cells * run->world.n_tallies;
    for (int lane = 0; lane < LANES; lane++) {
        run->sums[lane] = mem_array(n, sizeof *run->sums[lane], UINT64_MAX, err);
        run->lanes[lane].tally = run->sums[lane] ? mem_array(n, sizeof *run->lanes[lane].tally, UINT64_MAX, err) : NULL;
        if (!run->lanes[lane].tally)
            return false;
    }
    return true;
}

static bool prepare(struct transport_run *run, struct error *err)
{
    const struct transport_input *input = &run->input;
    if (!geometry_init(&run->geometry, input->grid, input->voxels, input->cells, input->cell_mm, input->cancel, err))
        return false;
    run->media = mem_array(input->n_materials, sizeof *run->media, UINT64_MAX, err);
    run->tables = run->media ? mem_array(1, sizeof *run->tables, UINT64_MAX, err) : NULL;
    if (!run->tables)
        return false;
    for (size_t i = 0; i < input->n_materials && !run_is_asked_to_stop(run); i++)
        medium_init(&run->media[i], &input->materials[i]);
    particle_tables_init(run->tables);
    run->n_cells = grid_n_voxels(&run->geometry.cells);
    if (run_is_asked_to_stop(run))
        return say_cancelled(err);
    run->world.n_tallies = input->mode == TRANSPORT_HYBRID ? N_SLOW_TALLIES : N_TALLIES;
    if (!make_lanes(run, err))
        return false;
    run->world.geometry = &run->geometry;
    run->world.media = run->media;
    run->world.n_media = input->n_materials;
    run->world.tables = run->tables;
    run->world.is_whole_cells = input->is_whole_cells;
    run->world.photons_per_neutron = PHOTONS_PER_NEUTRON;
    run->neutrons_per_photon = NEUTRONS_PER_PHOTON;
    if (input->mode == TRANSPORT_HYBRID && !hybrid_init(run, err))
        return false;
    world_init(&run->world);
    const struct particle_list *neutrons = &input->beam->neutrons, *photons = &input->beam->photons;
    if (photons->n > 0 && photons->per_unit > 0)
        run->photon_weight = (double)run->neutrons_per_photon * photons->per_unit / neutrons->per_unit;
    return transport_run_aim(run, input->aperture_lps_mm, input->direction_lps, err);
}

struct transport_run *transport_run_create(const struct transport_input *input, struct error *err)
{
    if (!check(input, err))
        return NULL;
    struct transport_run *run = mem_array(1, sizeof *run, UINT64_MAX, err);
    if (!run)
        return NULL;
    run->input = *input;
    run->n_threads = input->n_threads < 1 ? 1 : input->n_threads < LANES ? input->n_threads : LANES;
    if (prepare(run, err))
        return run;
    transport_run_destroy(run);
    return NULL;
}

void transport_run_destroy(struct transport_run *run)
{
    if (!run)
        return;
    for (int lane = 0; lane < LANES; lane++) {
        free(run->sums[lane]);
        free(run->lanes[lane].tally);
    }
    hybrid_finish(run);
    geometry_finish(&run->geometry);
    free(run->media);
    free(run->tables);
    free(run);
}

void transport_beam_axes(struct vec3 direction_lps, struct vec3 axes_lps[2])
{
    struct vec3 other = fabs(direction_lps.x) < .6 ? vec3(1, 0, 0) : vec3(0, 1, 0);
    axes_lps[0] = vec3_normalize(vec3_cross(direction_lps, other));
    axes_lps[1] = vec3_cross(direction_lps, axes_lps[0]);
}

bool transport_run_aim(struct transport_run *run, struct vec3 aperture_lps_mm, struct vec3 direction_lps,
                       struct error *err)
{
    if (!check_pose(aperture_lps_mm, direction_lps, err))
        return false;
    struct world *world = &run->world;
    geometry_place(&run->geometry, aperture_lps_mm, world->aperture_cm);
    struct vec3 along = vec3_normalize(direction_lps), across[2];
    transport_beam_axes(along, across);
    geometry_direct(&run->geometry, across[0], world->axis[0]);
    geometry_direct(&run->geometry, across[1], world->axis[1]);
    geometry_direct(&run->geometry, along, world->axis[2]);
    memset(run->balances, 0, sizeof run->balances);
    run->n_histories = 0;
    run->seconds = 0;
    return true;
}

uint64_t transport_run_histories(const struct transport_run *run)
{
    return run->n_histories;
}

/* Entry of a list for the i-th history of a lane: the lanes share none. */
static const struct particle *entry(const struct particle_list *list, int lane, uint64_t i)
{
    return &list->particles[(i % (list->n / LANES)) * LANES + (uint64_t)lane];
}

static uint64_t lane_share(uint64_t n, int lane)
{
    return n / LANES + (n % LANES > (uint64_t)lane);
}

static void work(struct transport_run *run, int index, int thread)
{
    const struct phase_space *beam = run->input.beam;
    struct lane *lane = &run->lanes[index];
    uint64_t from = lane_share(run->n_histories, index), to = lane_share(run->n_histories + run->n_batch, index);
    for (uint64_t i = from; i < to; i++) {
        if ((i - from) % CHUNK == 0 && run_pause(run, thread == 0, CHUNK))
            return;
        uint64_t stream = i * LANES + (uint64_t)index;
        struct random random = random_of(run->input.seed, stream);
        const struct particle *particle = entry(&beam->neutrons, index, i);
        bool is_hybrid = run->input.mode == TRANSPORT_HYBRID;
        float weight = is_hybrid ? hybrid_weight(run, particle, &random) : particle->weight;
        if (weight > 0)
            walk_neutron(&run->world, lane, particle, weight, &random);
        if (is_hybrid)
            hybrid_fast(run, index, i);
        if (run->photon_weight > 0 && i % run->neutrons_per_photon == (uint64_t)index % run->neutrons_per_photon) {
            const struct particle *photon = entry(&beam->photons, index, i / run->neutrons_per_photon);
            random = random_of(run->input.seed, PHOTON_STREAM | stream);
            walk_photon(&run->world, lane, photon, photon->weight * (float)run->photon_weight, &random);
        }
    }
    if (run->input.mode == TRANSPORT_HYBRID)
        hybrid_spread(run, index, thread, from, to);
}

static void work_lanes(void *context, int part, int n_parts)
{
    struct transport_run *run = context;
    (void)n_parts;
    for (int lane; (lane = atomic_fetch_add(&run->next_lane, 1)) < LANES;)
        work(run, lane, part);
}

static void flush(const struct transport_run *run, size_t n, float *from, double *to, bool is_kept)
{
    bool is_first = run->n_histories == 0;
    for (size_t i = 0; i < n && is_kept; i++)
        to[i] = (is_first ? 0 : to[i]) + (double)from[i];
    memset(from, 0, n * sizeof *from);
}

static void flush_row(struct transport_run *run, int index, struct cell_row row, bool is_kept)
{
    size_t n = run->world.n_tallies;
    flush(run, row.n * n, run->lanes[index].tally + row.begin * n, run->sums[index] + row.begin * n, is_kept);
    if (run->lanes[index].born)
        memset(run->lanes[index].born + row.begin, 0, row.n * sizeof(float));
}

/* Moves what lanes added up in a batch to their sums, or drops it; the first one of a pose replaces what was there.
 * Whole cells: all; else nothing is outside matter. */
static void flush_lanes(void *context, int part, int n_parts)
{
    struct transport_run *run = context;
    bool is_kept = !atomic_load(&run->is_cancelled);
    const struct cell_row all = { 0, (uint32_t)run->n_cells };
    for (int index = part; index < LANES; index += n_parts) {
        struct lane *lane = &run->lanes[index];
        if (run->input.is_whole_cells)
            flush_row(run, index, all, is_kept);
        for (size_t row = 0; row < run->geometry.n_rows && !run->input.is_whole_cells; row++)
            flush_row(run, index, run->geometry.rows[row], is_kept);
        for (size_t i = 0; i < run->wider.n_held; i++)
            flush(run, N_SMOOTH, lane->smooth[run->wider.held[i]], run->smooth_sums[index][run->wider.held[i]],
                  is_kept);
        if (is_kept)
            balance_add(&run->balances[index], &lane->balance);
        lane->balance = (struct balance){ 0 };
    }
}

static bool run_batch(struct transport_run *run, uint64_t n_histories)
{
    run->n_batch = n_histories;
    atomic_store(&run->next_lane, 0);
    parallel_run(run->n_threads, work_lanes, run);
    parallel_run(run->n_threads, flush_lanes, run);
    if (atomic_load(&run->is_cancelled))
        return false;
    run->n_histories += n_histories;
    return true;
}

bool transport_run_step(struct transport_run *run, uint64_t n_histories, struct error *err)
{
    if (n_histories < 1 || n_histories > TRANSPORT_MAX_HISTORIES - run->n_histories)
        return error_set(err, ERROR_RANGE, "%llu histories after %llu, 1 to %llu expected in all",
                         (unsigned long long)n_histories, (unsigned long long)run->n_histories,
                         (unsigned long long)TRANSPORT_MAX_HISTORIES);
    int64_t began_us = clock_now_us();
    run->n_step = n_histories;
    atomic_store(&run->n_done, 0);
    atomic_store(&run->is_cancelled, false);
    bool is_done = true;
    for (uint64_t left = n_histories, n; left > 0 && is_done; left -= n) {
        n = left < TRANSPORT_BATCH ? left : TRANSPORT_BATCH;
        is_done = run_batch(run, n);
    }
    run->seconds += (double)(clock_now_us() - began_us) / 1e6;
    return is_done || say_cancelled(err);
}

bool transport_run(const struct transport_input *input, struct transport_result *result, struct error *err)
{
    *result = (struct transport_result){ 0 };
    if (input->n_histories < LANES || input->n_histories > TRANSPORT_MAX_HISTORIES)
        return error_set(err, ERROR_RANGE, "%llu histories, %d to %llu expected",
                         (unsigned long long)input->n_histories, LANES, (unsigned long long)TRANSPORT_MAX_HISTORIES);
    struct transport_run *run = transport_run_create(input, err);
    bool is_done = run && transport_run_step(run, input->n_histories, err) && transport_run_read(run, result, err);
    transport_run_destroy(run);
    return is_done;
}
