#pragma once
/* Shapes as the rasteriser wants them, kept by least recent use within a budget of memory, no longer than their plan.
 * Images and labels are read where the plan has them. */
#include "core/derive/shapes.h"
#include "core/render/soft/kernels.h"
#include "core/scene/snapshot.h"
#include "core/surface/shape.h"

struct soft_shape {
    enum shape_kind kind;
    bool is_faceted;                 /* whatever the scene says */
    struct soft_points points;       /* vertices */
    const uint32_t *indices;         /* the shape's own: of triangles' corners or segments' ends; points have none */
    const uint8_t *shade;            /* points: light worked out in advance */
    struct vec3 edge_lps_mm[3];      /* points: of the voxel they stand for */
    size_t n_vertices, n_primitives; /* triangles, segments or points */
    struct box3 bounds_lps_mm;       /* empty: nothing to draw */
    bool is_light;                   /* a reduced one */
};

struct soft_cache;

/* What it keeps at most, besides what the picture at hand needs. */
#define SOFT_CACHE_BYTES ((uint64_t)512 << 20)

struct soft_cache *soft_cache_create(void);
void soft_cache_destroy(struct soft_cache *cache);
void soft_cache_forget(struct soft_cache *cache, const struct plan *plan);
/* Before a picture: drops what has not been drawn for longest while there is too much, but nothing that pictures from
 * oldest_begun on use (UINT64_MAX: none is begun). Gives the number of the picture that is about to be drawn. */
uint64_t soft_cache_trim(struct soft_cache *cache, uint64_t oldest_begun);

/* Borrowed until the picture is done. A region that cannot be shown in this way is empty.
 * errors ERROR_MEMORY, ERROR_LIMIT, and those of derive_shape */
NODISCARD const struct soft_shape *soft_cache_shape(struct soft_cache *cache, struct derive *derived, size_t region,
                                                    const struct shape_key *key, enum surface_detail detail,
                                                    struct error *err);
