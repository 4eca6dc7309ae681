/* Makes data/cache, data/plans and data/uploads at start, and hands files and folders to be deleted to the remover. */
#include "server/fleet/data_folders.h"

#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "core/base/path.h"
#include "server/fleet/remover.h"

char *path_inside(const char *folder, const char *name)
{
    size_t n = strlen(folder) + strlen(name) + 2;
    char *path = mem_new(n);
    (void)snprintf(path, n, "%s/%s", folder, name);
    return path;
}

bool data_throw_away(struct fleet *fleet, const char *path)
{
    char name[96];
    (void)snprintf(name, sizeof name, "trash-%lld-%d-%llu", (long long)clock_now_us(), (int)getpid(),
                   (unsigned long long)++fleet->n_trash);
    char *trash = path_inside(fleet->uploads_home, name);
    if (rename(path, trash) != 0) {
        free(trash);
        return false;
    }
    remover_put(fleet->remover, trash);
    return true;
}

static bool make_cache_folder(const char *data, struct error *err)
{
    char path[PATH_MAX];
    int n = snprintf(path, sizeof path, "%s/cache", data);
    if (n < 0 || (size_t)n >= sizeof path - PLAN_ID_SIZE - 1)
        return error_set(err, ERROR_LIMIT, "the data folder's path is too long");
    if (mkdir(path, 0700) != 0 && errno != EEXIST)
        return error_set(err, ERROR_IO, "%s cannot be made: %s", path, strerror(errno));
    return true;
}

static char *make_folder(const struct fleet *fleet, const char *name, struct error *err)
{
    char *path = path_inside(fleet->data_folder, name), *real = NULL;
    if (mkdir(path, 0700) != 0 && errno != EEXIST)
        error_set(err, ERROR_IO, "%s cannot be made: %s", path, strerror(errno));
    else if (!(real = path_resolve(path)))
        error_set(err, ERROR_IO, "%s: %s", path, strerror(errno));
    else if (strlen(real) > PATH_MAX / 2) {
        error_set(err, ERROR_LIMIT, "the data folder's path is too long");
        free(real);
        real = NULL;
    }
    free(path);
    return real;
}

static bool clear_leftovers(struct fleet *fleet, struct error *err)
{
    DIR *folder = opendir(fleet->uploads_home);
    if (!folder)
        return error_set(err, ERROR_IO, "%s: %s", fleet->uploads_home, strerror(errno));
    char **names =
        mem_new(REMOVER_MAX_WAITING * sizeof *names); /* moved after the listing: a moved one would be listed again */
    size_t n = 0;
    for (const struct dirent *entry; n < REMOVER_MAX_WAITING && (entry = readdir(folder));)
        if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0)
            names[n++] = mem_copy_text(entry->d_name);
    closedir(folder);
    for (size_t i = 0; i < n; i++) {
        char *path = path_inside(fleet->uploads_home, names[i]);
        if (!data_throw_away(fleet, path))
            log_warn("a leftover in %s cannot be moved: %s", fleet->uploads_home, strerror(errno));
        free(path);
        free(names[i]);
    }
    free(names);
    if (n > 0)
        log_info("%zu leftovers of uploads are removed", n);
    return true;
}

bool data_folders_create(struct fleet *fleet, struct error *err)
{
    if (!make_cache_folder(fleet->data_folder, err))
        return false;
    fleet->plans_home = make_folder(fleet, "plans", err);
    fleet->uploads_home = fleet->plans_home ? make_folder(fleet, "uploads", err) : NULL;
    fleet->remover = fleet->uploads_home ? remover_create(err) : NULL;
    return fleet->remover && clear_leftovers(fleet, err);
}

void data_folders_destroy(struct fleet *fleet)
{
    remover_destroy(fleet->remover);
    free(fleet->plans_home);
    free(fleet->uploads_home);
}
