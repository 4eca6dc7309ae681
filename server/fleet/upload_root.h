#pragma once
/* Finds the plan's folder inside an unpacked archive, on a thread of its own: an archive may hold any number of files,
 * and listing them takes a disk. Knows nothing of plans. */
#include <stdint.h>

#include "core/base/error.h"

enum {
    ROOT_FINDER_MAX_WAITING = 64,
    ROOT_FINDER_MAX_WRAPPING = 8 /* nested folders that hold nothing but one folder, from the archive's top down */
};

struct root_finder;

/* wake: any thread, a result is ready to be taken. errors ERROR_IO */
NODISCARD struct root_finder *root_finder_create(void (*wake)(void *context), void *context, struct error *err);
/* Waits for the folder that is being listed. */
void root_finder_destroy(struct root_finder *finder);
/* Starts the search below this folder, for this upload's number. Returns false when too many wait. */
NODISCARD bool root_finder_find(struct root_finder *finder, uint64_t number, const char *folder);
/* A search that has ended: its number, and the folder or the one folder inside that holds everything else. The path is
 * the caller's. Returns NULL when there is none. Names that begin with a dot, and __MACOSX, do not count. */
NODISCARD char *root_finder_take(struct root_finder *finder, uint64_t *number);
