/* Fair turns; see the header. */
#include "core/pipeline/turns.h"

#include <assert.h>
#include <stdlib.h>

#include "core/base/mem.h"

/* Sources that are remembered. A forgotten one counts as new, which gains it nothing: a new source starts with at most
 * TURNS_CREDIT_US of advantage. */
enum { MAX_SOURCES = 512 };

struct source {
    uint64_t id;
    int64_t used_us;
    bool is_active;   /* it has a request */
    bool is_entering; /* and had none at the choice before */
    size_t item;      /* its request that is next; SIZE_MAX: all are held */
};

struct turns {
    struct source sources[MAX_SOURCES];
    size_t n;
    int64_t n_active; /* sources with a request */
    int64_t floor_us; /* the least time that an active source has used; never falls */
};

struct turns *turns_create(void)
{
    return mem_new(sizeof(struct turns));
}

void turns_destroy(struct turns *turns)
{
    free(turns);
}

/* Adds a new source, in place of the inactive source that has used least if all places are taken. */
static struct source *add_source(struct turns *turns, uint64_t id)
{
    struct source *place = NULL;
    if (turns->n < MAX_SOURCES)
        place = &turns->sources[turns->n++];
    else
        for (struct source *other = turns->sources; other < turns->sources + turns->n; other++)
            if (!other->is_active && (!place || other->used_us < place->used_us))
                place = other;
    assert(place); /* fewer requests wait than sources are remembered */
    *place = (struct source){ .id = id, .used_us = turns->floor_us - TURNS_CREDIT_US };
    return place;
}

static struct source *known_source(struct turns *turns, uint64_t id)
{
    for (size_t i = 0; i < turns->n; i++)
        if (turns->sources[i].id == id)
            return &turns->sources[i];
    return NULL;
}

static struct source *find_source(struct turns *turns, uint64_t id)
{
    struct source *source = known_source(turns, id);
    return source ? source : add_source(turns, id);
}

/* True if the newer of two requests of one source goes first. */
static bool goes_before(const struct turns_item *item, const struct turns_item *older)
{
    if (item->is_still)
        return false;
    return older->is_still ? older->n_overtaken < TURNS_MAX_OVERTAKING
                           : item->is_acted && !older->is_acted && older->n_overtaken < TURNS_MAX_ACTED_OVERTAKING;
}

bool turns_may_interrupt(const struct turns_item *drawn, const struct turns_item *newcomer)
{
    return newcomer->source != drawn->source || (drawn->is_still && goes_before(newcomer, drawn));
}

/* Share of an advantage that each active source gets, in us. */
static int64_t advantage(const struct turns *turns, int64_t us)
{
    return turns->n_active > TURNS_FEW_SOURCES ? us * TURNS_FEW_SOURCES / turns->n_active : us;
}

/* A source that enters has saved no more than the credit. */
static void limit_credit(struct turns *turns)
{
    turns->n_active = 0;
    for (size_t i = 0; i < turns->n; i++)
        turns->n_active += turns->sources[i].is_active;
    int64_t least_us = turns->floor_us - advantage(turns, TURNS_CREDIT_US);
    for (struct source *source = turns->sources; source < turns->sources + turns->n; source++)
        if (source->is_active && source->is_entering && source->used_us < least_us)
            source->used_us = least_us;
}

static void activate(struct turns *turns, struct turns_item *const *items, size_t n)
{
    bool was_active[MAX_SOURCES] = { false };
    for (size_t i = 0; i < turns->n; i++) {
        was_active[i] = turns->sources[i].is_active;
        turns->sources[i].is_active = turns->sources[i].is_entering = false;
        turns->sources[i].item = SIZE_MAX;
    }
    for (size_t i = 0; i < n; i++) { /* before a source is added: one with a request keeps its place */
        struct source *source = known_source(turns, items[i]->source);
        if (!source || source->is_active)
            continue;
        source->is_active = true;
        source->is_entering = !was_active[source - turns->sources];
    }
    for (size_t i = 0; i < n; i++) {
        struct source *source = find_source(turns, items[i]->source);
        if (!source->is_active) { /* added just now */
            source->item = SIZE_MAX;
            source->is_entering = true;
        }
        source->is_active = true;
        if (!items[i]->is_held && (source->item == SIZE_MAX || goes_before(items[i], items[source->item])))
            source->item = i;
    }
    limit_credit(turns);
}

static int64_t key_of(const struct turns *turns, const struct source *source, struct turns_item *const *items)
{
    return source->used_us - (items[source->item]->is_still ? 0 : advantage(turns, TURNS_MOVING_AHEAD_US));
}

/* items[at] goes before older requests of its source: counts it for all stills, and of the moving pictures of other
 * views for the oldest, which is the next of them. */
static void count_overtaken(struct turns_item *const *items, size_t at)
{
    bool is_next = items[at]->is_acted;
    for (size_t i = 0; i < at; i++) {
        if (items[i]->source != items[at]->source || (!items[i]->is_still && (!is_next || items[i]->is_acted)))
            continue;
        items[i]->n_overtaken++;
        is_next = is_next && items[i]->is_still;
    }
}

size_t turns_choose(struct turns *turns, struct turns_item *const *items, size_t n)
{
    const struct source *best = NULL;
    int64_t least_us = INT64_MAX;
    activate(turns, items, n);
    for (size_t i = 0; i < turns->n; i++) {
        const struct source *source = &turns->sources[i];
        if (!source->is_active)
            continue;
        least_us = source->used_us < least_us ? source->used_us : least_us;
        if (source->item == SIZE_MAX)
            continue;
        int64_t key = key_of(turns, source, items), best_key = best ? key_of(turns, best, items) : INT64_MAX;
        if (!best || key < best_key || (key == best_key && source->item < best->item))
            best = source;
    }
    if (least_us != INT64_MAX && least_us > turns->floor_us)
        turns->floor_us = least_us;
    if (!best)
        return SIZE_MAX;
    struct turns_item *chosen = items[best->item];
    if (!chosen->is_begun && !chosen->is_still)
        count_overtaken(items, best->item);
    chosen->is_begun = true;
    return best->item;
}

void turns_charge(struct turns *turns, uint64_t source, int64_t cost_us)
{
    find_source(turns, source)->used_us += cost_us > 0 ? cost_us : 0;
}
