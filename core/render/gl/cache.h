#pragma once
/* What is kept on the graphics card: shapes, images, label layers; each uploaded on first use, dropped with its plan.
 */
#include "core/derive/shapes.h"
#include "core/render/gl/table.h"
#include "core/scene/snapshot.h"
#include "core/surface/shape.h"

struct gl_shape {
    enum shape_kind kind;
    bool is_faceted; /* whatever the scene says */
    GLuint vertex_array, vertices, indices;
    GLsizei n; /* indices of triangles; segments or points, each an instance of four corners */
    size_t n_triangles;
    struct vec3 edge_lps_mm[3]; /* points: of the voxel they stand for */
    struct box3 bounds_lps_mm;  /* empty: nothing to draw */
    bool is_light;              /* a reduced one */
};

struct gl_grid {
    GLuint texture;
    double value_per_unit, value_at_zero; /* images: value = texture * value_per_unit + value_at_zero */
};

struct gl_cache;

struct gl_cache *gl_cache_create(void);
void gl_cache_destroy(const struct gl *gl, struct gl_cache *cache);
void gl_cache_forget(const struct gl *gl, struct gl_cache *cache, const struct plan *plan);

/* What shapes take at most, besides what the picture at hand needs. */
#define GL_CACHE_BYTES ((uint64_t)512 << 20)
/* Before a picture: drops shapes that have not been drawn for longest while there is too much. */
void gl_cache_trim(const struct gl *gl, struct gl_cache *cache);

/* Borrowed for this picture. A region that cannot be shown in this way is empty.
 * errors ERROR_GL, ERROR_MEMORY, ERROR_LIMIT, and those of derive_shape */
NODISCARD const struct gl_shape *gl_cache_shape(const struct gl *gl, struct gl_cache *cache, struct derive *derived,
                                                size_t region, const struct shape_key *key, enum surface_detail detail,
                                                struct error *err);
/* Borrowed, good until the plan is forgotten. errors ERROR_GL, ERROR_MEMORY, ERROR_LIMIT */
NODISCARD const struct gl_grid *gl_cache_image(const struct gl *gl, struct gl_cache *cache, const struct plan *plan,
                                               size_t image, struct error *err);
NODISCARD const struct gl_grid *gl_cache_layer(const struct gl *gl, struct gl_cache *cache, const struct plan *plan,
                                               size_t layer, struct error *err);
