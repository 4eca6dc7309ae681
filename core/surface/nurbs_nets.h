#pragma once
/* From the outlines of a region to the control points of splines. */
#include "core/region/mask.h"
#include "core/surface/shape.h"

enum { NURBS_MIN_BINS = 8, NURBS_MAX_BINS = 360 };

/* Control points of one closed piece, or of a hole in one. */
struct nurbs_net {
    struct vec3 *points; /* [n_rows][n_around] LPS mm; in the nets' common store */
    size_t n_around, n_rows;
};

struct nurbs_nets {
    struct nurbs_net *nets;
    size_t n_nets;
    struct vec3 *store;
};

/* Rows lie on the slices across the index axis nearest patient S, in the direction of the index; around, they run as
 * outlines do: with the inside to the left. Below the first row and above the last it stands once more, half a slice
 * further out, where the univels end: so a piece of one slice has a thickness too.
 *
 * Outlines are those between inside and outside pixels, with pixels that touch at a corner together: the region's
 * border itself rather than the centres of its border pixels.
 *
 *   traces       Every piece and every hole is a net of its own, stacked by nurbs_pieces_link. Points are evenly spaced
 * along the outline in mm, `bins` of them or as many as the net's longest outline has, at least 8; each row begins
 * where it lies closest to the row below. Where a piece divides, the largest part goes on; the others begin there as
 * pieces of their own. degree bins  The point farthest from the middle (the centre of the outlined area) in each of
 * `bins` equal angles; where a bin has none, where the outline crosses the middle of the bin. The region must be one
 * piece without a hole on each of its slices, without a slice missing between two, and its outline must go once around
 * the middle of each slice, never back by more than NURBS_MAX_BACK_DEG or a bin.
 *
 *   errors  ERROR_RANGE bins, ERROR_UNSUPPORTED degree bins cannot show the region: which slice, and why; ERROR_LIMIT,
 * ERROR_MEMORY */
#define NURBS_MAX_BACK_DEG 15.0
NODISCARD bool nurbs_nets_make(const struct mask *mask, enum nurbs_sampling sampling, int bins, int n_threads,
                               struct nurbs_nets *nets, struct error *err);
void nurbs_nets_finish(struct nurbs_nets *nets);
