/* realpath, with a fallback for a confined process. */
#define _GNU_SOURCE
#include "core/base/path.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/base/mem.h"

char *path_resolve(const char *path)
{
    char *resolved = realpath(path, NULL);
    if (resolved || errno != EACCES || path[0] == '/' || access(path, F_OK) != 0)
        return resolved;
    return mem_copy_text(path);
}
