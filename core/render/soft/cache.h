#pragma once
/* Surfaces as the rasteriser wants them, kept until their plan is forgotten. Images and labels are read where the plan has them. */
#include "core/render/soft/kernels.h"
#include "core/scene/snapshot.h"

struct soft_surface {
    struct soft_points points;
    const uint32_t *indices; /* the mesh's own */
    size_t n_vertices, n_triangles;
    struct box3 bounds_lps_mm;
    bool is_light; /* a reduced one */
};

struct soft_cache;

struct soft_cache *soft_cache_create(void);
void soft_cache_destroy(struct soft_cache *cache);
void soft_cache_forget(struct soft_cache *cache, const struct plan *plan);

/* Borrowed, good until the plan is forgotten. errors ERROR_MEMORY, ERROR_LIMIT, and those of plan_surface */
NODISCARD const struct soft_surface *soft_cache_surface(struct soft_cache *cache, struct plan *plan, size_t region,
                                                        enum surface_algorithm algorithm, enum surface_detail detail,
                                                        struct error *err);
