#pragma once
/* Where tests find real data, and folders of their own. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct volume;

/* BEAMROOM_DATA or ../shared/data, with name behind it; false when there is no such file: skip() then. */
bool data_path(const char *name, char *path, size_t size);
/* A new folder under TMPDIR, and files in it; their own folder is made where there is none. */
void folder_make(char path[256]);
void folder_put(const char *folder, const char *name, const void *data, size_t size);
void folder_put_text(const char *folder, const char *name, const char *text);
void folder_put_data(const char *folder, const char *name, const char *from); /* a copy of real data that are there */
void folder_put_volume(const char *folder, const char *name, struct volume *volume); /* as NIfTI; takes the volume */
void folder_remove(const char *folder);
/* A whole file with a zero behind it, for the caller to free; fails the test where there is none. */
uint8_t *file_bytes(const char *path, size_t *size);
