#pragma once
/* Finds the lists of label names in a folder without plan.json, and the label map that each belongs to. */
#include <stdatomic.h>

#include "core/formats/folder.h"
#include "core/formats/plan_file.h"
#include "core/report/report.h"

/* Reads the lists of a folder: each labels.json, and each .json called after a grid beside it. Reports when they exceed
 * a total size; further lists are not read, nor after cancel (may be NULL) has turned true. */
struct name_lists;
struct name_lists *name_lists_find(const struct folder *folder, const struct folder_tree *tree,
                                   const atomic_bool *cancel, struct report *report);
void name_lists_destroy(struct name_lists *lists);

/* True if the "file" of a list is this map. */
bool name_lists_has_map(const struct name_lists *lists, const char *map);

/* Gives each label map among the plan file's regions its list: the list whose "file" is the map; else the list called
 * after it, like parts.json beside parts.nii.gz; else labels.json beside it, when no other map could be meant. Reports
 * maps that stay without a list while a labels.json lies beside them, and lists whose map does not exist. */
void name_lists_assign(const struct name_lists *lists, const struct folder *folder, struct plan_file *file,
                       struct report *report);
