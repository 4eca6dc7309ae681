/* Builds contour sets for tests, and decides by ray casting whether a point is enclosed. */
#include "tests/unit/made_contours.h"

#include "tests/check.h"

void contours_add_points(struct contour_set *set, const double *xyz, size_t n)
{
    set->contours = realloc(set->contours, (set->n_contours + 1) * sizeof *set->contours);
    assert_non_null(set->contours);
    struct contour *contour = &set->contours[set->n_contours++];
    *contour = (struct contour){ .points_lps_mm = malloc(n * 3 * sizeof(double) + 1), .n_points = n };
    assert_non_null(contour->points_lps_mm);
    memcpy(contour->points_lps_mm, xyz, n * 3 * sizeof(double));
}

void contours_add(struct contour_set *set, const double *xy, size_t n, double z)
{
    double *xyz = malloc(n * 3 * sizeof *xyz + 1);
    assert_non_null(xyz);
    for (size_t i = 0; i < n; i++) {
        xyz[3 * i] = xy[2 * i];
        xyz[3 * i + 1] = xy[2 * i + 1];
        xyz[3 * i + 2] = z;
    }
    contours_add_points(set, xyz, n);
    free(xyz);
}

void contours_add_box(struct contour_set *set, double x0, double y0, double x1, double y1, double z)
{
    contours_add(set, (double[]){ x0, y0, x1, y0, x1, y1, x0, y1 }, 4, z);
}

void contours_add_circle(struct contour_set *set, double x, double y, double r, size_t n, double z)
{
    double *xy = malloc(2 * n * sizeof *xy);
    assert_non_null(xy);
    for (size_t i = 0; i < n; i++) {
        double turn = 2 * MATH_PI * (double)i / (double)n;
        xy[2 * i] = x + r * cos(turn);
        xy[2 * i + 1] = y + r * sin(turn);
    }
    contours_add(set, xy, n, z);
    free(xy);
}

double circle_mm2(double r, size_t n)
{
    return (double)n / 2 * r * r * sin(2 * MATH_PI / (double)n);
}

void contours_move(struct contour_set *set, const struct affine *map)
{
    for (size_t c = 0; c < set->n_contours; c++)
        for (size_t i = 0; i < set->contours[c].n_points; i++) {
            double *p = set->contours[c].points_lps_mm + 3 * i;
            struct vec3 to = affine_point(map, vec3(p[0], p[1], p[2]));
            p[0] = to.x;
            p[1] = to.y;
            p[2] = to.z;
        }
}

struct affine rotation_of(double a, double b, double c)
{
    struct affine z = { { { cos(a), sin(a), 0 }, { -sin(a), cos(a), 0 }, { 0, 0, 1 } }, { 0, 0, 0 } };
    struct affine y = { { { cos(b), 0, -sin(b) }, { 0, 1, 0 }, { sin(b), 0, cos(b) } }, { 0, 0, 0 } };
    struct affine x = { { { 1, 0, 0 }, { 0, cos(c), sin(c) }, { 0, -sin(c), cos(c) } }, { 0, 0, 0 } };
    struct affine yz = affine_compose(&y, &z);
    return affine_compose(&x, &yz);
}

struct grid grid_make(uint32_t nx, uint32_t ny, uint32_t nz, double dx, double dy, double dz, struct vec3 origin)
{
    struct grid grid;
    struct affine map = { { { dx, 0, 0 }, { 0, dy, 0 }, { 0, 0, dz } }, origin };
    struct error err = { 0 };
    if (!grid_init(&grid, (uint32_t[3]){ nx, ny, nz }, &map, &err))
        fail_msg("%s", err.text);
    return grid;
}

struct mask *contours_fill(const struct contour_set *set, const struct grid *grid, struct contour_facts *facts)
{
    struct error err = { 0 };
    struct mask *mask = contour_fill(set, grid, &contour_defaults, facts, &err);
    if (!mask)
        fail_msg("%s", err.text);
    return mask;
}

bool contours_enclose(const struct contour_set *set, struct vec3 normal, struct vec3 u, double half_mm,
                      struct vec3 point)
{
    struct vec3 v = vec3_cross(normal, u);
    bool is_inside = false;
    for (size_t c = 0; c < set->n_contours; c++) {
        const struct contour *contour = &set->contours[c];
        const double *p = contour->points_lps_mm;
        double d = vec3_dot(normal, vec3_sub(point, vec3(p[0], p[1], p[2])));
        if (d < -half_mm || d >= half_mm)
            continue;
        for (size_t i = 0; i < contour->n_points; i++) {
            const double *a = p + 3 * i, *b = p + 3 * ((i + 1) % contour->n_points);
            struct vec3 to_a = vec3_sub(vec3(a[0], a[1], a[2]), point), to_b = vec3_sub(vec3(b[0], b[1], b[2]), point);
            double va = vec3_dot(v, to_a), vb = vec3_dot(v, to_b);
            if ((va > 0) == (vb > 0))
                continue;
            double ua = vec3_dot(u, to_a), ub = vec3_dot(u, to_b);
            is_inside ^= ua + (ub - ua) * va / (va - vb) > 0;
        }
    }
    return is_inside;
}
