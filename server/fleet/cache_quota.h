#pragma once
/* Keeps data/cache/<plan id>, where renderers write, within a quota. A thread of its own measures the folders of
 * running renderers every second: a hostile plan file may have taken over a renderer, so its own figures are not used.
 */
#include <stdint.h>

#include "core/base/error.h"

enum {
    CACHE_QUOTA_LOOK_MS = 1000,
    CACHE_QUOTA_MAX_FILES = 20000, /* files and folders in one plan's folder; a regular one has some hundred shaders */
    CACHE_QUOTA_MAX_DEPTH = 16,    /* nested folders there */
    CACHE_QUOTA_LEAST_FILE =
        64 << 20 /* the size of file that a renderer may always write: drivers create buffers as files in memory */
};

struct cache_quota_options {
    const char *folder; /* data/cache */
    uint64_t max_bytes; /* of all plans together; 0: 16 GiB. A single plan may have 64 MiB more, for shaders beside a
                           kept plan */
    uint64_t reserve_bytes; /* left free on the disk */
    /* Ends the process, with the reason; called on the cache's thread. */
    void (*end)(void *context, uint64_t process, const char *reason);
    void *context;
};

struct cache_quota;
NODISCARD struct cache_quota *cache_quota_create(const struct cache_quota_options *options, struct error *err);
void cache_quota_destroy(struct cache_quota *quota);
/* The largest file that a renderer may write: half of max_bytes, because a kept plan is written beside the one it
 * replaces. */
uint64_t cache_quota_max_file(const struct cache_quota *quota);
/* A renderer of the plan is about to start; a process, of whatever kind, has ended. Never waits. */
void cache_quota_begin(struct cache_quota *quota, const char *plan_id, uint64_t process);
void cache_quota_end(struct cache_quota *quota, uint64_t process);
