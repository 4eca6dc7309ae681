/* Opening a plan by its folder. */
#include "server/cli/open_plan.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "core/load/load.h"
#include "server/cli/exit_code.h"

static uint64_t max_bytes; /* 0: no limit */

bool command_take_limit(int *argc, char **argv)
{
    static const char option[] = "--max-mib";
    size_t n = sizeof option - 1;
    int kept = 1;
    for (int i = 1; i < *argc; i++) {
        if (strncmp(argv[i], option, n) != 0 || (argv[i][n] != 0 && argv[i][n] != '=')) {
            argv[kept++] = argv[i];
            continue;
        }
        const char *number = argv[i][n] == '=' ? argv[i] + n + 1 : i + 1 < *argc ? argv[++i] : "";
        char *end;
        errno = 0;
        unsigned long long mib = strtoull(number, &end, 10);
        if (number[0] < '0' || number[0] > '9' || *end || errno || mib > 1 << 24) {
            command_usage_error(argv[0], "--max-mib needs a number of MiB from 0 to %d, not '%s'", 1 << 24, number);
            return false;
        }
        max_bytes = (uint64_t)mib << 20;
    }
    argv[kept] = NULL;
    *argc = kept;
    return true;
}

struct plan *command_open_plan(const char *name, const char *folder)
{
    struct error err = { 0 };
    struct plan *plan = NULL;
    char *path = realpath(folder, NULL); /* so that "." gets the folder's name */
    if (!path) {
        error_set(&err, errno == ENOENT ? ERROR_NOT_FOUND : ERROR_IO, "%s: %s", folder, strerror(errno));
    } else {
        const char *slash = strrchr(path, '/');
        const struct region_set no_regions = { 0 }; /* a plan's id is made as a region's is */
        char id[REGION_ID_SIZE];
        region_make_id(&no_regions, slash ? slash + 1 : path, id);
        plan = plan_load(path, id, &(struct plan_load_options){ .max_bytes = max_bytes }, &err);
    }
    free(path);
    if (!plan)
        command_refused(name, &err);
    return plan;
}
