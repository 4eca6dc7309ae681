#pragma once
/* Reads what PHITS writes of [T-Deposit] and [T-Track] on a mesh xyz of linear steps: along an axis, or planes (2D-type
 * 1, 2, 3, 6 or 7), all pages together. Works on bytes in memory. Values are per particle of the source, in the unit
 * that the file names; x, y, z in cm. A file along an axis holds relative errors; those of planes lie in another file,
 * _err.out. Of several particles the first column counts if it is of all, else the file is refused.
 *
 * source  PHITS user's manual, sections on tallies and on the format of ANGEL */
#include "core/formats/tally/tally.h"

bool phits_tally_is(const uint8_t *data, size_t size);
/* True for a file along an axis, by its first bytes. */
bool phits_tally_has_errors(const uint8_t *data, size_t size);
/* Each box has to be there exactly once, and where its row or its plane says it lies.
 * errors  ERROR_FORMAT, with the line; ERROR_NOT_FOUND no such energy; ERROR_RANGE several, and no choice;
 *         ERROR_UNSUPPORTED another tally, mesh or axis; ERROR_LIMIT; ERROR_MEMORY */
NODISCARD bool phits_tally_read(const uint8_t *data, size_t size, const char *name, const struct tally_choice *choice,
                                struct tally *tally, struct error *err);
/* Takes the relative errors of a tally of planes from its _err.out. errors  as phits_tally_read; ERROR_RANGE another
 * mesh */
NODISCARD bool phits_tally_read_errors(const uint8_t *data, size_t size, const char *name,
                                       const struct tally_choice *choice, struct tally *tally, struct error *err);
