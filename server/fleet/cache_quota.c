/* The thread that measures what renderers write to data/cache, removes the least used, and ends renderers beyond the
 * quota. */
#define _GNU_SOURCE
#include "server/fleet/cache_quota.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <time.h>
#include <unistd.h>

#include "core/base/log.h"
#include "core/base/mem.h"
#include "core/base/queue.h"

enum {
    MAX_WAITING = 4096,
    ID_SIZE = 64,
    /* limits of one emptying: a renderer that goes on making files must not make it endless. The rest waits for the
       next look. */
    MAX_ROUNDS = 64,
    MAX_REMOVED = 2 * CACHE_QUOTA_MAX_FILES
};

static const uint64_t default_max_bytes = UINT64_C(16) << 30, slack_bytes = UINT64_C(64) << 20;

struct use { /* a process begins or ends to use a plan's folder; from the net thread */
    char id[ID_SIZE];
    uint64_t process;
    bool is_begin;
};

struct entry { /* one plan's folder */
    char id[ID_SIZE];
    uint64_t process; /* that uses the folder; 0: none */
    uint64_t n_bytes, n_files;
    int64_t used_ns; /* since 1970 */
    bool is_ended;   /* its process was ended by us; the folder is emptied after the end */
    bool was_blamed; /* its process was ended since the disk became short of space */
    bool was_tried;  /* emptied in this look already */
    bool has_rest;   /* emptying stopped at a limit and goes on at the next look */
};

struct cache_quota {
    struct cache_quota_options options;
    pthread_t thread;
    struct queue *uses;
    /* only for the thread */
    int file; /* descriptor of data/cache */
    struct entry *entries;
    size_t n_entries, room;
};

/* ---- one folder ------------------------------------------------------------------------------------------------- */

static int open_inner(int folder, const char *name)
{
    return openat(folder, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
}

/* Adds the sizes of all entries below folder; consumes the descriptor. What cannot be read counts as too much. Returns
 * false when the daemon lacks the means to look. */
static bool measure(int folder, int depth, struct entry *entry)
{
    bool is_measured = true;
    DIR *names = fdopendir(folder);
    if (!names) {
        is_measured = !error_is_shortage(errno);
        entry->n_files = CACHE_QUOTA_MAX_FILES + 1;
        close(folder);
        return is_measured;
    }
    for (const struct dirent *name;
         is_measured && entry->n_files <= CACHE_QUOTA_MAX_FILES && (name = readdir(names));) {
        struct stat facts;
        if (strcmp(name->d_name, ".") == 0 || strcmp(name->d_name, "..") == 0 ||
            fstatat(dirfd(names), name->d_name, &facts, AT_SYMLINK_NOFOLLOW) != 0)
            continue;
        entry->n_files++;
        entry->n_bytes += (uint64_t)facts.st_blocks * 512;
        if (!S_ISDIR(facts.st_mode))
            continue;
        int inner = depth < CACHE_QUOTA_MAX_DEPTH ? open_inner(dirfd(names), name->d_name) : -1;
        if (inner >= 0)
            is_measured = measure(inner, depth + 1, entry);
        else if (depth < CACHE_QUOTA_MAX_DEPTH && error_is_shortage(errno))
            is_measured = false;
        else if (depth == CACHE_QUOTA_MAX_DEPTH || errno != ENOENT)
            entry->n_files = CACHE_QUOTA_MAX_FILES + 1;
    }
    closedir(names);
    return is_measured;
}

/* Measures the folder again. Keeps the old figures when it cannot be read now. */
static void look_at(const struct cache_quota *quota, struct entry *entry)
{
    struct entry found = { .n_bytes = 0 };
    int folder = open_inner(quota->file, entry->id);
    if (folder >= 0 ? !measure(folder, 1, &found) : error_is_shortage(errno))
        return;
    entry->n_bytes = found.n_bytes;
    entry->n_files = found.n_files;
}

struct removing {
    int top;
    unsigned long n_seen, n_done;   /* in one round: entries found; entries removed or moved */
    unsigned long n_moved, n_tried; /* in all rounds */
};

/* Opens a folder whose mode the renderer may have changed. Another process may put a link in its place at any time, so
 * the mode is changed through the opened descriptor. */
static int open_for_removal(int folder, const char *name)
{
    char path[40];
    int handle = openat(folder, name, O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC), inner = -1;
    if (handle < 0)
        return -1;
    (void)snprintf(path, sizeof path, "/proc/self/fd/%d", handle);
    if (chmod(path, 0700) == 0)
        inner = openat(handle, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    close(handle);
    return inner;
}

/* Removes files and moves inner folders to the top: a tree of any depth becomes flat. */
static void flatten(struct removing *removing, int folder)
{
    int copy = openat(folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    DIR *names = copy >= 0 ? fdopendir(copy) : NULL;
    if (!names && copy >= 0)
        close(copy);
    for (const struct dirent *name; names && removing->n_tried < MAX_REMOVED && (name = readdir(names));) {
        char moved[40];
        if (strcmp(name->d_name, ".") == 0 || strcmp(name->d_name, "..") == 0)
            continue;
        removing->n_seen++;
        removing->n_tried++;
        if (unlinkat(folder, name->d_name, 0) == 0 || unlinkat(folder, name->d_name, AT_REMOVEDIR) == 0) {
            removing->n_done++;
        } else if (folder != removing->top) {
            (void)snprintf(moved, sizeof moved, "gone-%lu", ++removing->n_moved);
            removing->n_done += renameat(folder, name->d_name, removing->top, moved) == 0;
        } else {
            int inner = open_for_removal(folder, name->d_name); /* a folder that is not empty */
            if (inner < 0)
                continue;
            flatten(removing, inner);
            close(inner);
            (void)unlinkat(folder, name->d_name, AT_REMOVEDIR);
        }
    }
    if (names)
        closedir(names);
}

/* Removes the contents. The folder itself stays: a renderer may be about to start in it. */
static void empty(const struct cache_quota *quota, struct entry *entry)
{
    struct removing removing = { .top = open_inner(quota->file, entry->id) };
    entry->has_rest = false;
    if (removing.top < 0)
        return;
    for (int round = 0; round < MAX_ROUNDS && removing.n_tried < MAX_REMOVED;
         round++) { /* until a round finds nothing or removes nothing */
        removing.n_seen = removing.n_done = 0;
        flatten(&removing, removing.top);
        if (removing.n_done == 0)
            break;
    }
    close(removing.top);
    entry->has_rest = removing.n_done > 0 && !entry->process;
    if (removing.n_seen > 0 && removing.n_done == 0)
        log_warn("the cache of plan %s could not be emptied", entry->id);
    look_at(quota, entry);
}

/* ---- all of them ------------------------------------------------------------------------------------------------ */

static int64_t now_ns(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_REALTIME, &now); /* wall clock: compared with times of files */
    return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

static struct entry *entry_of(struct cache_quota *quota, const char *id)
{
    for (size_t i = 0; i < quota->n_entries; i++)
        if (strcmp(quota->entries[i].id, id) == 0)
            return &quota->entries[i];
    if (quota->n_entries == quota->room) {
        size_t room = quota->room ? 2 * quota->room : 64;
        struct entry *larger = realloc(quota->entries, room * sizeof *larger);
        if (!larger)
            return NULL;
        quota->entries = larger;
        quota->room = room;
    }
    struct entry *entry = &quota->entries[quota->n_entries++];
    *entry = (struct entry){ .used_ns = now_ns() };
    (void)snprintf(entry->id, sizeof entry->id, "%s", id);
    return entry;
}

/* Lists the folders that earlier daemons left. */
static void list(struct cache_quota *quota)
{
    int copy = openat(quota->file, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    DIR *names = copy >= 0 ? fdopendir(copy) : NULL;
    for (const struct dirent *name; names && (name = readdir(names));) {
        struct stat facts;
        if (name->d_name[0] == '.' || strlen(name->d_name) >= ID_SIZE ||
            fstatat(quota->file, name->d_name, &facts, AT_SYMLINK_NOFOLLOW) != 0 || !S_ISDIR(facts.st_mode))
            continue;
        struct entry *entry = entry_of(quota, name->d_name);
        if (!entry)
            break;
        entry->used_ns = (int64_t)facts.st_mtim.tv_sec * 1000000000 + facts.st_mtim.tv_nsec;
        look_at(quota, entry);
    }
    if (names)
        closedir(names);
}

/* Folders of running renderers come last: a renderer writes its kept plan only once. */
static struct entry *least_used(struct cache_quota *quota, bool with_running)
{
    struct entry *least = NULL;
    for (size_t i = 0; i < quota->n_entries; i++) {
        struct entry *entry = &quota->entries[i];
        if (entry->n_bytes == 0 || entry->is_ended || entry->was_tried || (entry->process && !with_running))
            continue;
        if (!least || (!entry->process && least->process) ||
            (!entry->process == !least->process && entry->used_ns < least->used_ns))
            least = entry;
    }
    return least;
}

static uint64_t total(const struct cache_quota *quota)
{
    uint64_t sum = 0;
    for (size_t i = 0; i < quota->n_entries; i++)
        sum += quota->entries[i].n_bytes;
    return sum;
}

static void end_process(struct cache_quota *quota, struct entry *entry, const char *reason)
{
    entry->is_ended = true;
    quota->options.end(quota->options.context, entry->process, reason);
}

/* At most once per look and folder. A renderer that fills its cache as fast as it is emptied is ended. */
static void remove_one(struct cache_quota *quota, struct entry *entry, const char *why)
{
    log_info("the cache of plan %s is removed (%llu MiB): %s", entry->id, (unsigned long long)(entry->n_bytes >> 20),
             why);
    uint64_t before = entry->n_bytes;
    entry->was_tried = true;
    empty(quota, entry);
    if (entry->n_bytes < before)
        return;
    if (entry->process)
        end_process(quota, entry, "was ended because its cache cannot be emptied while it runs");
    else if (!entry->has_rest)
        entry->n_bytes = 0; /* it cannot be removed: counted as empty, so that it is not tried for ever */
}

static bool is_short_of_space(const struct cache_quota *quota)
{
    struct statvfs disk;
    return fstatvfs(quota->file, &disk) == 0 && (uint64_t)disk.f_bavail * disk.f_frsize < quota->options.reserve_bytes;
}

/* Removes caches until the disk has space again. If that is not enough, ends renderers, the newest first, one per look
 * and each once: a removed file that a renderer holds open still takes space that no measuring finds. */
static void free_space(struct cache_quota *quota)
{
    struct entry *blamed = NULL;
    bool is_short = is_short_of_space(quota);
    for (struct entry *least; is_short && (least = least_used(quota, false)); is_short = is_short_of_space(quota))
        remove_one(quota, least, "the disk is short of space");
    for (size_t i = 0; i < quota->n_entries; i++) {
        struct entry *entry = &quota->entries[i];
        if (!is_short)
            entry->was_blamed = false;
        else if (entry->process && !entry->was_blamed && !entry->is_ended &&
                 (!blamed || entry->process > blamed->process))
            blamed = entry;
    }
    if (!blamed)
        return;
    blamed->was_blamed = true;
    end_process(quota, blamed, "was ended because the disk of the data folder is short of space");
}

static void look(struct cache_quota *quota)
{
    char reason[160];
    const uint64_t max_bytes = quota->options.max_bytes;
    for (size_t i = 0; i < quota->n_entries; i++) {
        struct entry *entry = &quota->entries[i];
        entry->was_tried = false;
        if (entry->has_rest && !entry->process)
            empty(quota, entry);
        if (!entry->process || entry->is_ended)
            continue;
        look_at(quota, entry);
        if (entry->n_bytes <= max_bytes + slack_bytes && entry->n_files <= CACHE_QUOTA_MAX_FILES)
            continue;
        (void)snprintf(reason, sizeof reason,
                       "was ended because it wrote more to its cache than the %llu MiB or %d files it may",
                       (unsigned long long)(max_bytes >> 20), CACHE_QUOTA_MAX_FILES);
        end_process(quota, entry, reason);
    }
    for (struct entry *least; total(quota) > max_bytes && (least = least_used(quota, true));)
        remove_one(quota, least, "caches of all plans took more than they may");
    free_space(quota);
}

static struct entry *entry_used_by(struct cache_quota *quota, uint64_t process)
{
    for (size_t i = 0; i < quota->n_entries; i++)
        if (quota->entries[i].process == process)
            return &quota->entries[i];
    return NULL;
}

static void note_use(struct cache_quota *quota, const struct use *use)
{
    struct entry *entry = use->is_begin ? entry_of(quota, use->id) : entry_used_by(quota, use->process);
    if (!entry)
        return;
    if (use->is_begin && entry->is_ended)
        empty(quota, entry); /* the end of the earlier process has not been reported yet */
    entry->process = use->is_begin ? use->process : 0;
    entry->used_ns = now_ns();
    (void)utimensat(quota->file, entry->id, NULL,
                    AT_SYMLINK_NOFOLLOW); /* the time of the folder tells the next daemon when it was used */
    if (!use->is_begin && entry->is_ended)
        empty(quota, entry);
    else if (!use->is_begin)
        look_at(quota, entry);
    entry->is_ended = false;
}

static bool is_any_left(const struct cache_quota *quota)
{
    for (size_t i = 0; i < quota->n_entries; i++)
        if (quota->entries[i].process || quota->entries[i].has_rest)
            return true;
    return false;
}

static void *work(void *argument)
{
    struct cache_quota *quota = argument;
    list(quota);
    for (int wait_ms = 0;; wait_ms = is_any_left(quota) ? CACHE_QUOTA_LOOK_MS : -1) {
        for (struct use *use = queue_take(quota->uses, wait_ms); use; use = queue_try_take(quota->uses)) {
            bool is_last = use->process == 0;
            if (!is_last)
                note_use(quota, use);
            free(use);
            if (is_last)
                return NULL;
        }
        look(quota);
    }
}

struct cache_quota *cache_quota_create(const struct cache_quota_options *options, struct error *err)
{
    struct cache_quota *quota = mem_new(sizeof *quota);
    quota->options = *options;
    if (quota->options.max_bytes == 0)
        quota->options.max_bytes = default_max_bytes;
    quota->uses = queue_create(MAX_WAITING, free);
    quota->file = open(options->folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    int failed = quota->file < 0 ? errno : pthread_create(&quota->thread, NULL, work, quota);
    if (!failed)
        return quota;
    error_set(err, ERROR_IO, "the cache folder %.120s cannot be watched: %s", options->folder, strerror(failed));
    if (quota->file >= 0)
        close(quota->file);
    queue_destroy(quota->uses);
    free(quota);
    return NULL;
}

static void put_use(struct cache_quota *quota, const char *id, uint64_t process, bool is_begin)
{
    struct use *use = mem_new(sizeof *use);
    *use = (struct use){ .process = process, .is_begin = is_begin };
    (void)snprintf(use->id, sizeof use->id, "%s", id);
    if (queue_try_put(quota->uses, use))
        return;
    free(use); /* the queue is full: the thread is removing something large */
    log_warn("%s%s",
             is_begin ? "a cache is not watched until its plan is opened again: "
                      : "the end of a renderer was not seen by the watch on caches",
             id);
}

void cache_quota_destroy(struct cache_quota *quota)
{
    if (!quota)
        return;
    struct use *last = mem_new(sizeof *last);
    while (!queue_try_put(quota->uses, last))
        (void)usleep(1000);
    pthread_join(quota->thread, NULL);
    queue_destroy(quota->uses);
    close(quota->file);
    free(quota->entries);
    free(quota);
}

uint64_t cache_quota_max_file(const struct cache_quota *quota)
{
    uint64_t half = quota->options.max_bytes / 2;
    return half > CACHE_QUOTA_LEAST_FILE ? half : CACHE_QUOTA_LEAST_FILE;
}

void cache_quota_begin(struct cache_quota *quota, const char *plan_id, uint64_t process)
{
    put_use(quota, plan_id, process, true);
}
void cache_quota_end(struct cache_quota *quota, uint64_t process)
{
    put_use(quota, "", process, false);
}
