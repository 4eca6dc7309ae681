#pragma once
/* Makes the control points of splines from the outlines of a region. */
#include "core/region/mask.h"
#include "core/surface/shape.h"

enum { NURBS_MIN_BINS = 8, NURBS_MAX_BINS = 360 };

/* Control points of one closed piece, or of one hole. */
struct nurbs_net {
    struct vec3 *points; /* [n_rows][n_around] patient LPS, mm; allocated with the other nets */
    size_t n_around, n_rows;
};

struct nurbs_nets {
    struct nurbs_net *nets;
    size_t n_nets;
    struct vec3 *store;
};

/* Makes the nets of a region. Rows are on the slices across the index axis nearest patient S, in ascending index;
 * around, they run like outlines, with the inside to the left. Below the first row and above the last one the row is
 * repeated half a slice further out, where the univels end: so a piece of one slice has a thickness too.
 *
 * The outlines run between inside and outside pixels, with pixels that touch at a corner connected: the border of the
 * region itself, not the centres of its border pixels.
 *
 *   traces       Every piece and every hole is a net of its own, stacked by nurbs_pieces_link. Points are evenly spaced
 *                in mm along the outline: as many as the net's longest outline has, at least 8 and at most `bins`.
 *                Each row begins where it is closest to the row below. Where a piece divides, its largest part
 *                continues; the others begin there as pieces of their own.
 *   degree bins  In each of `bins` equal angles the outline point farthest from the middle (the centre of the outlined
 *                area); in an angle without a point, the crossing of the outline with its central ray. The region must
 *                be one piece without a hole on each of its slices, no slice may be missing in between, and its outline
 *                must go once around the middle of each slice, never back by more than NURBS_MAX_BACK_DEG or one bin.
 *   errors       ERROR_RANGE bins; ERROR_UNSUPPORTED degree bins cannot show the region: which slice, and why;
 *                ERROR_LIMIT; ERROR_MEMORY
 *   thread       any */
#define NURBS_MAX_BACK_DEG 15.0
NODISCARD bool nurbs_nets_make(const struct mask *mask, enum nurbs_sampling sampling, int bins, int n_threads,
                               struct nurbs_nets *nets, struct error *err);
void nurbs_nets_finish(struct nurbs_nets *nets);
