/* The cache of results that are built once; see the header. One mutex guards all of it; builds run without it. */
#include "core/base/once_cache.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

enum { N_BUCKETS = 256 };

struct entry {
    uint64_t hash;
    size_t n_key_bytes;
    void *result;  /* NULL while it is built */
    uint64_t used; /* the cache's clock when the result was last requested */
    struct entry *next;
    max_align_t key[];
};

struct refusal {
    uint64_t hash;
    size_t n_key_bytes;
    struct error why;
    struct refusal *next;
    max_align_t key[];
};

struct once_cache {
    const struct once_cache_type *type;
    pthread_mutex_t lock; /* guards everything below; never held during a build */
    pthread_cond_t built; /* an entry got its result or was removed */
    struct entry *buckets[N_BUCKETS];
    struct refusal *refusals; /* newest first */
    size_t n_refusals, n_results;
    uint64_t n_bytes, budget_bytes, clock;
};

struct once_cache *once_cache_create(const struct once_cache_type *type, uint64_t budget_bytes)
{
    struct once_cache *cache = mem_new(sizeof *cache);
    cache->type = type;
    cache->budget_bytes = budget_bytes;
    pthread_mutex_init(&cache->lock, NULL);
    pthread_cond_init(&cache->built, NULL);
    return cache;
}

static void forget_refusals(struct once_cache *cache)
{
    for (struct refusal *refusal = cache->refusals, *next; refusal; refusal = next) {
        next = refusal->next;
        free(refusal);
    }
    cache->refusals = NULL;
    cache->n_refusals = 0;
}

void once_cache_destroy(struct once_cache *cache)
{
    if (!cache)
        return;
    for (size_t b = 0; b < N_BUCKETS; b++)
        for (struct entry *entry = cache->buckets[b], *next; entry; entry = next) {
            next = entry->next;
            if (entry->result)
                cache->type->unref(entry->result);
            free(entry);
        }
    forget_refusals(cache);
    pthread_cond_destroy(&cache->built);
    pthread_mutex_destroy(&cache->lock);
    free(cache);
}

/* ---- entries; the lock is held ---------------------------------------------------------------------------------- */

static struct entry *find(struct once_cache *cache, const struct once_key *key)
{
    for (struct entry *entry = cache->buckets[key->hash % N_BUCKETS]; entry; entry = entry->next)
        if (entry->hash == key->hash && entry->n_key_bytes == key->n_bytes &&
            cache->type->is_equal(entry->key, key->bytes))
            return entry;
    return NULL;
}

static const struct refusal *find_refusal(const struct once_cache *cache, const struct once_key *key)
{
    for (const struct refusal *refusal = cache->refusals; refusal; refusal = refusal->next)
        if (refusal->hash == key->hash && refusal->n_key_bytes == key->n_bytes &&
            cache->type->is_equal(refusal->key, key->bytes))
            return refusal;
    return NULL;
}

static void add_refusal(struct once_cache *cache, const struct once_key *key, const struct error *why)
{
    if (cache->n_refusals == ONCE_CACHE_MAX_REFUSALS)
        forget_refusals(cache); /* each is found again by the next build of its key */
    struct refusal *refusal = mem_new(sizeof *refusal + key->n_bytes);
    refusal->hash = key->hash;
    refusal->n_key_bytes = key->n_bytes;
    refusal->why = *why;
    memcpy(refusal->key, key->bytes, key->n_bytes);
    refusal->next = cache->refusals;
    cache->refusals = refusal;
    cache->n_refusals++;
}

/* Without a result: tells other threads that it is being built, and is not dropped. */
static struct entry *add(struct once_cache *cache, const struct once_key *key)
{
    struct entry *entry = mem_new(sizeof *entry + key->n_bytes);
    struct entry **bucket = &cache->buckets[key->hash % N_BUCKETS];
    entry->hash = key->hash;
    entry->n_key_bytes = key->n_bytes;
    memcpy(entry->key, key->bytes, key->n_bytes);
    entry->next = *bucket;
    *bucket = entry;
    return entry;
}

static void drop(struct once_cache *cache, struct entry *entry)
{
    struct entry **link = &cache->buckets[entry->hash % N_BUCKETS];
    while (*link != entry)
        link = &(*link)->next;
    *link = entry->next;
    if (entry->result) {
        cache->n_results--;
        cache->n_bytes -= cache->type->n_bytes(entry->result);
        cache->type->unref(entry->result);
    }
    free(entry);
}

static void fill(struct once_cache *cache, struct entry *entry, void *result)
{
    entry->result = result;
    entry->used = ++cache->clock;
    cache->n_results++;
    cache->n_bytes += cache->type->n_bytes(result);
}

static struct entry *least_recently_used(struct once_cache *cache)
{
    struct entry *oldest = NULL;
    for (size_t b = 0; b < N_BUCKETS; b++)
        for (struct entry *entry = cache->buckets[b]; entry; entry = entry->next)
            if (entry->result && entry->used < cache->clock && (!oldest || entry->used < oldest->used) &&
                cache->type->n_bytes(entry->result) > 0)
                oldest = entry;
    return oldest;
}

/* Never drops the result that was used last: see once_cache_get. */
static void keep_within_budget(struct once_cache *cache)
{
    while (cache->n_bytes > cache->budget_bytes) {
        struct entry *oldest = least_recently_used(cache);
        if (!oldest)
            return;
        drop(cache, oldest);
    }
}

/* Releases the lock during the build. NULL on failure. */
static struct entry *build_entry(struct once_cache *cache, const struct once_key *key, once_cache_build *build,
                                 void *context, struct error *err)
{
    struct error why = { 0 };
    struct entry *entry = add(cache, key);
    pthread_mutex_unlock(&cache->lock);
    void *result = build(context, &why);
    pthread_mutex_lock(&cache->lock);
    if (result) {
        fill(cache, entry, result);
    } else {
        drop(cache, entry);
        if (cache->type->is_final && cache->type->is_final(why.code))
            add_refusal(cache, key, &why);
        if (err)
            *err = why;
        entry = NULL;
    }
    pthread_cond_broadcast(&cache->built);
    return entry;
}

/* ---- from outside ----------------------------------------------------------------------------------------------- */

void *once_cache_get(struct once_cache *cache, const struct once_key *key, once_cache_build *build, void *context,
                     struct error *err)
{
    void *result = NULL;
    pthread_mutex_lock(&cache->lock);
    struct entry *entry = find(cache, key);
    while (entry && !entry->result) {
        pthread_cond_wait(&cache->built, &cache->lock);
        entry = find(cache, key); /* removed if the build failed */
    }
    const struct refusal *refusal = entry ? NULL : find_refusal(cache, key);
    if (entry)
        entry->used = ++cache->clock;
    else if (!refusal)
        entry = build_entry(cache, key, build, context, err);
    else if (err)
        *err = refusal->why;
    if (entry) {
        result = entry->result;
        cache->type->ref(result);
        keep_within_budget(cache);
    }
    pthread_mutex_unlock(&cache->lock);
    return result;
}

void once_cache_offer(struct once_cache *cache, const struct once_key *key, void *result)
{
    pthread_mutex_lock(&cache->lock);
    if (!find(cache, key)) {
        cache->type->ref(result);
        fill(cache, add(cache, key), result);
        keep_within_budget(cache);
    }
    pthread_mutex_unlock(&cache->lock);
}

bool once_cache_has(struct once_cache *cache, const struct once_key *key)
{
    pthread_mutex_lock(&cache->lock);
    bool has = find(cache, key) || find_refusal(cache, key);
    pthread_mutex_unlock(&cache->lock);
    return has;
}

bool once_cache_is_ready(struct once_cache *cache, const struct once_key *key)
{
    pthread_mutex_lock(&cache->lock);
    const struct entry *entry = find(cache, key);
    bool is_ready = entry ? entry->result != NULL : find_refusal(cache, key) != NULL;
    pthread_mutex_unlock(&cache->lock);
    return is_ready;
}

bool once_cache_is_refused(struct once_cache *cache, const struct once_key *key, struct error *why)
{
    pthread_mutex_lock(&cache->lock);
    const struct refusal *refusal = find_refusal(cache, key);
    if (refusal)
        *why = refusal->why;
    pthread_mutex_unlock(&cache->lock);
    return refusal != NULL;
}

bool once_cache_has_refusals(struct once_cache *cache)
{
    pthread_mutex_lock(&cache->lock);
    bool has_some = cache->n_refusals > 0;
    pthread_mutex_unlock(&cache->lock);
    return has_some;
}

void once_cache_drop_alike(struct once_cache *cache, const struct once_key *key,
                           bool (*is_alike)(const void *a, const void *b))
{
    size_t n_others = ONCE_CACHE_ALIKE;
    pthread_mutex_lock(&cache->lock);
    const struct entry *own = find(cache, key);
    while (n_others >= ONCE_CACHE_ALIKE) {
        struct entry *oldest = NULL;
        n_others = 0;
        for (struct entry *entry = cache->buckets[key->hash % N_BUCKETS]; entry; entry = entry->next)
            if (entry != own && entry->result && entry->hash == key->hash && entry->n_key_bytes == key->n_bytes &&
                is_alike(entry->key, key->bytes)) {
                n_others++;
                oldest = !oldest || entry->used < oldest->used ? entry : oldest;
            }
        if (n_others >= ONCE_CACHE_ALIKE)
            drop(cache, oldest);
    }
    pthread_mutex_unlock(&cache->lock);
}

void once_cache_set_budget(struct once_cache *cache, uint64_t budget_bytes)
{
    pthread_mutex_lock(&cache->lock);
    cache->budget_bytes = budget_bytes;
    keep_within_budget(cache);
    pthread_mutex_unlock(&cache->lock);
}

void once_cache_usage(struct once_cache *cache, struct once_cache_usage *usage)
{
    pthread_mutex_lock(&cache->lock);
    *usage = (struct once_cache_usage){ cache->n_results, cache->n_bytes, cache->budget_bytes };
    pthread_mutex_unlock(&cache->lock);
}
