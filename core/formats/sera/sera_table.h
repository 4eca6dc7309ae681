#pragma once
/* Reads SERA's table of doses over depth and radius along a beam, .dose (edit directive Bopt): a heading, then one
 * point per line in fixed columns. Notes after the points are skipped. Works on unpacked text in memory. */
#include "core/dose/curve.h"
#include "core/report/report.h"

#define SERA_TABLE_MAX_BYTES ((uint64_t)192 << 20)

/* Fills the curve but for id, name and per; the unit is cGy. Points with nothing but zeros lie outside the run's mesh
 * and become not-a-number. errors  ERROR_FORMAT (with the line), ERROR_LIMIT, ERROR_MEMORY; curve is then empty */
NODISCARD bool sera_table_parse(const uint8_t *data, size_t size, const char *name, struct dose_curve *curve,
                                struct report *report, struct error *err);
