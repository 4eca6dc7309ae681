#include "core/plan/plan_shapes.h"

#include <pthread.h>
#include <stdlib.h>

#include "core/base/mem.h"

struct entry {
    struct shape_name name;
    struct shape *shape; /* NULL while it is built */
    struct surface_facts facts;
    uint64_t used; /* when last, on the clock of uses */
    struct entry *next;
};

struct refusal { /* a shape that cannot be had */
    struct shape_name name;
    struct error why;
    struct refusal *next;
};

struct plan_shapes {
    pthread_mutex_t lock; /* of all below; never held while something is built */
    pthread_cond_t built; /* an entry got its shape or went away */
    struct entry *entries;
    struct refusal *refusals; /* the newest first */
    size_t n_refusals;
    uint64_t n_bytes, budget_bytes, clock;
    struct {
        pthread_mutex_t lock; /* held while it is decided */
        uint32_t reduction;   /* 0: not decided yet */
    } light[SURFACE_N_ALGORITHMS];
};

struct plan_shapes *plan_shapes_create(uint64_t budget_bytes)
{
    struct plan_shapes *shapes = mem_new(sizeof *shapes);
    pthread_mutex_init(&shapes->lock, NULL);
    pthread_cond_init(&shapes->built, NULL);
    for (int algorithm = 0; algorithm < SURFACE_N_ALGORITHMS; algorithm++)
        pthread_mutex_init(&shapes->light[algorithm].lock, NULL);
    shapes->budget_bytes = budget_bytes;
    return shapes;
}

static void forget_refusals(struct plan_shapes *shapes)
{
    for (struct refusal *refusal = shapes->refusals, *next; refusal; refusal = next) {
        next = refusal->next;
        free(refusal);
    }
    shapes->refusals = NULL;
    shapes->n_refusals = 0;
}

void plan_shapes_destroy(struct plan_shapes *shapes)
{
    if (!shapes)
        return;
    for (struct entry *entry = shapes->entries, *next; entry; entry = next) {
        next = entry->next;
        shape_unref(entry->shape);
        free(entry);
    }
    forget_refusals(shapes);
    for (int algorithm = 0; algorithm < SURFACE_N_ALGORITHMS; algorithm++)
        pthread_mutex_destroy(&shapes->light[algorithm].lock);
    pthread_cond_destroy(&shapes->built);
    pthread_mutex_destroy(&shapes->lock);
    free(shapes);
}

static bool is_same(const struct shape_name *a, const struct shape_name *b)
{
    return a->region == b->region && a->detail == b->detail && shape_key_equal(&a->key, &b->key);
}

static struct entry *find(struct plan_shapes *shapes, const struct shape_name *name)
{
    for (struct entry *entry = shapes->entries; entry; entry = entry->next)
        if (is_same(&entry->name, name))
            return entry;
    return NULL;
}

static const struct refusal *find_refusal(const struct plan_shapes *shapes, const struct shape_name *name)
{
    for (const struct refusal *refusal = shapes->refusals; refusal; refusal = refusal->next)
        if (is_same(&refusal->name, name))
            return refusal;
    return NULL;
}

/* Begins anew when there are too many: each is found again when it is asked for. */
static void add_refusal(struct plan_shapes *shapes, const struct shape_name *name, const struct error *why)
{
    if (shapes->n_refusals == PLAN_MAX_REFUSALS)
        forget_refusals(shapes);
    struct refusal *refusal = mem_new(sizeof *refusal);
    *refusal = (struct refusal){ *name, *why, shapes->refusals };
    shapes->refusals = refusal;
    shapes->n_refusals++;
}

static struct entry *add(struct plan_shapes *shapes, const struct shape_name *name)
{
    struct entry *entry = mem_new(sizeof *entry);
    entry->name = *name;
    entry->next = shapes->entries;
    shapes->entries = entry;
    return entry;
}

static void drop(struct plan_shapes *shapes, struct entry *entry)
{
    struct entry **link = &shapes->entries;
    while (*link != entry)
        link = &(*link)->next;
    *link = entry->next;
    if (entry->shape)
        shapes->n_bytes -= entry->shape->n_bytes;
    shape_unref(entry->shape);
    free(entry);
}

/* Drops what was not used for longest until the rest fits; never the one that was just used, or whoever asks for it in
 * turn with another would build without end. */
static void keep_within_budget(struct plan_shapes *shapes)
{
    while (shapes->n_bytes > shapes->budget_bytes) {
        struct entry *oldest = NULL;
        for (struct entry *entry = shapes->entries; entry; entry = entry->next)
            if (entry->shape && entry->used < shapes->clock && (!oldest || entry->used < oldest->used))
                oldest = entry;
        if (!oldest)
            return;
        drop(shapes, oldest);
    }
}

static void fill(struct plan_shapes *shapes, struct entry *entry, struct shape *shape,
                 const struct surface_facts *facts)
{
    entry->shape = shape;
    entry->facts = *facts;
    entry->used = ++shapes->clock;
    shapes->n_bytes += shape->n_bytes;
}

struct shape *plan_shapes_get(struct plan_shapes *shapes, const struct shape_name *name, plan_shape_build *build,
                              void *context, struct surface_facts *facts, struct error *err)
{
    struct shape *shape = NULL;
    struct error why = { 0 };
    pthread_mutex_lock(&shapes->lock);
    struct entry *entry = find(shapes, name);
    while (entry && !entry->shape) {
        pthread_cond_wait(&shapes->built, &shapes->lock);
        entry = find(shapes, name); /* it may be gone: the build failed */
    }
    const struct refusal *refusal = entry ? NULL : find_refusal(shapes, name);
    if (entry) {
        entry->used = ++shapes->clock;
    } else if (refusal) {
        if (err)
            *err = refusal->why;
        pthread_mutex_unlock(&shapes->lock);
        return NULL;
    } else {
        entry = add(shapes,
                    name); /* without a shape: says to others that it is being built, and is dropped by nobody else */
        struct surface_facts built = { 0 };
        pthread_mutex_unlock(&shapes->lock);
        shape = build(context, name, &built, &why);
        pthread_mutex_lock(&shapes->lock);
        if (shape)
            fill(shapes, entry, shape, &built);
        else
            drop(shapes, entry);
        if (!shape && plan_is_refusal(why.code))
            add_refusal(shapes, name, &why);
        if (!shape && err)
            *err = why;
        pthread_cond_broadcast(&shapes->built);
        if (!shape) {
            pthread_mutex_unlock(&shapes->lock);
            return NULL;
        }
    }
    shape = shape_ref(entry->shape);
    *facts = entry->facts;
    keep_within_budget(shapes);
    pthread_mutex_unlock(&shapes->lock);
    return shape;
}

bool plan_is_refusal(enum error_code code)
{
    return code == ERROR_UNSUPPORTED || code == ERROR_LIMIT || code == ERROR_RANGE || code == ERROR_FORMAT;
}

bool plan_shapes_refused(struct plan_shapes *shapes, const struct shape_name *name, struct error *why)
{
    pthread_mutex_lock(&shapes->lock);
    const struct refusal *refusal = find_refusal(shapes, name);
    if (refusal)
        *why = refusal->why;
    pthread_mutex_unlock(&shapes->lock);
    return refusal != NULL;
}

bool plan_shapes_refused_some(struct plan_shapes *shapes)
{
    pthread_mutex_lock(&shapes->lock);
    bool has_some = shapes->n_refusals > 0;
    pthread_mutex_unlock(&shapes->lock);
    return has_some;
}

bool plan_shapes_has(struct plan_shapes *shapes, const struct shape_name *name)
{
    pthread_mutex_lock(&shapes->lock);
    bool has = find(shapes, name) || find_refusal(shapes, name);
    pthread_mutex_unlock(&shapes->lock);
    return has;
}

void plan_shapes_offer(struct plan_shapes *shapes, const struct shape_name *name, const struct shape *shape,
                       const struct surface_facts *facts)
{
    pthread_mutex_lock(&shapes->lock);
    if (!find(shapes, name)) {
        fill(shapes, add(shapes, name), shape_ref(shape), facts);
        keep_within_budget(shapes);
    }
    pthread_mutex_unlock(&shapes->lock);
}

void plan_shapes_set_budget(struct plan_shapes *shapes, uint64_t budget_bytes)
{
    pthread_mutex_lock(&shapes->lock);
    shapes->budget_bytes = budget_bytes;
    keep_within_budget(shapes);
    pthread_mutex_unlock(&shapes->lock);
}

void plan_shapes_usage(struct plan_shapes *shapes, struct plan_shape_usage *usage)
{
    pthread_mutex_lock(&shapes->lock);
    *usage = (struct plan_shape_usage){ .n_bytes = shapes->n_bytes, .budget_bytes = shapes->budget_bytes };
    for (struct entry *entry = shapes->entries; entry; entry = entry->next)
        usage->n_shapes += entry->shape != NULL;
    pthread_mutex_unlock(&shapes->lock);
}

uint32_t plan_shapes_reduction(struct plan_shapes *shapes, enum surface_algorithm algorithm,
                               uint32_t (*decide)(void *context, struct error *err), void *context, struct error *err)
{
    pthread_mutex_lock(&shapes->light[algorithm].lock);
    if (shapes->light[algorithm].reduction == 0)
        shapes->light[algorithm].reduction = decide(context, err);
    uint32_t reduction = shapes->light[algorithm].reduction;
    pthread_mutex_unlock(&shapes->light[algorithm].lock);
    return reduction;
}
