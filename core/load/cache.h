#pragma once
/* Keeps an opened plan in one file, so that opening it again needs no decoding. The file is used only when the plan's
 * folder holds the same files (name, size, inode, time to the nanosecond), the same version of the program wrote it and
 * every checksum fits. Its content is checked like any other input all the same. */
#include <stdatomic.h>

#include "core/formats/folder.h"
#include "core/plan/plan.h"

#define PLAN_CACHE_NAME "plan.cache" /* in the cache folder; plan.cache.part while it is written */
enum {
    PLAN_CACHE_MAX_HEAD_MIB = 256, /* of the head: everything but voxels */
    PLAN_CACHE_MAX_MIB = 8192,     /* of the whole file; a larger plan is not kept */
    PLAN_CACHE_LEAVES_MIB = 256    /* must stay free on the disk; otherwise the plan is not kept */
};

/* The files of the plan's folder as they were before it was read. */
struct plan_sources;
/* Consumes the tree. Returns NULL when the tree is cut: then not all files can be compared later. */
struct plan_sources *plan_sources_create(struct folder_tree *tree);
void plan_sources_destroy(struct plan_sources *sources);

/* Writes the plan to PLAN_CACHE_NAME in the cache folder, which belongs to this plan alone; replaces an older file,
 * whole or not at all. Does nothing for a plan that was read from the cache, or without sources. Any thread. errors
 * ERROR_LIMIT more than PLAN_CACHE_MAX_MIB, or no room on the disk; ERROR_IO; ERROR_MEMORY */
NODISCARD bool plan_cache_store(const struct plan *plan, const struct plan_sources *sources, const char *cache_folder,
                                struct error *err);

/* Limit, progress and cancelling of plan_cache_read. */
struct plan_cache_reading {
    uint64_t max_bytes;                             /* of all voxels; a file with more is not read; 0: no limit */
    void (*begin)(void *context, uint64_t n_bytes); /* n_bytes will be read; may be NULL */
    void (*step)(void *context, uint64_t n_bytes);  /* n_bytes more were read; any thread; may be NULL */
    void *context;
    const atomic_bool *cancel; /* may be NULL */
};
/* Fills everything of the plan but id and load_us. Returns false when there is no usable file; the plan is then
 * unchanged. */
NODISCARD bool plan_cache_read(const char *cache_folder, const struct plan_sources *sources,
                               const struct plan_cache_reading *reading, struct plan *plan);
