#pragma once
/* The 256 ways the eight corners of a cell can be inside or outside, and the triangles between inside corners of each:
 * generated, not typed. Corners are numbered as in cube_cases.h. */
#include <stdbool.h>
#include <stdint.h>

enum { CORNER_MAX_TRIANGLES = 4 };

struct corner_case {
    uint8_t corners[3 * CORNER_MAX_TRIANGLES]; /* of each triangle; the rest 0 */
    uint8_t n_triangles;
    uint8_t used; /* bit c: a triangle has corner c */
};

/* Triangles wind counter-clockwise seen from outside when x, y, z are right-handed; the other way if mirrored. */
void corner_cases_make(struct corner_case cases[256], bool is_mirrored);
