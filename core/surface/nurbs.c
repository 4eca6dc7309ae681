/* Evaluates B-spline basis functions and points of a tube. */
#include "core/surface/nurbs.h"

#include <assert.h>

void nurbs_basis(const double *knots, size_t span, int order, double t, double values[NURBS_MAX_ORDER])
{
    /* from order 1, whose function is 1 on its span, upwards: a function of order n is a blend of two of order n - 1 */
    double before[NURBS_MAX_ORDER], after[NURBS_MAX_ORDER]; /* t - knot, knot - t */
    values[0] = 1;
    for (int k = 1; k < order; k++) {
        double carried = 0;
        before[k] = t - knots[span + 1 - (size_t)k];
        after[k] = knots[span + (size_t)k] - t;
        for (int r = 0; r < k; r++) {
            double share = values[r] / (after[r + 1] + before[k - r]);
            values[r] = carried + after[r + 1] * share;
            carried = before[k - r] * share;
        }
        values[k] = carried;
    }
}

double nurbs_tube_v_end(const struct nurbs_tube *tube)
{
    return (double)tube->n_rows - tube->order_along + 1;
}

/* The basis functions at a parameter, and the first control point they belong to. */
struct nurbs_basis_at {
    double values[NURBS_MAX_ORDER];
    size_t first;
};

static size_t whole_part(double t, size_t end)
{
    return t >= (double)end ? end - 1 : t > 0 ? (size_t)t : 0;
}

static struct nurbs_basis_at place_around(const struct nurbs_tube *tube, double u)
{
    struct nurbs_basis_at place;
    double knots[2 * NURBS_MAX_ORDER];
    size_t span = whole_part(u, tube->n_around), order = (size_t)tube->order;
    for (size_t k = 0; k < 2 * order; k++)
        knots[k] = (double)span + (double)k - (double)(order - 1);
    nurbs_basis(knots, order - 1, tube->order, u, place.values);
    place.first = span;
    return place;
}

static struct nurbs_basis_at place_along(const struct nurbs_tube *tube, double v)
{
    struct nurbs_basis_at place;
    double knots[2 * NURBS_MAX_ORDER], v_end = nurbs_tube_v_end(tube);
    size_t span = whole_part(v, tube->n_rows - (size_t)tube->order_along + 1), order = (size_t)tube->order_along;
    for (size_t k = 0; k < 2 * order; k++) {
        double knot = (double)span + (double)k - (double)(order - 1);
        knots[k] = knot < 0 ? 0 : knot > v_end ? v_end : knot;
    }
    nurbs_basis(knots, order - 1, tube->order_along, v, place.values);
    place.first = span;
    return place;
}

struct vec3 nurbs_tube_point(const struct nurbs_tube *tube, double u, double v)
{
    assert(tube->order >= NURBS_MIN_ORDER && tube->order <= NURBS_MAX_ORDER && tube->n_around >= (size_t)tube->order);
    assert(tube->order_along >= NURBS_MIN_ORDER && tube->order_along <= NURBS_MAX_ORDER &&
           tube->n_rows >= (size_t)tube->order_along);
    struct nurbs_basis_at around = place_around(tube, u), along = place_along(tube, v);
    struct vec3 sum = vec3(0, 0, 0);
    double weight = 0;
    for (int b = 0; b < tube->order_along; b++)
        for (int a = 0; a < tube->order; a++) {
            size_t at = (along.first + (size_t)b) * tube->n_around + (around.first + (size_t)a) % tube->n_around;
            double share = around.values[a] * along.values[b] * (tube->weights ? tube->weights[at] : 1);
            sum = vec3_add(sum, vec3_scale(tube->points[at], share));
            weight += share;
        }
    return vec3_scale(sum, 1 / weight);
}
