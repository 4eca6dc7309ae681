#pragma once
/* Reads MCPL, version 3: lists of particles that McStas, MCNP, Geant4, PHITS and OpenMC exchange. Works on bytes in
 * memory, packed by gzip or not. Of the particles neutrons (PDG code 2112) and photons (22) are taken, others counted;
 * times, polarisations and flags are passed over. Units of the file: cm, MeV.
 *
 * source  T. Kittelmann and others, Comput. Phys. Commun. 218, 17 (2017), doi 10.1016/j.cpc.2017.04.012 */
#include "core/beam/beam_particles.h"

#define MCPL_MAX_BYTES (UINT64_C(1) << 30) /* unpacked */
enum { MCPL_MAX_TEXTS = 65536 };           /* comments, and blobs */

bool mcpl_is(const uint8_t *data, size_t size); /* by the first bytes, packed or not */

/* A file whose program died before it wrote the count (0 in its header) holds as many particles as whole records
 * follow. errors  ERROR_FORMAT, with the place; ERROR_LIMIT; ERROR_UNSUPPORTED another version; ERROR_MEMORY */
NODISCARD bool mcpl_read(const uint8_t *data, size_t size, const char *name, struct beam_particles *particles,
                         struct error *err);
