#pragma once
/* What is kept on the graphics card: surfaces, images, label layers; each uploaded on first use, dropped with its plan. */
#include "core/render/gl/table.h"
#include "core/scene/snapshot.h"

struct gl_surface {
    GLuint vertex_array, vertices, indices;
    GLsizei n_indices;
    size_t n_triangles;
    struct box3 bounds_lps_mm;
    bool is_light; /* a reduced one */
};

struct gl_grid {
    GLuint texture;
    double value_per_unit, value_at_zero; /* images: value = texture * value_per_unit + value_at_zero */
};

struct gl_cache;

struct gl_cache *gl_cache_create(void);
void gl_cache_destroy(const struct gl *gl, struct gl_cache *cache);
void gl_cache_forget(const struct gl *gl, struct gl_cache *cache, const struct plan *plan);

/* Borrowed, good until the plan is forgotten. errors ERROR_GL, ERROR_MEMORY, ERROR_LIMIT, and those of plan_surface */
NODISCARD const struct gl_surface *gl_cache_surface(const struct gl *gl, struct gl_cache *cache, struct plan *plan, size_t region,
                                                    enum surface_algorithm algorithm, enum surface_detail detail,
                                                    struct error *err);
NODISCARD const struct gl_grid *gl_cache_image(const struct gl *gl, struct gl_cache *cache, const struct plan *plan, size_t image,
                                               struct error *err);
NODISCARD const struct gl_grid *gl_cache_layer(const struct gl *gl, struct gl_cache *cache, const struct plan *plan, size_t layer,
                                               struct error *err);
