#include "server/http/intake.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"

struct intake {
    char *folder;
    uint64_t max_bytes, last_number;
    int n_files, window_ms;
};

struct intake_file {
    struct intake *intake;
    char *path;
    int fd;
    uint64_t n_bytes, window_bytes; /* in all, and since the window began */
    int64_t window_us;
};

struct intake *intake_create(const char *folder, uint64_t max_bytes)
{
    struct intake *intake = mem_new(sizeof *intake);
    intake->folder = folder ? mem_copy_text(folder) : NULL;
    intake->max_bytes = max_bytes;
    intake->window_ms = INTAKE_WINDOW_MS;
    return intake;
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
    return problem_set(problem, PROBLEM_TOO_LARGE, "", "", "an archive of more than %" PRIu64 " MiB, the limit set by max-upload-mib",
                       intake->max_bytes >> 20);
}

static bool refuse_storage(int why, struct problem *problem)
{
    return problem_set(problem, PROBLEM_STORAGE, "", "", "the server cannot keep the archive: %s", strerror(why));
}

static bool check_sender(const struct call *call, struct problem *problem)
{
    static const char *const types[] = { "application/zip", "application/x-tar", "application/gzip", "application/octet-stream" };
    if (!call_origin_is_own(call, problem))
        return false;
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++)
        if (call_media_type_is(call, types[i]))
            return true;
    return problem_set(problem, PROBLEM_MEDIA_TYPE, "", "",
                       "Content-Type is \"%.60s\", expected application/zip, application/x-tar, application/gzip or application/octet-stream",
                       call->content_type ? call->content_type : "");
}

static bool check_space(const struct intake *intake, int64_t length, struct problem *problem)
{
    struct statvfs disk;
    uint64_t needed = INTAKE_SPARE_BYTES + (length > 0 ? (uint64_t)length : 0);
    if (statvfs(intake->folder, &disk) != 0)
        return refuse_storage(errno, problem);
    uint64_t n_free = (uint64_t)disk.f_bavail * disk.f_frsize;
    return n_free >= needed || problem_set(problem, PROBLEM_STORAGE, "", "", "the server's disk has %" PRIu64 " MiB free, and %" PRIu64 " MiB are needed",
                                           n_free >> 20, needed >> 20);
}

struct intake_file *intake_begin(struct intake *intake, const struct call *call, int64_t length, struct problem *problem)
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
    if (intake->n_files >= INTAKE_MAX_FILES) {
        problem_set(problem, PROBLEM_BUSY, "", "", "%d archives are being received already, which is as many as may be", INTAKE_MAX_FILES);
        problem->retry_after_ms = INTAKE_RETRY_MS;
        return NULL;
    }
    if (!check_space(intake, length, problem))
        return NULL;
    size_t n = strlen(intake->folder) + 32;
    struct intake_file *file = mem_new(sizeof *file);
    file->intake = intake;
    file->path = mem_new(n);
    (void)snprintf(file->path, n, "%s/%" PRIu64 ".part", intake->folder, ++intake->last_number);
    file->fd = open(file->path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (file->fd < 0) {
        refuse_storage(errno, problem);
        free(file->path);
        free(file);
        return NULL;
    }
    file->window_us = clock_now_us();
    intake->n_files++;
    return file;
}

/* A sender that trickles would hold one of the few places for ever. */
static bool is_fast_enough(struct intake_file *file, size_t n, struct problem *problem)
{
    int64_t now_us = clock_now_us();
    file->window_bytes += n;
    if (now_us - file->window_us < (int64_t)file->intake->window_ms * 1000)
        return true;
    bool is_enough = file->window_bytes >= INTAKE_WINDOW_BYTES;
    if (!is_enough)
        problem_set(problem, PROBLEM_TIMEOUT, "", "", "%" PRIu64 " bytes came in %.0f s; at least %d are expected", file->window_bytes,
                    (double)(now_us - file->window_us) / 1e6, INTAKE_WINDOW_BYTES);
    file->window_us = now_us;
    file->window_bytes = 0;
    return is_enough;
}

bool intake_add(struct intake_file *file, const char *bytes, size_t n, struct problem *problem)
{
    if (!is_fast_enough(file, n, problem))
        return false;
    if (n > file->intake->max_bytes - file->n_bytes)
        return refuse_size(file->intake, problem);
    while (n > 0) {
        ssize_t n_written = write(file->fd, bytes, n);
        if (n_written < 0 && errno == EINTR)
            continue;
        if (n_written <= 0)
            return refuse_storage(n_written < 0 ? errno : ENOSPC, problem);
        bytes += n_written;
        n -= (size_t)n_written;
        file->n_bytes += (uint64_t)n_written;
    }
    return true;
}

static void release(struct intake_file *file)
{
    file->intake->n_files--;
    free(file->path);
    free(file);
}

char *intake_finish(struct intake_file *file, uint64_t *n_bytes, struct problem *problem)
{
    int failed = close(file->fd) != 0 ? errno : 0; /* some file systems say only here that the disk is full */
    file->fd = -1;
    if (failed) {
        refuse_storage(failed, problem);
        intake_drop(file);
        return NULL;
    }
    char *path = mem_copy_text(file->path);
    *n_bytes = file->n_bytes;
    release(file);
    return path;
}

void intake_drop(struct intake_file *file)
{
    if (!file)
        return;
    if (file->fd >= 0)
        (void)close(file->fd);
    if (unlink(file->path) != 0)
        log_warn("what came of an upload cannot be removed: %s", strerror(errno));
    release(file);
}
