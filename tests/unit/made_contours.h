#pragma once
/* Contours for tests, and the slow way to say what they enclose. */
#include "core/region/contour.h"

/* Adds a copy of n points; xy are pairs, z the third coordinate of all. */
void contours_add(struct contour_set *set, const double *xy, size_t n, double z);
void contours_add_points(struct contour_set *set, const double *xyz, size_t n);
void contours_add_box(struct contour_set *set, double x0, double y0, double x1, double y1, double z);
/* A regular polygon on a circle; its area is n / 2 r^2 sin(2 pi / n). */
void contours_add_circle(struct contour_set *set, double x, double y, double r, size_t n, double z);
double circle_mm2(double r, size_t n);
/* Every point through a map. */
void contours_move(struct contour_set *set, const struct affine *map);
struct affine rotation_of(double a, double b, double c); /* about z, then y, then x, in radians */

struct grid grid_make(uint32_t nx, uint32_t ny, uint32_t nz, double dx, double dy, double dz, struct vec3 origin);
/* contour_fill with the defaults; fails the test when it fails. */
struct mask *contours_fill(const struct contour_set *set, const struct grid *grid, struct contour_facts *facts);
/* How many times a ray within the plane from the point meets edges of contours whose plane is within half_mm of it,
 * along the direction u: odd is inside. All contours have the normal given. */
bool contours_enclose(const struct contour_set *set, struct vec3 normal, struct vec3 u, double half_mm,
                      struct vec3 point);
