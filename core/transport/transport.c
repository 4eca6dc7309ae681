/* Histories in lanes, lanes over threads, and from tallies to doses with errors. */
#include "core/transport/transport.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/transport/walk.h"

/* The error is the spread of lanes; what a lane adds up does not depend on the thread that works on it. A lane takes
 * its own entries of the list, so that the spread includes what the list's length costs. */
enum { LANES = PHASE_SPACE_LANES, CHUNK = 256, NEUTRONS_PER_PHOTON = 8 };
/* Histories that a lane adds up in single precision, where they need half of the cache, before they go to its sums. */
enum { FLUSH = 1 << 16 };
#define LEAST_MATTER .05F /* of a cell, for values */

struct run {
    const struct transport_input *input;
    struct geometry geometry;
    struct medium *media;
    struct particle_tables *tables;
    struct world world;
    struct lane lanes[LANES];
    double (*sums[LANES])[N_TALLIES];   /* by cell, cm */
    float (*scratch[LANES])[N_TALLIES]; /* by thread */
    size_t n_cells;
    uint64_t n_photons;
    double photon_weight; /* of a photon of the beam, for neutrons of weight 1 */
    atomic_int next_lane;
    atomic_uint_fast64_t n_done;
    atomic_bool is_cancelled;
};

static bool is_direction(struct vec3 direction)
{
    return vec3_is_finite(direction) && fabs(vec3_length(direction) - 1) < 1e-3;
}

static bool check_voxels(const struct transport_input *input, struct error *err)
{
    if (input->n_materials < 1 || input->n_materials > MATERIAL_MAX)
        return error_set(err, ERROR_LIMIT, "%zu materials, 1 to %d expected", input->n_materials, MATERIAL_MAX);
    for (size_t i = 0; i < input->n_materials; i++)
        if (!material_check(&input->materials[i], err))
            return false;
    size_t n = grid_n_voxels(input->grid);
    for (size_t i = 0; i < n; i++)
        if (input->voxels[i] > input->n_materials)
            return error_set(err, ERROR_RANGE, "voxel %zu has material %d, at most %zu expected", i, input->voxels[i],
                             input->n_materials);
    return true;
}

static bool check(const struct transport_input *input, struct error *err)
{
    if (input->n_histories < LANES || input->n_histories > TRANSPORT_MAX_HISTORIES)
        return error_set(err, ERROR_RANGE, "%llu histories, %d to %llu expected",
                         (unsigned long long)input->n_histories, LANES, (unsigned long long)TRANSPORT_MAX_HISTORIES);
    if (!vec3_is_finite(input->aperture_lps_mm) || vec3_length(input->aperture_lps_mm) > GRID_FARTHEST_MM)
        return error_set(err, ERROR_RANGE, "the aperture is farther than %g mm from the origin", GRID_FARTHEST_MM);
    if (!is_direction(input->direction_lps))
        return error_set(err, ERROR_RANGE, "the beam's direction is not of length 1");
    if (input->beam->neutrons.n == 0)
        return error_set(err, ERROR_RANGE, "the beam has no neutrons");
    return check_voxels(input, err);
}

/* The beam's axes in the box's frame: any two across it. */
static void aim(struct run *run)
{
    struct world *world = &run->world;
    geometry_place(&run->geometry, run->input->aperture_lps_mm, world->aperture_cm);
    struct vec3 along = vec3_normalize(run->input->direction_lps);
    struct vec3 other = fabs(along.x) < .6 ? vec3(1, 0, 0) : vec3(0, 1, 0);
    struct vec3 across = vec3_normalize(vec3_cross(along, other));
    geometry_direct(&run->geometry, across, world->axis[0]);
    geometry_direct(&run->geometry, vec3_cross(along, across), world->axis[1]);
    geometry_direct(&run->geometry, along, world->axis[2]);
}

static int n_threads(const struct run *run)
{
    int n = run->input->n_threads;
    return n < 1 ? 1 : n < LANES ? n : LANES;
}

static bool prepare(struct run *run, struct error *err)
{
    const struct transport_input *input = run->input;
    if (!geometry_init(&run->geometry, input->grid, input->voxels, input->cells, input->cell_mm, err))
        return false;
    run->media = mem_array(input->n_materials, sizeof *run->media, UINT64_MAX, err);
    run->tables = run->media ? mem_array(1, sizeof *run->tables, UINT64_MAX, err) : NULL;
    if (!run->tables)
        return false;
    for (size_t i = 0; i < input->n_materials; i++)
        medium_init(&run->media[i], &input->materials[i]);
    particle_tables_init(run->tables);
    run->n_cells = grid_n_voxels(&run->geometry.cells);
    for (int lane = 0; lane < LANES; lane++)
        if (!(run->sums[lane] = mem_array(run->n_cells, sizeof *run->sums[lane], UINT64_MAX, err)) ||
            (lane < n_threads(run) &&
             !(run->scratch[lane] = mem_array(run->n_cells, sizeof *run->scratch[lane], UINT64_MAX, err))))
            return false;
    run->world.geometry = &run->geometry;
    run->world.media = run->media;
    run->world.n_media = input->n_materials;
    run->world.tables = run->tables;
    run->world.is_whole_cells = input->is_whole_cells;
    world_init(&run->world);
    aim(run);
    const struct particle_list *neutrons = &input->beam->neutrons, *photons = &input->beam->photons;
    run->n_photons = photons->n > 0 && photons->per_unit > 0 ? input->n_histories / NEUTRONS_PER_PHOTON : 0;
    if (run->n_photons > 0)
        run->photon_weight =
            photons->per_unit / (double)run->n_photons / (neutrons->per_unit / (double)input->n_histories);
    return true;
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

static bool is_stopped(struct run *run)
{
    if (run->input->cancel && atomic_load(run->input->cancel))
        atomic_store(&run->is_cancelled, true);
    return atomic_load(&run->is_cancelled);
}

/* Moves what a lane added up to its sums. */
static void flush(struct run *run, int index)
{
    float *from = run->lanes[index].tally[0];
    double *to = run->sums[index][0];
    for (size_t i = 0; i < run->n_cells * N_TALLIES; i++)
        to[i] += (double)from[i];
    memset(from, 0, run->n_cells * sizeof *run->scratch[0]);
}

static void work(struct run *run, int index, bool is_caller)
{
    struct lane *lane = &run->lanes[index];
    uint64_t n_neutrons = lane_share(run->input->n_histories, index), n_photons = lane_share(run->n_photons, index);
    for (uint64_t i = 0; i < n_neutrons + n_photons; i++) {
        if (i > 0 && i % FLUSH == 0)
            flush(run, index);
        if (i % CHUNK == 0) {
            if (is_stopped(run))
                return;
            uint64_t done = atomic_fetch_add(&run->n_done, CHUNK) + CHUNK;
            if (is_caller && run->input->progress)
                run->input->progress(run->input->context,
                                     fmin(1, (double)done / (double)(run->input->n_histories + run->n_photons)));
        }
        struct random random = random_of(run->input->seed, i * LANES + (uint64_t)index);
        if (i < n_neutrons)
            walk_neutron(&run->world, lane, entry(&run->input->beam->neutrons, index, i), &random);
        else {
            const struct particle *photon = entry(&run->input->beam->photons, index, i - n_neutrons);
            walk_photon(&run->world, lane, photon, photon->weight * (float)run->photon_weight, &random);
        }
    }
    flush(run, index);
}

static void work_lanes(void *context, int part, int n_parts)
{
    struct run *run = context;
    (void)n_parts;
    for (int lane; (lane = atomic_fetch_add(&run->next_lane, 1)) < LANES;) {
        run->lanes[lane].tally = run->scratch[part];
        work(run, lane, part == 0);
    }
}

static const struct {
    enum transport_tally tally;
    double factor;
} meaning[TRANSPORT_N_QUANTITIES] = {
    [TRANSPORT_BORON] = { TALLY_SLOW, KERMA_BORON_GY_CM2 },
    [TRANSPORT_NITROGEN] = { TALLY_SLOW, KERMA_NITROGEN_GY_CM2 },
    [TRANSPORT_FAST] = { TALLY_RECOIL, 1 },
    [TRANSPORT_GAMMA] = { TALLY_PHOTON, 1 },
    [TRANSPORT_FAST_FLUENCE] = { TALLY_FAST, 1 },
    [TRANSPORT_EPITHERMAL_FLUENCE] = { TALLY_EPITHERMAL, 1 },
    [TRANSPORT_THERMAL_FLUENCE] = { TALLY_THERMAL, 1 },
};

static void value_of(const struct run *run, size_t cell, int quantity, double scale, float *value, float *error)
{
    double sum = 0, squares = 0;
    for (int lane = 0; lane < LANES; lane++)
        sum += run->sums[lane][cell][meaning[quantity].tally];
    for (int lane = 0; lane < LANES; lane++) {
        double apart = run->sums[lane][cell][meaning[quantity].tally] - sum / LANES;
        squares += apart * apart;
    }
    *value = (float)(sum * scale * meaning[quantity].factor);
    *error = (float)(sqrt(squares * LANES / (LANES - 1)) * scale * meaning[quantity].factor);
}

static bool make_volumes(struct run *run, struct transport_result *result, struct error *err)
{
    for (int i = 0; i < TRANSPORT_N_QUANTITIES; i++) {
        result->values[i] = volume_create(&run->geometry.cells, VOXEL_F32, err);
        result->errors[i] = result->values[i] ? volume_create(&run->geometry.cells, VOXEL_F32, err) : NULL;
        if (!result->errors[i])
            return false;
    }
    return (result->mask = volume_create(&run->geometry.cells, VOXEL_U8, err)) != NULL;
}

static bool finish(struct run *run, struct transport_result *result, struct error *err)
{
    if (!make_volumes(run, result, err))
        return false;
    double cell_cm3 = grid_voxel_mm3(&run->geometry.cells) / 1000;
    double scale = run->input->beam->neutrons.per_unit / (double)run->input->n_histories / cell_cm3;
    for (size_t cell = 0; cell < run->n_cells; cell++) {
        float matter = run->geometry.matter[cell];
        if (!run->input->is_whole_cells && matter < LEAST_MATTER)
            continue;
        ((uint8_t *)result->mask->voxels)[cell] = 1;
        for (int i = 0; i < TRANSPORT_N_QUANTITIES; i++)
            value_of(run, cell, i, run->input->is_whole_cells ? scale : scale / (double)matter,
                     (float *)result->values[i]->voxels + cell, (float *)result->errors[i]->voxels + cell);
    }
    for (int i = 0; i < TRANSPORT_N_QUANTITIES; i++) {
        volume_measure(result->values[i]);
        volume_measure(result->errors[i]);
    }
    volume_measure(result->mask);
    return true;
}

static struct transport_balance balance(const struct run *run)
{
    struct balance sum = { 0 };
    double list = 0;
    for (int lane = 0; lane < LANES; lane++) {
        const struct balance *of = &run->lanes[lane].balance;
        sum.entered += of->entered;
        sum.leaked += of->leaked;
        sum.absorbed += of->absorbed;
        sum.roulette += of->roulette;
        sum.emitted_mev += of->emitted_mev + of->photon_entered_mev;
        sum.photon_leaked_mev += of->photon_leaked_mev;
        sum.photon_left_mev += of->photon_left_mev;
        for (uint64_t i = 0, n = lane_share(run->input->n_histories, lane); i < n; i++)
            list += (double)entry(&run->input->beam->neutrons, lane, i)->weight;
    }
    double per = sum.entered > 0 ? 1 / sum.entered : 0, per_mev = sum.emitted_mev > 0 ? 1 / sum.emitted_mev : 0;
    return (struct transport_balance){ list > 0 ? 1 - sum.entered / list : 0,
                                       sum.leaked * per,
                                       sum.absorbed * per,
                                       sum.roulette * per,
                                       sum.photon_leaked_mev * per_mev,
                                       sum.photon_left_mev * per_mev };
}

static bool run_all(struct run *run, struct transport_result *result, struct error *err)
{
    int64_t began_us = clock_now_us();
    if (!prepare(run, err))
        return false;
    parallel_run(n_threads(run), work_lanes, run);
    if (atomic_load(&run->is_cancelled))
        return error_set(err, ERROR_CANCELLED, "the simulation was cancelled");
    if (!finish(run, result, err))
        return false;
    result->balance = balance(run);
    result->n_histories = run->input->n_histories;
    result->seconds = (double)(clock_now_us() - began_us) / 1e6;
    return true;
}

bool transport_run(const struct transport_input *input, struct transport_result *result, struct error *err)
{
    *result = (struct transport_result){ 0 };
    if (!check(input, err))
        return false;
    struct run *run = mem_array(1, sizeof *run, UINT64_MAX, err);
    if (!run)
        return false;
    run->input = input;
    bool is_done = run_all(run, result, err);
    for (int lane = 0; lane < LANES; lane++) {
        free(run->sums[lane]);
        free(run->scratch[lane]);
    }
    geometry_finish(&run->geometry);
    free(run->media);
    free(run->tables);
    free(run);
    if (!is_done)
        transport_result_finish(result);
    return is_done;
}

void transport_result_finish(struct transport_result *result)
{
    for (int i = 0; i < TRANSPORT_N_QUANTITIES; i++) {
        volume_unref(result->values[i]);
        volume_unref(result->errors[i]);
    }
    volume_unref(result->mask);
    *result = (struct transport_result){ 0 };
}
