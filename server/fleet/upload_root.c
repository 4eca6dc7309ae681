/* The thread that walks down from an archive's top while each folder holds nothing but one folder. */
#include "server/fleet/upload_root.h"

#include <dirent.h>
#include <fcntl.h>
#include <limits.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "core/base/mem.h"
#include "core/base/queue.h"

struct search {
    uint64_t number;
    char *path; /* the folder; then the result */
};

struct root_finder {
    pthread_t thread;
    struct queue *waiting, *done;
    void (*wake)(void *context);
    void *context;
};

static void search_destroy(void *item)
{
    struct search *search = item;
    free(search->path);
    free(search);
}

/* True if a folder holds nothing but one folder, whose name is filled in. */
static bool find_only_folder(const char *path, char name[NAME_MAX + 1])
{
    DIR *folder = opendir(path);
    size_t n = 0;
    bool is_folder = false;
    if (!folder)
        return false;
    for (const struct dirent *entry; n < 2 && (entry = readdir(folder));) {
        struct stat facts;
        if (entry->d_name[0] == '.' || strcmp(entry->d_name, "__MACOSX") == 0)
            continue;
        n++;
        is_folder = fstatat(dirfd(folder), entry->d_name, &facts, AT_SYMLINK_NOFOLLOW) == 0 && S_ISDIR(facts.st_mode);
        (void)snprintf(name, NAME_MAX + 1, "%s", entry->d_name);
    }
    closedir(folder);
    return n == 1 && is_folder;
}

static void find_root(struct search *search)
{
    char name[NAME_MAX + 1];
    for (int i = 0; i < ROOT_FINDER_MAX_WRAPPING && find_only_folder(search->path, name); i++) {
        size_t n = strlen(search->path) + strlen(name) + 2;
        char *inner = mem_new(n);
        (void)snprintf(inner, n, "%s/%s", search->path, name);
        free(search->path);
        search->path = inner;
    }
}

static void *work(void *argument)
{
    struct root_finder *finder = argument;
    for (struct search *search; (search = queue_take(finder->waiting, -1));) {
        find_root(search);
        if (!queue_try_put(finder->done, search))
            search_destroy(search); /* cannot be: the fleet has fewer uploads */
        finder->wake(finder->context);
    }
    return NULL;
}

struct root_finder *root_finder_create(void (*wake)(void *context), void *context, struct error *err)
{
    struct root_finder *finder = mem_new(sizeof *finder);
    finder->wake = wake;
    finder->context = context;
    finder->waiting = queue_create(ROOT_FINDER_MAX_WAITING, search_destroy);
    finder->done = queue_create(2 * ROOT_FINDER_MAX_WAITING, search_destroy);
    int failed = pthread_create(&finder->thread, NULL, work, finder);
    if (!failed)
        return finder;
    error_set(err, ERROR_IO, "the thread that looks into uploads cannot be started: %s", strerror(failed));
    queue_destroy(finder->waiting);
    queue_destroy(finder->done);
    free(finder);
    return NULL;
}

void root_finder_destroy(struct root_finder *finder)
{
    if (!finder)
        return;
    queue_close(finder->waiting);
    pthread_join(finder->thread, NULL);
    queue_destroy(finder->waiting);
    queue_destroy(finder->done);
    free(finder);
}

bool root_finder_find(struct root_finder *finder, uint64_t number, const char *folder)
{
    struct search *search = mem_new(sizeof *search);
    *search = (struct search){ number, mem_copy_text(folder) };
    if (queue_try_put(finder->waiting, search))
        return true;
    search_destroy(search);
    return false;
}

char *root_finder_take(struct root_finder *finder, uint64_t *number)
{
    struct search *search = queue_try_take(finder->done);
    if (!search)
        return NULL;
    char *path = search->path;
    *number = search->number;
    free(search);
    return path;
}
