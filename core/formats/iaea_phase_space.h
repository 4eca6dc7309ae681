#pragma once
/* Reads a phase space of the IAEA: the text of its .IAEAheader, and the records of its .IAEAphsp. Works on bytes in
 * memory. Neutrons and photons are taken, others counted. Units of the file: cm, MeV.
 *
 * source  R. Capote and others, Phase-space database for external beam radiotherapy, IAEA INDC(NDS)-0484 (2006) */
#include "core/beam/beam_particles.h"

#define IAEA_PHASE_SPACE_MAX_BYTES (UINT64_C(1) << 30) /* of the records */
enum { IAEA_HEADER_MAX_BYTES = 1 << 20, IAEA_MAX_EXTRAS = 32 };

/* Fields of a record in their order. */
enum iaea_field { IAEA_X, IAEA_Y, IAEA_Z, IAEA_U, IAEA_V, IAEA_W, IAEA_WEIGHT, IAEA_N_FIELDS };
struct iaea_header {
    bool is_stored[IAEA_N_FIELDS];
    double constants[IAEA_N_FIELDS]; /* of fields that are not stored; a stored W is computed from U and V */
    size_t record_bytes;
    bool is_big;
    uint64_t n_particles;
    double histories; /* 0: not given */
    char title[BEAM_PARTICLES_TITLE_SIZE];
};

/* errors  ERROR_FORMAT, with block and what is expected; ERROR_LIMIT; ERROR_UNSUPPORTED an event generator */
NODISCARD bool iaea_header_parse(const uint8_t *data, size_t size, const char *name, struct iaea_header *header,
                                 struct error *err);
/* errors  ERROR_FORMAT, with the particle's number and place; ERROR_LIMIT; ERROR_MEMORY */
NODISCARD bool iaea_phase_space_read(const struct iaea_header *header, const uint8_t *data, size_t size,
                                     const char *name, struct beam_particles *particles, struct error *err);
