/* Writes unpacked files and folders, and clears a folder after a failure. */
#define _GNU_SOURCE
#include "server/renderer/unpack_write.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "server/renderer/unpack_limits.h"
#include "server/renderer/unpack_name.h"

enum { FOLDER_FLAGS = O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC };

void unpack_writer_init(struct unpack_writer *writer, int folder)
{
    *writer = (struct unpack_writer){ .folder = folder, .parent = -1 };
}

void unpack_writer_finish(struct unpack_writer *writer)
{
    if (writer->parent >= 0)
        close(writer->parent);
    writer->parent = -1;
}

static bool refuse(struct problem *problem, const char *name, const char *what)
{
    int reason = errno;
    char shown[UNPACK_SHOWN_SIZE];
    unpack_show(name, shown);
    bool is_full = reason == ENOSPC || reason == EDQUOT || reason == EFBIG;
    return problem_set(problem, is_full ? PROBLEM_STORAGE : PROBLEM_INTERNAL, "", "", "entry \"%s\": %s: %s", shown,
                       what, strerror(reason));
}

/* Opens the parent folder of a name of n bytes, part by part. base: the last part of the name. */
static bool enter(struct unpack_writer *writer, const char *name, size_t n, char base[UNPACK_PART_SIZE + 1],
                  struct problem *problem)
{
    size_t at = n;
    while (at > 0 && name[at - 1] != '/')
        at--;
    memcpy(base, name + at, n - at);
    base[n - at] = 0;
    size_t n_parent = at > 0 ? at - 1 : 0;
    if (writer->parent >= 0 && strlen(writer->parent_name) == n_parent &&
        memcmp(writer->parent_name, name, n_parent) == 0)
        return true;
    unpack_writer_finish(writer);
    memcpy(writer->parent_name, name, n_parent);
    writer->parent_name[n_parent] = 0;
    int now = openat(writer->folder, ".", FOLDER_FLAGS);
    for (size_t from = 0; now >= 0 && from < n_parent;) {
        char part[UNPACK_PART_SIZE + 1];
        size_t length = strcspn(writer->parent_name + from, "/");
        memcpy(part, name + from, length);
        part[length] = 0;
        int next = openat(now, part, FOLDER_FLAGS);
        int reason = errno;
        close(now);
        errno = reason;
        now = next;
        from += length + 1;
    }
    writer->parent = now;
    return now >= 0 || refuse(problem, name, "its folder cannot be opened");
}

bool unpack_make_folder(struct unpack_writer *writer, const char *name, size_t n, struct problem *problem)
{
    char base[UNPACK_PART_SIZE + 1];
    if (writer->folder < 0)
        return true;
    if (!enter(writer, name, n, base, problem))
        return false;
    return mkdirat(writer->parent, base, 0750) == 0 || refuse(problem, name, "the folder cannot be made");
}

bool unpack_make_file(struct unpack_writer *writer, const char *name, int *file, struct problem *problem)
{
    char base[UNPACK_PART_SIZE + 1];
    *file = -1;
    if (writer->folder < 0)
        return true;
    if (!enter(writer, name, strlen(name), base, problem))
        return false;
    *file = openat(writer->parent, base, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0640);
    return *file >= 0 || refuse(problem, name, "the file cannot be made");
}

bool unpack_write(int file, const char *name, const void *data, size_t n, struct problem *problem)
{
    const char *from = data;
    while (n > 0) {
        ssize_t done = write(file, from, n);
        if (done < 0 && errno == EINTR)
            continue;
        if (done <= 0)
            return refuse(problem, name, "the file cannot be written");
        from += done;
        n -= (size_t)done;
    }
    return true;
}

/* ---- whole folders ---------------------------------------------------------------------------------------------- */

static DIR *list(int parent, const char *name)
{
    int folder = openat(parent, name, FOLDER_FLAGS);
    DIR *entries = folder >= 0 ? fdopendir(folder) : NULL;
    if (!entries && folder >= 0)
        close(folder);
    return entries;
}

/* NULL: there is no further one, or with errno not 0: the folder cannot be read on. */
static const char *next_name(DIR *entries)
{
    for (const struct dirent *entry; errno = 0, (entry = readdir(entries));)
        if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0)
            return entry->d_name;
    return NULL;
}

bool unpack_is_empty(int folder, struct problem *problem)
{
    DIR *entries = list(folder, ".");
    if (!entries)
        return problem_set(problem, PROBLEM_INTERNAL, "", "", "the folder to unpack into cannot be read: %s",
                           strerror(errno));
    bool is_empty = next_name(entries) == NULL;
    int reason = errno;
    closedir(entries);
    if (is_empty && reason)
        return problem_set(problem, PROBLEM_INTERNAL, "", "", "the folder to unpack into cannot be read: %s",
                           strerror(reason));
    return is_empty || problem_set(problem, PROBLEM_INTERNAL, "", "",
                                   "the folder to unpack into is not empty; expected is an empty one");
}

static bool clear(int parent, const char *name, int depth)
{
    DIR *entries = list(parent, name);
    if (!entries)
        return false;
    bool is_clear = true;
    for (const char *entry; (entry = next_name(entries));)
        if (unlinkat(dirfd(entries), entry, 0) != 0)
            is_clear = depth > 0 && clear(dirfd(entries), entry, depth - 1) &&
                       unlinkat(dirfd(entries), entry, AT_REMOVEDIR) == 0 && is_clear;
    is_clear = is_clear && errno == 0;
    closedir(entries);
    return is_clear;
}

bool unpack_clear(int folder)
{
    return clear(folder, ".", UNPACK_MAX_DEPTH + 1);
}

bool unpack_lift(struct unpack_writer *writer, const char *top, struct problem *problem)
{
    static const char aside[] =
        "\177top"; /* an entry in the folder may have the name of the folder, but never this one */
    if (writer->folder < 0)
        return true;
    unpack_writer_finish(writer);
    if (renameat(writer->folder, top, writer->folder, aside) != 0)
        return refuse(problem, top, "the folder cannot be renamed");
    DIR *entries = list(writer->folder, aside);
    if (!entries)
        return refuse(problem, top, "the folder cannot be read");
    bool is_done = true;
    for (const char *entry; is_done && (entry = next_name(entries));)
        is_done = renameat(dirfd(entries), entry, writer->folder, entry) == 0;
    int reason = errno;
    is_done = is_done && reason == 0;
    closedir(entries);
    errno = reason;
    if (!is_done && errno == EXDEV) /* Landlock version 1 refuses every move, so nothing was moved: undo the rename */
        is_done = renameat(writer->folder, aside, writer->folder, top) == 0;
    else if (is_done)
        is_done = unlinkat(writer->folder, aside, AT_REMOVEDIR) == 0;
    return is_done || refuse(problem, top, "what is in the folder cannot be moved");
}
