#pragma once
/* Caches the drawables that a back end makes of shapes, grids and tracks, from picture to picture: within a budget of
 * memory the least recently used is dropped first, nothing while a picture uses it, nothing outlives its plan. One
 * policy for all back ends, which only make and free their own kind of drawable. */
#include "core/derive/shapes.h"
#include "core/scene/snapshot.h"

/* The first member of everything that a back end makes. */
struct drawable {
    uint64_t n_bytes; /* memory that dropping it frees; 0: kept as long as its plan */
    bool holds_shape; /* of a shape: it holds a reference of it */
    /* of shapes, filled by the cache */
    struct box3 bounds_lps_mm; /* empty: nothing to draw, and the back end made nothing */
    size_t n_triangles;
    bool is_coarse; /* of reduced detail */
};

/* A back end's way to make and free. make_* give NULL on failure; shape and volume are borrowed. */
struct drawable_maker {
    /* n_passes: of shading_normals, for triangles. */
    struct drawable *(*make_shape)(void *context, const struct shape *shape, int n_passes, struct error *err);
    void (*destroy_shape)(void *context, struct drawable *drawable);
    /* volumes: n of one type and grid, n > 1 only of real numbers with slope 1 and offset 0. */
    struct drawable *(*make_grid)(void *context, const struct volume *const *volumes, size_t n, bool is_labels,
                                  struct error *err);
    void (*destroy_grid)(void *context, struct drawable *drawable);
    struct drawable *(*make_tracks)(void *context, const struct track_set *set, struct error *err);
    void (*destroy_tracks)(void *context, struct drawable *drawable);
    void *context;
};

#define DRAW_CACHE_BYTES ((uint64_t)512 << 20) /* of what no begun picture uses */

struct draw_cache;

struct draw_cache *draw_cache_create(const struct drawable_maker *maker);
void draw_cache_destroy(struct draw_cache *cache);
/* No picture is begun. */
void draw_cache_forget(struct draw_cache *cache, const struct plan *plan);

/* A picture that is begun; in the caller's storage. Drawables it uses from then on stay until it ends. */
struct draw_cache_use {
    struct draw_cache *cache; /* NULL: none */
    uint64_t picture;         /* counted from 1 */
    struct draw_cache_use *next;
};
/* Begins a picture; first drops the drawables that exceed the budget. */
void draw_cache_begin(struct draw_cache *cache, struct draw_cache_use *use);
void draw_cache_end(struct draw_cache_use *use);

/* Gives the shape of a want and by how much its detail is reduced (1: not). One reference, the caller's; NULL on
 * failure. A failure that derive_is_refusal counts as "cannot be shown". */
typedef struct shape *draw_shape_source(struct derive *derived, const struct shape_want *want, uint32_t *reduction,
                                        struct error *err);

/* The drawable of a shape, borrowed until the picture ends. Empty bounds: the subject cannot be shown in this way,
 * which is logged once. errors  those of source and of make_shape, ERROR_LIMIT more primitives than can be drawn */
NODISCARD const struct drawable *draw_cache_shape(struct draw_cache *cache, struct derive *derived,
                                                  const struct shape_want *want, draw_shape_source *source,
                                                  struct error *err);
/* The drawable of a shape that was computed from the plan for a scene, borrowed until the picture ends. It holds a
 * reference of the shape; when a picture begins, those of shapes that nobody else holds any more are dropped. n_passes:
 * of shading_normals. errors those of make_shape, ERROR_LIMIT as above */
NODISCARD const struct drawable *draw_cache_computed_shape(struct draw_cache *cache, const struct plan *plan,
                                                           struct shape *shape, int n_passes, uint32_t reduction,
                                                           struct error *err);
/* The drawable of the plan's image or label layer, borrowed until the plan is forgotten. errors those of make_grid */
NODISCARD const struct drawable *draw_cache_grid(struct draw_cache *cache, const struct plan *plan,
                                                 struct subject subject, struct error *err);
/* The drawable of the plan's tracks, borrowed until the picture ends. errors those of make_tracks */
NODISCARD const struct drawable *draw_cache_tracks(struct draw_cache *cache, const struct plan *plan,
                                                   struct error *err);
/* The drawable of volumes that were computed from the plan, borrowed until the picture ends. It holds a reference of
 * the first one, which with n tells lists of volumes apart; when a picture begins, those of volumes that nobody else
 * holds any more are dropped. errors those of make_grid */
NODISCARD const struct drawable *draw_cache_volumes(struct draw_cache *cache, const struct plan *plan,
                                                    const struct volume *const *volumes, size_t n, bool is_labels,
                                                    struct error *err);
