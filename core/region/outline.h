#pragma once
/* Outlines of a mask on the slices of its grid: closed lines around its pieces and along its holes. Knows nothing of
 * regions, planes of a picture or GL.
 *
 * The way round walks from side to side of the border pixels (those with a 4-neighbour outside; what lies beyond the
 * grid is outside), with the inside always to the left. Each side has one side after it and one before it, so the walk
 * cannot help coming home: a spike one pixel wide is walked out and back, a lone pixel once around, and every piece and
 * every hole has its own line, without marks to stumble over and a stack to recover with.
 *
 *   OUTLINE_TRACED            through the centres of border pixels, from one to the next of its 8 neighbours; pixels
 * that touch at a corner belong together. Each border pixel is one point, however often lines come by; one pixel alone
 * is a line of one point. OUTLINE_MARCHING_SQUARES  through the middles of the sides between inside and outside, half a
 * pixel further out; pixels that touch at a corner are cut apart, as marching cubes does on the faces of its cells.
 * Each point is on one line, once. */
#include "core/region/mask.h"

enum outline_method { OUTLINE_TRACED, OUTLINE_MARCHING_SQUARES };

#define OUTLINE_MAX_POINTS ((uint64_t)1 << 26) /* of all lines together, walked */

struct outline_set {
    float *points_ijk; /* [n_points][3], each once: index coordinates of the mask's grid */
    uint32_t *walk;  /* [n_walk] numbers of points; after the last of a line comes its first again, not repeated here */
    uint32_t *line;  /* [n_lines + 1] where in walk each line begins; those of slice 0 first */
    uint32_t *slice; /* [n_slices + 1] which line each slice begins with */
    size_t n_points, n_walk, n_lines, n_slices;
};

/* All slices across an index axis (0, 1, 2). A mask without a voxel has no line, and that is no error.
 *   returns  lines run counter-clockwise around the inside as seen with the two other axes, in ascending order, to the
 * right and up; clockwise around holes. Equal for any n_threads. errors   ERROR_RANGE axis, ERROR_LIMIT more than
 * OUTLINE_MAX_POINTS, ERROR_MEMORY */
NODISCARD struct outline_set *outline_stack(const struct mask *mask, int axis, enum outline_method method,
                                            int n_threads, struct error *err);
/* The two choices that a method makes, each on its own: splines (core/surface/nurbs_shape.c) combine them anew. */
struct outline_rule {
    bool is_joined;  /* pixels that touch at a corner belong together */
    bool is_between; /* points are the middles of sides, not the centres of pixels */
};

/* As outline_stack. */
NODISCARD struct outline_set *outline_walk(const struct mask *mask, int axis, struct outline_rule rule, int n_threads,
                                           struct error *err);
/* One slice of them. errors as above, ERROR_RANGE index */
NODISCARD struct outline_set *outline_slice(const struct mask *mask, int axis, uint32_t index,
                                            enum outline_method method, struct error *err);
void outline_set_destroy(struct outline_set *set);

/* A cut through a mask as a mask of one slice, whose outlines then lie on the plane: what a slice pane needs where the
 * plane is not one of the grid's own, as on an oblique grid. Each pixel carries the voxel that holds its centre;
 * outside the grid nothing. lps_mm_from_pixel  columns[0] and columns[1] span the plane; columns[2] is across it, any
 * length but 0 errors             ERROR_RANGE a side of 0 or more than VOLUME_MAX_SIDE, a singular map; ERROR_MEMORY */
NODISCARD struct mask *mask_cut(const struct mask *mask, const struct affine *lps_mm_from_pixel, const uint32_t size[2],
                                struct error *err);
