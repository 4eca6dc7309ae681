/* Lists all files below a folder of a plan. */
#define _GNU_SOURCE
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/mem.h"
#include "core/formats/folder.h"
#include "core/formats/text.h"

struct walk {
    const struct folder *folder;
    bool (*is_skipped)(const struct folder *folder, const char *name);
    struct folder_tree *tree;
    size_t capacity;
    struct error *err; /* set when is_failed */
    bool is_failed;    /* the system refused a call: the tree is incomplete */
};

static bool fail(struct walk *walk, enum error_code code, const char *under, const char *what)
{
    walk->is_failed = true;
    return error_set(walk->err, code, "%s%s%s", under, under[0] ? ": " : "", what);
}

static bool fail_listing(struct walk *walk, const char *under, int reason)
{
    char what[128];
    snprintf(what, sizeof what, "the folder cannot be listed: %s", strerror(reason));
    return fail(walk, error_is_shortage(reason) ? ERROR_MEMORY : ERROR_IO, under, what);
}

static bool add_file(struct walk *walk, const char *name, const struct stat *about)
{
    struct folder_tree *tree = walk->tree;
    if (tree->n_files >= FOLDER_MAX_FILES) {
        tree->is_cut = true;
        return false;
    }
    if (tree->n_files == walk->capacity) {
        size_t capacity = walk->capacity ? 2 * walk->capacity : 256;
        struct folder_file *files = realloc(tree->files, capacity * sizeof *files);
        if (!files)
            return fail(walk, ERROR_MEMORY, "", "no memory for the names of the files");
        tree->files = files;
        walk->capacity = capacity;
    }
    tree->files[tree->n_files++] =
        (struct folder_file){ .name = mem_copy_text(name),
                              .bytes = (uint64_t)about->st_size,
                              .inode = (uint64_t)about->st_ino,
                              .modified_ns = (int64_t)about->st_mtim.tv_sec * 1000000000 + about->st_mtim.tv_nsec };
    return true;
}

/* Finds the file or folder that a link leads to; false when it lies outside the folder. */
static bool look_behind_link(const struct folder *folder, const char *name, struct stat *about)
{
    return folder_look(folder, name, NULL) == FOLDER_FILE && fstatat(folder->fd, name, about, 0) == 0;
}

static void pass_over(struct walk *walk, const char *name)
{
    if (walk->tree->n_passed++ == 0)
        text_clean(name, walk->tree->passed, sizeof walk->tree->passed);
}

/* Folders that may not be entered, or are gone by now, are passed over. */
static bool is_passed_over(int reason)
{
    return reason == EACCES || reason == EPERM || reason == ENOENT || reason == ENOTDIR || reason == ELOOP;
}

/* Lists one folder and those below it. Consumes fd; with fd < 0 errno says why the folder could not be opened.
 * Returns false when FOLDER_MAX_FILES are reached, or on failure (is_failed). */
static bool walk_into(struct walk *walk, int fd, const char *under, int depth)
{
    bool goes_on = true;
    DIR *directory = fd < 0 ? NULL : fdopendir(fd);
    if (!directory) {
        int reason = errno;
        if (fd >= 0)
            close(fd);
        return (fd < 0 && is_passed_over(reason)) || fail_listing(walk, under, reason);
    }
    while (goes_on) {
        errno = 0;
        struct dirent *entry = readdir(directory);
        if (!entry && errno)
            goes_on = fail_listing(walk, under, errno);
        if (!entry)
            break;
        char name[FOLDER_NAME_SIZE];
        struct stat about;
        int n = snprintf(name, sizeof name, "%s%s%s", under, under[0] ? "/" : "", entry->d_name);
        if (entry->d_name[0] == '.' || fstatat(dirfd(directory), entry->d_name, &about, AT_SYMLINK_NOFOLLOW) != 0)
            continue;
        if (n < 0 || n >= (int)sizeof name || !folder_check_name(name, NULL)) {
            pass_over(walk, entry->d_name);
        } else if (S_ISDIR(about.st_mode)) {
            bool is_deep = depth >= FOLDER_MAX_DEPTH;
            walk->tree->is_cut |= is_deep;
            if (!is_deep && !(walk->is_skipped && walk->is_skipped(walk->folder, name)))
                goes_on =
                    walk_into(walk,
                              openat(dirfd(directory), entry->d_name, O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW),
                              name, depth + 1);
        } else if (S_ISREG(about.st_mode) || (S_ISLNK(about.st_mode) && look_behind_link(walk->folder, name, &about))) {
            goes_on = add_file(walk, name, &about);
        } else {
            pass_over(walk, name);
        }
    }
    closedir(directory);
    return goes_on;
}

static int compare_files(const void *a, const void *b)
{
    return strcmp(((const struct folder_file *)a)->name, ((const struct folder_file *)b)->name);
}

bool folder_walk(const struct folder *folder, const char *under,
                 bool (*is_skipped)(const struct folder *folder, const char *name), struct folder_tree *tree,
                 struct error *err)
{
    *tree = (struct folder_tree){ 0 };
    /* folder_look rejects a link that leads out of the folder */
    if (under[0] && folder_look(folder, under, NULL) != FOLDER_DIRECTORY)
        return error_set(err, ERROR_NOT_FOUND, "%s: there is no such folder in the plan's folder", under);
    struct walk walk = { .folder = folder, .is_skipped = is_skipped, .tree = tree, .err = err };
    int fd = openat(folder->fd, under[0] ? under : ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (fd < 0)
        return fail_listing(&walk, under, errno);
    walk_into(&walk, fd, under, 0);
    if (walk.is_failed)
        return false;
    if (tree->n_files > 1)
        qsort(tree->files, tree->n_files, sizeof *tree->files, compare_files);
    return true;
}

void folder_tree_finish(struct folder_tree *tree)
{
    for (size_t i = 0; i < tree->n_files; i++)
        free(tree->files[i].name);
    free(tree->files);
    *tree = (struct folder_tree){ 0 };
}
