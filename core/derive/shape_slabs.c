/* Keeps the indices of shapes' triangles along patient axes in the store. */
#include "core/derive/shape_slabs.h"

#include <stdlib.h>

#include "core/base/mem.h"

struct recipe {
    struct derive_recipe base;
    struct shape_key key; /* normalised */
    int axis;
};

static bool is_equal(const struct derive_recipe *left, const struct derive_recipe *right)
{
    const struct recipe *a = (const struct recipe *)left, *b = (const struct recipe *)right;
    return a->axis == b->axis && shape_key_equal(&a->key, &b->key);
}

static void destroy(struct derive_result *base)
{
    struct shape_slabs *result = (struct shape_slabs *)base;
    mesh_slabs_destroy(result->slabs);
    free(result);
}

static struct derive_result *build(struct derive *derive, const struct derive_recipe *base, const void *way,
                                   struct error *err);

static const struct derive_kind kind = { sizeof(struct recipe), is_equal, build, destroy };

/* way: the shape, which the recipe names. */
static struct derive_result *build(struct derive *derive, const struct derive_recipe *base, const void *way,
                                   struct error *err)
{
    const struct shape *shape = way;
    struct mesh_slabs *slabs = mesh_slabs_create(shape->mesh, ((const struct recipe *)base)->axis, err);
    (void)derive;
    if (!slabs)
        return NULL;
    struct shape_slabs *result = mem_new(sizeof *result);
    derive_result_init(&result->base, &kind, sizeof *result + slabs->n_bytes);
    result->slabs = slabs;
    return &result->base;
}

struct shape_slabs *shape_slabs_get(struct derive *derive, const struct shape_want *want, const struct shape *shape,
                                    int axis, struct error *err)
{
    struct recipe recipe = { { &kind, want->subject }, want->key, axis };
    shape_key_normalise(&recipe.key);
    return (struct shape_slabs *)derive_get(derive, &recipe.base, shape, err);
}
