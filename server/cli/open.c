#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "server/cli/command.h"

struct plan *command_open_plan(const char *name, const char *folder)
{
    struct error err = { 0 };
    struct plan *plan = NULL;
    char *path = realpath(folder, NULL); /* "." has a name too */
    if (!path) {
        error_set(&err, errno == ENOENT ? ERROR_NOT_FOUND : ERROR_IO, "%s: %s", folder, strerror(errno));
    } else {
        const char *slash = strrchr(path, '/');
        const struct region_set no_regions = { 0 }; /* ids of plans and regions are made alike */
        char id[REGION_ID_SIZE];
        region_make_id(&no_regions, slash ? slash + 1 : path, id);
        plan = plan_load(path, id, NULL, &err);
    }
    free(path);
    if (!plan)
        command_refused(name, &err);
    return plan;
}
