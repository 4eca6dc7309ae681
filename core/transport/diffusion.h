#pragma once
/* Diffusion of slow neutrons in the blocks of a geometry: where they are born to where they are. Built once a run, then
 * constant: any thread; each solution has numbers of its own. Knows no histories. */
#include "core/transport/geometry.h"
#include "core/transport/medium.h"

#define DIFFUSION_BELOW_EV .06F /* the energy below which neutrons diffuse */
#define DIFFUSION_SKIN_CM 1.0   /* nearer to air they do not begin to */

/* A material as diffusing neutrons see it: means over their spectrum in an infinite medium. */
struct diffusion_medium {
    double coefficient_cm; /* D */
    /* Extrapolation length of a free surface over D: 2.1313 for one free path (G. Placzek, W. Seidel, 1947), more as
     * those with longer ones leave from deeper. */
    double extrapolation;
    double absorption_cm;
    double slow;    /* mean of sqrt(0.0253 eV / E) */
    double thermal; /* share of the fluence below NEUTRON_THERMAL_EV */
};
void diffusion_medium_init(struct diffusion_medium *diffusing, const struct material *material,
                           const struct medium *medium);

/* Balances of blocks in a box: what a block loses for a fluence of 1, less what its neighbours give it. Blocks at the
 * box's sides hold nothing. */
struct diffusion_net {
    size_t n_blocks, n_rows;
    int32_t n[3];
    ptrdiff_t step[3]; /* between neighbours along each axis, in blocks */
    struct cell_row *rows;
    float *coupling[3]; /* to the next block along an axis, cm2 / cm * cm */
    float *diagonal, *inverse;
};

struct diffusion {
    struct diffusion_net fine, coarse; /* coarse: of blocks twice as wide, for a first guess */
    uint8_t *is_deep;                  /* slow neutrons begin to diffuse there */
    float *absorbed, *leaked;          /* neutrons for a fluence of 1 */
    /* For a fluence of 1: fluence times volume of matter, of thermal neutrons and times sqrt(0.0253 eV / E); photon
     * energy, MeV. The fluence is what the surface leaves of it (Milne). */
    float *thermal, *slow, *emitted_mev;
};

/*   geometry  whose cells are its blocks
 *   errors    ERROR_MEMORY; ERROR_CANCELLED */
NODISCARD bool diffusion_init(struct diffusion *diffusion, const struct geometry *geometry,
                              const struct material *materials, const struct medium *media, size_t n_media,
                              const atomic_bool *cancel, struct error *err);
void diffusion_finish(struct diffusion *diffusion);

enum { DIFFUSION_N_SCRATCH = 3 }; /* arrays of n_blocks */

/* Fluence of a source by conjugate gradients, from that of the coarse blocks, to a residual of `tolerance` of the
 * source. fluence and scratch need no values, but fluence is 0 where nothing diffuses. Returns the number of
 * iterations. */
int diffusion_solve(const struct diffusion *diffusion, const float *source, double tolerance, float *fluence,
                    float *scratch[DIFFUSION_N_SCRATCH]);
