#pragma once
/* Outlines of a mask on the slices of its grid: closed lines around its pieces and along its holes. Knows nothing of
 * regions, picture planes or GL.
 *
 * The lines follow the sides of border pixels (pixels with a 4-neighbour outside; everything beyond the grid is
 * outside) with the inside to the left. Every side has exactly one successor and one predecessor, so each line closes:
 * a spike one pixel wide is followed out and back, a single pixel once around, and every piece and every hole has a
 * line of its own. No marks and no recovery stack are needed.
 *
 *   OUTLINE_TRACED            through the centres of border pixels, from one to the next of its 8 neighbours; pixels
 *                             that touch at a corner are connected. Each border pixel is one point, however often lines
 *                             pass it; a single pixel is a line of one point.
 *   OUTLINE_MARCHING_SQUARES  through the midpoints of the sides between inside and outside, half a pixel further out;
 *                             pixels that touch at a corner are separated, as marching cubes does on the faces of its
 *                             cells. Each point is on one line, once. */
#include "core/region/mask.h"

enum outline_method { OUTLINE_TRACED, OUTLINE_MARCHING_SQUARES };

#define OUTLINE_MAX_POINTS ((uint64_t)1 << 26) /* points of all lines together, repeated ones counted */

struct outline_set {
    float *points_ijk; /* [n_points][3], no point twice: index coordinates of the mask's grid */
    uint32_t *walk; /* [n_walk] indices of points, line after line; a line is closed, its first point is not repeated at
                       the end */
    uint32_t *line; /* [n_lines + 1] start of each line in walk; lines of slice 0 first */
    uint32_t *slice; /* [n_slices + 1] first line of each slice */
    size_t n_points, n_walk, n_lines, n_slices;
};

/* Outlines of all slices across an index axis (0, 1, 2). An empty mask has no lines, and that is no error.
 *
 *   returns  lines run counter-clockwise around the inside, clockwise around holes, with the two other axes in
 *            ascending order drawn to the right and up; the caller's; equal for any n_threads
 *   errors   ERROR_RANGE axis; ERROR_LIMIT more than OUTLINE_MAX_POINTS; ERROR_MEMORY
 *   thread   any */
NODISCARD struct outline_set *outline_stack(const struct mask *mask, int axis, enum outline_method method,
                                            int n_threads, struct error *err);
/* The two choices behind a method, separately: the splines of core/surface/nurbs_nets.c combine them differently. */
struct outline_rule {
    bool is_joined;  /* pixels that touch at a corner are connected */
    bool is_between; /* points are midpoints of sides instead of centres of pixels */
};

/* Same as outline_stack, by rule. */
NODISCARD struct outline_set *outline_walk(const struct mask *mask, int axis, struct outline_rule rule, int n_threads,
                                           struct error *err);
/* Outlines of one slice. Errors: as outline_stack, and ERROR_RANGE index. */
NODISCARD struct outline_set *outline_slice(const struct mask *mask, int axis, uint32_t index,
                                            enum outline_method method, struct error *err);
void outline_set_destroy(struct outline_set *set);

/* Cuts a mask by a plane into a mask of one slice, whose outlines are then on the plane: for a slice pane whose plane
 * is not one of the grid's own (oblique). Each pixel takes the voxel that contains its centre; pixels outside the grid
 * are outside.
 *
 *   lps_mm_from_pixel  columns[0] and columns[1] span the plane; columns[2] crosses it, with any length but 0
 *   errors             ERROR_RANGE a side of 0 or over VOLUME_MAX_SIDE, a singular map; ERROR_MEMORY */
NODISCARD struct mask *mask_cut(const struct mask *mask, const struct affine *lps_mm_from_pixel, const uint32_t size[2],
                                struct error *err);
