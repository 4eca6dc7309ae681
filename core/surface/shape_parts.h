#pragma once
/* Inside shape_make: one function per representation, each in a file of its own. All take a mask with at least one
 * inside voxel, treat everything beyond the grid as outside, give equal bytes for any n_threads (1..64), and fail with
 * ERROR_LIMIT or ERROR_MEMORY. */
#include "core/region/mask.h"
#include "core/surface/shape.h"

enum { SHAPE_MAX_THREADS = 64 };

/* Direction to the light of solid points: the patient's left, front and above. */
#define SHAPE_LIGHT_LPS vec3(0.4, -0.7, 0.6)
#define SHAPE_LIGHT_AMBIENT 0.25

NODISCARD struct line_set *shape_outline(const struct mask *mask, enum outline_method method, int n_threads,
                                         struct error *err);

NODISCARD struct point_set *shape_points(const struct mask *mask, int n_threads, struct error *err);

NODISCARD struct mesh *shape_univels(const struct mask *mask, int n_threads, struct error *err);

/* The neighbour fan. Vertices are the centres of border voxels. Each voxel takes those of its 26 neighbours that are
 * border voxels too, sorted by angle around its outward normal (if that is 0, around the index axis along which it has
 * the fewest neighbours), and makes a triangle with every two consecutive ones that are neighbours of each other. A
 * triangle of several fans is kept once. It winds to face the direction of its three corners' outward normals together;
 * the thesis could not tell that from the sequence of neighbours. Not a closed surface: fans of neighbours cross each
 * other, and a line of voxels or a single one has no triangle. */
NODISCARD struct mesh *shape_fan(const struct mask *mask, int n_threads, struct error *err);

/* A spline surface of order 2, 3 or 4 (linear, quadratic, cubic) for each net of nurbs_nets.h, as a mesh: triangles
 * between points of the surface, up to 4 steps per control point, fewer if the whole would have more than
 * NURBS_FINE_TRIANGLES. The ends are closed flat. A net with fewer rows than the order has, along it, its number of
 * rows as order. A piece is closed and winds outward; around a hole the surface winds into the hole. Splines of order 3
 * and 4 leave their control points: to the inner side where the outline is convex, the more so the farther apart the
 * points are; one-pixel spikes and corners disappear.
 *
 *   errors  ERROR_RANGE order or bins; ERROR_UNSUPPORTED see nurbs_nets.h */
enum { NURBS_FINE_TRIANGLES = 1000000 };
NODISCARD struct mesh *shape_nurbs(const struct mask *mask, const struct shape_key *key, int n_threads,
                                   struct error *err);
