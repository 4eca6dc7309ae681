#pragma once
/* The daemon's own folders below the data folder: data/cache, data/plans (uploaded plans), data/uploads (archives on
 * their way). Makes them at start, and throws away what lies there. Internal to server/fleet; net thread. */
#include "server/fleet/plan_entry.h"

/* Makes the folders and clears what an earlier daemon left in data/uploads.
 *   errors ERROR_IO, ERROR_LIMIT (the path is too long) */
NODISCARD bool data_folders_create(struct fleet *fleet, struct error *err);
void data_folders_destroy(struct fleet *fleet); /* stops removing; the folders stay */
/* Moves a file or folder of the data folder into data/uploads at once; a thread removes it there. Returns false with
 * errno when it could not be moved. */
bool data_throw_away(struct fleet *fleet, const char *path);
/* "folder/name", to be freed. */
char *path_inside(const char *folder, const char *name);
