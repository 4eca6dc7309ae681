/* Delta tracking: a particle flies to tentative collisions of the densest medium, and each of them counts for the
 * fluence there, whatever lies there. */
/* Source: E. R. Woodcock et al., Techniques used in the GEM code for Monte Carlo neutronics calculations in reactors
 * and other systems of complex geometry, ANL-7050 (1965). */
#include "core/transport/walk.h"

#include "core/transport/direction.h"
#include "core/transport/photon_data.h"

/* Share of the first weight; below, one of two goes on with twice the weight. Late collisions of a light neutron cost
 * as much as others and count less: at a half, the error falls most in a given time. */
#define NEUTRON_LEAST_WEIGHT .5F
#define FAST_LEAST_PER_CM 1.F /* points per cm that count for fast neutrons, whose collisions are rare */
#define PHOTON_LEAST_WEIGHT .005F
#define PHOTONS_PER_NEUTRON 8.F /* that are followed for each absorbed neutron of weight 1 */
#define PHOTON_LEAST_PER_CM .9F /* points per cm that count for the kerma, also where collisions are rare */
#define FREE_STILL_EV .2F       /* nuclei but hydrogen change no energy below: they move as fast as the neutron */

void balance_add(struct balance *sum, const struct balance *more)
{
    sum->begun += more->begun;
    sum->entered += more->entered;
    sum->leaked += more->leaked;
    sum->absorbed += more->absorbed;
    sum->roulette += more->roulette;
    sum->emitted_mev += more->emitted_mev;
    sum->photon_entered_mev += more->photon_entered_mev;
    sum->photon_leaked_mev += more->photon_leaked_mev;
    sum->photon_left_mev += more->photon_left_mev;
}

void world_init(struct world *world)
{
    for (int bin = 0; bin < NEUTRON_N_BINS; bin++) {
        world->neutron_highest[bin] = neutron_bin_ev(bin) >= (double)NEUTRON_FAST_EV ? FAST_LEAST_PER_CM : 1e-3F;
        for (size_t i = 0; i < world->n_media; i++)
            world->neutron_highest[bin] = fmaxf(world->neutron_highest[bin], world->media[i].neutron[bin].total_cm);
    }
    float electrons = 0;
    for (size_t i = 0; i < world->n_media; i++)
        electrons = fmaxf(electrons, world->media[i].electrons);
    for (int bin = 0; bin < PHOTON_N_BINS; bin++)
        world->photon_highest[bin] = fmaxf(PHOTON_LEAST_PER_CM, world->tables->photon_cm2_g[bin] * electrons);
}

/* To the box's face along the way, in the box's frame. False if the particle misses the box. */
static bool enter(const struct world *world, const struct particle *particle, float position[3], float direction[3])
{
    double at[3], along[3], from = 0, to = 1e9;
    for (int i = 0; i < 3; i++) {
        at[i] = world->aperture_cm[i] + world->axis[0][i] * (double)particle->x_cm +
                world->axis[1][i] * (double)particle->y_cm;
        along[i] = 0;
        for (int j = 0; j < 3; j++)
            along[i] += world->axis[j][i] * (double)particle->direction[j];
    }
    for (int i = 0; i < 3; i++) {
        double inverse = 1 / (fabs(along[i]) < 1e-9 ? 1e-9 : along[i]), a = -at[i] * inverse,
               b = ((double)world->geometry->size_cm[i] - at[i]) * inverse;
        from = fmax(from, fmin(a, b));
        to = fmin(to, fmax(a, b));
    }
    if (from >= to)
        return false;
    for (int i = 0; i < 3; i++) {
        position[i] = (float)(at[i] + (from + 1e-4) * along[i]);
        direction[i] = (float)along[i];
    }
    return true;
}

/* Material and cell at a position; -1 outside. The tally is fetched while the material is looked up, which takes as
 * long. */
static inline int locate(const struct world *world, const struct lane *lane, const float position[3], ptrdiff_t *cell)
{
    ptrdiff_t block = geometry_block(world->geometry, position);
    *cell = world->geometry->are_cells_blocks ? block : geometry_cell(world->geometry, position);
    if (*cell >= 0)
        __builtin_prefetch(&lane->tally[*cell], 1);
    return geometry_material_in(world->geometry, block, position);
}

/* Flies to the next tentative collision, a mean of 1 / highest away: the material and the cell there, as locate. */
static inline int fly(const struct world *world, const struct lane *lane, float position[3], const float direction[3],
                      float highest, uint64_t bits, ptrdiff_t *cell)
{
    float step = -logf(random_high(bits)) / highest;
    for (int i = 0; i < 3; i++)
        position[i] += direction[i] * step;
    return locate(world, lane, position, cell);
}

/* Photon from the box's inside or its face; its kerma counts at each tentative collision. */
static void follow_photon(const struct world *world, struct lane *lane, float position[3], float direction[3],
                          float energy_mev, float weight, struct random *random)
{
    const struct particle_tables *tables = world->tables;
    for (;;) {
        int bin = photon_bin(energy_mev);
        uint64_t bits = random_bits(random);
        float highest = world->photon_highest[bin];
        ptrdiff_t cell;
        int material = fly(world, lane, position, direction, highest, bits, &cell);
        if (material < 0) {
            lane->balance.photon_leaked_mev += (double)(weight * energy_mev);
            return;
        }
        if (cell >= 0 && (material > 0 || world->is_whole_cells))
            lane->tally[cell][TALLY_PHOTON] += weight * tables->photon_gy_cm2[bin] / highest;
        if (material == 0 ||
            random_low(bits) * highest >= tables->photon_cm2_g[bin] * world->media[material - 1].electrons)
            continue;
        double before_mev = (double)(weight * energy_mev);
        weight *= tables->photon_compton[bin];
        photon_scatter(tables, direction, &energy_mev, random);
        bool is_end = energy_mev < (float)PHOTON_LOWEST_MEV || weight < PHOTON_LEAST_WEIGHT;
        lane->balance.photon_left_mev += before_mev - (is_end ? 0 : (double)(weight * energy_mev));
        if (is_end)
            return;
    }
}

/* Photons of an absorption, as many on average as PHOTONS_PER_NEUTRON says; their weights give the energy.
 *
 *   chance  even from 0 to 1 */
static void emit(const struct world *world, struct lane *lane, const struct medium *medium, const float position[3],
                 float absorbed, float chance, struct random *random)
{
    for (int n = (int)(absorbed * PHOTONS_PER_NEUTRON + chance); n > 0; n--) {
        uint64_t bits = random_bits(random);
        float at[3] = { position[0], position[1], position[2] }, direction[3] = { 0, 0, 1 };
        direction_turn(direction, 2 * random_high(bits) - 1, world->tables->azimuth[bits & 1023]);
        float line_mev = medium->line_mev[(bits >> 10) & (MEDIUM_N_LINES - 1)];
        double emitted_mev = medium->emitted_mev * (double)(1 / PHOTONS_PER_NEUTRON);
        lane->balance.emitted_mev += emitted_mev;
        if (medium->emitted_mev > 0)
            follow_photon(world, lane, at, direction, line_mev, (float)emitted_mev / line_mev, random);
    }
}

static inline float at_least(float value, float least)
{
    return value > least ? value : least;
}

static void scatter_water(const struct particle_tables *tables, int bin, float direction[3], float *energy_ev,
                          struct random *random)
{
    uint64_t bits = random_bits(random);
    int from = tables->water_group_of_bin[bin], to = tables->water_outcome[from][bits >> 55];
    *energy_ev = tables->water_low_ev[to] +
                 tables->water_width_ev[to] * ((float)((bits >> 32) & 0xffff) + .5F) * (1.F / 65536.F);
    float cosine = direction_cosine(tables->water_cosine[from][to], random_bits(random));
    direction_turn(direction, cosine, tables->azimuth[bits & 1023]);
}

static void scatter(const struct world *world, const struct medium *medium, int bin, float direction[3],
                    float *energy_ev, struct random *random)
{
    const struct particle_tables *tables = world->tables;
    const struct medium_bin *at = &medium->neutron[bin];
    uint64_t bits = random_bits(random);
    float met = random_high(bits);
    if (met < at->h) {
        if (*energy_ev < NEUTRON_BOUND_EV) {
            scatter_water(tables, bin, direction, energy_ev, random);
            return;
        }
        float kept = random_low(bits); /* of the energy: even from 0 to 1, for isotropic scattering by equal masses */
        *energy_ev = at_least(*energy_ev * kept, NEUTRON_LOWEST_EV);
        direction_turn(direction, sqrtf(kept), tables->azimuth[bits & 1023]);
        return;
    }
    int light = met < at->hc ? 0 : met < at->hcn ? 1 : met < at->hcno ? 2 : 3;
    float mass = light < 3 ? nuclide_table[NUCLIDE_C + light].mass : medium->rest_mass;
    float cosine =
        direction_cosine(light < 3 ? tables->cosine[light][bin] : medium->rest_cosine[bin], random_bits(random));
    float square = mass * mass + 2 * mass * cosine + 1;
    if (*energy_ev > FREE_STILL_EV)
        *energy_ev *= square / ((mass + 1) * (mass + 1));
    direction_turn(direction, (1 + mass * cosine) / sqrtf(square), tables->azimuth[bits & 1023]);
}

static inline void count(const struct world *world, struct lane *lane, ptrdiff_t cell, float energy_ev, int bin,
                         float path_cm)
{
    float *tally = lane->tally[cell];
    int band = energy_ev < NEUTRON_THERMAL_EV ? TALLY_THERMAL
               : energy_ev < NEUTRON_FAST_EV  ? TALLY_EPITHERMAL
                                              : TALLY_FAST;
    tally[band] += path_cm;
    tally[TALLY_SLOW] += path_cm * world->tables->inverse_speed[bin];
    if (band == TALLY_FAST)
        tally[TALLY_RECOIL] += path_cm * world->tables->recoil_gy_cm2[bin];
}

void walk_neutron(const struct world *world, struct lane *lane, const struct particle *particle, struct random *random)
{
    float position[3], direction[3], energy_ev = particle->energy, weight = particle->weight;
    const float least = weight * NEUTRON_LEAST_WEIGHT;
    lane->balance.begun += (double)weight;
    if (!enter(world, particle, position, direction))
        return;
    lane->balance.entered += (double)weight;
    for (;;) {
        int bin = neutron_bin(energy_ev);
        uint64_t bits = random_bits(random);
        float highest = world->neutron_highest[bin];
        ptrdiff_t cell;
        int material = fly(world, lane, position, direction, highest, bits, &cell);
        if (material < 0) {
            lane->balance.leaked += (double)weight;
            return;
        }
        if (cell >= 0 && (material > 0 || world->is_whole_cells))
            count(world, lane, cell, energy_ev, bin, weight / highest);
        if (material == 0)
            continue;
        const struct medium *medium = &world->media[material - 1];
        const struct medium_bin *at = &medium->neutron[bin];
        if (random_low(bits) * highest >= at->total_cm)
            continue;
        float absorbed = weight * at->absorbed;
        weight -= absorbed;
        lane->balance.absorbed += (double)absorbed;
        emit(world, lane, medium, position, absorbed, random_last(bits), random);
        if (weight < least) {
            bool is_kept = random_bits(random) >> 63;
            lane->balance.roulette += (double)(is_kept ? -weight : weight);
            if (!is_kept)
                return;
            weight *= 2;
        }
        scatter(world, medium, bin, direction, &energy_ev, random);
    }
}

void walk_photon(const struct world *world, struct lane *lane, const struct particle *particle, float weight,
                 struct random *random)
{
    float position[3], direction[3];
    if (!enter(world, particle, position, direction))
        return;
    lane->balance.photon_entered_mev += (double)(weight * particle->energy);
    follow_photon(world, lane, position, direction, particle->energy, weight, random);
}
