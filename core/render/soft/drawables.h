#pragma once
/* Shapes as the rasteriser wants them, for draw_cache.h. Images and labels are read where the plan has them. */
#include "core/render/soft/kernels.h"
#include "core/render/visible/draw_cache.h"

struct soft_shape {
    struct drawable base;
    enum shape_kind kind;
    bool is_faceted;                 /* whatever the scene says */
    struct soft_points points;       /* vertices */
    const uint32_t *indices;         /* the shape's own: of triangles' corners or segments' ends; points have none */
    const uint8_t *shade;            /* points: light worked out in advance */
    struct vec3 edge_lps_mm[3];      /* points: of the voxel they stand for */
    size_t n_vertices, n_primitives; /* triangles, segments or points */
    struct shape *shape;             /* a reference: indices and shade are its */
    float *positions;                /* what points points into */
    int16_t *normals;
};

/* Its drawables are struct soft_shape; it makes none of grids. */
struct drawable_maker soft_drawable_maker(void);
