#pragma once
/* Inside core/surface: marching cubes with additional results for tests and for other methods (smoothing). Any
 * thread. */
#include "core/surface/surface.h"

/* The compiled version that runs: the best for this processor, or the portable one. Both give the same bytes. */
enum marching_cubes_code { MARCHING_CUBES_BEST, MARCHING_CUBES_PORTABLE };

/* Start position of a vertex: the midpoint of a crossed edge of the working grid, which is the mask's grid, shifted. */
struct marching_point {
    int16_t at2[3]; /* twice the position, in voxels of the working grid */
    uint8_t axis;   /* direction of the edge: 0, 1, 2 */
    int8_t outward; /* +1 if the outside end has the higher index, else -1 */
};

/* Links between vertices. A crossed edge is on four faces between cells; on each face, a line of the surface leads from
 * it to another crossed edge. So every vertex has four links. Two lines pass through it: links 0 and 3 are the ends of
 * one, links 1 and 2 of the other. (link 3 - link 0) x (link 2 - link 1), times the vertex' outward, points outward. At
 * an open border of the grid a missing link is the vertex itself. */
struct marching_graph {
    struct marching_point *points; /* [n_vertices] */
    uint32_t (*links)[4];          /* [n_vertices] */
    struct affine lps_mm_from_at;
    int32_t start[3];      /* index in the mask of the working grid's voxel 0 0 0 */
    bool has_no_positions; /* set by the caller, who writes the mesh's positions and bounds instead */
};
void marching_graph_finish(struct marching_graph *graph);

/* Extracts the surface of a mask. graph: NULL, or filled when a mesh is returned; marching_graph_finish frees it.
 * Errors: as surface_marching_cubes. */
NODISCARD struct mesh *marching_cubes_run(enum marching_cubes_code code, const struct mask *mask,
                                          const struct surface_options *options, struct marching_graph *graph,
                                          struct error *err);
NODISCARD struct mesh *marching_cubes_with(enum marching_cubes_code code, const struct mask *mask,
                                           const struct surface_options *options, struct error *err);

struct marching_rows;
/* Writes the points of the vertices owned by rows from..end, and the links made by the cells they own
 * (marching_graph.c). */
void marching_graph_write(enum marching_cubes_code code, const struct marching_rows *grid, struct marching_graph *graph,
                          size_t from, size_t end);
