/* Neutrons of a lane that were handed over, by diffusion, and the photons of their captures. */
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/transport/run.h"

#define TOLERANCE \
    3e-2 /* of what a lane hands over, before what is left is spread on coarse blocks: 0.2 % of a fluence */
#define CAPTURE_STREAM (UINT64_C(1) << 61)
#define FAST_STREAM (UINT64_C(1) << 60)
enum { PHOTONS_PER_NEUTRON = 8, HISTORIES_PER_FAST = 2, NEUTRONS_PER_BEAM_PHOTON = 16 };

static bool list_fast(struct transport_run *run, struct error *err)
{
    const struct particle_list *list = &run->input.beam->neutrons;
    struct fast_entries *fast = &run->fast;
    fast->entries = mem_array(list->n, sizeof *fast->entries, UINT64_MAX, err);
    size_t n = 0;
    double slow_weight = 0;
    for (int lane = 0; lane < LANES && fast->entries; lane++) {
        fast->first[lane] = n;
        for (size_t i = (size_t)lane; i < list->n; i += LANES)
            if (list->particles[i].energy >= NEUTRON_FAST_EV)
                fast->entries[n++] = (uint32_t)i;
            else
                slow_weight += (double)list->particles[i].weight;
        fast->n[lane] = n - fast->first[lane];
        fast->weight[lane] = (float)((double)fast->n[lane] / (double)(list->n / LANES));
    }
    fast->usual_weight = n < list->n ? (float)(slow_weight / (double)(list->n - n)) : 0;
    return fast->entries != NULL;
}

/* Fields are smoothed over less than what they change over: photons go 10 cm and more, but their sources lie within
 * some cm; the dose of fast neutrons, that of the fastest, falls to its half in 2 cm, their fluence in 1 cm. */
static const double sigma_cm[N_SMOOTH] = { [SMOOTH_FAST] = .7, [SMOOTH_RECOIL] = 1.2, [SMOOTH_PHOTON] = 1.0 };

static bool make_smooth(struct transport_run *run, struct error *err)
{
    if (!smooth_cells_init(&run->wider, &run->geometry, err))
        return false;
    for (int i = 0; i < N_SMOOTH; i++)
        if (!smoothing_init(&run->smoothing[i], &run->wider, sigma_cm[i], err))
            return false;
    size_t n = smooth_n_cells(&run->geometry);
    for (int lane = 0; lane < LANES; lane++) {
        run->smooth_sums[lane] = mem_array(n, sizeof *run->smooth_sums[lane], UINT64_MAX, err);
        run->lanes[lane].smooth =
            run->smooth_sums[lane] ? mem_array(n, sizeof *run->lanes[lane].smooth, UINT64_MAX, err) : NULL;
        if (!run->lanes[lane].smooth)
            return false;
    }
    run->world.has_smooth = true;
    return true;
}

bool hybrid_init(struct transport_run *run, struct error *err)
{
    const struct transport_input *input = &run->input;
    if (!diffusion_init(&run->diffusion, &run->geometry, input->materials, run->media, input->n_materials,
                        input->cancel, err) ||
        !list_fast(run, err) || !make_smooth(run, err))
        return false;
    for (int lane = 0; lane < LANES; lane++) {
        if (!(run->lanes[lane].born = mem_array(run->n_cells, sizeof(float), UINT64_MAX, err)))
            return false;
        for (int i = 0; i < 1 + DIFFUSION_N_SCRATCH && lane < run->n_threads; i++)
            if (!(run->scratch[lane][i] = mem_array(run->n_cells, sizeof(float), UINT64_MAX, err)))
                return false;
    }
    run->world.is_deep = run->diffusion.is_deep;
    run->world.slow_below_ev = DIFFUSION_BELOW_EV;
    run->world.photons_per_neutron = PHOTONS_PER_NEUTRON;
    run->neutrons_per_photon = NEUTRONS_PER_BEAM_PHOTON;
    return true;
}

void hybrid_finish(struct transport_run *run)
{
    for (int lane = 0; lane < LANES; lane++) {
        free(run->lanes[lane].born);
        free(run->lanes[lane].smooth);
        free(run->smooth_sums[lane]);
        for (int i = 0; i < 1 + DIFFUSION_N_SCRATCH; i++)
            free(run->scratch[lane][i]);
    }
    for (int i = 0; i < N_SMOOTH; i++)
        smoothing_finish(&run->smoothing[i]);
    smooth_cells_finish(&run->wider);
    free(run->fast.entries);
    diffusion_finish(&run->diffusion);
}

float hybrid_weight(const struct transport_run *run, const struct particle *particle, struct random *random)
{
    float usual = run->fast.usual_weight, weight = particle->weight;
    if (particle->energy < NEUTRON_FAST_EV || weight >= usual)
        return weight;
    return random_unit(random) * usual < weight ? usual : 0;
}

void hybrid_fast(struct transport_run *run, int lane, uint64_t i)
{
    const struct fast_entries *fast = &run->fast;
    if (fast->n[lane] == 0 || i % HISTORIES_PER_FAST != 0)
        return;
    uint32_t entry = fast->entries[fast->first[lane] + i / HISTORIES_PER_FAST % fast->n[lane]];
    const struct particle *particle = &run->input.beam->neutrons.particles[entry];
    struct random random = random_of(run->input.seed, FAST_STREAM | (i * LANES + (uint64_t)lane));
    walk_fast(&run->world, &run->lanes[lane], particle, particle->weight * fast->weight[lane] * HISTORIES_PER_FAST,
              &random);
}

/* Adds a fluence to the tallies. Returns the photon energy that it emits. */
static double count(const struct diffusion *diffusion, struct lane *lane, const float *fluence, double *absorbed)
{
    double emitted_mev = 0, leaked = 0;
    *absorbed = 0;
    for (size_t r = 0; r < diffusion->fine.n_rows; r++)
        for (size_t i = diffusion->fine.rows[r].begin, end = i + diffusion->fine.rows[r].n; i < end; i++) {
            float at = fluence[i];
            lane->tally[i * N_SLOW_TALLIES + TALLY_THERMAL] += at * diffusion->thermal[i];
            lane->tally[i * N_SLOW_TALLIES + TALLY_SLOW] += at * diffusion->slow[i];
            *absorbed += (double)(at * diffusion->absorbed[i]);
            leaked += (double)(at * diffusion->leaked[i]);
            emitted_mev += fmax(0, (double)(at * diffusion->emitted_mev[i]));
        }
    lane->balance.absorbed += *absorbed;
    lane->balance.leaked += leaked;
    return emitted_mev;
}

void hybrid_spread(struct transport_run *run, int index, int thread, uint64_t from, uint64_t to)
{
    const struct diffusion *diffusion = &run->diffusion;
    struct lane *lane = &run->lanes[index];
    float *fluence = run->scratch[thread][0];
    diffusion_solve(diffusion, lane->born, TOLERANCE, fluence, run->scratch[thread] + 1);
    double absorbed, emitted_mev = count(diffusion, lane, fluence, &absorbed);
    uint64_t most = PHOTONS_PER_NEUTRON * (to - from), n = (uint64_t)fmax(0, absorbed * PHOTONS_PER_NEUTRON), done = 0;
    n = n < most ? n : most;
    /* Every so many MeV along the cells a photon, from a first one by chance. */
    struct random random = random_of(run->input.seed, CAPTURE_STREAM | (from * LANES + (uint64_t)index));
    double each_mev = n > 0 ? emitted_mev / (double)n : 0, next_mev = each_mev * (double)random_unit(&random),
           sum_mev = 0;
    for (size_t r = 0; r < diffusion->fine.n_rows && each_mev > 0; r++)
        for (size_t i = diffusion->fine.rows[r].begin, end = i + diffusion->fine.rows[r].n; i < end; i++)
            for (sum_mev += fmax(0, (double)(fluence[i] * diffusion->emitted_mev[i])); next_mev < sum_mev; done++) {
                if (done % 256 == 0 && run_pause(run, false, 0))
                    return;
                walk_capture(&run->world, lane, i, each_mev, &random);
                next_mev += each_mev;
            }
}
