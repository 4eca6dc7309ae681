#pragma once
/* Case table of marching cubes: the 256 combinations of inside corners of a cell, with the triangles of each.
 * Generated, not typed. Any thread.
 *
 * Corners: bit 0 of a corner's number is x, bit 1 is y, bit 2 is z; bit c of a case says that corner c is inside.
 *   Edges: 0..3 along x, at (y, z) = (0,0) (1,0) (0,1) (1,1);
 *          4, 5 along y and 6, 7 along z on the face x = 0, at 0 and 1 of the other coordinate;
 *          8..11 are 4..7 on the face x = 1. */
#include <stdbool.h>
#include <stdint.h>

enum { CUBE_EDGES = 12, CUBE_MAX_TRIANGLES = 5 };

struct cube_case {                             /* 32 bytes, in parts that vector code loads whole */
    _Alignas(32) uint8_t is_crossed[8];        /* edges 0..7: 1 if exactly one end is inside */
    uint8_t edges[3 * CUBE_MAX_TRIANGLES + 1]; /* the edge of each triangle corner; unused entries are 0 */
    uint8_t n_triangles;
};

/* Fills the table. Triangles are counter-clockwise as seen from the outside corners for right-handed x, y, z; clockwise
 * if is_mirrored. */
void cube_cases_make(struct cube_case cases[256], bool is_mirrored);
/* The polygons before they are cut into triangles: for each crossed edge the next one on its loop (outside corners to
 * the viewer's side), -1 for all other edges. */
void cube_case_links(int inside, int8_t next[CUBE_EDGES]);
