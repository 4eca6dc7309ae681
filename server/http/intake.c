/* Writes archives that are being received to files, within limits of size, space, number and speed. */
#include "server/http/intake.h"

#include <assert.h>
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/statvfs.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "core/base/spool.h"

struct intake {
    struct spool *spool;
    char *folder;
    uint64_t max_bytes, last_number;
    uint64_t reserve_bytes, n_promised; /* n_promised: sum of the files' `promised` */
    uint64_t (*free_bytes)(void *context, int *failed);
    void *context;
    struct intake_file *files;
    int n_files, window_ms;
};

struct intake_file {
    struct intake *intake;
    struct intake_file *next;
    char user[IDENTITY_MAX_USER + 1]; /* who sends it; "": nobody who has signed in */
    struct spool_file *spooled;
    char *path;
    uint64_t n_bytes, window_bytes; /* received in all; since the window began */
    uint64_t n_written;             /* of n_bytes, as was last seen */
    uint64_t promised;              /* bytes of disk granted to this file and not written by then */
    uint64_t n_unlooked;            /* received since the disk was last checked */
    int64_t window_us;
    bool is_waiting; /* for the disk, not for the sender */
};

static uint64_t ask_disk(void *context, int *failed)
{
    const struct intake *intake = context;
    struct statvfs disk;
    *failed = statvfs(intake->folder, &disk) != 0 ? errno : 0;
    return *failed ? 0 : (uint64_t)disk.f_bavail * disk.f_frsize;
}

struct intake *intake_create(const char *folder, uint64_t max_bytes, uint64_t reserve_bytes, struct error *err)
{
    struct intake *intake = mem_new(sizeof *intake);
    intake->spool = spool_create(err);
    if (!intake->spool) {
        free(intake);
        return NULL;
    }
    intake->folder = folder ? mem_copy_text(folder) : NULL;
    intake->max_bytes = max_bytes;
    intake->reserve_bytes = reserve_bytes;
    intake->window_ms = INTAKE_WINDOW_MS;
    intake->free_bytes = ask_disk;
    intake->context = intake;
    return intake;
}

void intake_set_disk(struct intake *intake, uint64_t (*free_bytes)(void *context, int *failed), void *context)
{
    intake->free_bytes = free_bytes;
    intake->context = context;
}

void intake_wait(struct intake *intake)
{
    spool_wait(intake->spool);
}

void intake_set_window_ms(struct intake *intake, int ms)
{
    intake->window_ms = ms;
}

void intake_destroy(struct intake *intake)
{
    if (!intake)
        return;
    assert(intake->n_files == 0);
    spool_destroy(intake->spool);
    free(intake->folder);
    free(intake);
}

bool intake_is_for(const struct call *call)
{
    static const char *const segments[] = { "api", "v1", "plans" };
    if (call->method != CALL_POST || call->n_segments != 3)
        return false;
    for (size_t i = 0; i < 3; i++)
        if (strcmp(call->segments[i], segments[i]) != 0)
            return false;
    return true;
}

static bool refuse_size(const struct intake *intake, struct problem *problem)
{
    return problem_set(problem, PROBLEM_TOO_LARGE, "", "",
                       "an archive of more than %" PRIu64 " MiB, the limit set by max-upload-mib",
                       intake->max_bytes >> 20);
}

static bool refuse_storage(int why, struct problem *problem)
{
    return problem_set(problem, PROBLEM_STORAGE, "", "", "the server cannot keep the archive: %s", strerror(why));
}

static bool check_sender(const struct call *call, struct problem *problem)
{
    static const char *const types[] = { "application/zip", "application/x-tar", "application/gzip",
                                         "application/octet-stream" };
    if (!call_origin_is_own(call, problem))
        return false;
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++)
        if (call_media_type_is(call, types[i]))
            return true;
    return problem_set(
        problem, PROBLEM_MEDIA_TYPE, "", "",
        "Content-Type is \"%.60s\", expected application/zip, application/x-tar, application/gzip or application/octet-stream",
        call->content_type ? call->content_type : "");
}

/* True if the disk has room for all that was granted and `more` bytes, and the reserve stays free. */
static bool check_space(const struct intake *intake, uint64_t more, struct problem *problem)
{
    int failed;
    uint64_t n_free = intake->free_bytes(intake->context, &failed);
    if (failed)
        return refuse_storage(failed, problem);
    uint64_t kept = intake->reserve_bytes +
                    intake->n_promised; /* cannot overflow: each part was granted against the disk's free space */
    if (n_free >= kept && n_free - kept >= more)
        return true;
    return problem_set(problem, PROBLEM_STORAGE, "", "",
                       "the server's disk has %" PRIu64 " MiB free; expected are %" PRIu64
                       " MiB for this archive, %" PRIu64 " for others that are being received, and %" PRIu64
                       " that stay free",
                       n_free >> 20, (more + (1 << 20) - 1) >> 20, intake->n_promised >> 20,
                       intake->reserve_bytes >> 20);
}

static void promise(struct intake_file *file, uint64_t n)
{
    file->promised += n;
    file->intake->n_promised += n;
}

/* Bytes that were written meanwhile are promised no longer. */
static void see_written(struct intake_file *file)
{
    uint64_t n = spool_written(file->spooled) - file->n_written;
    file->n_written += n;
    file->promised -= n;
    file->intake->n_promised -= n;
}

/* To be called before n bytes more are taken. An announced length was granted as a whole; else space is granted in
 * steps. After each step the disk is checked again, because others write to it too. */
static bool is_granted(struct intake_file *file, size_t n, struct problem *problem)
{
    struct intake *intake = file->intake;
    see_written(file);
    uint64_t needed = file->n_bytes - file->n_written + n;
    if (needed > file->promised) {
        uint64_t left = intake->max_bytes - file->n_bytes, step = INTAKE_STEP_BYTES < left ? INTAKE_STEP_BYTES : left;
        step = step > n ? step : n; /* the caller checked that n is within max_bytes */
        if (!check_space(intake, step, problem))
            return false;
        promise(file, step);
        file->n_unlooked = 0;
    } else if (file->n_unlooked >= INTAKE_STEP_BYTES) {
        if (!check_space(intake, 0, problem))
            return false;
        file->n_unlooked = 0;
    }
    return true;
}

/* True if there is a place for one more file of this user. */
static bool check_number(const struct intake *intake, const char *user, struct problem *problem)
{
    int n = 0;
    for (const struct intake_file *file = intake->files; file && user[0]; file = file->next)
        n += strcmp(file->user, user) == 0;
    bool is_free = true;
    if (intake->n_files >= INTAKE_MAX_FILES)
        is_free = problem_set(problem, PROBLEM_LIMIT, "", "",
                              "%d archives are being received already; at most so many are at once", INTAKE_MAX_FILES);
    else if (n >= INTAKE_MAX_OF_USER)
        is_free = problem_set(problem, PROBLEM_LIMIT, "", "",
                              "%d archives of yours are being received already; at most so many are at once", n);
    problem->retry_after_ms = is_free ? 0 : INTAKE_RETRY_MS;
    return is_free;
}

struct intake_file *intake_begin(struct intake *intake, const struct call *call, int64_t length,
                                 void (*moved)(void *context), void *context, struct problem *problem)
{
    if (!check_sender(call, problem))
        return NULL;
    if (!intake->folder) {
        problem_set(problem, PROBLEM_STORAGE, "", "", "this server keeps no uploads");
        return NULL;
    }
    if (length > 0 && (uint64_t)length > intake->max_bytes) {
        refuse_size(intake, problem);
        return NULL;
    }
    if (!check_number(intake, call->identity.user, problem) ||
        !check_space(intake, length > 0 ? (uint64_t)length : 0, problem))
        return NULL;
    size_t n = strlen(intake->folder) + 32;
    struct intake_file *file = mem_new(sizeof *file);
    *file = (struct intake_file){ .intake = intake, .next = intake->files };
    (void)snprintf(file->user, sizeof file->user, "%s", call->identity.user);
    intake->files = file;
    file->path = mem_new(n);
    (void)snprintf(file->path, n, "%s/%" PRIu64 ".part", intake->folder, ++intake->last_number);
    file->spooled = spool_open(intake->spool, file->path, moved, context);
    file->window_us = clock_now_us();
    promise(file, length > 0 ? (uint64_t)length : 0);
    intake->n_files++;
    return file;
}

static void begin_window(struct intake_file *file, int64_t now_us)
{
    file->window_us = now_us;
    file->window_bytes = 0;
}

/* Returns false when too little came in a window: a slow sender would hold one of the few slots for ever. */
static bool is_fast_enough(struct intake_file *file, size_t n, struct problem *problem)
{
    int64_t now_us = clock_now_us();
    file->window_bytes += n;
    if (now_us - file->window_us < (int64_t)file->intake->window_ms * 1000)
        return true;
    bool is_enough = file->window_bytes >= INTAKE_WINDOW_BYTES;
    if (!is_enough)
        problem_set(problem, PROBLEM_TOO_SLOW, "", "", "%" PRIu64 " bytes came in %.0f s; at least %d are expected",
                    file->window_bytes, (double)(now_us - file->window_us) / 1e6, INTAKE_WINDOW_BYTES);
    begin_window(file, now_us);
    return is_enough;
}

bool intake_add(struct intake_file *file, const char *bytes, size_t n, size_t *n_taken, struct problem *problem)
{
    int failed = spool_failed(file->spooled);
    *n_taken = 0;
    if (failed)
        return refuse_storage(failed, problem);
    if (file->is_waiting)
        begin_window(file, clock_now_us());
    if (!is_fast_enough(file, n, problem))
        return false;
    if (n > file->intake->max_bytes - file->n_bytes)
        return refuse_size(file->intake, problem);
    if (!is_granted(file, n, problem))
        return false;
    *n_taken = spool_write(file->spooled, bytes, n);
    file->n_bytes += *n_taken;
    file->n_unlooked += *n_taken;
    file->is_waiting = *n_taken < n;
    return true;
}

/* Takes file. */
static void leave(struct intake_file *file, bool is_kept)
{
    struct intake_file **at = &file->intake->files;
    while (*at != file)
        at = &(*at)->next;
    *at = file->next;
    spool_leave(file->spooled, is_kept);
    file->intake->n_files--;
    file->intake->n_promised -= file->promised;
    free(file->path);
    free(file);
}

bool intake_end(struct intake_file *file)
{
    return spool_end(file->spooled);
}

char *intake_finish(struct intake_file *file, uint64_t *n_bytes, struct problem *problem)
{
    int failed = spool_failed(file->spooled);
    char *path = failed ? NULL : mem_copy_text(file->path);
    *n_bytes = file->n_bytes;
    if (failed)
        refuse_storage(failed, problem);
    leave(file, !failed);
    return path;
}

void intake_drop(struct intake_file *file)
{
    if (file)
        leave(file, false);
}
