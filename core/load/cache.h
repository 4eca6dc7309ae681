#pragma once
/* A whole opened plan kept in one file, so that opening it again is reading and no decoding. The file is believed only
 * when the plan's folder holds the very files it was made from (name, size, inode, time to the nanosecond), when the
 * same version of the program wrote it and every checksum fits; it is treated as anybody's bytes all the same. */
#include <stdatomic.h>

#include "core/formats/folder.h"
#include "core/plan/plan.h"

#define PLAN_CACHE_NAME "plan.cache" /* in the cache folder; plan.cache.part while it is written */
enum {
    PLAN_CACHE_MAX_HEAD_MIB = 256, /* everything but voxels */
    PLAN_CACHE_MAX_MIB = 8192,     /* of the file; a larger plan is not kept */
    PLAN_CACHE_LEAVES_MIB = 256    /* on the disk; where there would be less, a plan is not kept */
};

/* The files of the plan's folder as they were before it was read. */
struct plan_sources;
/* NULL when there are too many to keep an eye on. Takes the tree. */
struct plan_sources *plan_sources_create(struct folder_tree *tree);
void plan_sources_destroy(struct plan_sources *sources);

/* Keeps an opened plan in a folder of its own, so that it opens fast as long as no file of its folder changes. At once
 * or not at all; an older one is replaced. Does nothing for a plan that came from there, or without sources. Any
 * thread. errors  ERROR_LIMIT too large (PLAN_CACHE_MAX_MIB), ERROR_IO, ERROR_MEMORY */
NODISCARD bool plan_cache_store(const struct plan *plan, const struct plan_sources *sources, const char *cache_folder,
                                struct error *err);

/* For the one who reads. */
struct plan_cache_reading {
    uint64_t max_bytes;                             /* of voxels; more is not read; 0: no limit */
    void (*begin)(void *context, uint64_t n_bytes); /* so many bytes are to be read; NULL: not wanted, as the next */
    void (*step)(void *context, uint64_t n_bytes);  /* so many more were read; any thread */
    void *context;
    const atomic_bool *cancel; /* may be NULL */
};
/* Fills the plan (all but id, shapes and load_us) and says true; false: nothing usable is there, and the plan is as it
 * was. */
NODISCARD bool plan_cache_read(const char *cache_folder, const struct plan_sources *sources,
                               const struct plan_cache_reading *reading, struct plan *plan);
