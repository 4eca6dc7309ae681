#pragma once
/* Contours for tests, and a slow independent test of what they enclose. */
#include "core/region/contour/contour.h"

/* Adds a contour of n points; xy has pairs, z is the third coordinate of all. */
void contours_add(struct contour_set *set, const double *xy, size_t n, double z);
void contours_add_points(struct contour_set *set, const double *xyz, size_t n);
void contours_add_box(struct contour_set *set, double x0, double y0, double x1, double y1, double z);
/* Adds a regular polygon on a circle; its area is n / 2 r^2 sin(2 pi / n). */
void contours_add_circle(struct contour_set *set, double x, double y, double r, size_t n, double z);
double circle_mm2(double r, size_t n);
/* Maps every point. */
void contours_move(struct contour_set *set, const struct affine *map);
struct affine rotation_of(double a, double b, double c); /* about z, then y, then x, in radians */

struct grid grid_make(uint32_t nx, uint32_t ny, uint32_t nz, double dx, double dy, double dz, struct vec3 origin);
/* Calls contour_fill with the defaults; fails the test if it fails. */
struct mask *contours_fill(const struct contour_set *set, const struct grid *grid, struct contour_facts *facts);
/* Returns true if a ray in the plane from the point along u crosses the contours an odd number of times (inside).
 * Counts contours whose plane is within half_mm of the point; all of them have the given normal. */
bool contours_enclose(const struct contour_set *set, struct vec3 normal, struct vec3 u, double half_mm,
                      struct vec3 point);
