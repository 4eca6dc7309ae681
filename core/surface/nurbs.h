#pragma once
/* Non-uniform rational B-splines (NURBS) as tubes: closed around, and open from the first to the last row of control
 * points. Knows nothing of regions or triangles.
 *
 *   thread  any; keeps nothing
 *   source  M. G. Cox, The numerical evaluation of B-splines, J. Inst. Maths Applics 10, 1972; C. de Boor, On
 *           calculating with B-splines, J. Approx. Theory 6, 1972: the recurrence. */
#include <stddef.h>

#include "core/math/vec.h"

enum { NURBS_MIN_ORDER = 2, NURBS_MAX_ORDER = 4 };

/* Computes the `order` basis functions that are not 0 at t: those of control points span - order + 1 .. span. They are
 * not negative, and their sum is 1.
 *
 *   knots  ascending; knots[span] <= t <= knots[span + 1] and knots[span] < knots[span + 1]; knots[span - order + 2] ..
 *          knots[span + order - 1] are read */
void nurbs_basis(const double *knots, size_t span, int order, double t, double values[NURBS_MAX_ORDER]);

/* Control points [n_rows][n_around]; each row is closed. */
struct nurbs_tube {
    const struct vec3 *points;
    const double *weights; /* [n_rows][n_around], positive; NULL: all 1 */
    size_t n_around;       /* at least order */
    size_t n_rows;         /* at least order_along */
    int order, order_along;
};
/* Around, the knots are the whole numbers; u runs from 0 to n_around, which is the same point. Along, the knots are 0
 * (order_along times), 1, 2, ..., v_end (order_along times), so that v = 0 is the curve of the first row alone and v =
 * v_end that of the last. */
double nurbs_tube_v_end(const struct nurbs_tube *tube); /* n_rows - order_along + 1 */
struct vec3 nurbs_tube_point(const struct nurbs_tube *tube, double u, double v);
