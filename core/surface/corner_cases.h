#pragma once
/* Case table of the 8-cell algorithm: the 256 combinations of inside corners of a cell, with the triangles between
 * inside corners. Generated, not typed. Corners are numbered as in cube_cases.h. Any thread. */
#include <stdbool.h>
#include <stdint.h>

enum { CORNER_MAX_TRIANGLES = 4 };

struct corner_case {
    uint8_t corners[3 * CORNER_MAX_TRIANGLES]; /* three per triangle; unused entries are 0 */
    uint8_t n_triangles;
    uint8_t used; /* bit c: corner c is used by a triangle */
};

/* Fills the table. Triangles are counter-clockwise as seen from outside for right-handed x, y, z; clockwise if
 * is_mirrored. */
void corner_cases_make(struct corner_case cases[256], bool is_mirrored);
