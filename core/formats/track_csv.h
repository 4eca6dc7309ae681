#pragma once
/* Reads particle tracks from a table of comma-separated values. Works on bytes in memory.
 *
 * The first line that is not empty names the columns, in any order: x0_mm y0_mm z0_mm (start), x1_mm y1_mm z1_mm (end),
 * in patient LPS, and class (a word of track_class_word); energy_mev may be missing, and its cells may be empty.
 * Further columns are ignored. Each further line is one segment. A cell may stand in double quotes; '#' begins a
 * comment. */
#include "core/report/report.h"
#include "core/track/track.h"

enum { TRACK_CSV_MAX_BYTES = 256 << 20, TRACK_CSV_MAX_COLUMNS = 64 };
#define TRACK_CSV_MAX_PLACE_MM 1e6 /* farthest end point of a segment inside a treatment room */
#define TRACK_CSV_MAX_MEV 1e9

/* True if the start of a file is a header line with the columns of the end points and the class. */
bool track_csv_looks_like(const uint8_t *data, size_t size);

/* Appends the segments to set. A line that is not a segment, of no length, or beyond TRACK_CSV_MAX_PLACE_MM is left
 * out, which the report says with the line's number. errors  ERROR_FORMAT a column is missing or given twice, not one
 * line is a segment; ERROR_LIMIT more than TRACK_MAX_SEGMENTS or TRACK_CSV_MAX_COLUMNS; ERROR_MEMORY */
NODISCARD bool track_csv_parse(const uint8_t *data, size_t size, const char *name, struct track_set *set,
                               struct report *report, struct error *err);
