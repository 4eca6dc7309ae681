#pragma once
/* Where a plane cuts regions, their surfaces and grids: the lines that slice panes draw over the image. Knows no scene
 * and no pixels. */
#include "core/region/outline.h"
#include "core/scene/plane.h"
#include "core/surface/mesh.h"

/* Line segments in the plane, in patient space. */
struct cut_lines {
    double (*ends_lps_mm)[2][3];
    size_t n, capacity;
};
void cut_lines_finish(struct cut_lines *lines);

/* A region's univels, those of everything inside it among them. */
struct cut_region {
    const struct grid *grid;   /* the region's own */
    struct box3 bounds_lps_mm; /* around all of them */
    struct {
        const struct volume *layer;
        uint8_t *is_inside; /* [65536] by label */
    } * parts;
    size_t n_parts;
};
NODISCARD bool cut_region_init(struct cut_region *cut, const struct region_set *set, size_t region, struct error *err);
void cut_region_finish(struct cut_region *cut);
bool cut_region_holds(const struct cut_region *cut, struct vec3 point_lps_mm);

/* The pixels on the plane that hold univels, as a mask of one slice: the grid's own voxels where the plane is one of
 * its slices, else pixels along the plane's axes, as large as the grid's smallest spacing, each carrying the voxel at
 * its centre. *mask NULL: the plane misses the region. errors ERROR_MEMORY, ERROR_LIMIT */
NODISCARD bool cut_univels(const struct cut_region *cut, const struct plane *plane, struct mask **mask,
                           struct error *err);
/* Adds a slice's outlines; a pixel alone is a small diamond. errors of outline_slice */
NODISCARD bool cut_outlines(const struct mask *slice, enum outline_method method, struct cut_lines *lines,
                            struct error *err);
/* Adds the borders between pixels inside and outside. */
NODISCARD bool cut_borders(const struct mask *slice, struct cut_lines *lines, struct error *err);
/* Adds where the plane cuts the triangles: closed outlines where the mesh is closed. A corner on the plane counts as
 * above it. Works in single precision, as meshes do. */
NODISCARD bool cut_mesh(const struct mesh *mesh, const struct plane *plane, struct cut_lines *lines, struct error *err);
/* Adds where the plane cuts the outer faces of a grid. */
NODISCARD bool cut_grid(const struct grid *grid, const struct plane *plane, struct cut_lines *lines, struct error *err);
/* The corners of a grid's outer faces; bit 0, 1, 2 of the number: high along i, j, k. */
void cut_grid_corners(const struct grid *grid, struct vec3 corners_lps_mm[8]);
