#pragma once
/* Makes and frees the rasteriser's drawables, which draw_cache.h keeps: shapes. Images and labels need none, as they
 * are read from the plan. */
#include "core/render/soft/kernels.h"
#include "core/render/visible/draw_cache.h"

struct soft_shape {
    struct drawable base;
    enum shape_kind kind;
    bool is_faceted;                 /* always shaded with one normal a triangle */
    struct soft_points points;       /* vertices */
    const uint32_t *indices;         /* of the corners of triangles or the ends of segments; points have none */
    const uint8_t *shade;            /* points: shaded in advance */
    struct vec3 edge_lps_mm[3];      /* points: of the voxel they stand for */
    size_t n_vertices, n_primitives; /* triangles, segments or points */
    struct shape *shape;             /* a reference: it owns indices and shade */
    float *positions;                /* with normals, the memory of points */
    int16_t *normals;
};

/* The maker of struct soft_shape. */
struct drawable_maker soft_drawable_maker(void);
