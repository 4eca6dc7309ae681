#define _GNU_SOURCE
#include "tests/unit/data_folder.h"

#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

bool data_path(const char *name, char *path, size_t size)
{
    const char *root = getenv("BEAMROOM_DATA");
    snprintf(path, size, "%s/%s", root ? root : "../shared/data", name);
    return access(path, R_OK) == 0;
}

void folder_make(char path[256])
{
    const char *root = getenv("TMPDIR");
    snprintf(path, 256, "%s/beamroom-test-XXXXXX", root ? root : "/tmp");
    if (!mkdtemp(path))
        abort();
}

void folder_put(const char *folder, const char *name, const void *data, size_t size)
{
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    char *slash = strrchr(path, '/');
    *slash = 0;
    mkdir(path, 0700);
    *slash = '/';
    FILE *file = fopen(path, "wb");
    if (!file || fwrite(data, 1, size, file) != size || fclose(file) != 0)
        abort();
}

static int remove_one(const char *path, const struct stat *about, int kind, struct FTW *where)
{
    (void)about;
    (void)kind;
    (void)where;
    return remove(path);
}

void folder_remove(const char *folder)
{
    nftw(folder, remove_one, 16, FTW_DEPTH | FTW_PHYS);
}
