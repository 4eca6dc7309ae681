/* Builds shapes of regions, one or many side by side, and keeps them in the store. */
#include "core/derive/region_shape.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/derive/region_masks.h"
#include "core/derive/region_surface.h"
#include "core/region/boundary.h"
#include "core/surface/shape_make.h"

/* How a shape is built; changes nothing of it. */
struct way {
    int n_threads;
    struct region_masks
        *masks; /* NULL: the mask is made for this shape alone; else it is wish number `wish` of these */
    size_t wish;
};

struct mask *region_shape_mask(const struct plan *plan, struct subject subject, const struct shape_key *key,
                               struct error *err)
{
    if (key->has_inner_boundary)
        return mask_from_region_own(&plan->regions, subject.index, parallel_cores(), err);
    return mask_from_region(&plan->regions, subject.index, parallel_cores(), err);
}

static struct shape *build_other(const struct shape_key *key, const struct mask *mask, int n_threads,
                                 struct shape_facts *facts, struct error *err)
{
    int64_t began_us = clock_now_us();
    struct shape *shape = shape_make_from_mask(key, mask, n_threads, err);
    if (!shape)
        return NULL;
    *facts = (struct shape_facts){ .reduction = 1, .n_univels = mask_count(mask) };
    facts->build_ms = (double)(clock_now_us() - began_us) / 1000;
    facts->univel_volume_mm3 = (double)facts->n_univels * fabs(affine_determinant(&mask->lps_mm_from_ijk));
    shape_facts_count(shape, facts);
    if (key->representation == REPRESENTATION_FAN)
        facts->volume_mm3 = NAN; /* its triangles overlap: it encloses nothing */
    return shape;
}

/* ---- the kind --------------------------------------------------------------------------------------------------- */

static bool is_equal(const struct derive_recipe *left, const struct derive_recipe *right)
{
    const struct region_shape_recipe *a = (const struct region_shape_recipe *)left,
                                     *b = (const struct region_shape_recipe *)right;
    return a->reduction == b->reduction && shape_key_equal(&a->key, &b->key);
}

static struct derive_result *build(struct derive *derive, const struct derive_recipe *base, const void *argument,
                                   struct error *err);

static void destroy(struct derive_result *base)
{
    struct region_shape *result = (struct region_shape *)base;
    shape_unref(result->shape);
    free(result);
}

static const struct derive_kind kind = { sizeof(struct region_shape_recipe), is_equal, build, destroy };

/* Takes the shape. */
static struct region_shape *result_of(struct shape *shape, const struct shape_facts *facts)
{
    struct region_shape *result = mem_new(sizeof *result);
    derive_result_init(&result->base, &kind, shape->n_bytes);
    result->shape = shape;
    result->facts = *facts;
    return result;
}

static struct derive_result *build(struct derive *derive, const struct derive_recipe *base, const void *argument,
                                   struct error *err)
{
    const struct region_shape_recipe *recipe = (const struct region_shape_recipe *)base;
    const struct way *way = argument;
    const struct plan *plan = derive_plan(derive);
    struct shape *shape = NULL;
    struct shape_facts facts = { 0 };
    int64_t began_us = clock_now_us();
    struct mask *mask = way->masks ? region_masks_take(way->masks, way->wish, err)
                                   : region_shape_mask(plan, base->subject, &recipe->key, err);
    double mask_ms = (double)(clock_now_us() - began_us) / 1000;
    if (mask && recipe->key.representation != REPRESENTATION_SURFACE)
        shape = build_other(&recipe->key, mask, way->n_threads, &facts, err);
    else if (mask && recipe->reduction > 1)
        shape = region_surface_build_coarse(mask, recipe->key.algorithm, recipe->reduction, &facts, err);
    else if (mask)
        shape = region_surface_build(mask, recipe->key.algorithm, way->n_threads, &facts, err);
    mask_destroy(mask);
    if (!shape) {
        if (err)
            error_prefix(err, "region \"%s\"", plan->regions.regions[base->subject.index].name);
        return NULL;
    }
    facts.build_ms += mask_ms;
    return &result_of(shape, &facts)->base;
}

struct region_shape_recipe region_shape_recipe(struct subject subject, const struct shape_key *key, uint32_t reduction)
{
    struct region_shape_recipe recipe = { { &kind, subject }, *key, reduction };
    shape_key_normalise(&recipe.key);
    return recipe;
}

struct region_shape *region_shape_get(struct derive *derive, const struct region_shape_recipe *recipe,
                                      struct error *err)
{
    return (struct region_shape *)derive_get(derive, &recipe->base, &(struct way){ parallel_cores(), NULL, 0 }, err);
}

void region_shape_offer(struct derive *derive, const struct region_shape_recipe *recipe, const struct shape *shape,
                        const struct shape_facts *facts)
{
    struct region_shape *result = result_of(shape_ref(shape), facts);
    derive_offer(derive, &recipe->base, &result->base);
    derive_result_unref(&result->base);
}

/* ---- many at once ----------------------------------------------------------------------------------------------- */

struct batch {
    struct derive *derive;
    struct region_shape_recipe *missing; /* [n_missing] */
    size_t n_missing;
    struct region_masks *masks; /* a wish for each missing shape */
    bool (*go_on)(void *context);
    void *context;
    atomic_size_t next;
    atomic_bool is_over;
};

static void build_next(void *context, int part, int n_parts)
{
    struct batch *batch = context;
    for (size_t at; !atomic_load(&batch->is_over) && (at = atomic_fetch_add(&batch->next, 1)) < batch->n_missing;) {
        if (part == 0 && batch->go_on && !batch->go_on(batch->context)) {
            atomic_store(&batch->is_over, true);
            return;
        }
        struct error err = { 0 };
        const struct derive_recipe *recipe = &batch->missing[at].base;
        const struct way way = { n_parts > 1 ? 1 : parallel_cores(), batch->masks, at };
        struct derive_result *result = derive_get(batch->derive, recipe, &way, &err);
        if (!result)
            log_warn("shape of region %s: %s", subject_id(derive_plan(batch->derive), recipe->subject), err.text);
        derive_result_unref(result);
    }
}

static void find_missing(struct batch *batch, const struct region_shape_recipe *recipes, size_t n)
{
    struct mask_wish *wishes = mem_new((n + 1) * sizeof *wishes);
    for (size_t i = 0; i < n; i++) {
        if (derive_has(batch->derive, &recipes[i].base))
            continue;
        wishes[batch->n_missing] =
            (struct mask_wish){ recipes[i].base.subject.index, recipes[i].key.has_inner_boundary };
        batch->missing[batch->n_missing++] = recipes[i];
    }
    batch->masks = region_masks_create(derive_plan(batch->derive), wishes, batch->n_missing, REGION_MASKS_BYTES);
    free(wishes);
}

void region_shapes_build(struct derive *derive, const struct region_shape_recipe *recipes, size_t n,
                         bool (*go_on)(void *context), void *context)
{
    struct batch batch = { .derive = derive, .go_on = go_on, .context = context };
    size_t n_threads = (size_t)parallel_cores();
    batch.missing = mem_new((n + 1) * sizeof *batch.missing);
    atomic_init(&batch.next, 0);
    atomic_init(&batch.is_over, false);
    find_missing(&batch, recipes, n);
    if (batch.n_missing > 0)
        parallel_run((int)(n_threads < batch.n_missing ? n_threads : batch.n_missing), build_next, &batch);
    region_masks_destroy(batch.masks);
    free(batch.missing);
}

static double box_of(const struct plan *plan, struct subject subject)
{
    const struct region *region = &plan->regions.regions[subject.index];
    double size = 1;
    for (int axis = 0; axis < 3; axis++)
        size *= (double)region->high_ijk[axis] - region->low_ijk[axis] + 1;
    return size;
}

/* An insertion sort: a plan has few regions. */
void region_shape_sort(const struct plan *plan, struct region_shape_recipe *recipes, size_t n)
{
    for (size_t i = 1; i < n; i++) {
        struct region_shape_recipe recipe = recipes[i];
        size_t at = i;
        for (; at > 0 && box_of(plan, recipes[at - 1].base.subject) < box_of(plan, recipe.base.subject); at--)
            recipes[at] = recipes[at - 1];
        recipes[at] = recipe;
    }
}
