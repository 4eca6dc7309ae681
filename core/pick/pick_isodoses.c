/* Intersects a ray with the triangles of isodose surfaces. */
#include "core/pick/pick_isodoses.h"

#include <math.h>

static struct vec3 vertex(const struct mesh *mesh, uint32_t index)
{
    const float *p = mesh->positions_lps_mm + 3 * (size_t)index;
    return vec3((double)p[0], (double)p[1], (double)p[2]);
}

/* Distance along the ray to a triangle; infinity: it misses. Both sides count. Source: T. Moeller, B. Trumbore, Fast,
 * Minimum Storage Ray-Triangle Intersection, J. Graphics Tools 2(1), 1997. */
static double triangle_mm(const struct mesh *mesh, const uint32_t corners[3], struct vec3 origin, struct vec3 direction)
{
    struct vec3 a = vertex(mesh, corners[0]);
    struct vec3 u = vec3_sub(vertex(mesh, corners[1]), a), v = vec3_sub(vertex(mesh, corners[2]), a);
    struct vec3 across = vec3_cross(direction, v);
    double determinant = vec3_dot(u, across);
    if (determinant == 0)
        return INFINITY;
    struct vec3 from = vec3_sub(origin, a), turned = vec3_cross(from, u);
    double s = vec3_dot(from, across) / determinant, t = vec3_dot(direction, turned) / determinant;
    return s >= 0 && t >= 0 && s + t <= 1 ? vec3_dot(v, turned) / determinant : INFINITY;
}

/* True if the ray meets the box. */
static bool meets_box(const struct box3 *box, struct vec3 origin, struct vec3 direction)
{
    const double o[3] = { origin.x, origin.y, origin.z }, d[3] = { direction.x, direction.y, direction.z },
                 low[3] = { box->low.x, box->low.y, box->low.z }, high[3] = { box->high.x, box->high.y, box->high.z };
    const double slack_mm = 1e-3;
    double from = 0, to = INFINITY;
    for (int axis = 0; axis < 3; axis++) {
        double a = (low[axis] - slack_mm - o[axis]) / d[axis], b = (high[axis] + slack_mm - o[axis]) / d[axis];
        if (d[axis] == 0 && (o[axis] < low[axis] - slack_mm || o[axis] > high[axis] + slack_mm))
            return false;
        if (d[axis] == 0)
            continue;
        from = fmax(from, fmin(a, b));
        to = fmin(to, fmax(a, b));
    }
    return from <= to;
}

static double surface_mm(const struct shape *shape, const struct clip_range *range, struct vec3 origin,
                         struct vec3 direction)
{
    const struct mesh *mesh = shape->mesh;
    double nearest = INFINITY;
    if (mesh->n_triangles == 0 || !meets_box(&shape->bounds_lps_mm, origin, direction))
        return INFINITY;
    for (size_t t = 0; t < mesh->n_triangles; t++) {
        double mm = triangle_mm(mesh, mesh->indices + 3 * t, origin, direction);
        if (mm >= range->from_mm && mm <= range->to_mm && mm < nearest)
            nearest = mm;
    }
    return nearest;
}

size_t pick_isodoses(const struct snapshot *snapshot, struct vec3 origin_lps_mm, struct vec3 direction,
                     struct pick_isodose_hit hits[ISODOSES_MAX])
{
    struct isodose isodoses[ISODOSES_MAX];
    struct dose_scale scale;
    size_t n_hits = 0;
    if (!isodoses_are_shown(snapshot) || !dose_scale_of(snapshot, &scale))
        return 0;
    bool is_clipped = snapshot->scene.dose.surfaces.clipped;
    struct clip_range range = clip_ray(snapshot->clips, is_clipped ? snapshot->n_clips : 0, origin_lps_mm, direction);
    size_t n = isodoses_shown(snapshot, &scale, isodoses);
    for (size_t i = 0; i < n; i++) {
        struct error why;
        struct isodose_shape *made = isodose_shape_get(snapshot->derived, &isodoses[i].choice, SURFACE_FULL, &why);
        double t_mm = made ? surface_mm(made->shape, &range, origin_lps_mm, direction) : INFINITY;
        if (made)
            derive_result_unref(&made->base);
        if (isfinite(t_mm))
            hits[n_hits++] = (struct pick_isodose_hit){ t_mm, isodoses[i].subject, isodoses[i].opacity };
    }
    dose_scale_finish(&scale);
    return n_hits;
}
