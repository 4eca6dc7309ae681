#pragma once
/* One line of SERA's tables of points: three coordinates, a region's number, then values. seraMC writes fixed columns
 * (10 characters a number, 4 the region), in which negative numbers touch; seraPlan leaves blanks between them. */
#include <stdbool.h>
#include <stddef.h>

enum { SERA_ROW_MAX_VALUES = 9 };

struct sera_row {
    double at[3];
    double region; /* a whole number, else not-a-number */
    double values[SERA_ROW_MAX_VALUES];
    size_t n_unprinted, n_unread; /* "***" or a number beyond all use; no number at all. Either is not-a-number above */
};

/* Whether a line of n characters is in fixed columns: as long as these make it, and not so many words. */
bool sera_row_is_fixed(const char *line, size_t n, size_t n_values);
/* false when it has not as many fields. */
bool sera_row_parse(const char *line, size_t n, bool is_fixed, size_t n_values, struct sera_row *row);
