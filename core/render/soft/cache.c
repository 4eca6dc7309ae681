#include "core/render/soft/cache.h"

#include <stdlib.h>

#include "core/base/mem.h"
#include "core/render/shading.h"

struct entry {
    const struct plan *plan;
    size_t region;
    enum surface_algorithm algorithm;
    enum surface_detail detail;
    struct soft_surface surface;
    struct mesh *mesh;
    float *positions; /* what surface.points points into */
    int16_t *normals;
    struct entry *next;
};

struct soft_cache {
    struct entry *first;
};

struct soft_cache *soft_cache_create(void)
{
    return mem_new(sizeof(struct soft_cache));
}

static void entry_destroy(struct entry *entry)
{
    mesh_unref(entry->mesh);
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

/* By component, so that one instruction works on several vertices; normals in 16 bits, fine enough to shade with. */
static bool fill(struct entry *entry, int n_passes, struct error *err)
{
    const struct mesh *mesh = entry->mesh;
    size_t n = mesh->n_vertices;
    float *normals = shading_normals(mesh, n_passes, err);
    entry->positions = normals ? mem_large_array(n, 3 * sizeof *entry->positions, UINT64_MAX, err) : NULL;
    entry->normals = entry->positions ? mem_large_array(n, 3 * sizeof *entry->normals, UINT64_MAX, err) : NULL;
    for (size_t i = 0; entry->normals && i < n; i++)
        for (size_t axis = 0; axis < 3; axis++) {
            entry->positions[axis * n + i] = mesh->positions_lps_mm[3 * i + axis];
            entry->normals[axis * n + i] = (int16_t)(normals[3 * i + axis] * 32767.0f);
        }
    free(normals);
    if (!entry->normals)
        return false;
    const float *p = entry->positions;
    const int16_t *m = entry->normals;
    entry->surface.points = (struct soft_points){ p, p + n, p + 2 * n, m, m + n, m + 2 * n };
    entry->surface.indices = mesh->indices;
    entry->surface.n_vertices = n;
    entry->surface.n_triangles = mesh->n_triangles;
    entry->surface.bounds_lps_mm = mesh->bounds_lps_mm;
    return true;
}

const struct soft_surface *soft_cache_surface(struct soft_cache *cache, struct plan *plan, size_t region,
                                              enum surface_algorithm algorithm, enum surface_detail detail, struct error *err)
{
    for (struct entry *entry = cache->first; entry; entry = entry->next)
        if (entry->plan == plan && entry->region == region && entry->algorithm == algorithm && entry->detail == detail)
            return &entry->surface;
    struct surface_facts facts = { 0 };
    struct entry *made = mem_new(sizeof *made);
    made->plan = plan;
    made->region = region;
    made->algorithm = algorithm;
    made->detail = detail;
    made->mesh = plan_surface(plan, region, algorithm, detail, &facts, err);
    bool is_good = made->mesh != NULL;
    if (is_good && made->mesh->n_triangles > (size_t)INT32_MAX / 3)
        is_good = error_set(err, ERROR_LIMIT, "a surface of %zu triangles: at most %d can be drawn", made->mesh->n_triangles, INT32_MAX / 3);
    if (is_good && fill(made, shading_passes(facts.reduction), err)) {
        made->surface.is_light = facts.reduction > 1;
        made->next = cache->first;
        cache->first = made;
        return &made->surface;
    }
    error_prefix(err, "region %s", plan->regions.regions[region].id);
    entry_destroy(made);
    return NULL;
}
