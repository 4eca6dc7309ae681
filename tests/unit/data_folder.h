#pragma once
/* Where tests find real data, and folders of their own. */
#include <stdbool.h>
#include <stddef.h>

/* BEAMROOM_DATA or ../shared/data, with name behind it; false when there is no such file: skip() then. */
bool data_path(const char *name, char *path, size_t size);
/* A new folder under TMPDIR, and files in it; text NULL: only the path. */
void folder_make(char path[256]);
void folder_put(const char *folder, const char *name, const void *data, size_t size);
void folder_remove(const char *folder);
