/* Drawing a source's particles and following them through the delimiter. */
#include "core/transport/phase_space.h"

#include <stdlib.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/transport/direction.h"

/* Polyethylene with lithium: atoms per barn and cm. Source: seraMC's materials Rx_215_enr and Rx_215_nat (SERA 1C1). */
static const struct {
    double h, c, o, lithium_6_enriched, lithium_6_natural, electrons_of_water;
} delimiter_material = { .0545, .0308, .0104, .0075, .0005025, 1.031 };
#define LITHIUM_6_2200_B 940. /* Sears 1992, as in medium.c */
#define FARTHEST_CM 30.       /* from the axis: beyond, a particle is lost */
/* A lane gives up after FIRST_TRIES, and MOST_TRIES for each entry that it has. */
enum { MOST_TRIES = 2000, FIRST_TRIES = 100000 };

struct drawing {
    const struct beam_source *source;
    const struct beam_spectrum *spectrum;
    const struct particle_tables *tables;
    double cumulative[SOURCE_MAX_GROUPS], weight[SOURCE_MAX_GROUPS]; /* of drawing a group; of what is drawn */
    struct particle *particles;
    size_t n;
    uint64_t seed;
    bool are_photons;
    const atomic_bool *cancel;
    uint64_t tries[PHASE_SPACE_LANES]; /* by lane; 0: it found none */
};

/* How much more often than its share a group is drawn. Any positive numbers give the same mean; these make the fast
 * dose, which few neutrons bring, as sure as the others. */
double phase_space_importance(double energy_ev)
{
    return energy_ev > 9.2e3 ? fmin(40, 4 * sqrt(energy_ev / 1e4)) : energy_ev < 1 ? .5 : 1;
}

static void prepare(struct drawing *drawing)
{
    const struct beam_spectrum *spectrum = drawing->spectrum;
    double sum = 0, drawn = 0;
    for (size_t i = 0; i < spectrum->n_groups; i++)
        sum += spectrum->share[i];
    for (size_t i = 0; i < spectrum->n_groups; i++) {
        double more = drawing->are_photons ? 1 : phase_space_importance(spectrum->bounds_ev[i]);
        drawn += spectrum->share[i] / sum * more;
        drawing->cumulative[i] = drawn;
        drawing->weight[i] = 1 / more;
    }
    for (size_t i = 0; i < spectrum->n_groups; i++) {
        drawing->cumulative[i] /= drawn;
        drawing->weight[i] *= drawn;
    }
}

/* Energy in a current of Maxwell's spectrum, E exp(-E / 0.0253 eV), within bounds. */
static double draw_slow_ev(double low, double high, struct random *random)
{
    for (;;) {
        double energy_ev = sqrt(low * low + (high * high - low * low) * (double)random_unit(random));
        if ((double)random_unit(random) <= exp((low - energy_ev) / .0253))
            return energy_ev;
    }
}

static double draw_energy_ev(const struct drawing *drawing, size_t group, struct random *random)
{
    double low = drawing->spectrum->bounds_ev[group + 1], high = drawing->spectrum->bounds_ev[group];
    if (drawing->are_photons)
        return low + (high - low) * (double)random_unit(random);
    if (high <= .11 && !drawing->spectrum->is_by_lethargy)
        return draw_slow_ev(low, high, random);
    return low * pow(high / low, (double)random_unit(random));
}

/* A point of the disk and a direction; z counts up to the aperture plane at 0. */
static size_t draw_start(const struct drawing *drawing, float position[3], float direction[3], struct random *random)
{
    const struct beam_source *source = drawing->source;
    double u = (double)random_unit(random);
    size_t group = 0;
    while (group < drawing->spectrum->n_groups - 1 && u > drawing->cumulative[group])
        group++;
    double radius = source->radius_cm * sqrt((double)random_unit(random)),
           angle = 2 * M_PI * (double)random_unit(random);
    position[0] = (float)(radius * cos(angle));
    position[1] = (float)(radius * sin(angle));
    position[2] = (float)-source->to_aperture_cm;
    double at = (double)random_unit(random) * (double)source->n_cuts;
    size_t cut = (size_t)at < source->n_cuts ? (size_t)at : source->n_cuts - 1;
    const double *cuts = drawing->spectrum->cuts[group];
    double high = cut ? cuts[cut - 1] : 1, cosine = high + (at - (double)cut) * (cuts[cut] - high);
    direction[0] = direction[1] = 0;
    direction[2] = 1;
    if (cosine < 1)
        direction_turn(direction, (float)fmax(cosine, 1e-3), drawing->tables->azimuth[random_bits(random) >> 54]);
    return group;
}

enum flight { FLIGHT_OUT, FLIGHT_LOST, FLIGHT_HOLE, FLIGHT_WALL };

/* Flies to a tentative collision; mean_cm is the shortest mean free path in the delimiter. Between the disk and a
 * shorter delimiter is air, as in its hole. */
static enum flight fly(const struct beam_source *source, float position[3], const float direction[3], double mean_cm,
                       struct random *random)
{
    const struct beam_delimiter *delimiter = &source->delimiter;
    float step = (float)(-log((double)random_unit(random)) * mean_cm), z = position[2] + direction[2] * step;
    if (z > 0)
        return FLIGHT_OUT;
    if (z < (float)-fmax(delimiter->length_cm, source->to_aperture_cm) - .05F)
        return FLIGHT_LOST;
    for (int i = 0; i < 3; i++)
        position[i] += direction[i] * step;
    double radius = hypot((double)position[0], (double)position[1]);
    if (radius > FARTHEST_CM + 4)
        return FLIGHT_LOST;
    if (z < (float)-delimiter->length_cm - .05F)
        return FLIGHT_HOLE;
    double hole = delimiter->exit_radius_cm - (delimiter->entrance_radius_cm - delimiter->exit_radius_cm) *
                                                  (double)position[2] / delimiter->length_cm;
    return radius < hole ? FLIGHT_HOLE : FLIGHT_WALL;
}

static bool neutron_passes(const struct drawing *drawing, float position[3], float direction[3], double *energy_ev,
                           struct random *random)
{
    for (;;) {
        double h = delimiter_material.h * nuclide_scatter_b(NUCLIDE_H, *energy_ev);
        double hc = h + delimiter_material.c * nuclide_scatter_b(NUCLIDE_C, *energy_ev);
        double scatter = hc + delimiter_material.o * nuclide_scatter_b(NUCLIDE_O, *energy_ev);
        double lithium = LITHIUM_6_2200_B * sqrt(.0253 / *energy_ev);
        double highest = scatter + delimiter_material.lithium_6_enriched * lithium;
        enum flight flight = fly(drawing->source, position, direction, 1 / highest, random);
        if (flight == FLIGHT_OUT || flight == FLIGHT_LOST)
            return flight == FLIGHT_OUT;
        if (flight == FLIGHT_HOLE)
            continue;
        bool is_enriched =
            hypot((double)position[0], (double)position[1]) < drawing->source->delimiter.natural_lithium_from_cm;
        double absorption =
            lithium * (is_enriched ? delimiter_material.lithium_6_enriched : delimiter_material.lithium_6_natural);
        double met = (double)random_unit(random) * highest;
        if (met < absorption)
            return false;
        if (met > absorption + scatter)
            continue;
        met = (double)random_unit(random) * scatter;
        double mass = met < h ? 1 : met < hc ? 12 : 16, cosine = 2 * (double)random_unit(random) - 1;
        double square = fmax(mass * mass + 2 * mass * cosine + 1, 1e-9);
        *energy_ev *= square / ((mass + 1) * (mass + 1));
        if (*energy_ev < .02) /* in balance with the matter at room temperature */
            *energy_ev = .0253;
        direction_turn(direction, (float)((1 + mass * cosine) / sqrt(square)),
                       drawing->tables->azimuth[random_bits(random) >> 54]);
    }
}

static bool photon_passes(const struct drawing *drawing, float position[3], float direction[3], float *energy_mev,
                          float *weight, struct random *random)
{
    for (;;) {
        int bin = photon_bin(*energy_mev);
        double mean_cm = 1 / ((double)drawing->tables->photon_cm2_g[bin] * delimiter_material.electrons_of_water);
        enum flight flight = fly(drawing->source, position, direction, mean_cm, random);
        if (flight == FLIGHT_OUT || flight == FLIGHT_LOST)
            return flight == FLIGHT_OUT;
        if (flight == FLIGHT_HOLE)
            continue;
        *weight *= drawing->tables->photon_compton[bin];
        photon_scatter(drawing->tables, direction, energy_mev, random);
        if (*energy_mev < .03F || *weight < .05F)
            return false;
    }
}

/* One particle of the source; false if it does not reach the aperture plane. */
static bool draw(const struct drawing *drawing, struct particle *particle, struct random *random)
{
    float position[3], direction[3];
    size_t group = draw_start(drawing, position, direction, random);
    double energy = draw_energy_ev(drawing, group, random);
    float weight = (float)drawing->weight[group], energy_mev = (float)(energy * 1e-6);
    bool has_delimiter = drawing->source->delimiter.length_cm > 0;
    if (drawing->are_photons
            ? has_delimiter && !photon_passes(drawing, position, direction, &energy_mev, &weight, random)
            : has_delimiter && !neutron_passes(drawing, position, direction, &energy, random))
        return false;
    if (direction[2] < 1e-3F)
        return false;
    float far = -position[2] / direction[2];
    *particle = (struct particle){ position[0] + far * direction[0],
                                   position[1] + far * direction[1],
                                   { direction[0], direction[1], direction[2] },
                                   drawing->are_photons ? energy_mev : (float)energy,
                                   weight };
    return hypotf(particle->x_cm, particle->y_cm) <= (float)FARTHEST_CM;
}

/* False if it gives up. */
static bool draw_entry(const struct drawing *drawing, size_t i, uint64_t *tries)
{
    struct random random = random_of(drawing->seed, PHASE_SPACE_STREAM | (2 * i + drawing->are_photons));
    uint64_t most = FIRST_TRIES + i / PHASE_SPACE_LANES * MOST_TRIES;
    do {
        if (*tries >= most || (drawing->cancel && atomic_load(drawing->cancel)))
            return false;
        ++*tries;
    } while (!draw(drawing, &drawing->particles[i], &random));
    return true;
}

static void draw_lanes(void *context, int part, int n_parts)
{
    struct drawing *drawing = context;
    for (int lane = part; lane < PHASE_SPACE_LANES; lane += n_parts)
        for (size_t i = (size_t)lane; i < drawing->n; i += PHASE_SPACE_LANES)
            if (!draw_entry(drawing, i, &drawing->tries[lane])) {
                drawing->tries[lane] = 0;
                break;
            }
}

static bool draw_list(struct particle_list *list, struct drawing *drawing, size_t n, int n_threads, struct error *err)
{
    n = (n + PHASE_SPACE_LANES - 1) / PHASE_SPACE_LANES * PHASE_SPACE_LANES;
    list->particles = mem_array(n, sizeof *list->particles, UINT64_MAX, err);
    if (!list->particles)
        return false;
    drawing->particles = list->particles;
    drawing->n = list->n = n;
    prepare(drawing);
    parallel_run(n_threads < PHASE_SPACE_LANES ? n_threads : PHASE_SPACE_LANES, draw_lanes, drawing);
    if (drawing->cancel && atomic_load(drawing->cancel))
        return error_set(err, ERROR_CANCELLED, "drawing the beam's particles was cancelled");
    uint64_t tries = 0;
    for (int lane = 0; lane < PHASE_SPACE_LANES && n > 0; lane++) {
        if (drawing->tries[lane] == 0)
            return error_set(err, ERROR_RANGE,
                             "source %.100s: fewer than one of %d particles, or none of %d, reaches the aperture",
                             drawing->source->name, MOST_TRIES, FIRST_TRIES);
        tries += drawing->tries[lane];
    }
    double area_cm2 = M_PI * drawing->source->radius_cm * drawing->source->radius_cm;
    list->per_unit = n > 0 ? drawing->spectrum->per_cm2 * area_cm2 * (double)n / (double)tries : 0;
    return true;
}

static bool check_source(const struct beam_source *source, struct error *err)
{
    if (source->radius_cm > FARTHEST_CM)
        return error_set(err, ERROR_RANGE, "source %.100s: a disk of %g cm in radius, at most %g expected",
                         source->name, source->radius_cm, FARTHEST_CM);
    if (source->to_aperture_cm < source->delimiter.length_cm - .1)
        return error_set(err, ERROR_RANGE,
                         "source %.100s: its disk is %g cm from the aperture plane, within the delimiter of %g cm",
                         source->name, source->to_aperture_cm, source->delimiter.length_cm);
    return true;
}

bool phase_space_of_source(struct phase_space *space, const struct beam_source *source, size_t n_neutrons,
                           size_t n_photons, uint64_t seed, int n_threads, const atomic_bool *cancel, struct error *err)
{
    *space = (struct phase_space){ 0 };
    if (n_neutrons > PHASE_SPACE_MAX_PARTICLES || n_photons > PHASE_SPACE_MAX_PARTICLES)
        return error_set(err, ERROR_LIMIT, "a list of %zu particles, at most %d expected",
                         n_neutrons > n_photons ? n_neutrons : n_photons, PHASE_SPACE_MAX_PARTICLES);
    if (!check_source(source, err))
        return false;
    struct particle_tables *tables = mem_array(1, sizeof *tables, UINT64_MAX, err);
    if (!tables)
        return false;
    particle_tables_init(tables);
    struct drawing drawing = { source, &source->neutrons, tables, .seed = seed, .cancel = cancel };
    bool is_done = draw_list(&space->neutrons, &drawing, n_neutrons, n_threads, err);
    if (is_done && source->photons.per_cm2 > 0) {
        drawing =
            (struct drawing){ source, &source->photons, tables, .seed = seed, .are_photons = true, .cancel = cancel };
        is_done = draw_list(&space->photons, &drawing, n_photons, n_threads, err);
    }
    free(tables);
    if (!is_done)
        phase_space_finish(space);
    return is_done;
}

void phase_space_finish(struct phase_space *space)
{
    free(space->neutrons.particles);
    free(space->photons.particles);
    *space = (struct phase_space){ 0 };
}
