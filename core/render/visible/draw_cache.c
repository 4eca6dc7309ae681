/* Keeps the drawables that a back end makes of shapes and grids from picture to picture. */
#include "core/render/visible/draw_cache.h"

#include <assert.h>
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

#include "core/base/log.h"
#include "core/base/mem.h"
#include "core/render/visible/visible.h"

struct entry {
    const struct plan *plan;
    struct subject subject;
    struct shape_key key;       /* of a shape */
    enum surface_detail detail; /* of a shape */
    struct volume *volume;      /* of computed volumes: a reference of the first; else NULL */
    size_t n_volumes;           /* of them */
    struct shape *shape;        /* of a computed shape: a reference; else NULL */
    struct drawable *drawable;  /* NULL: the shape cannot be shown */
    struct drawable nothing;    /* stands for it then */
    uint64_t n_bytes;           /* counted against the budget */
    uint64_t used;              /* the last picture that used it */
    struct entry *next;
};

struct draw_cache {
    struct drawable_maker maker;
    struct entry *first;
    struct draw_cache_use *begun;
    uint64_t n_bytes, n_pictures;
};

struct draw_cache *draw_cache_create(const struct drawable_maker *maker)
{
    struct draw_cache *cache = mem_new(sizeof *cache);
    cache->maker = *maker;
    return cache;
}

static bool is_grid(const struct entry *entry)
{
    return entry->volume || entry->subject.kind == SUBJECT_IMAGE || entry->subject.kind == SUBJECT_LABEL_LAYER;
}

static void entry_destroy(const struct draw_cache *cache, struct entry *entry)
{
    const struct drawable_maker *maker = &cache->maker;
    if (entry->drawable && entry->subject.kind == SUBJECT_TRACKS)
        maker->destroy_tracks(maker->context, entry->drawable);
    else if (entry->drawable)
        (is_grid(entry) ? maker->destroy_grid : maker->destroy_shape)(maker->context, entry->drawable);
    volume_unref(entry->volume);
    shape_unref(entry->shape);
    free(entry);
}

static void unlink_entry(struct draw_cache *cache, struct entry **at)
{
    struct entry *entry = *at;
    *at = entry->next;
    cache->n_bytes -= entry->n_bytes;
    entry_destroy(cache, entry);
}

void draw_cache_forget(struct draw_cache *cache, const struct plan *plan)
{
    assert(!cache->begun);
    for (struct entry **at = &cache->first; *at;)
        if (!plan || (*at)->plan == plan)
            unlink_entry(cache, at);
        else
            at = &(*at)->next;
}

void draw_cache_destroy(struct draw_cache *cache)
{
    if (!cache)
        return;
    draw_cache_forget(cache, NULL);
    free(cache);
}

/* True if only the cache and the drawable still hold what the drawable was computed from. */
static bool is_forsaken(const struct entry *entry)
{
    return (entry->volume && atomic_load(&entry->volume->references) == 1) ||
           (entry->shape && atomic_load(&entry->shape->references) == (entry->drawable->holds_shape ? 2 : 1));
}

static void trim(struct draw_cache *cache)
{
    uint64_t oldest_begun = UINT64_MAX;
    for (const struct draw_cache_use *use = cache->begun; use; use = use->next)
        oldest_begun = use->picture < oldest_begun ? use->picture : oldest_begun;
    for (struct entry **at = &cache->first; *at;)
        if ((*at)->used < oldest_begun && is_forsaken(*at))
            unlink_entry(cache, at);
        else
            at = &(*at)->next;
    while (cache->n_bytes > DRAW_CACHE_BYTES) {
        struct entry **oldest = NULL;
        for (struct entry **at = &cache->first; *at; at = &(*at)->next)
            if ((*at)->n_bytes > 0 && (*at)->used < oldest_begun && (!oldest || (*at)->used < (*oldest)->used))
                oldest = at;
        if (!oldest)
            return;
        unlink_entry(cache, oldest);
    }
}

void draw_cache_begin(struct draw_cache *cache, struct draw_cache_use *use)
{
    trim(cache);
    *use = (struct draw_cache_use){ cache, ++cache->n_pictures, cache->begun };
    cache->begun = use;
}

void draw_cache_end(struct draw_cache_use *use)
{
    if (!use->cache)
        return;
    struct draw_cache_use **at = &use->cache->begun;
    while (*at != use)
        at = &(*at)->next;
    *at = use->next;
    use->cache = NULL;
}

static const struct drawable *keep(struct draw_cache *cache, const struct entry *made)
{
    struct entry *entry = mem_new(sizeof *entry);
    *entry = *made;
    entry->next = cache->first;
    entry->used = cache->n_pictures;
    cache->first = entry;
    cache->n_bytes += entry->n_bytes;
    return entry->drawable ? entry->drawable : &entry->nothing;
}

/* ---- shapes ----------------------------------------------------------------------------------------------------- */

static const struct drawable *find_shape(struct draw_cache *cache, const struct entry *wanted)
{
    for (struct entry *entry = cache->first; entry; entry = entry->next)
        if (entry->plan == wanted->plan && !entry->volume && !entry->shape && entry->detail == wanted->detail &&
            subject_equal(entry->subject, wanted->subject) && shape_key_equal(&entry->key, &wanted->key)) {
            entry->used = cache->n_pictures;
            return entry->drawable ? entry->drawable : &entry->nothing;
        }
    return NULL;
}

static size_t n_primitives(const struct shape *shape)
{
    return shape->kind == SHAPE_TRIANGLES ? shape->mesh->n_triangles
           : shape->kind == SHAPE_LINES   ? shape->lines->n_segments
                                          : shape->points->n_points;
}

/* Points stand for voxels: around these, not around their centres. */
static struct box3 bounds_of(const struct shape *shape)
{
    struct box3 box = shape->bounds_lps_mm;
    for (int i = 0; shape->kind == SHAPE_POINTS && shape->points->n_points > 0 && i < 3; i++) {
        struct vec3 e = shape->points->edge_lps_mm[i], half = vec3(fabs(e.x) / 2, fabs(e.y) / 2, fabs(e.z) / 2);
        box.low = vec3_sub(box.low, half);
        box.high = vec3_add(box.high, half);
    }
    return box;
}

static struct drawable *make_shape(struct draw_cache *cache, const struct shape *shape, int n_passes,
                                   uint32_t reduction, struct error *err)
{
    if (n_primitives(shape) > (size_t)INT32_MAX / 3) {
        error_set(err, ERROR_LIMIT, "%zu triangles, lines or points: at most %d can be drawn", n_primitives(shape),
                  INT32_MAX / 3);
        return NULL;
    }
    struct drawable *drawable = cache->maker.make_shape(cache->maker.context, shape, n_passes, err);
    if (!drawable)
        return NULL;
    drawable->bounds_lps_mm = bounds_of(shape);
    drawable->n_triangles = shape->kind == SHAPE_TRIANGLES ? shape->mesh->n_triangles : 0;
    drawable->is_coarse = reduction > 1;
    return drawable;
}

/* In front of its id, for people. */
static const char *subject_word(struct subject subject)
{
    return subject.kind == SUBJECT_REGION ? "region " : "";
}

const struct drawable *draw_cache_shape(struct draw_cache *cache, struct derive *derived, const struct shape_want *want,
                                        draw_shape_source *source, struct error *err)
{
    const struct plan *plan = derive_plan(derived);
    struct entry made = {
        .plan = plan,
        .subject = want->subject,
        .key = want->key,
        .detail = want->key.representation == REPRESENTATION_SURFACE ? want->detail : SURFACE_FULL,
        .nothing = { .bounds_lps_mm = box3_empty() },
    };
    const struct drawable *found = find_shape(cache, &made);
    if (found)
        return found;
    struct error why = { 0 };
    uint32_t reduction = 1;
    struct shape *shape = source(derived, want, &reduction, &why);
    if (shape)
        made.drawable = make_shape(cache, shape, visible_shading_passes(&want->key, reduction), reduction, &why);
    bool is_refused = !shape && derive_is_refusal(why.code);
    shape_unref(shape);
    if (is_refused)
        log_info("%s%s is not drawn: %s", subject_word(want->subject), subject_id(plan, want->subject), why.text);
    if (made.drawable || is_refused) {
        made.n_bytes = sizeof made + (made.drawable ? made.drawable->n_bytes : 0);
        return keep(cache, &made);
    }
    if (err)
        *err = why;
    error_prefix(err, "%s%s", subject_word(want->subject), subject_id(plan, want->subject));
    return NULL;
}

const struct drawable *draw_cache_computed_shape(struct draw_cache *cache, const struct plan *plan, struct shape *shape,
                                                 int n_passes, uint32_t reduction, struct error *err)
{
    for (struct entry *entry = cache->first; entry; entry = entry->next)
        if (entry->plan == plan && entry->shape == shape) {
            entry->used = cache->n_pictures;
            return entry->drawable;
        }
    struct entry made = { .plan = plan, .subject = subject_plan() };
    made.drawable = make_shape(cache, shape, n_passes, reduction, err);
    if (!made.drawable)
        return NULL;
    made.shape = shape_ref(shape);
    made.n_bytes = sizeof made + made.drawable->n_bytes;
    return keep(cache, &made);
}

/* ---- tracks ----------------------------------------------------------------------------------------------------- */

const struct drawable *draw_cache_tracks(struct draw_cache *cache, const struct plan *plan, struct error *err)
{
    for (struct entry *entry = cache->first; entry; entry = entry->next)
        if (entry->plan == plan && entry->subject.kind == SUBJECT_TRACKS) {
            entry->used = cache->n_pictures;
            return entry->drawable;
        }
    struct entry made = { .plan = plan, .subject = { SUBJECT_TRACKS, 0, 0 } };
    made.drawable = cache->maker.make_tracks(cache->maker.context, &plan->tracks, err);
    if (!made.drawable) {
        error_prefix(err, "tracks");
        return NULL;
    }
    made.n_bytes = made.drawable->n_bytes;
    return keep(cache, &made);
}

/* ---- grids ------------------------------------------------------------------------------------------------------ */

const struct drawable *draw_cache_grid(struct draw_cache *cache, const struct plan *plan, struct subject subject,
                                       struct error *err)
{
    for (struct entry *entry = cache->first; entry; entry = entry->next)
        if (entry->plan == plan && subject_equal(entry->subject, subject))
            return entry->drawable;
    bool is_labels = subject.kind == SUBJECT_LABEL_LAYER;
    const struct volume *volume = is_labels ? plan->regions.layers[subject.index] : plan->images[subject.index].volume;
    struct entry made = { .plan = plan, .subject = subject };
    made.drawable = cache->maker.make_grid(cache->maker.context, &volume, 1, is_labels, err);
    if (made.drawable) {
        made.n_bytes = made.drawable->n_bytes;
        return keep(cache, &made);
    }
    if (is_labels)
        error_prefix(err, "label layer %zu", subject.index);
    else
        error_prefix(err, "image %s", plan->images[subject.index].id);
    return NULL;
}

const struct drawable *draw_cache_volumes(struct draw_cache *cache, const struct plan *plan,
                                          const struct volume *const *volumes, size_t n, bool is_labels,
                                          struct error *err)
{
    for (struct entry *entry = cache->first; entry; entry = entry->next)
        if (entry->plan == plan && entry->volume == volumes[0] && entry->n_volumes == n) {
            entry->used = cache->n_pictures;
            return entry->drawable;
        }
    struct entry made = { .plan = plan, .subject = subject_plan() };
    made.drawable = cache->maker.make_grid(cache->maker.context, volumes, n, is_labels, err);
    if (!made.drawable)
        return NULL;
    made.volume = volume_ref(volumes[0]);
    made.n_volumes = n;
    made.n_bytes = sizeof made + n * grid_n_voxels(&volumes[0]->grid) * voxel_size(volumes[0]->type);
    return keep(cache, &made);
}
