/* Generates the marching cubes case table. */
#include "core/surface/cube_cases.h"

#include <assert.h>
#include <string.h>

/* Corners of each face, counter-clockwise as seen from outside the cell. */
static const uint8_t faces[6][4] = { { 0, 4, 6, 2 }, { 1, 3, 7, 5 }, { 0, 1, 5, 4 },
                                     { 2, 6, 7, 3 }, { 0, 2, 3, 1 }, { 4, 5, 7, 6 } };

static int edge_between(int a, int b)
{
    int low = a & b;
    int x = low & 1, y = low >> 1 & 1, z = low >> 2 & 1;
    switch (a ^ b) {
    case 1: return y + 2 * z;
    case 2: return 4 + z + 4 * x;
    default: return 6 + y + 4 * x;
    }
}

/* faces_of[edge]: bit f is set if the edge is on face f */
static void find_faces(uint8_t faces_of[CUBE_EDGES])
{
    memset(faces_of, 0, CUBE_EDGES);
    for (int f = 0; f < 6; f++)
        for (int i = 0; i < 4; i++) {
            int e = edge_between(faces[f][i], faces[f][(i + 1) % 4]);
            faces_of[e] = (uint8_t)(faces_of[e] | 1 << f);
        }
}

/* Going counter-clockwise around each face, a line leads from where the inside is entered to where it is next left. So
 * on an ambiguous face (two inside corners across a diagonal) each inside corner is cut off alone. The cell on the
 * other side goes the opposite way around the same corners and draws the same lines, so no crack can open. */
void cube_case_links(int inside, int8_t next[CUBE_EDGES])
{
    memset(next, -1, CUBE_EDGES);
    for (int f = 0; f < 6; f++)
        for (int i = 0; i < 4; i++) {
            int here = faces[f][i], there = faces[f][(i + 1) % 4];
            if ((inside >> here & 1) || !(inside >> there & 1))
                continue;
            int at = i;
            do
                at = (at + 1) % 4;
            while (inside >> faces[f][(at + 1) % 4] & 1);
            next[edge_between(here, there)] = (int8_t)edge_between(faces[f][at], faces[f][(at + 1) % 4]);
        }
}

/* Cuts the polygon loop[first..last] (closed by the side last-first) into triangles with no inner side on a face of the
 * cell: such a side could coincide with one of the neighbour's, and the edge would have four triangles. Depth-first
 * search over the third corner of the triangle on the closing side; false if there is no such cut. */
static bool cut_loop(const uint8_t *loop, int first, int last, const uint8_t faces_of[CUBE_EDGES],
                     struct cube_case *out)
{
    if (last - first < 2)
        return true;
    for (int apex = first + 1; apex < last; apex++) {
        bool left_inner = apex - first > 1, right_inner = last - apex > 1;
        if ((left_inner && (faces_of[loop[first]] & faces_of[loop[apex]])) ||
            (right_inner && (faces_of[loop[apex]] & faces_of[loop[last]])))
            continue;
        uint8_t before = out->n_triangles;
        uint8_t *triangle = out->edges + 3 * out->n_triangles++;
        triangle[0] = loop[first];
        triangle[1] = loop[apex];
        triangle[2] = loop[last];
        if (cut_loop(loop, first, apex, faces_of, out) && cut_loop(loop, apex, last, faces_of, out))
            return true;
        out->n_triangles = before;
    }
    return false;
}

void cube_cases_make(struct cube_case cases[256], bool is_mirrored)
{
    uint8_t faces_of[CUBE_EDGES];
    find_faces(faces_of);
    memset(cases, 0, 256 * sizeof *cases);
    for (int inside = 0; inside < 256; inside++) {
        struct cube_case *out = &cases[inside];
        int8_t next[CUBE_EDGES];
        cube_case_links(inside, next);
        for (int e = 0; e < 8; e++)
            out->is_crossed[e] = next[e] >= 0;
        for (int start = 0; start < CUBE_EDGES; start++) {
            uint8_t loop[CUBE_EDGES];
            int length = 0;
            for (int e = start; next[e] >= 0;) { /* clears the loop on the way, so each is followed once */
                int8_t following = next[e];
                next[e] = -1;
                loop[length++] = (uint8_t)e;
                e = following;
            }
            bool is_cut = cut_loop(loop, 0, length - 1, faces_of, out);
            assert(is_cut && "every loop of the 256 cases can be cut");
            (void)is_cut;
        }
        for (int t = 0; is_mirrored && t < out->n_triangles; t++) {
            uint8_t swapped = out->edges[3 * t + 1];
            out->edges[3 * t + 1] = out->edges[3 * t + 2];
            out->edges[3 * t + 2] = swapped;
        }
    }
}
