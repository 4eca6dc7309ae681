/* Doses with errors, from the tallies of lanes. */
#include <math.h>

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

static void value_of(const struct transport_run *run, size_t cell, int quantity, double scale, float *value,
                     float *error)
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

static bool fill(const struct transport_run *run, struct transport_result *result, struct error *err)
{
    if (!make_volumes(run, result, err))
        return false;
    double cell_cm3 = grid_voxel_mm3(&run->geometry.cells) / 1000;
    double scale = run->input.beam->neutrons.per_unit / (double)run->n_histories / cell_cm3;
    for (size_t cell = 0; cell < run->n_cells; cell++) {
        float matter = run->geometry.matter[cell];
        if (run->input.is_whole_cells ? !geometry_holds_cell(&run->geometry, cell) : matter < LEAST_MATTER)
            continue;
        ((uint8_t *)result->mask->voxels)[cell] = 1;
        for (int i = 0; i < TRANSPORT_N_QUANTITIES; i++)
            value_of(run, cell, i, run->input.is_whole_cells ? scale : scale / (double)matter,
                     (float *)result->values[i]->voxels + cell, (float *)result->errors[i]->voxels + cell);
    }
    for (int i = 0; i < TRANSPORT_N_QUANTITIES; i++) {
        volume_measure(result->values[i]);
        volume_measure(result->errors[i]);
    }
    volume_measure(result->mask);
    return true;
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
