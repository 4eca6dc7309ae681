/* The thread that removes folder trees, one after another. */
#include "server/fleet/remover.h"

#include <errno.h>
#include <fts.h>
#include <poll.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/base/log.h"
#include "core/base/mem.h"
#include "core/base/queue.h"

enum { TRIES = 5, PAUSE_MS = 200 /* a killed process may still finish a write */ };

struct remover {
    pthread_t thread;
    struct queue *paths;
    atomic_bool is_stopping;
    atomic_size_t n_left; /* given and not removed */
};

/* Returns 0 when nothing is left, else the first errno. */
static int remove_tree(const struct remover *remover, char *path)
{
    char *const roots[] = { path, NULL };
    int failed = 0;
    FTS *tree = fts_open(roots, FTS_PHYSICAL | FTS_NOCHDIR, NULL);
    if (!tree)
        return errno;
    /* Read before the question: fts_close leaks the roots of a tree of which nothing was read. */
    for (const FTSENT *entry; (entry = fts_read(tree)) && !atomic_load(&remover->is_stopping);) {
        if (entry->fts_info == FTS_D)
            continue; /* it is visited again as FTS_DP when it is empty */
        int gone = entry->fts_info == FTS_DP || entry->fts_info == FTS_DNR ? rmdir(entry->fts_accpath)
                                                                           : unlink(entry->fts_accpath);
        if (gone != 0 && errno != ENOENT && !failed)
            failed = errno;
    }
    fts_close(tree);
    return failed;
}

static void *work(void *argument)
{
    struct remover *remover = argument;
    for (char *path; (path = queue_take(remover->paths, -1));) {
        int failed = remove_tree(remover, path);
        for (int i = 1; i < TRIES && failed && !atomic_load(&remover->is_stopping); i++) {
            poll(NULL, 0, PAUSE_MS);
            failed = remove_tree(remover, path);
        }
        if (failed)
            log_warn("something in the data folder could not be removed: %s", strerror(failed));
        free(path);
        atomic_fetch_sub(&remover->n_left, 1);
    }
    return NULL;
}

struct remover *remover_create(struct error *err)
{
    struct remover *remover = mem_new(sizeof *remover);
    remover->paths = queue_create(REMOVER_MAX_WAITING, free);
    int failed = pthread_create(&remover->thread, NULL, work, remover);
    if (failed) {
        error_set(err, ERROR_IO, "the thread that removes folders cannot be started: %s", strerror(failed));
        queue_destroy(remover->paths);
        free(remover);
        return NULL;
    }
    return remover;
}

void remover_destroy(struct remover *remover)
{
    if (!remover)
        return;
    atomic_store(&remover->is_stopping, true);
    queue_close(remover->paths);
    pthread_join(remover->thread, NULL);
    queue_destroy(remover->paths);
    free(remover);
}

void remover_put(struct remover *remover, char *path)
{
    atomic_fetch_add(&remover->n_left, 1);
    if (queue_try_put(remover->paths, path))
        return;
    atomic_fetch_sub(&remover->n_left, 1);
    log_warn("too much waits to be removed; the next start of the server removes the rest");
    free(path);
}

bool remover_is_idle(const struct remover *remover)
{
    return atomic_load(&remover->n_left) == 0;
}
