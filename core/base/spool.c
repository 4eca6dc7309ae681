/* One thread, and a list of the files that have something for it to do; it does one thing for each in turn. */
#include "core/base/spool.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/base/log.h"
#include "core/base/mem.h"

struct block {
    size_t n;
    uint8_t bytes[SPOOL_BLOCK_BYTES];
};

struct spool {
    pthread_t thread;
    pthread_mutex_t lock; /* for all below, and for what is marked in the files */
    pthread_cond_t has_work, is_idle;
    struct spool_file *first, **last;
    bool is_busy, is_ending;
};

struct spool_file {
    struct spool *spool;
    struct spool_file *next;
    struct block *filled; /* the caller's */
    char *path;
    int fd; /* this and the next of the thread alone */
    bool was_tried, is_ours;
    void (*moved)(void *context);
    void *context;
    /* with the lock: */
    struct block *given, *spare; /* one is NULL; given: to be written */
    uint64_t n_written;
    int failed;
    bool is_listed, waits, is_ending, is_closed, is_left, is_kept;
};

static void list(struct spool_file *file)
{
    struct spool *spool = file->spool;
    if (file->is_listed)
        return;
    file->is_listed = true;
    file->next = NULL;
    *spool->last = file;
    spool->last = &file->next;
    (void)pthread_cond_signal(&spool->has_work);
}

/* ---- on the thread ---------------------------------------------------------------------------------------------- */

static int open_file(struct spool_file *file)
{
    file->was_tried = true;
    file->fd = open(file->path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600);
    file->is_ours = file->fd >= 0;
    return file->is_ours ? 0 : errno;
}

static int write_block(const struct spool_file *file, const struct block *block, uint64_t *n_written)
{
    for (size_t at = 0; at < block->n;) {
        ssize_t n = write(file->fd, block->bytes + at, block->n - at);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            return n < 0 ? errno : ENOSPC;
        at += (size_t)n;
        *n_written += (uint64_t)n;
    }
    return 0;
}

static int close_file(struct spool_file *file)
{
    int fd = file->fd;
    file->fd = -1;
    return fd >= 0 && close(fd) != 0 ? errno : 0; /* some file systems report a full disk only here */
}

static void free_file(struct spool_file *file)
{
    (void)close_file(file);
    if (file->is_ours && !file->is_kept && unlink(file->path) != 0)
        log_warn("what came of a file that was given up cannot be removed: %s", strerror(errno));
    free(file->filled);
    free(file->given);
    free(file->spare);
    free(file->path);
    free(file);
}

/* Does the next thing without the lock, which the caller holds. Returns an errno. */
static int do_next(struct spool_file *file, struct block *given, bool closes, uint64_t *n_written)
{
    int failed = 0;
    (void)pthread_mutex_unlock(&file->spool->lock);
    if (!file->was_tried)
        failed = open_file(file);
    else if (given && file->fd >= 0)
        failed = write_block(file, given, n_written);
    else if (closes)
        failed = close_file(file);
    (void)pthread_mutex_lock(&file->spool->lock);
    return failed;
}

static void serve(struct spool_file *file)
{
    const bool is_first = !file->was_tried, closes = !is_first && !file->given && file->is_ending;
    struct block *given = is_first ? NULL : file->given;
    uint64_t n_written = 0;
    int failed = do_next(file, given, closes, &n_written);
    if (!file->failed)
        file->failed = failed;
    file->n_written += n_written;
    file->is_closed = file->is_closed || closes;
    if (given) {
        file->given = NULL;
        file->spare = given;
    }
    if (file->waits && !file->given && (!file->is_ending || file->is_closed)) {
        file->waits = false;
        file->moved(file->context);
    }
    if (file->given || file->is_left || (file->is_ending && !file->is_closed))
        list(file);
}

static void *run(void *argument)
{
    struct spool *spool = argument;
    (void)pthread_mutex_lock(&spool->lock);
    for (;;) {
        while (!spool->first && !spool->is_ending)
            (void)pthread_cond_wait(&spool->has_work, &spool->lock);
        struct spool_file *file = spool->first;
        if (!file)
            break;
        spool->first = file->next;
        if (!spool->first)
            spool->last = &spool->first;
        file->is_listed = false;
        spool->is_busy = true;
        if (file->is_left) {
            (void)pthread_mutex_unlock(&spool->lock);
            free_file(file);
            (void)pthread_mutex_lock(&spool->lock);
        } else {
            serve(file);
        }
        spool->is_busy = false;
        if (!spool->first)
            (void)pthread_cond_broadcast(&spool->is_idle);
    }
    (void)pthread_mutex_unlock(&spool->lock);
    return NULL;
}

/* ---- the caller's ----------------------------------------------------------------------------------------------- */

struct spool *spool_create(struct error *err)
{
    struct spool *spool = mem_new(sizeof *spool);
    spool->last = &spool->first;
    (void)pthread_mutex_init(&spool->lock, NULL);
    (void)pthread_cond_init(&spool->has_work, NULL);
    (void)pthread_cond_init(&spool->is_idle, NULL);
    if (pthread_create(&spool->thread, NULL, run, spool) == 0)
        return spool;
    error_set(err, ERROR_IO, "no thread to write files");
    free(spool);
    return NULL;
}

void spool_wait(struct spool *spool)
{
    (void)pthread_mutex_lock(&spool->lock);
    while (spool->first || spool->is_busy)
        (void)pthread_cond_wait(&spool->is_idle, &spool->lock);
    (void)pthread_mutex_unlock(&spool->lock);
}

void spool_destroy(struct spool *spool)
{
    if (!spool)
        return;
    (void)pthread_mutex_lock(&spool->lock);
    spool->is_ending = true;
    (void)pthread_cond_signal(&spool->has_work);
    (void)pthread_mutex_unlock(&spool->lock);
    (void)pthread_join(spool->thread, NULL);
    (void)pthread_cond_destroy(&spool->has_work);
    (void)pthread_cond_destroy(&spool->is_idle);
    (void)pthread_mutex_destroy(&spool->lock);
    free(spool);
}

struct spool_file *spool_open(struct spool *spool, const char *path, void (*moved)(void *context), void *context)
{
    struct spool_file *file = mem_new(sizeof *file);
    file->spool = spool;
    file->path = mem_copy_text(path);
    file->fd = -1;
    file->moved = moved;
    file->context = context;
    file->filled = mem_new(sizeof *file->filled);
    file->spare = mem_new(sizeof *file->spare);
    (void)pthread_mutex_lock(&spool->lock);
    list(file);
    (void)pthread_mutex_unlock(&spool->lock);
    return file;
}

/* Gives what was filled to the thread. False: it still has the block before, and the caller waits. */
static bool give(struct spool_file *file)
{
    (void)pthread_mutex_lock(&file->spool->lock);
    const bool is_free = !file->given;
    if (is_free) {
        file->given = file->filled;
        file->filled = file->spare;
        file->spare = NULL;
        file->filled->n = 0;
        list(file);
    }
    file->waits = !is_free;
    (void)pthread_mutex_unlock(&file->spool->lock);
    return is_free;
}

size_t spool_write(struct spool_file *file, const void *bytes, size_t n)
{
    const uint8_t *at = bytes;
    size_t n_taken = 0;
    while (n_taken < n) {
        if (file->filled->n == SPOOL_BLOCK_BYTES && !give(file))
            break;
        size_t room = SPOOL_BLOCK_BYTES - file->filled->n, left = n - n_taken, part = left < room ? left : room;
        memcpy(file->filled->bytes + file->filled->n, at + n_taken, part);
        file->filled->n += part;
        n_taken += part;
    }
    return n_taken;
}

bool spool_end(struct spool_file *file)
{
    if (file->filled->n > 0 && !give(file))
        return false;
    (void)pthread_mutex_lock(&file->spool->lock);
    file->is_ending = true;
    file->waits = !file->is_closed;
    if (file->waits)
        list(file);
    const bool has_ended = file->is_closed;
    (void)pthread_mutex_unlock(&file->spool->lock);
    return has_ended;
}

int spool_failed(struct spool_file *file)
{
    (void)pthread_mutex_lock(&file->spool->lock);
    int failed = file->failed;
    (void)pthread_mutex_unlock(&file->spool->lock);
    return failed;
}

uint64_t spool_written(struct spool_file *file)
{
    (void)pthread_mutex_lock(&file->spool->lock);
    uint64_t n = file->n_written;
    (void)pthread_mutex_unlock(&file->spool->lock);
    return n;
}

void spool_leave(struct spool_file *file, bool is_kept)
{
    struct spool *spool = file->spool;
    (void)pthread_mutex_lock(&spool->lock);
    file->is_left = true;
    file->is_kept = is_kept;
    file->waits = false;
    list(file);
    (void)pthread_mutex_unlock(&spool->lock);
}
