#pragma once
/* The 256 ways the eight corners of a cell can be inside or outside, and the triangles of each: generated, not typed.
 *
 * Corners: bit 0 of a corner's number is x, bit 1 is y, bit 2 is z; bit c of a case says that corner c is inside.
 * Edges: 0..3 along x, at (y, z) = (0,0) (1,0) (0,1) (1,1);
 *        4, 5 along y and 6, 7 along z on the face x = 0, each for the other coordinate 0 and 1; 8..11 are 4..7 on the
 * face x = 1. */
#include <stdbool.h>
#include <stdint.h>

enum { CUBE_EDGES = 12, CUBE_MAX_TRIANGLES = 5 };

struct cube_case {                             /* 32 bytes, in parts that vector code loads whole */
    _Alignas(32) uint8_t is_crossed[8];        /* edges 0..7: 1 when one end is inside, the other outside */
    uint8_t edges[3 * CUBE_MAX_TRIANGLES + 1]; /* edge on which each corner of each triangle lies; the rest 0 */
    uint8_t n_triangles;
};

/* Triangles wind counter-clockwise seen from the outside corners when x, y, z are right-handed; the other way if
 * mirrored. */
void cube_cases_make(struct cube_case cases[256], bool is_mirrored);
/* The same before it is cut into triangles: for each crossed edge the next one on its loop round the outside corners'
 * side, -1 for the others. */
void cube_case_links(int inside, int8_t next[CUBE_EDGES]);
