#pragma once
/* Inside of core/surface: marching cubes with what its tests and other methods need beyond the mesh. */
#include "core/surface/surface.h"

/* The same code compiled for any processor and for one with bit counting. */
enum marching_cubes_code { MARCHING_CUBES_BEST, MARCHING_CUBES_PORTABLE };

/* Where a vertex starts: in the middle of a crossed edge of the working grid, which is the mask's, shifted. */
struct marching_point {
    int16_t at2[3]; /* twice its place */
    uint8_t axis;   /* of the edge: 0, 1, 2 */
    int8_t outward; /* +1: the outside end has the higher index; -1 */
};

/* How vertices hang together: a crossed edge lies on four faces between cells, and on each of them a line of the
 * surface leaves it for another crossed edge. So every vertex has four links, and where two lines pass through it,
 * links 0 and 3 are the ends of one, 1 and 2 of the other; (link 3 - link 0) x (link 2 - link 1), times the vertex'
 * outward, points outward. A link is missing only where the border of the grid is left open: there it is the vertex
 * itself. */
struct marching_graph {
    struct marching_point *points; /* [n_vertices] */
    uint32_t (*links)[4];          /* [n_vertices] */
    struct affine lps_mm_from_at;
    int32_t start[3];      /* index in the mask of place 0 0 0 */
    bool has_no_links;     /* set by the caller: they are not wanted, links stays NULL */
    bool has_no_positions; /* set by the caller, who writes the mesh's positions, and its bounds, itself */
};
void marching_graph_finish(struct marching_graph *graph);

/* graph: NULL, or filled when a mesh is returned. errors as surface_marching_cubes */
NODISCARD struct mesh *marching_cubes_run(enum marching_cubes_code code, const struct mask *mask,
                                          const struct surface_options *options, struct marching_graph *graph,
                                          struct error *err);
NODISCARD struct mesh *marching_cubes_with(enum marching_cubes_code code, const struct mask *mask,
                                           const struct surface_options *options, struct error *err);

struct marching_rows;
/* Points and links of the vertices that rows from..end own, and those of the cells they own (marching_graph.c). */
void marching_graph_write(enum marching_cubes_code code, const struct marching_rows *grid, struct marching_graph *graph,
                          size_t from, size_t end);
