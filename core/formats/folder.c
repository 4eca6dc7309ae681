/* Opens, lists and reads files of a plan's folder without leaving it. */
#define _GNU_SOURCE
#include "core/formats/folder.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/openat2.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "core/base/mem.h"
#include "core/base/path.h"

void bytes_free(struct bytes *bytes)
{
    free(bytes->data);
    *bytes = (struct bytes){ 0 };
}

bool folder_open(struct folder *folder, const char *path, struct error *err)
{
    char *resolved = path_resolve(path);
    if (!resolved || strlen(resolved) >= sizeof folder->path) {
        free(resolved);
        return error_set(err, errno == ENOMEM ? ERROR_MEMORY : ERROR_NOT_FOUND,
                         "the plan's folder does not exist or cannot be entered: %s", strerror(errno));
    }
    memcpy(folder->path, resolved, strlen(resolved) + 1);
    free(resolved);
    folder->fd = open(folder->path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder->fd < 0)
        return error_set(err, errno == ENOTDIR ? ERROR_NOT_FOUND : ERROR_IO, "the plan's folder cannot be opened: %s",
                         strerror(errno));
    return true;
}

void folder_close(struct folder *folder)
{
    if (folder->fd >= 0)
        close(folder->fd);
    folder->fd = -1;
}

bool folder_check_name(const char *name, struct error *err)
{
    size_t length = strlen(name);
    if (length == 0)
        return error_set(err, ERROR_RANGE, "an empty file name");
    if (length >= FOLDER_NAME_SIZE)
        return error_set(err, ERROR_RANGE, "a file name of %zu bytes; at most %d are allowed", length,
                         FOLDER_NAME_SIZE - 1);
    for (const char *c = name; *c; c++)
        if ((unsigned char)*c < 32 || *c == 127)
            return error_set(err, ERROR_RANGE, "a file name with a control character");
    if (name[0] == '/')
        return error_set(err, ERROR_RANGE, "%s: names in a plan are relative to its folder, this one is absolute",
                         name);
    for (const char *part = name; part; part = strchr(part, '/')) {
        part += *part == '/';
        if (strncmp(part, "..", 2) == 0 && (part[2] == '/' || part[2] == 0))
            return error_set(err, ERROR_RANGE, "%s: a name in a plan must not contain \"..\"", name);
    }
    return true;
}

/* For a name with a symbolic link when openat2 is missing: resolves it, checks that it is inside, opens the result. */
static int open_resolved(const struct folder *folder, const char *name)
{
    char joined[sizeof folder->path + FOLDER_NAME_SIZE + 1];
    snprintf(joined, sizeof joined, "%s/%s", folder->path, name);
    char *resolved = realpath(joined, NULL);
    if (!resolved)
        return -1;
    size_t length = strlen(folder->path);
    bool is_inside = strncmp(resolved, folder->path, length) == 0 &&
                     (resolved[length] == '/' || resolved[length] == 0 || length == 1);
    int fd = -1;
    if (is_inside)
        fd = open(resolved, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW);
    else
        errno = EXDEV;
    free(resolved);
    return fd;
}

/* Used when openat2 is missing or refused: opens one folder after the other and follows no link; a name with a link is
 * resolved first. */
static int open_by_parts(const struct folder *folder, const char *name)
{
    char part[FOLDER_NAME_SIZE];
    int at = folder->fd;
    for (;;) {
        size_t n = strcspn(name, "/");
        bool is_last = name[n] == 0;
        snprintf(part, sizeof part, "%.*s", (int)n, name);
        int next = openat(at, part, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW | (is_last ? 0 : O_DIRECTORY));
        int reason = errno;
        if (at != folder->fd)
            close(at);
        errno = reason;
        if (next < 0 || is_last)
            return next;
        at = next;
        name += n + 1;
        name += strspn(name, "/");
        if (!*name)
            return at;
    }
}

/* O_NONBLOCK: opening a named pipe in the folder must not hang. */
static int open_beneath(const struct folder *folder, const char *name)
{
    struct open_how how = { .flags = O_RDONLY | O_CLOEXEC | O_NONBLOCK,
                            .resolve = RESOLVE_BENEATH | RESOLVE_NO_MAGICLINKS };
    long fd = syscall(SYS_openat2, folder->fd, name, &how, sizeof how);
    if (fd < 0 && (errno == ENOSYS || errno == EPERM || errno == EAGAIN)) {
        fd = open_by_parts(folder, name);
        if (fd < 0 && (errno == ELOOP || errno == ENOTDIR))
            return open_resolved(folder, name);
    }
    return (int)fd;
}

enum folder_kind folder_look(const struct folder *folder, const char *name, uint64_t *bytes)
{
    if (bytes)
        *bytes = 0;
    if (!folder_check_name(name, NULL))
        return FOLDER_OTHER;
    int fd = open_beneath(folder, name);
    if (fd < 0) {
        int reason = errno;
        if (error_is_shortage(reason))
            error_set(NULL, ERROR_MEMORY, "%s: %s", name, strerror(reason));
        return reason == ENOENT || reason == ENOTDIR ? FOLDER_ABSENT : FOLDER_OTHER;
    }
    struct stat about;
    enum folder_kind kind = FOLDER_OTHER;
    if (fstat(fd, &about) == 0) {
        kind = S_ISREG(about.st_mode) ? FOLDER_FILE : S_ISDIR(about.st_mode) ? FOLDER_DIRECTORY : FOLDER_OTHER;
        if (bytes && kind == FOLDER_FILE)
            *bytes = (uint64_t)about.st_size;
    }
    close(fd);
    return kind;
}

bool folder_read_part(const struct folder_part *part, const char *name, uint64_t at, void *out, size_t n,
                      struct error *err)
{
    size_t have = 0;
    while (have < n) {
        ssize_t got = pread(part->fd, (uint8_t *)out + have, n - have, (off_t)(at + have));
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0)
            return error_set(err, ERROR_IO, "%s: reading failed after %zu bytes: %s", name, have, strerror(errno));
        if (got == 0)
            return error_set(err, ERROR_IO, "%s: the file shrank while it was read: %zu of %zu bytes", name, have, n);
        have += (size_t)got;
    }
    return true;
}

bool folder_open_part(const struct folder *folder, const char *name, struct folder_part *part, struct error *err)
{
    *part = (struct folder_part){ .fd = -1 };
    if (!folder_check_name(name, err))
        return false;
    int fd = open_beneath(folder, name);
    if (fd < 0) {
        if (errno == EXDEV || errno == ELOOP)
            return error_set(err, ERROR_RANGE, "%s: a link that leads out of the plan's folder is not followed", name);
        if (errno == ENOENT || errno == ENOTDIR)
            return error_set(err, ERROR_NOT_FOUND, "%s: there is no such file in the plan's folder", name);
        return error_set(err, error_is_shortage(errno) ? ERROR_MEMORY : ERROR_IO, "%s: cannot be opened: %s", name,
                         strerror(errno));
    }
    struct stat about;
    if (fstat(fd, &about) != 0 || !S_ISREG(about.st_mode)) {
        close(fd);
        return error_set(err, ERROR_IO, "%s: not a plain file", name);
    }
    *part = (struct folder_part){ fd, (uint64_t)about.st_size };
    return true;
}

void folder_close_part(struct folder_part *part)
{
    if (part->fd >= 0)
        close(part->fd);
    part->fd = -1;
}

bool folder_read(const struct folder *folder, const char *name, uint64_t limit, uint64_t most, struct bytes *bytes,
                 struct error *err)
{
    *bytes = (struct bytes){ 0 };
    struct folder_part part;
    if (!folder_open_part(folder, name, &part, err))
        return false;
    bool is_read = false;
    if (part.n_bytes > limit) {
        error_set(err, ERROR_LIMIT, "%s: %llu bytes; at most %llu are read", name, (unsigned long long)part.n_bytes,
                  (unsigned long long)limit);
    } else {
        bytes->size = part.n_bytes < most ? (size_t)part.n_bytes : (size_t)most;
        bytes->data = malloc(bytes->size + 1); /* one more byte, 0: text readers may look at the byte after the last */
        if (!bytes->data) {
            error_set(err, ERROR_MEMORY, "%s: no memory for %zu bytes", name, bytes->size);
        } else {
            bytes->data[bytes->size] = 0;
            is_read = folder_read_part(&part, name, 0, bytes->data, bytes->size, err);
        }
    }
    folder_close_part(&part);
    if (!is_read)
        bytes_free(bytes);
    return is_read;
}

static int compare_names(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

bool folder_list(const struct folder *folder, char ***names, size_t *n_names, struct error *err)
{
    *names = NULL;
    *n_names = 0;
    int fd = openat(folder->fd, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    DIR *directory = fd < 0 ? NULL : fdopendir(fd);
    if (!directory) {
        if (fd >= 0)
            close(fd);
        return error_set(err, ERROR_IO, "the plan's folder cannot be listed: %s", strerror(errno));
    }
    char **list = mem_array(FOLDER_MAX_ENTRIES, sizeof *list, UINT32_MAX, err);
    if (!list) {
        closedir(directory);
        return false;
    }
    size_t n = 0;
    errno = 0;
    for (struct dirent *entry; n < FOLDER_MAX_ENTRIES && (entry = readdir(directory)); errno = 0)
        if (entry->d_name[0] != '.' && folder_check_name(entry->d_name, NULL))
            list[n++] = mem_copy_text(entry->d_name);
    int reason = errno;
    closedir(directory);
    if (n < FOLDER_MAX_ENTRIES && reason) {
        folder_free_names(list, n);
        return error_set(err, ERROR_IO, "the plan's folder cannot be listed: %s", strerror(reason));
    }
    qsort(list, n, sizeof *list, compare_names);
    *names = list;
    *n_names = n;
    return true;
}

void folder_free_names(char **names, size_t n_names)
{
    for (size_t i = 0; names && i < n_names; i++)
        free(names[i]);
    free(names);
}
