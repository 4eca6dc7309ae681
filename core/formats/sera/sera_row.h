#pragma once
/* Reads one line of SERA's tables of points: three coordinates, a region's number, then values. seraMC writes fixed
 * columns (10 characters for a number, 4 for the region), where negative numbers touch; seraPlan separates by blanks.
 */
#include <stdbool.h>
#include <stddef.h>

enum { SERA_ROW_MAX_VALUES = 9 };

struct sera_row {
    double at[3];
    double region; /* a whole number; not-a-number when the field is none */
    double values[SERA_ROW_MAX_VALUES];
    size_t n_unprinted,
        n_unread; /* fields "***" or with an absurd number; fields that are no number. Both become not-a-number above */
};

/* True if a line of n characters is in fixed columns: it has exactly their length, or another number of words than
 * fields. */
bool sera_row_is_fixed(const char *line, size_t n, size_t n_values);
/* Returns false when the line has too few fields. */
bool sera_row_parse(const char *line, size_t n, bool is_fixed, size_t n_values, struct sera_row *row);
