#include "core/render/soft/cache.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/log.h"
#include "core/base/mem.h"
#include "core/render/visible/shading.h"
#include "core/render/visible/visible.h"

struct entry {
    const struct plan *plan;
    size_t region;
    struct shape_key key;
    enum surface_detail detail;
    struct soft_shape drawn;
    struct shape *shape; /* NULL: cannot be shown */
    float *positions;    /* what drawn.points points into */
    int16_t *normals;
    uint64_t n_bytes, used; /* used: the picture that drew it last */
    struct entry *next;
};

struct soft_cache {
    struct entry *first;
    uint64_t n_bytes, n_pictures;
};

struct soft_cache *soft_cache_create(void)
{
    return mem_new(sizeof(struct soft_cache));
}

static void entry_destroy(struct entry *entry)
{
    shape_unref(entry->shape);
    free(entry->positions);
    free(entry->normals);
    free(entry);
}

void soft_cache_forget(struct soft_cache *cache, const struct plan *plan)
{
    for (struct entry **at = &cache->first; *at;) {
        struct entry *entry = *at;
        if (plan && entry->plan != plan) {
            at = &entry->next;
            continue;
        }
        *at = entry->next;
        cache->n_bytes -= entry->n_bytes;
        entry_destroy(entry);
    }
}

void soft_cache_destroy(struct soft_cache *cache)
{
    if (!cache)
        return;
    soft_cache_forget(cache, NULL);
    free(cache);
}

uint64_t soft_cache_trim(struct soft_cache *cache, uint64_t oldest_begun)
{
    while (cache->n_bytes > SOFT_CACHE_BYTES) {
        struct entry **oldest = NULL;
        for (struct entry **at = &cache->first; *at; at = &(*at)->next)
            if ((*at)->used < oldest_begun && (!oldest || (*at)->used < (*oldest)->used))
                oldest = at;
        if (!oldest)
            break;
        struct entry *entry = *oldest;
        *oldest = entry->next;
        cache->n_bytes -= entry->n_bytes;
        entry_destroy(entry);
    }
    return ++cache->n_pictures;
}

/* By component, so that one instruction works on several vertices; normals in 16 bits, fine enough to shade with.
 * normals NULL: none. */
static bool fill_vertices(struct entry *entry, const float *positions, const float *normals, size_t n,
                          struct error *err)
{
    entry->positions = mem_large_array(n, 3 * sizeof *entry->positions, UINT64_MAX, err);
    entry->normals = entry->positions ? mem_large_array(n, 3 * sizeof *entry->normals, UINT64_MAX, err) : NULL;
    if (!entry->normals)
        return false;
    for (size_t i = 0; i < n; i++)
        for (size_t axis = 0; axis < 3; axis++) {
            entry->positions[axis * n + i] = positions[3 * i + axis];
            entry->normals[axis * n + i] = normals ? (int16_t)(normals[3 * i + axis] * 32767.0f) : 0;
        }
    const float *p = entry->positions;
    const int16_t *m = entry->normals;
    entry->drawn.points = (struct soft_points){ p, p + n, p + 2 * n, m, m + n, m + 2 * n };
    entry->drawn.n_vertices = n;
    return true;
}

static bool fill_triangles(struct entry *entry, int n_passes, struct error *err)
{
    const struct mesh *mesh = entry->shape->mesh;
    float *smooth = n_passes > 0 ? shading_normals(mesh, n_passes, err) : NULL;
    bool is_good = (smooth || n_passes == 0) &&
                   fill_vertices(entry, mesh->positions_lps_mm, smooth ? smooth : mesh->normals, mesh->n_vertices, err);
    free(smooth);
    entry->drawn.indices = mesh->indices;
    entry->drawn.n_primitives = mesh->n_triangles;
    return is_good;
}

static bool fill_points(struct entry *entry, struct error *err)
{
    const struct point_set *points = entry->shape->points;
    struct box3 *box = &entry->drawn.bounds_lps_mm;
    memcpy(entry->drawn.edge_lps_mm, points->edge_lps_mm, sizeof points->edge_lps_mm);
    for (int i = 0; i < 3 && points->n_points > 0; i++) { /* around the voxels, not their centres */
        struct vec3 e = points->edge_lps_mm[i], half = vec3(fabs(e.x) / 2, fabs(e.y) / 2, fabs(e.z) / 2);
        box->low = vec3_sub(box->low, half);
        box->high = vec3_add(box->high, half);
    }
    entry->drawn.shade = points->shade;
    entry->drawn.n_primitives = points->n_points;
    return fill_vertices(entry, points->positions_lps_mm, points->normals, points->n_points, err);
}

static bool fill(struct entry *entry, uint32_t reduction, struct error *err)
{
    const struct shape *shape = entry->shape;
    entry->drawn.kind = shape->kind;
    entry->drawn.is_faceted = shape->is_faceted;
    entry->drawn.bounds_lps_mm = shape->bounds_lps_mm;
    entry->drawn.is_light = reduction > 1;
    bool is_good = false;
    switch (shape->kind) {
    case SHAPE_TRIANGLES: is_good = fill_triangles(entry, visible_shading_passes(&entry->key, reduction), err); break;
    case SHAPE_LINES:
        entry->drawn.indices = shape->lines->indices;
        entry->drawn.n_primitives = shape->lines->n_segments;
        is_good = fill_vertices(entry, shape->lines->positions_lps_mm, NULL, shape->lines->n_vertices, err);
        break;
    case SHAPE_POINTS: is_good = fill_points(entry, err); break;
    }
    if (is_good && entry->drawn.n_primitives > (size_t)INT32_MAX / 3)
        return error_set(err, ERROR_LIMIT, "%zu triangles, lines or points: at most %d can be drawn",
                         entry->drawn.n_primitives, INT32_MAX / 3);
    entry->n_bytes = sizeof *entry + shape->n_bytes + entry->drawn.n_vertices * 3 * (sizeof(float) + sizeof(int16_t));
    return is_good;
}

const struct soft_shape *soft_cache_shape(struct soft_cache *cache, struct derive *derived, size_t region,
                                          const struct shape_key *key, enum surface_detail detail, struct error *err)
{
    const struct plan *plan = derive_plan(derived);
    detail = key->representation == REPRESENTATION_SURFACE ? detail : SURFACE_FULL;
    for (struct entry *entry = cache->first; entry; entry = entry->next)
        if (entry->plan == plan && entry->region == region && entry->detail == detail &&
            shape_key_equal(&entry->key, key)) {
            entry->used = cache->n_pictures;
            return &entry->drawn;
        }
    struct shape_facts facts = { 0 };
    struct error why = { 0 };
    struct entry *made = mem_new(sizeof *made);
    made->plan = plan;
    made->region = region;
    made->key = *key;
    made->detail = detail;
    made->used = cache->n_pictures;
    made->drawn.bounds_lps_mm = box3_empty();
    made->n_bytes = sizeof *made;
    made->shape = derive_shape(derived, &(struct shape_want){ subject_region(region), *key, detail }, &facts, &why);
    if (made->shape ? fill(made, facts.reduction, &why) : derive_is_refusal(why.code)) {
        if (!made->shape)
            log_info("region %s is not drawn: %s", plan->regions.regions[region].id, why.text);
        made->next = cache->first;
        cache->first = made;
        cache->n_bytes += made->n_bytes;
        return &made->drawn;
    }
    entry_destroy(made);
    if (err)
        *err = why;
    error_prefix(err, "region %s", plan->regions.regions[region].id);
    return NULL;
}
