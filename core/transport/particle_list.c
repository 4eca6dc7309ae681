/* Particles of a file as a list that histories take theirs from. */
#include "core/transport/particle_list.h"

#include <math.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/transport/medium.h"
#include "core/transport/photon_data.h"
#include "core/transport/random.h"

#define LEAST_COSINE 1e-3 /* with the beam's axis; below, a particle does not leave the aperture */

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static bool to_unit(double a[3])
{
    double length = sqrt(dot(a, a));
    for (int i = 0; i < 3 && length > 1e-6; i++)
        a[i] /= length;
    return length > 1e-6;
}

bool particle_frame_init(struct particle_frame *frame, const double origin_cm[3], const double along[3],
                         const double across[3], struct error *err)
{
    double(*axes)[3] = frame->axes;
    *frame = (struct particle_frame){ 0 };
    for (int i = 0; i < 3; i++) {
        frame->origin_cm[i] = origin_cm[i];
        axes[2][i] = along[i];
        axes[0][i] = across[i];
    }
    if (!to_unit(axes[2]) || !to_unit(axes[0]))
        return error_set(err, ERROR_RANGE, "the direction of the particles' beam, or the one across it, has no length");
    double part = dot(axes[0], axes[2]);
    for (int i = 0; i < 3; i++)
        axes[0][i] -= part * axes[2][i];
    if (!to_unit(axes[0]))
        return error_set(err, ERROR_RANGE, "the direction of the particles' beam and the one across it are parallel");
    for (int i = 0; i < 3; i++)
        axes[1][i] = axes[2][(i + 1) % 3] * axes[0][(i + 2) % 3] - axes[2][(i + 2) % 3] * axes[0][(i + 1) % 3];
    return true;
}

enum fate { USED, BACKWARD, BESIDE, SOFT };

/* To the aperture plane, in the beam's own axes. */
static enum fate place(const struct particle_frame *frame, const struct beam_particle *from, struct particle *to)
{
    double at[3], way[3], shift[3], direction[3], turn[2] = { cos(frame->turn_rad), sin(frame->turn_rad) };
    for (int i = 0; i < 3; i++) {
        shift[i] = (double)from->position_cm[i] - frame->origin_cm[i];
        direction[i] = (double)from->direction[i];
    }
    for (int i = 0; i < 3; i++) {
        at[i] = dot(frame->axes[i], shift);
        way[i] = dot(frame->axes[i], direction);
    }
    if (way[2] < LEAST_COSINE)
        return BACKWARD;
    double far = -at[2] / way[2], x = at[0] + far * way[0], y = at[1] + far * way[1];
    *to = (struct particle){ (float)(turn[0] * x - turn[1] * y),
                             (float)(turn[1] * x + turn[0] * y),
                             { (float)(turn[0] * way[0] - turn[1] * way[1]),
                               (float)(turn[1] * way[0] + turn[0] * way[1]), (float)way[2] },
                             from->energy_mev,
                             from->weight };
    return hypot(x, y) <= PARTICLE_FARTHEST_CM ? USED : BESIDE;
}

/* Those that are used, in the order of the file. */
static bool place_all(const struct particle_frame *frame, const struct beam_particle *from, size_t n, bool are_photons,
                      struct particle **used, struct particle_weights *weights, struct error *err)
{
    *weights = (struct particle_weights){ 0 };
    if (!(*used = mem_array(n, sizeof **used, UINT64_MAX, err)))
        return false;
    for (size_t i = 0; i < n; i++) {
        struct particle *to = &(*used)[weights->n_used];
        double weight = (double)from[i].weight;
        enum fate fate = place(frame, &from[i], to);
        if (fate == USED && are_photons && (double)from[i].energy_mev < PHOTON_LOWEST_MEV)
            fate = SOFT;
        weights->all += weight;
        weights->backward += fate == BACKWARD ? weight : 0;
        weights->beside += fate == BESIDE ? weight : 0;
        weights->soft += fate == SOFT ? weight : 0;
        if (fate != USED || !(weight > 0))
            continue;
        if (!are_photons)
            to->energy = fmaxf(to->energy * 1e6F, NEUTRON_LOWEST_EV);
        weights->n_used++;
    }
    return true;
}

/* Draws m entries from n particles, evenly spaced in what their weights and importances add up to. A drawn entry's
 * weight makes the sum right: it is that of all of them over how often such a particle is drawn. */
static void draw(const struct particle *from, size_t n, bool are_photons, struct particle *to, size_t m,
                 double mean_weight, struct random *random)
{
    double sum = 0, upto = 0, offset = (double)random_unit(random);
    for (size_t i = 0; i < n; i++)
        sum += (double)from[i].weight * (are_photons ? 1 : phase_space_importance((double)from[i].energy));
    for (size_t i = 0, k = 0; i < n; i++) {
        double importance = are_photons ? 1 : phase_space_importance((double)from[i].energy);
        upto += (double)from[i].weight * importance;
        bool is_last = i == n - 1;
        while (k < m && (is_last || ((double)k + offset) * sum / (double)m < upto)) {
            to[k * PHASE_SPACE_LANES] = from[i];
            to[k++ * PHASE_SPACE_LANES].weight = (float)(sum / (double)m / importance / mean_weight);
        }
    }
}

static bool make_list(struct particle_list *list, const struct particle *used, const struct particle_weights *weights,
                      bool are_photons, double per_weight, size_t n, uint64_t seed, struct error *err)
{
    double sum = 0;
    size_t n_used = weights->n_used;
    n = (n + PHASE_SPACE_LANES - 1) / PHASE_SPACE_LANES * PHASE_SPACE_LANES;
    if (n == 0 || n_used < PHASE_SPACE_LANES)
        return true;
    for (size_t i = 0; i < n_used; i++)
        sum += (double)used[i].weight;
    if (!(list->particles = mem_array(n, sizeof *list->particles, UINT64_MAX, err)))
        return false;
    list->n = n;
    list->per_unit = per_weight * sum;
    for (size_t lane = 0; lane < PHASE_SPACE_LANES; lane++) {
        size_t at = n_used * lane / PHASE_SPACE_LANES, end = n_used * (lane + 1) / PHASE_SPACE_LANES;
        struct random random = random_of(seed, PHASE_SPACE_STREAM | (2 * lane + are_photons));
        draw(used + at, end - at, are_photons, list->particles + lane, n / PHASE_SPACE_LANES, sum / (double)n, &random);
    }
    return true;
}

static bool take_kind(struct particle_list *list, const struct beam_particle *from, size_t n_from,
                      const struct particle_frame *frame, bool are_photons, double per_weight, size_t n, uint64_t seed,
                      struct particle_weights *weights, struct error *err)
{
    struct particle *used = NULL;
    bool is_done = place_all(frame, from, n_from, are_photons, &used, weights, err) &&
                   make_list(list, used, weights, are_photons, per_weight, n, seed, err);
    free(used);
    return is_done;
}

bool phase_space_of_particles(struct phase_space *space, const struct beam_particles *particles,
                              const struct particle_frame *frame, double per_weight, size_t n_neutrons,
                              size_t n_photons, uint64_t seed, struct particle_weights *neutrons,
                              struct particle_weights *photons, struct error *err)
{
    *space = (struct phase_space){ 0 };
    if (n_neutrons > PHASE_SPACE_MAX_PARTICLES || n_photons > PHASE_SPACE_MAX_PARTICLES)
        return error_set(err, ERROR_LIMIT, "a list of %zu particles, at most %d expected",
                         n_neutrons > n_photons ? n_neutrons : n_photons, PHASE_SPACE_MAX_PARTICLES);
    bool is_done = take_kind(&space->neutrons, particles->neutrons, particles->n_neutrons, frame, false, per_weight,
                             n_neutrons, seed, neutrons, err) &&
                   take_kind(&space->photons, particles->photons, particles->n_photons, frame, true, per_weight,
                             n_photons, seed, photons, err);
    if (is_done && space->neutrons.n == 0)
        is_done = error_set(err, ERROR_RANGE, "of %zu neutrons %zu go through the aperture plane, %d or more expected",
                            particles->n_neutrons, neutrons->n_used, PHASE_SPACE_LANES);
    if (!is_done)
        phase_space_finish(space);
    return is_done;
}
