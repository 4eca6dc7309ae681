#pragma once
/* Where a plane cuts regions, their surfaces and grids: the lines that slice panes draw over the image. Knows no scene
 * and no pixels. */
#include "core/region/outline.h"
#include "core/scene/plane.h"
#include "core/surface/mesh_slabs.h"

/* Line segments in the plane, in patient space. */
struct cut_lines {
    double (*ends_lps_mm)[2][3];
    size_t n, capacity;
};
void cut_lines_finish(struct cut_lines *lines);
NODISCARD bool cut_lines_add(struct cut_lines *lines, struct vec3 a, struct vec3 b, struct error *err);

/* A region's univels, with those of its descendants on the same grid. */
struct cut_region {
    const struct grid *grid;   /* of the region's label layer */
    struct box3 bounds_lps_mm; /* of all these univels */
    struct {
        const struct volume *layer;
        uint8_t *is_inside; /* [65536] by label */
    } * parts;
    size_t n_parts;
};
NODISCARD bool cut_region_init(struct cut_region *cut, const struct region_set *set, size_t region, struct error *err);
void cut_region_finish(struct cut_region *cut);
bool cut_region_holds(const struct cut_region *cut, struct vec3 point_lps_mm);

/* The pixels of the plane that hold univels, as a mask of one slice. If the plane is one of the grid's own slices, its
 * pixels are the grid's voxels. Else they lie along the plane's axes, are as large as the grid's smallest spacing, and
 * carry the voxel at their centre. *mask NULL: the plane misses the region. errors ERROR_MEMORY, ERROR_LIMIT */
NODISCARD bool cut_univels(const struct cut_region *cut, const struct plane *plane, struct mask **mask,
                           struct error *err);
/* Adds the outlines of a slice; a single pixel becomes a small diamond. errors those of outline_slice */
NODISCARD bool cut_outlines(const struct mask *slice, enum outline_method method, struct cut_lines *lines,
                            struct error *err);
/* Adds the sides of pixels between inside and outside. errors ERROR_MEMORY */
NODISCARD bool cut_borders(const struct mask *slice, struct cut_lines *lines, struct error *err);
/* How far along the edge from a point below a plane to one above it the plane lies, 0 .. 1, from their positions along
 * its normal. Whoever cuts an edge does it from below to above with this share, so that all get the same point. */
static inline double cut_share(double below_mm, double above_mm, double position_mm)
{
    return (position_mm - below_mm) / (above_mm - below_mm);
}
static inline struct vec3 cut_between(struct vec3 below, struct vec3 above, double share)
{
    return vec3_add(below, vec3_scale(vec3_sub(above, below), share));
}
/* A plane in single precision, as meshes are cut: a vertex is above it where cut_position(p, normal) >= position. */
struct cut_plane {
    float normal[3], position;
};
struct cut_plane cut_plane(const struct plane *plane);
static inline float cut_position(float x, float y, float z, const float normal[3])
{
    return normal[0] * x + normal[1] * y + normal[2] * z;
}
/* The patient axis that a plane is square to: 0 L, 1 P, 2 S; -1: the plane is oblique. */
int cut_axis(const struct plane *plane);
/* Adds the segments where the plane cuts the mesh's triangles: closed outlines if the mesh is closed. A vertex on the
 * plane counts as above it. Single precision, as the mesh has. slabs: the mesh's along cut_axis, or NULL: every
 * triangle is looked at. errors ERROR_MEMORY */
NODISCARD bool cut_mesh(const struct mesh *mesh, const struct mesh_slabs *slabs, const struct plane *plane,
                        struct cut_lines *lines, struct error *err);
/* Adds the segments where the plane cuts the outer faces of a grid. errors ERROR_MEMORY */
NODISCARD bool cut_grid(const struct grid *grid, const struct plane *plane, struct cut_lines *lines, struct error *err);
/* The corners of a grid's outer faces; bit 0, 1, 2 of the number: high along i, j, k. */
void cut_grid_corners(const struct grid *grid, struct vec3 corners_lps_mm[8]);
