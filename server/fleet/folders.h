#pragma once
/* Which plans lie in the folders given: names and a fingerprint of what is in each. Opens no plan file. */
#include <stddef.h>
#include <stdint.h>

#include "core/base/error.h"

enum { FOLDERS_MAX_PLANS = 2000, FOLDERS_MAX_ENTRIES = 20000 /* looked at in one folder */ };

struct plan_folder {
    char *path;           /* absolute, links resolved */
    char *name;           /* last part as listed */
    uint64_t fingerprint; /* changes when a file directly inside comes, goes, or is written */
};

struct folder_list {
    struct plan_folder *folders; /* sorted within each folder given */
    size_t n_folders;
    size_t n_left_out; /* beyond FOLDERS_MAX_PLANS */
    char problem[240]; /* a folder given that cannot be read; "" else */
};

/* A folder given is a plan when plan.json is in it, or when it has files and no subfolders; else each subfolder is one,
 * or, where it has no plan.json itself, each of its own subfolders that has. What begins with a dot is passed over; the
 * same folder twice counts once. */
void folders_list(const char *const *given, size_t n_given, struct folder_list *list);
void folder_list_finish(struct folder_list *list);
/* An id for URLs from a name: [a-z0-9-], 1 to 63 characters. */
void folder_make_id(const char *name, char id[64]);
