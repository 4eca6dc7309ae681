#pragma once
/* What renderers keep on disk, data/cache/<plan id>, stays within a quota. A thread of its own looks at the folders of
 * running renderers every second. A renderer may be in the hands of a hostile file: what it writes is measured here,
 * not asked of it. */
#include <stdint.h>

#include "core/base/error.h"

enum {
    CACHE_LOOK_MS = 1000,
    CACHE_MAX_FILES = 20000, /* in one plan's folder, folders counted; an honest one has some hundred shaders */
    CACHE_MAX_DEPTH = 16,    /* folders in folders there */
    CACHE_LEAST_FILE =
        64 << 20 /* a renderer may write files of this size at least: drivers make buffers as files in memory */
};

struct cache_options {
    const char *folder; /* data/cache */
    uint64_t max_bytes; /* of all plans together; 0: 16 GiB. A single plan's may be 64 MiB more: shaders beside a kept
                           plan */
    uint64_t reserve_bytes; /* what is left free on the disk */
    /* End the process, for the reason; from the thread. */
    void (*end)(void *context, uint64_t process, const char *reason);
    void *context;
};

struct cache;
NODISCARD struct cache *cache_create(const struct cache_options *options, struct error *err);
void cache_destroy(struct cache *cache);
/* The largest file a renderer may write: half of what a plan may have, as a kept plan is written beside the one it
 * replaces. */
uint64_t cache_max_file(const struct cache *cache);
/* A renderer of the plan is about to start; a process has ended, whatever it was. */
void cache_begin(struct cache *cache, const char *plan_id, uint64_t process);
void cache_end(struct cache *cache, uint64_t process);
