#pragma once
/* Reads a mesh tally of MCNP (FMESH, file meshtal): rectangular, in columns or in matrices, of any energies. Several
 * times count by their total. Works on bytes in memory. Values are per particle of the source, in 1/cm2 unless a dose
 * function, a multiplier or OUT changed them; x, y, z in cm.
 *
 * source  MCNP6 manual, LA-UR-17-29981 (2017), section 3.3.5.25 (FMESH) */
#include "core/formats/tally/tally.h"

bool meshtal_is(const uint8_t *data, size_t size);
/* Each box has to be there exactly once, and where its row says it lies.
 * errors  ERROR_FORMAT, with the line; ERROR_NOT_FOUND no such tally or energy; ERROR_RANGE several of them, and no
 *         choice; ERROR_UNSUPPORTED cylinders, uneven steps; ERROR_LIMIT; ERROR_MEMORY */
NODISCARD bool meshtal_read(const uint8_t *data, size_t size, const char *name, const struct tally_choice *choice,
                            struct tally *tally, struct error *err);
