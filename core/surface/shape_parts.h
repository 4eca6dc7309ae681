#pragma once
/* Inside of shape_make: what it is put together from, one function a file. All take a mask with at least one voxel
 * inside, with what lies beyond the grid outside, give equal bytes for any n_threads (1..64), and fail with ERROR_LIMIT
 * or ERROR_MEMORY. */
#include "core/region/mask.h"
#include "core/surface/shape.h"

enum { SHAPE_MAX_THREADS = 64 };

/* Where the light of solid points comes from: the patient's left, front and above. */
#define SHAPE_LIGHT_LPS vec3(0.4, -0.7, 0.6)
#define SHAPE_LIGHT_AMBIENT 0.25

NODISCARD struct line_set *shape_outline(const struct mask *mask, enum outline_method method, int n_threads,
                                         struct error *err);

NODISCARD struct point_set *shape_points(const struct mask *mask, int n_threads, struct error *err);

NODISCARD struct mesh *shape_univels(const struct mask *mask, int n_threads, struct error *err);

/* The neighbour fan: vertices are the centres of border voxels. Each takes those of its 26 neighbours that are border
 * voxels too, in the order in which they lie around its outward normal (where that is 0, around the index axis along
 * which it has the fewest neighbours), and makes a triangle with each two that follow one another and are neighbours of
 * each other. A triangle that several fans have is there once. It winds so that it faces the way that the outward
 * normals of its three corners do together: what the thesis could not tell from the order of the neighbours. No closed
 * surface: fans of neighbours cross each other, and along a line of voxels or around a lone one there is no triangle.
 */
NODISCARD struct mesh *shape_fan(const struct mask *mask, int n_threads, struct error *err);

/* A spline surface of order 2, 3 or 4 (linear, quadratic, cubic) for each net of nurbs_nets.h, as a mesh: triangles
 * between points of the surface, up to 4 from one control point to the next, fewer where the whole would have more than
 * NURBS_FINE_TRIANGLES. The ends are closed flat. Along a net with fewer rows than the order, the order is its number
 * of rows. A piece is closed and winds outward; around a hole it winds into the hole. Splines of order 3 and 4 leave
 * their control points: on the inner side where the outline bulges, the more so the farther the points lie apart, and
 * one-pixel spikes and corners go. errors ERROR_RANGE order or bins, ERROR_UNSUPPORTED see nurbs_nets.h */
enum { NURBS_FINE_TRIANGLES = 1000000 };
NODISCARD struct mesh *shape_nurbs(const struct mask *mask, const struct shape_key *key, int n_threads,
                                   struct error *err);
