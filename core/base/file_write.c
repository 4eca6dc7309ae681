/* Writes a file beside its path, then renames it into place. */
#include "core/base/file_write.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/types.h>
#include <unistd.h>

static bool write_all(int file, const char *bytes, size_t n_bytes)
{
    while (n_bytes > 0) {
        ssize_t n = write(file, bytes, n_bytes);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            return false;
        bytes += n;
        n_bytes -= (size_t)n;
    }
    return true;
}

/* Messages cut the path at 180 bytes, so that the system's reason still fits in error.text. */
bool file_write(const char *path, const void *bytes, size_t n_bytes, struct error *err)
{
    char partial[PATH_MAX];
    int n = snprintf(partial, sizeof partial, "%s.partial-%ld", path, (long)getpid());
    if (n < 0 || (size_t)n >= sizeof partial)
        return error_set(err, ERROR_LIMIT, "the path is longer than %d bytes", PATH_MAX);
    int file = open(partial, O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (file < 0)
        return error_set(err, ERROR_IO, "%.180s: cannot be created: %s", path, strerror(errno));
    bool is_written = write_all(file, bytes, n_bytes);
    int reason = errno;
    if (close(file) != 0 && is_written) {
        is_written = false;
        reason = errno;
    }
    if (is_written && rename(partial, path) != 0) {
        is_written = false;
        reason = errno;
    }
    if (!is_written) {
        unlink(partial);
        return error_set(err, ERROR_IO, "%.180s: cannot be written: %s", path, strerror(reason));
    }
    return true;
}

bool file_folder_paths(const char *folder, char place[FILE_FOLDER_SIZE], char partial[PATH_MAX], struct error *err)
{
    size_t n = strlen(folder);
    while (n > 1 && folder[n - 1] == '/')
        n--;
    if (n == 0 || n >= FILE_FOLDER_SIZE)
        return error_set(err, ERROR_RANGE, "a folder's path has 1 to %d bytes, this one %zu", FILE_FOLDER_SIZE - 1, n);
    memcpy(place, folder, n);
    place[n] = 0;
    snprintf(partial, PATH_MAX, "%s.partial-%ld", place, (long)getpid());
    return true;
}
