/* Finds the plans in the configured folders: which folder is a plan, its name, fingerprint and id. */
#include "server/fleet/folders.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "core/base/mem.h"
#include "core/base/path.h"

/* FNV-1a. The hashes of entries are added up, so that the order of listing does not matter. */
static uint64_t hash_bytes(uint64_t hash, const void *bytes, size_t n)
{
    for (const unsigned char *p = bytes; n > 0; n--)
        hash = (hash ^ *p++) * 0x100000001b3u;
    return hash;
}

static uint64_t hash_entry(const char *name, const struct stat *facts)
{
    int64_t numbers[3] = { (int64_t)facts->st_size, (int64_t)facts->st_mtim.tv_sec, (int64_t)facts->st_mtim.tv_nsec };
    return hash_bytes(hash_bytes(0xcbf29ce484222325u, name, strlen(name)), numbers, sizeof numbers);
}

struct looked_at {
    uint64_t fingerprint;
    size_t n_files, n_folders;
    bool has_plan_json;
    char **subfolders; /* names */
};

static int compare_names(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static bool look_at(const char *path, bool wants_names, struct looked_at *seen)
{
    memset(seen, 0, sizeof *seen);
    DIR *folder = opendir(path);
    if (!folder)
        return false;
    if (wants_names)
        seen->subfolders = mem_new(FOLDERS_MAX_ENTRIES * sizeof *seen->subfolders);
    const struct dirent *entry;
    for (size_t n = 0; n < FOLDERS_MAX_ENTRIES && (entry = readdir(folder)); n++) {
        struct stat facts;
        if (entry->d_name[0] == '.' || fstatat(dirfd(folder), entry->d_name, &facts, 0) != 0)
            continue;
        seen->fingerprint += hash_entry(entry->d_name, &facts);
        if (S_ISDIR(facts.st_mode)) {
            if (wants_names)
                seen->subfolders[seen->n_folders] = mem_copy_text(entry->d_name);
            seen->n_folders++;
        } else if (S_ISREG(facts.st_mode)) {
            seen->n_files++;
            seen->has_plan_json |= strcmp(entry->d_name, "plan.json") == 0;
        }
    }
    closedir(folder);
    if (wants_names)
        qsort(seen->subfolders, seen->n_folders, sizeof *seen->subfolders, compare_names);
    return true;
}

static void looked_at_finish(struct looked_at *seen)
{
    for (size_t i = 0; seen->subfolders && i < seen->n_folders; i++)
        free(seen->subfolders[i]);
    free(seen->subfolders);
}

static void add(struct folder_list *list, const char *path, const char *name, uint64_t fingerprint)
{
    char *real = path_resolve(path);
    if (!real)
        return;
    bool is_known = false;
    for (size_t i = 0; i < list->n_folders && !is_known; i++)
        is_known = strcmp(list->folders[i].path, real) == 0;
    if (is_known || list->n_folders >= FOLDERS_MAX_PLANS) {
        list->n_left_out += !is_known;
        free(real);
        return;
    }
    list->folders[list->n_folders++] = (struct plan_folder){ real, mem_copy_text(name), fingerprint };
}

static const char *last_part(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash && slash[1] ? slash + 1 : path;
}

static bool join(char path[PATH_MAX], const char *folder, const char *name)
{
    int n = snprintf(path, PATH_MAX, "%s/%s", folder, name);
    return n > 0 && n < PATH_MAX;
}

/* A collection: a subfolder that is no plan but holds plans. Returns true when it holds any. */
static bool add_inner(struct folder_list *list, const char *path, const char *name, const struct looked_at *seen)
{
    bool has_any = false;
    for (size_t i = 0; i < seen->n_folders; i++) {
        char inner[PATH_MAX], full_name[512];
        struct looked_at inside = { 0 };
        if (!join(inner, path, seen->subfolders[i]) || !look_at(inner, false, &inside) || !inside.has_plan_json)
            continue;
        (void)snprintf(full_name, sizeof full_name, "%.250s %.250s", name, seen->subfolders[i]);
        add(list, inner, full_name, inside.fingerprint);
        has_any = true;
    }
    return has_any;
}

static void list_one(const char *given, struct folder_list *list)
{
    char *real = path_resolve(given);
    struct looked_at seen = { 0 };
    if (!real || !look_at(real, true, &seen)) {
        if (!list->problem[0])
            (void)snprintf(list->problem, sizeof list->problem, "%.150s: %s", given, strerror(errno));
        free(real);
        return;
    }
    if (seen.has_plan_json || (seen.n_folders == 0 && seen.n_files > 0)) {
        add(list, real, last_part(real), seen.fingerprint);
    } else {
        for (size_t i = 0; i < seen.n_folders; i++) {
            char path[PATH_MAX];
            struct looked_at inside = { 0 };
            if (!join(path, real, seen.subfolders[i]))
                continue;
            /* an unreadable folder is listed too: its scan says why */
            bool is_read = look_at(path, true, &inside);
            if (!is_read || inside.has_plan_json || !add_inner(list, path, seen.subfolders[i], &inside))
                add(list, path, seen.subfolders[i], inside.fingerprint);
            looked_at_finish(&inside);
        }
    }
    looked_at_finish(&seen);
    free(real);
}

void folders_list(const char *const *given, size_t n_given, struct folder_list *list)
{
    memset(list, 0, sizeof *list);
    list->folders = mem_new(FOLDERS_MAX_PLANS * sizeof *list->folders);
    for (size_t i = 0; i < n_given; i++)
        list_one(given[i], list);
}

void folder_list_finish(struct folder_list *list)
{
    for (size_t i = 0; i < list->n_folders; i++) {
        free(list->folders[i].path);
        free(list->folders[i].name);
    }
    free(list->folders);
    memset(list, 0, sizeof *list);
}

void folder_make_id(const char *name, char id[64])
{
    size_t n = 0;
    for (; *name && n < 59; name++) { /* leaves room for a number, "-999" */
        char c = *name >= 'A' && *name <= 'Z' ? (char)(*name - 'A' + 'a') : *name;
        bool is_plain = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
        if (is_plain)
            id[n++] = c;
        else if (n > 0 && id[n - 1] != '-')
            id[n++] = '-';
    }
    while (n > 0 && id[n - 1] == '-')
        n--;
    id[n] = 0;
    if (n == 0)
        memcpy(id, "plan", 5);
}
