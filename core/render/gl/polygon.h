#pragma once
/* Convex polygons in planes, cut on the processor before OpenGL draws them. */
#include "core/render/visible/draw.h"

/* A rectangle has four corners; each cut adds at most one: six faces of a grid, all clip planes. */
enum { GL_POLYGON_CORNERS = 4 + 6 + CLIP_MAX };

struct gl_polygon {
    int n; /* < 3: nothing is left */
    struct vec3 lps_mm[GL_POLYGON_CORNERS];
};

/* The rectangle of the plane within reach. */
struct gl_polygon gl_polygon_of_reach(const struct plane *plane, const struct plane_reach *reach);
/* Keeps the part where inside, given at the corners, is 0 or more. */
void gl_polygon_keep(struct gl_polygon *polygon, const double inside[GL_POLYGON_CORNERS]);
/* Cuts off what lies above a clip plane of the set. */
void gl_polygon_clip(struct gl_polygon *polygon, const struct clip_set *clip);
/* The polygon in which a plane cuts a grid's outer faces, as far as no clip plane cuts it off; n < 3: nothing is left.
 */
struct gl_polygon gl_slice_polygon(const struct grid *grid, const struct plane *plane, const struct clip_set *clip);
