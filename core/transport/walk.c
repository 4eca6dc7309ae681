/* Delta tracking: a particle flies to tentative collisions of the densest medium, and each of them counts for the
 * fluence there, whatever lies there. */
/* Source: E. R. Woodcock et al., Techniques used in the GEM code for Monte Carlo neutronics calculations in reactors
 * and other systems of complex geometry, ANL-7050 (1965). */
#include "core/transport/walk.h"

#include "core/transport/direction.h"
#include "core/transport/photon_data.h"
#include "core/transport/smooth.h"

/* Share of the first weight; below, one of two goes on with twice the weight. Late collisions of a light neutron cost
 * as much as others and count less: at a half, the error falls most in a given time. */
#define NEUTRON_LEAST_WEIGHT .5F
#define FAST_LEAST_PER_CM 1.F /* points per cm that count for fast neutrons, whose collisions are rare */
#define FAST_STEP_CM .5F      /* of their first flight, where they alone are followed */
#define FAST_LEAST_LEFT 1e-2F /* share of a neutron that has not collided, below which its flight ends */
enum { FAST_COLLISIONS = 2 }; /* that are followed of a first flight */
#define PHOTON_LEAST_WEIGHT .005F
#define PHOTON_LEAST_PER_CM .9F  /* points per cm that count for the kerma, also where collisions are rare */
#define PHOTON_SMOOTH_PER_CM .5F /* where means are taken over centimetres */
#define FREE_STILL_EV .2F        /* nuclei but hydrogen change no energy below: they move as fast as the neutron */

void balance_add(struct balance *sum, const struct balance *more)
{
    sum->begun += more->begun;
    sum->entered += more->entered;
    sum->leaked += more->leaked;
    sum->absorbed += more->absorbed;
    sum->roulette += more->roulette;
    sum->handed += more->handed;
    sum->emitted_mev += more->emitted_mev;
    sum->photon_entered_mev += more->photon_entered_mev;
    sum->photon_leaked_mev += more->photon_leaked_mev;
    sum->photon_left_mev += more->photon_left_mev;
}

void world_init(struct world *world)
{
    for (int bin = 0; bin < NEUTRON_N_BINS; bin++) {
        float highest = 1e-3F;
        bool is_fast = neutron_bin_ev(bin) >= (double)NEUTRON_FAST_EV;
        for (size_t i = 0; i < world->n_media; i++)
            highest = fmaxf(highest, world->media[i].neutron[bin].total_cm);
        world->neutron_highest[bin] = is_fast && !world->has_smooth ? fmaxf(highest, FAST_LEAST_PER_CM) : highest;
        world->fast_highest[bin] = fmaxf(highest, FAST_LEAST_PER_CM);
    }
    float electrons = 0;
    for (size_t i = 0; i < world->n_media; i++)
        electrons = fmaxf(electrons, world->media[i].electrons);
    for (int bin = 0; bin < PHOTON_N_BINS; bin++)
        world->photon_highest[bin] = fmaxf(world->has_smooth ? PHOTON_SMOOTH_PER_CM : PHOTON_LEAST_PER_CM,
                                           world->tables->photon_cm2_g[bin] * electrons);
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
        __builtin_prefetch(lane->tally + (size_t)*cell * world->n_tallies, 1);
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

/* On through air as far as there is no matter near: nothing is met or counted there. */
static inline void cross_air(const struct world *world, float position[3], const float direction[3])
{
    const struct geometry *geometry = world->geometry;
    for (ptrdiff_t block; (block = geometry_block(geometry, position)) >= 0 && geometry->clear[block] > 0;)
        for (int i = 0; i < 3; i++)
            position[i] += direction[i] * ((float)geometry->clear[block] * (float)GEOMETRY_BLOCK_CM);
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
        float counted = weight * tables->photon_gy_cm2[bin] / highest;
        if (lane->smooth && material > 0)
            lane->smooth[smooth_cell(world->geometry, position)][SMOOTH_PHOTON] += counted;
        else if (!lane->smooth && cell >= 0 && (material > 0 || world->is_whole_cells))
            lane->tally[(size_t)cell * world->n_tallies + TALLY_PHOTON] += counted;
        if (material == 0 && !world->is_whole_cells)
            cross_air(world, position, direction);
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

static void emit_one(const struct world *world, struct lane *lane, const struct medium *medium, const float position[3],
                     double emitted_mev, struct random *random)
{
    uint64_t bits = random_bits(random);
    float at[3] = { position[0], position[1], position[2] }, direction[3] = { 0, 0, 1 };
    direction_turn(direction, 2 * random_high(bits) - 1, world->tables->azimuth[bits & 1023]);
    float line_mev = medium->line_mev[(bits >> 10) & (MEDIUM_N_LINES - 1)];
    lane->balance.emitted_mev += emitted_mev;
    follow_photon(world, lane, at, direction, line_mev, (float)emitted_mev / line_mev, random);
}

/* Photons of an absorption, as many on average as the world says; their weights give the energy.
 *
 *   chance  even from 0 to 1 */
static void emit(const struct world *world, struct lane *lane, const struct medium *medium, const float position[3],
                 float absorbed, float chance, struct random *random)
{
    for (int n = (int)(absorbed * world->photons_per_neutron + chance); n > 0 && medium->emitted_mev > 0; n--)
        emit_one(world, lane, medium, position, medium->emitted_mev / (double)world->photons_per_neutron, random);
}

void walk_capture(const struct world *world, struct lane *lane, size_t cell, double emitted_mev, struct random *random)
{
    enum { TRIES = 64 };
    const struct geometry *geometry = world->geometry;
    const size_t nx = (size_t)geometry->n_blocks[0], ny = (size_t)geometry->n_blocks[1];
    for (int i = 0; i < TRIES; i++) {
        uint64_t bits = random_bits(random);
        const float at[3] = { ((float)(cell % nx) + random_high(bits)) * (float)GEOMETRY_BLOCK_CM,
                              ((float)(cell / nx % ny) + random_low(bits)) * (float)GEOMETRY_BLOCK_CM,
                              ((float)(cell / nx / ny) + random_unit(random)) * (float)GEOMETRY_BLOCK_CM };
        int material = geometry_material_in(geometry, (ptrdiff_t)cell, at);
        if (material <= 0)
            continue;
        if (world->media[material - 1].emitted_mev > 0)
            emit_one(world, lane, &world->media[material - 1], at, emitted_mev, random);
        return;
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
    float *tally = lane->tally + (size_t)cell * world->n_tallies;
    int band = energy_ev < NEUTRON_THERMAL_EV ? TALLY_THERMAL
               : energy_ev < NEUTRON_FAST_EV  ? TALLY_EPITHERMAL
                                              : TALLY_FAST;
    tally[TALLY_SLOW] += path_cm * world->tables->inverse_speed[bin];
    if (band == TALLY_FAST && world->has_smooth)
        return;
    tally[band] += path_cm;
    if (band == TALLY_FAST)
        tally[TALLY_RECOIL] += path_cm * world->tables->recoil_gy_cm2[bin];
}

void walk_neutron(const struct world *world, struct lane *lane, const struct particle *particle, float weight,
                  struct random *random)
{
    float position[3], direction[3], energy_ev = particle->energy;
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
        if (material == 0) {
            if (!world->is_whole_cells)
                cross_air(world, position, direction);
            continue;
        }
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
        if (world->is_deep && energy_ev < world->slow_below_ev && world->is_deep[cell]) {
            lane->born[cell] += weight;
            lane->balance.handed += (double)weight;
            return;
        }
    }
}

/* Collisions of a neutron on its first flight, each of which stands for its part of the neutron. */
struct first_collisions {
    float position[FAST_COLLISIONS][3];
    int material[FAST_COLLISIONS], n;
};

/* Marches along the first flight and counts what has not collided. It collides where as much has as chance says. */
static void march(const struct world *world, struct lane *lane, float position[3], const float direction[3],
                  float energy_ev, float weight, struct random *random, struct first_collisions *collisions)
{
    const int bin = neutron_bin(energy_ev);
    const float recoil = world->tables->recoil_gy_cm2[bin], least = weight * FAST_LEAST_LEFT,
                part = weight / FAST_COLLISIONS;
    float passed[MATERIAL_MAX], collides_at = weight - part * random_unit(random);
    for (size_t i = 0; i < world->n_media; i++)
        passed[i] = expf(-world->media[i].neutron[bin].total_cm * FAST_STEP_CM);
    collisions->n = 0;
    cross_air(world, position, direction);
    for (float begin = random_unit(random) * FAST_STEP_CM; weight > least; begin = FAST_STEP_CM) {
        for (int i = 0; i < 3; i++)
            position[i] += direction[i] * begin;
        int material = geometry_material_in(world->geometry, geometry_block(world->geometry, position), position);
        if (material < 0)
            return;
        if (material == 0) {
            cross_air(world, position, direction);
            continue;
        }
        float left = weight * passed[material - 1];
        float path_cm = (weight - left) / world->media[material - 1].neutron[bin].total_cm;
        float *smooth = lane->smooth[smooth_cell(world->geometry, position)];
        smooth[SMOOTH_FAST] += path_cm;
        smooth[SMOOTH_RECOIL] += path_cm * recoil;
        for (weight = left; weight < collides_at && collisions->n < FAST_COLLISIONS; collides_at -= part) {
            memcpy(collisions->position[collisions->n], position, sizeof collisions->position[0]);
            collisions->material[collisions->n++] = material;
        }
    }
}

/* A fast neutron from a collision until it is slow. */
static void follow_fast(const struct world *world, struct lane *lane, float position[3], int material,
                        const float from[3], float energy_ev, float weight, struct random *random)
{
    float direction[3] = { from[0], from[1], from[2] };
    for (int bin = neutron_bin(energy_ev);;) {
        if (material > 0) {
            const struct medium *medium = &world->media[material - 1];
            weight -= weight * medium->neutron[bin].absorbed;
            scatter(world, medium, bin, direction, &energy_ev, random);
            if (energy_ev < NEUTRON_FAST_EV)
                return;
            bin = neutron_bin(energy_ev);
        }
        uint64_t bits = random_bits(random);
        float highest = world->fast_highest[bin];
        ptrdiff_t cell;
        material = fly(world, lane, position, direction, highest, bits, &cell);
        if (material < 0)
            return;
        if (material == 0) {
            cross_air(world, position, direction);
            continue;
        }
        float *smooth = lane->smooth[smooth_cell(world->geometry, position)];
        smooth[SMOOTH_FAST] += weight / highest;
        smooth[SMOOTH_RECOIL] += weight / highest * world->tables->recoil_gy_cm2[bin];
        if (random_low(bits) * highest >= world->media[material - 1].neutron[bin].total_cm)
            material = 0;
    }
}

void walk_fast(const struct world *world, struct lane *lane, const struct particle *particle, float weight,
               struct random *random)
{
    float position[3], direction[3];
    if (!enter(world, particle, position, direction))
        return;
    struct first_collisions first;
    march(world, lane, position, direction, particle->energy, weight, random, &first);
    for (int i = 0; i < first.n; i++)
        follow_fast(world, lane, first.position[i], first.material[i], direction, particle->energy,
                    weight / FAST_COLLISIONS, random);
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
