#pragma once
/* Particles that another program wrote down where its beam leaves: neutrons and photons, each with place, direction,
 * energy and weight, in that program's axes. Plain data; knows no file and no transport. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/base/error.h"

enum { BEAM_PARTICLES_MAX = 40000000, BEAM_PARTICLES_TITLE_SIZE = 128 };
#define BEAM_PARTICLE_MAX_MEV 1e4
#define BEAM_PARTICLE_MAX_CM 1e5 /* of a coordinate */
#define BEAM_PARTICLE_MAX_WEIGHT 1e20

struct beam_particle {
    float position_cm[3];
    float direction[3]; /* of length 1 */
    float energy_mev, weight;
};
struct beam_particles {
    struct beam_particle *neutrons, *photons; /* owned */
    size_t n_neutrons, n_photons;
    uint64_t n_others;                     /* of other kinds: left out */
    double histories;                      /* primary particles of the run that wrote them; 0: the file does not say */
    bool is_count_given;                   /* false: the file's size alone says how many there are */
    char title[BEAM_PARTICLES_TITLE_SIZE]; /* for people; "" none */
};

/* Room for as many of each kind as were counted, none of them yet. ERROR_LIMIT, ERROR_MEMORY */
NODISCARD bool beam_particles_init(struct beam_particles *particles, uint64_t n_neutrons, uint64_t n_photons,
                                   const char *name, struct error *err);
void beam_particles_finish(struct beam_particles *particles);

/* Names the value of a particle that is wrong: "its energy", ...; NULL: none. Brings its direction to length 1. */
const char *beam_particle_check(struct beam_particle *particle);
