#pragma once
/* Finds the plans in the configured folders, with a fingerprint of each. Opens no plan file. Any thread. */
#include <stddef.h>
#include <stdint.h>

#include "core/base/error.h"

enum { FOLDERS_MAX_PLANS = 2000, FOLDERS_MAX_ENTRIES = 20000 /* read in one folder */ };

struct plan_folder {
    char *path;           /* absolute, links resolved */
    char *name;           /* last part of the path, as listed */
    uint64_t fingerprint; /* changes when an entry directly inside is added, removed or written */
};

struct folder_list {
    struct plan_folder *folders; /* sorted by name within each configured folder */
    size_t n_folders;
    size_t n_left_out; /* beyond FOLDERS_MAX_PLANS */
    char problem[240]; /* the first configured folder that cannot be read, and why; "": none */
};

/* A configured folder is a plan itself if it holds plan.json, or files and no subfolders. Else each subfolder is a
 * plan; or, if it holds no plan.json but subfolders that do, each of those. Names that begin with a dot are ignored; a
 * folder that is reached twice is listed once. */
void folders_list(const char *const *given, size_t n_given, struct folder_list *list);
void folder_list_finish(struct folder_list *list);
/* An id for URLs from a name: [a-z0-9-], 1 to 63 characters. */
void folder_make_id(const char *name, char id[64]);
