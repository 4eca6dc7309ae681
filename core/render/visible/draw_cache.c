/* Keeps the drawables that a back end makes of shapes and grids from picture to picture. */
#include "core/render/visible/draw_cache.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "core/base/log.h"
#include "core/base/mem.h"
#include "core/render/visible/visible.h"

struct entry {
    const struct plan *plan;
    struct subject subject;
    struct shape_key key;       /* of a shape */
    enum surface_detail detail; /* of a shape */
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

static bool is_grid(struct subject subject)
{
    return subject.kind == SUBJECT_IMAGE || subject.kind == SUBJECT_LABEL_LAYER;
}

static void entry_destroy(const struct draw_cache *cache, struct entry *entry)
{
    const struct drawable_maker *maker = &cache->maker;
    if (entry->drawable)
        (is_grid(entry->subject) ? maker->destroy_grid : maker->destroy_shape)(maker->context, entry->drawable);
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

static void trim(struct draw_cache *cache)
{
    uint64_t oldest_begun = UINT64_MAX;
    for (const struct draw_cache_use *use = cache->begun; use; use = use->next)
        oldest_begun = use->picture < oldest_begun ? use->picture : oldest_begun;
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
        if (entry->plan == wanted->plan && entry->detail == wanted->detail &&
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

static struct drawable *make_shape(struct draw_cache *cache, const struct shape *shape, const struct shape_key *key,
                                   uint32_t reduction, struct error *err)
{
    if (n_primitives(shape) > (size_t)INT32_MAX / 3) {
        error_set(err, ERROR_LIMIT, "%zu triangles, lines or points: at most %d can be drawn", n_primitives(shape),
                  INT32_MAX / 3);
        return NULL;
    }
    struct drawable *drawable =
        cache->maker.make_shape(cache->maker.context, shape, visible_shading_passes(key, reduction), err);
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
        made.drawable = make_shape(cache, shape, &want->key, reduction, &why);
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
    made.drawable = cache->maker.make_grid(cache->maker.context, volume, is_labels, err);
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
