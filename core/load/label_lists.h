#pragma once
/* Inside core/load: which map of a folder without a plan.json a list of label names belongs to. */
#include <stdatomic.h>

#include "core/formats/folder.h"
#include "core/formats/plan_file.h"
#include "core/report/report.h"

/* The lists of a folder: each labels.json, and each .json called after a grid beside it. They are read up to a sum of
 * bytes, which is reported when it is met. When cancel (may be NULL) turns true the rest is left out. */
struct name_lists;
struct name_lists *name_lists_find(const struct folder *folder, const struct folder_tree *tree,
                                   const atomic_bool *cancel, struct report *report);
void name_lists_destroy(struct name_lists *lists);

/* Whether a list says by its "file" that it belongs to this map. */
bool name_lists_name(const struct name_lists *lists, const char *map);

/* Gives each label map among the plan file's regions the list that belongs to it: one that names the map; one called
 * after it, like parts.json beside parts.nii.gz; labels.json beside it when no other map could be meant. Maps that are
 * left without while there is a labels.json beside them, and lists whose map is not there, are reported. */
void name_lists_assign(const struct name_lists *lists, const struct folder *folder, struct plan_file *file,
                       struct report *report);
