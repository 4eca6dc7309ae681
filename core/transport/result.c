/* Doses with errors, from the tallies of lanes. */
#include <math.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/transport/run.h"

#define LEAST_MATTER .05F /* of a cell, for values */

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

static bool make_volumes(const struct transport_run *run, struct transport_result *result, struct error *err)
{
    for (int i = 0; i < TRANSPORT_N_QUANTITIES; i++) {
        result->values[i] = volume_create(&run->geometry.cells, VOXEL_F32, err);
        result->errors[i] = result->values[i] ? volume_create(&run->geometry.cells, VOXEL_F32, err) : NULL;
        if (!result->errors[i])
            return false;
    }
    return (result->mask = volume_create(&run->geometry.cells, VOXEL_U8, err)) != NULL;
}

/* Tallies of which a part is on wider cells. */
static const enum transport_tally of_smooth[N_SMOOTH] = {
    [SMOOTH_FAST] = TALLY_FAST, [SMOOTH_RECOIL] = TALLY_RECOIL, [SMOOTH_PHOTON] = TALLY_PHOTON
};

struct filling {
    const struct transport_run *run;
    struct transport_result *result;
    double scale;
    smooth_lanes *smooth[N_SMOOTH], *room[N_SMOOTH]; /* hybrid mode; room for each */
    double cell_cm3;
};

/* Adds what wider cells hold, as if a cell had counted it in its matter. */
static void add_smooth(const struct filling *filling, size_t cell, double of[N_TALLIES][LANES])
{
    const struct geometry *geometry = &filling->run->geometry;
    const size_t nx = (size_t)geometry->n_blocks[0], ny = (size_t)geometry->n_blocks[1];
    const int32_t block[3] = { (int32_t)(cell % nx), (int32_t)(cell / nx % ny), (int32_t)(cell / nx / ny) };
    double share = (double)geometry->matter[cell] * filling->cell_cm3;
    for (int i = 0; i < N_SMOOTH; i++) {
        float at[LANES];
        smooth_at(&filling->run->wider, filling->smooth[i], block, at);
        for (int lane = 0; lane < LANES; lane++)
            of[of_smooth[i]][lane] += share * (double)at[lane];
    }
}

static void fill_cell(const struct filling *filling, size_t cell)
{
    const struct transport_run *run = filling->run;
    struct transport_result *result = filling->result;
    float matter = run->geometry.matter[cell];
    if (run->input.is_whole_cells ? !geometry_holds_cell(&run->geometry, cell) : matter < LEAST_MATTER)
        return;
    ((uint8_t *)result->mask->voxels)[cell] = 1;
    double of[N_TALLIES][LANES] = { { 0 } }, means[N_TALLIES], errors[N_TALLIES];
    const size_t n_tallies = run->world.n_tallies;
    for (int lane = 0; lane < LANES; lane++)
        for (size_t i = 0; i < n_tallies; i++)
            of[i][lane] = run->sums[lane][cell * n_tallies + i];
    if (run->world.has_smooth)
        add_smooth(filling, cell, of);
    double scale = run->input.is_whole_cells ? filling->scale : filling->scale / (double)matter;
    for (int i = 0; i < N_TALLIES; i++) {
        double sum = 0, squares = 0;
        for (int lane = 0; lane < LANES; lane++)
            sum += of[i][lane];
        for (int lane = 0; lane < LANES; lane++)
            squares += (of[i][lane] - sum / LANES) * (of[i][lane] - sum / LANES);
        means[i] = fmax(0, sum) * scale;
        errors[i] = sqrt(squares * LANES / (LANES - 1)) * scale;
    }
    for (int i = 0; i < TRANSPORT_N_QUANTITIES; i++) {
        ((float *)result->values[i]->voxels)[cell] = (float)(means[meaning[i].tally] * meaning[i].factor);
        ((float *)result->errors[i]->voxels)[cell] = (float)(errors[meaning[i].tally] * meaning[i].factor);
    }
}

static void fill_part(void *context, int part, int n_parts)
{
    const struct filling *filling = context;
    size_t n = filling->run->n_cells;
    for (size_t cell = n * (size_t)part / (size_t)n_parts; cell < n * ((size_t)part + 1) / (size_t)n_parts; cell++)
        fill_cell(filling, cell);
}

static void smooth_part(void *context, int part, int n_parts)
{
    const struct filling *filling = context;
    const struct transport_run *run = filling->run;
    const struct smooth_cells *wider = &run->wider;
    for (int i = part; i < N_SMOOTH; i += n_parts) {
        for (int lane = 0; lane < LANES; lane++)
            for (size_t held = 0; held < wider->n_held; held++)
                filling->smooth[i][wider->held[held]][lane] = (float)run->smooth_sums[lane][wider->held[held]][i];
        smooth_field(wider, &run->smoothing[i], filling->smooth[i], filling->room[i]);
    }
}

static bool make_smooth(struct filling *filling, struct error *err)
{
    const struct transport_run *run = filling->run;
    for (int i = 0; i < 2 * N_SMOOTH; i++) {
        smooth_lanes **to = i < N_SMOOTH ? &filling->smooth[i] : &filling->room[i - N_SMOOTH];
        if (!(*to = mem_array(run->wider.n_cells, sizeof **to, UINT64_MAX, err)))
            return false;
    }
    parallel_run(run->n_threads < N_SMOOTH ? run->n_threads : N_SMOOTH, smooth_part, filling);
    return true;
}

static void drop_smooth(struct filling *filling)
{
    for (int i = 0; i < N_SMOOTH; i++) {
        free(filling->smooth[i]);
        free(filling->room[i]);
    }
}

static void measure_part(void *context, int part, int n_parts)
{
    struct transport_result *result = ((const struct filling *)context)->result;
    for (int i = part; i < TRANSPORT_N_QUANTITIES; i += n_parts) {
        volume_measure(result->values[i]);
        volume_measure(result->errors[i]);
    }
}

static bool fill(const struct transport_run *run, struct transport_result *result, struct error *err)
{
    if (!make_volumes(run, result, err))
        return false;
    double cell_cm3 = grid_voxel_mm3(&run->geometry.cells) / 1000;
    struct filling filling = { .run = run,
                               .result = result,
                               .scale = run->input.beam->neutrons.per_unit / (double)run->n_histories / cell_cm3,
                               .cell_cm3 = cell_cm3 };
    bool is_ready = !run->world.has_smooth || make_smooth(&filling, err);
    if (is_ready) {
        parallel_run(run->n_threads, fill_part, &filling);
        parallel_run(run->n_threads, measure_part, &filling);
        volume_measure(result->mask);
    }
    drop_smooth(&filling);
    return is_ready;
}

static struct transport_balance balance(const struct transport_run *run)
{
    struct balance sum = { 0 };
    for (int lane = 0; lane < LANES; lane++)
        balance_add(&sum, &run->balances[lane]);
    double emitted_mev = sum.emitted_mev + sum.photon_entered_mev;
    double per = sum.entered > 0 ? 1 / sum.entered : 0, per_mev = emitted_mev > 0 ? 1 / emitted_mev : 0;
    return (struct transport_balance){ sum.begun > 0 ? 1 - sum.entered / sum.begun : 0,
                                       sum.leaked * per,
                                       sum.absorbed * per,
                                       sum.roulette * per,
                                       sum.photon_leaked_mev * per_mev,
                                       sum.photon_left_mev * per_mev };
}

bool transport_run_read(const struct transport_run *run, struct transport_result *result, struct error *err)
{
    *result = (struct transport_result){ 0 };
    if (run->n_histories < LANES)
        return error_set(err, ERROR_STATE, "no doses after %llu histories, at least %d expected",
                         (unsigned long long)run->n_histories, LANES);
    if (!fill(run, result, err)) {
        transport_result_finish(result);
        return false;
    }
    result->balance = balance(run);
    result->n_histories = run->n_histories;
    result->seconds = run->seconds;
    return true;
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
