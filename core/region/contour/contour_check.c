/* Area of the contours of one plane: shoelace formula, with the sign of the nesting depth. */
#include "core/region/contour/contour_check.h"

#include <stdlib.h>

#include "core/base/mem.h"

enum { SAMPLES = 16 };

struct polygon {
    const struct contour *contour;
    double low[2], high[2], mm2;
};

/* Two unit vectors that span the plane. */
struct axes {
    struct vec3 a, b;
};

static struct axes axes_across(struct vec3 normal)
{
    struct vec3 other = fabs(normal.x) < 0.6 ? vec3(1, 0, 0) : vec3(0, 1, 0);
    struct axes axes;
    axes.a = vec3_normalize(vec3_cross(normal, other));
    axes.b = vec3_cross(normal, axes.a);
    return axes;
}

static void point_at(const struct contour *contour, size_t i, const struct axes *axes, double ab[2])
{
    const double *p = contour->points_lps_mm + 3 * i;
    struct vec3 point = vec3(p[0], p[1], p[2]);
    ab[0] = vec3_dot(axes->a, point);
    ab[1] = vec3_dot(axes->b, point);
}

static struct polygon polygon_of(const struct contour *contour, const struct axes *axes)
{
    struct polygon polygon = { contour, { INFINITY, INFINITY }, { -INFINITY, -INFINITY }, 0 };
    double first[2], last[2], to[2], twice = 0;
    point_at(contour, 0, axes, first);
    last[0] = last[1] = 0; /* relative to the first point, to keep digits */
    for (size_t i = 0; i < contour->n_points; i++) {
        point_at(contour, i, axes, to);
        for (int k = 0; k < 2; k++) {
            polygon.low[k] = fmin(polygon.low[k], to[k]);
            polygon.high[k] = fmax(polygon.high[k], to[k]);
            to[k] -= first[k];
        }
        twice += last[0] * to[1] - last[1] * to[0];
        last[0] = to[0];
        last[1] = to[1];
    }
    polygon.mm2 = fabs(twice) / 2;
    return polygon;
}

static bool has_point(const struct polygon *polygon, const struct axes *axes, const double at[2])
{
    const struct contour *contour = polygon->contour;
    double from[2], to[2];
    int turns = 0;
    point_at(contour, contour->n_points - 1, axes, from);
    for (size_t i = 0; i < contour->n_points; i++) {
        point_at(contour, i, axes, to);
        double side = (to[0] - from[0]) * (at[1] - from[1]) - (at[0] - from[0]) * (to[1] - from[1]);
        turns += from[1] <= at[1] && to[1] > at[1] && side > 0;
        turns -= from[1] > at[1] && to[1] <= at[1] && side < 0;
        from[0] = to[0];
        from[1] = to[1];
    }
    return turns != 0;
}

static bool is_inside(const struct polygon *inner, const struct polygon *outer, const struct axes *axes,
                      uint64_t *n_steps)
{
    ++*n_steps;
    if (inner->mm2 >= outer->mm2 || inner->low[0] > outer->high[0] || inner->high[0] < outer->low[0] ||
        inner->low[1] > outer->high[1] || inner->high[1] < outer->low[1])
        return false;
    size_t n = inner->contour->n_points, n_samples = n < SAMPLES ? n : SAMPLES, n_inside = 0;
    for (size_t i = 0; i < n_samples; i++) {
        double at[2];
        point_at(inner->contour, i * n / n_samples, axes, at);
        n_inside += has_point(outer, axes, at);
    }
    *n_steps += n_samples * outer->contour->n_points;
    return 2 * n_inside > n_samples;
}

double contour_outlines_mm2(const struct contour *const *contours, size_t n, struct vec3 normal_lps, uint64_t *n_steps)
{
    struct axes axes = axes_across(normal_lps);
    struct polygon *polygons = mem_array(n, sizeof *polygons, UINT64_MAX, NULL);
    if (!polygons)
        return NAN;
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        polygons[i] = polygon_of(contours[i], &axes);
    for (size_t i = 0; i < n && *n_steps <= CONTOUR_MAX_CHECKED; i++) {
        size_t depth = 0;
        for (size_t k = 0; k < n && *n_steps <= CONTOUR_MAX_CHECKED; k++)
            depth += k != i && is_inside(&polygons[i], &polygons[k], &axes, n_steps);
        sum += depth % 2 == 1 ? -polygons[i].mm2 : polygons[i].mm2;
    }
    free(polygons);
    return *n_steps <= CONTOUR_MAX_CHECKED ? sum : NAN;
}
