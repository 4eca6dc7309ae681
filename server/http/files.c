/* Reads the files of the page into memory at start, and finds one by its path. */
#define _GNU_SOURCE
#include "server/http/files.h"

#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/mem.h"
#include "server/wire/fields.h"

struct files {
    struct file *files;
    size_t n;
};

static const char *media_type_of(const char *name)
{
    static const char *const types[][2] = {
        { ".html", "text/html; charset=utf-8" },
        { ".css", "text/css; charset=utf-8" },
        { ".js", "text/javascript; charset=utf-8" },
        { ".mjs", "text/javascript; charset=utf-8" },
        { ".json", "application/json" },
        { ".svg", "image/svg+xml" },
        { ".png", "image/png" },
        { ".ico", "image/x-icon" },
        { ".woff2", "font/woff2" },
        { ".txt", "text/plain; charset=utf-8" },
        { ".webmanifest", "application/manifest+json" },
    };
    size_t n = strlen(name);
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
        size_t ending = strlen(types[i][0]);
        if (n > ending && strcmp(name + n - ending, types[i][0]) == 0)
            return types[i][1];
    }
    return NULL;
}

/* FNV-1a, 64 bits: only tells contents apart for caching. */
static uint64_t hash_bytes(const uint8_t *bytes, size_t n)
{
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t i = 0; i < n; i++)
        hash = (hash ^ bytes[i]) * 0x100000001b3u;
    return hash;
}

/* Reads one file into form. */
static bool read_form(const char *name, struct file_form *form, struct error *err)
{
    struct stat facts;
    FILE *stream = fopen(name, "rbe");
    if (!stream || fstat(fileno(stream), &facts) != 0) {
        if (stream)
            fclose(stream);
        return error_set(err, ERROR_IO, "%s: %s", name, strerror(errno));
    }
    if (!S_ISREG(facts.st_mode) || facts.st_size > FILES_MAX_BYTES) {
        fclose(stream);
        return error_set(err, ERROR_LIMIT, "%s: not a file, or over %d bytes", name, FILES_MAX_BYTES);
    }
    form->n_bytes = (size_t)facts.st_size;
    form->bytes = mem_new(form->n_bytes + 1);
    size_t got = fread(form->bytes, 1, form->n_bytes, stream);
    fclose(stream);
    if (got != form->n_bytes)
        return error_set(err, ERROR_IO, "%s: %zu bytes read, %zu expected", name, got, form->n_bytes);
    (void)snprintf(form->etag, sizeof form->etag, "\"%016" PRIx64 "\"", hash_bytes(form->bytes, form->n_bytes));
    return true;
}

static bool add_file(struct files *files, const char *folder, const char *path, const char *media_type,
                     struct error *err)
{
    static const char *const endings[N_CODINGS] = { "", ".gz", ".br" };
    if (files->n == FILES_MAX || strlen(path) >= sizeof files->files->path)
        return error_set(err, ERROR_LIMIT, "%s%s: its path is too long, or there are more than %d files", folder, path,
                         FILES_MAX);
    struct file *file = &files->files[files->n++];
    memcpy(file->path, path, strlen(path) + 1);
    file->media_type = media_type;
    file->is_immutable = strncmp(path, "/page/", strlen("/page/")) == 0;
    for (enum content_coding coding = CODING_IDENTITY; coding < N_CODINGS; coding++) {
        char name[4096];
        (void)snprintf(name, sizeof name, "%s%s%s", folder, path, endings[coding]);
        if (coding != CODING_IDENTITY && access(name, F_OK) != 0)
            continue;
        if (!read_form(name, &file->forms[coding], err))
            return false;
        file->has_forms = coding != CODING_IDENTITY;
    }
    return true;
}

static bool add_folder(struct files *files, const char *folder, const char *below, int depth, struct error *err)
{
    char path[4096];
    (void)snprintf(path, sizeof path, "%s%s", folder, below);
    DIR *dir = opendir(path);
    if (!dir)
        return error_set(err, ERROR_IO, "%s: %s", path, strerror(errno));
    bool ok = true;
    for (struct dirent *entry; ok && (entry = readdir(dir));) {
        char inner[512];
        struct stat facts;
        if (entry->d_name[0] == '.')
            continue;
        int n = snprintf(inner, sizeof inner, "%s/%s", below, entry->d_name);
        if (n < 0 || (size_t)n >= sizeof inner || fstatat(dirfd(dir), entry->d_name, &facts, 0) != 0)
            continue;
        const char *media_type = media_type_of(entry->d_name);
        if (S_ISDIR(facts.st_mode) && depth < 8)
            ok = add_folder(files, folder, inner, depth + 1, err);
        else if (S_ISREG(facts.st_mode) && media_type)
            ok = add_file(files, folder, inner, media_type, err);
    }
    closedir(dir);
    return ok;
}

struct files *files_create(const char *folder, struct error *err)
{
    struct files *files = mem_new(sizeof *files);
    files->files = mem_new(FILES_MAX * sizeof *files->files);
    if (!add_folder(files, folder, "", 0, err)) {
        files_destroy(files);
        return NULL;
    }
    if (!files_find(files, "/")) {
        error_set(err, ERROR_NOT_FOUND, "%s holds no index.html: is it the page's folder?", folder);
        files_destroy(files);
        return NULL;
    }
    return files;
}

void files_destroy(struct files *files)
{
    if (!files)
        return;
    for (size_t i = 0; i < files->n; i++)
        for (enum content_coding coding = CODING_IDENTITY; coding < N_CODINGS; coding++)
            free(files->files[i].forms[coding].bytes);
    free(files->files);
    free(files);
}

static bool is_id_behind(const char *path, const char *start)
{
    size_t n = strlen(start);
    return strncmp(path, start, n) == 0 && id_is_valid(path + n);
}

/* /signin/proxy is not the page's: a proxy in front asks there. */
static bool is_sign_in(const char *path)
{
    static const char *const paths[] = { "/signin", "/signin/first", "/signin/done" };
    for (size_t i = 0; i < sizeof paths / sizeof paths[0]; i++)
        if (strcmp(path, paths[i]) == 0)
            return true;
    return false;
}

/* /meetings/ID, and its minutes. */
static bool is_meeting(const char *path)
{
    static const char minutes[] = "/minutes";
    const size_t n = strlen(path), n_end = sizeof minutes - 1;
    char head[128];
    const bool is_minutes = n > n_end && n < sizeof head && strcmp(path + n - n_end, minutes) == 0;
    (void)snprintf(head, sizeof head, "%.*s", is_minutes ? (int)(n - n_end) : 0, path);
    return is_id_behind(is_minutes ? head : path, "/meetings/");
}

/* The list of kept records, and the paper of one. */
static bool is_of_records(const char *path)
{
    return strcmp(path, "/records") == 0 || is_id_behind(path, "/records/");
}

const struct file *files_find(const struct files *files, const char *path)
{
    if (strcmp(path, "/") == 0 || is_sign_in(path) || is_id_behind(path, "/rooms/") || is_meeting(path) ||
        is_of_records(path))
        path = "/index.html";
    else if (is_id_behind(path, "/display/"))
        path = "/display.html";
    for (size_t i = 0; i < files->n; i++)
        if (strcmp(files->files[i].path, path) == 0)
            return &files->files[i];
    return NULL;
}

enum content_coding file_coding(const struct file *file, const char *accept)
{
    bool exists[N_CODINGS];
    for (enum content_coding coding = CODING_IDENTITY; coding < N_CODINGS; coding++)
        exists[coding] = file->forms[coding].bytes != NULL;
    return coding_choose(accept, exists);
}
