/* Walks a plan's folder and computes its digest by libsodium. */
#include "server/renderer/digest.h"

#include <errno.h>
#include <fcntl.h>
#include <fts.h>
#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/mem.h"
#include "core/plan/origin.h"

enum { READ_BYTES = 1 << 20 };

struct file {
    char *path;                                           /* below the folder */
    int64_t size, time_s, time_ns, changed_s, changed_ns; /* changed: of content or facts, which no program sets back */
    uint64_t inode;
};

struct files {
    struct file *list;
    size_t n;
    const struct digest_watch *watch;
    double n_all, n_read; /* bytes */
};

static int compare(const void *a, const void *b)
{
    return strcmp(((const struct file *)a)->path, ((const struct file *)b)->path);
}

static void finish(struct files *files)
{
    for (size_t i = 0; i < files->n; i++)
        free(files->list[i].path);
    free(files->list);
}

static bool add(struct files *files, const char *path, const struct stat *facts, struct error *err)
{
    if (files->n == DIGEST_MAX_FILES)
        return error_set(err, ERROR_LIMIT, "the folder has more than %d files", DIGEST_MAX_FILES);
    if (files->n % 256 == 0) {
        void *more = realloc(files->list, (files->n + 256) * sizeof files->list[0]);
        if (!more)
            return error_set(err, ERROR_MEMORY, "no memory for a list of %zu files", files->n + 256);
        files->list = more;
    }
    files->list[files->n++] = (struct file){ .path = mem_copy_text(path),
                                             .size = (int64_t)facts->st_size,
                                             .time_s = (int64_t)facts->st_mtim.tv_sec,
                                             .time_ns = (int64_t)facts->st_mtim.tv_nsec,
                                             .changed_s = (int64_t)facts->st_ctim.tv_sec,
                                             .changed_ns = (int64_t)facts->st_ctim.tv_nsec,
                                             .inode = (uint64_t)facts->st_ino };
    return true;
}

/* A link that leads nowhere or out of the folder, where a confined process may not look: no part of a plan either.
 * root: the folder without links in its path. */
static bool leads_out(const FTSENT *entry, const char *root)
{
    struct stat facts;
    char target[PATH_MAX];
    const size_t n = strlen(root);
    if (entry->fts_level == 0 || lstat(entry->fts_path, &facts) != 0 || !S_ISLNK(facts.st_mode))
        return false;
    return !realpath(entry->fts_path, target) || strncmp(target, root, n) != 0 || target[n] != '/';
}

static bool walk(const char *folder, struct files *files, struct error *err)
{
    char *root = mem_copy_text(folder), plain[PATH_MAX] = "";
    char *const roots[] = { root, NULL };
    const size_t n_root = strlen(folder);
    bool ok = true;
    if (!realpath(folder, plain))
        plain[0] = 0;
    errno = 0;
    FTS *tree = fts_open(roots, FTS_LOGICAL | FTS_NOCHDIR, NULL);
    for (FTSENT *entry; ok && tree && (entry = fts_read(tree));) {
        const bool is_hidden = entry->fts_level > 0 && entry->fts_name[0] == '.';
        if ((is_hidden || leads_out(entry, plain)) && entry->fts_info == FTS_D)
            (void)fts_set(tree, entry, FTS_SKIP);
        else if (is_hidden || leads_out(entry, plain))
            continue;
        else if (entry->fts_info == FTS_DNR || entry->fts_info == FTS_ERR || entry->fts_info == FTS_NS)
            ok = error_set(err, ERROR_IO, "%.100s: %s", entry->fts_name, strerror(entry->fts_errno));
        else if (entry->fts_info == FTS_F)
            ok = add(files, entry->fts_path + n_root + (entry->fts_path[n_root] == '/'), entry->fts_statp, err);
    }
    if (!tree)
        ok = error_set(err, ERROR_IO, "%s", strerror(errno));
    else
        (void)fts_close(tree);
    free(root);
    if (ok && files->n)
        qsort(files->list, files->n, sizeof files->list[0], compare);
    return ok;
}

static void write_hex(crypto_hash_sha256_state *state, char hex[65])
{
    unsigned char bytes[crypto_hash_sha256_BYTES];
    (void)crypto_hash_sha256_final(state, bytes);
    (void)sodium_bin2hex(hex, 65, bytes, sizeof bytes);
}

static void add_text(crypto_hash_sha256_state *state, const char *text, size_t n)
{
    (void)crypto_hash_sha256_update(state, (const unsigned char *)text, n);
}

static void make_key(const struct files *files, char key[65])
{
    crypto_hash_sha256_state state;
    (void)crypto_hash_sha256_init(&state);
    for (size_t i = 0; i < files->n; i++) {
        const struct file *file = &files->list[i];
        char facts[160];
        (void)snprintf(facts, sizeof facts, "%" PRId64 " %" PRId64 " %" PRId64 " %" PRId64 " %" PRId64 " %" PRIu64 "\n",
                       file->size, file->time_s, file->time_ns, file->changed_s, file->changed_ns, file->inode);
        add_text(&state, file->path, strlen(file->path) + 1);
        add_text(&state, facts, strlen(facts));
    }
    write_hex(&state, key);
}

static bool goes_on(struct files *files, double n_more, struct error *err)
{
    files->n_read += n_more;
    return !files->watch ||
           files->watch->goes_on(files->watch->context, 100 * files->n_read / fmax(files->n_all, files->n_read)) ||
           error_set(err, ERROR_CANCELLED, "reading the files was stopped");
}

static bool digest_file(struct files *files, int folder, const char *path, unsigned char *buffer, char hex[65],
                        uint64_t *n_bytes, struct error *err)
{
    crypto_hash_sha256_state state;
    ssize_t n = -1;
    bool ok = true;
    int fd = openat(folder, path, O_RDONLY | O_CLOEXEC | O_NOCTTY);
    (void)crypto_hash_sha256_init(&state);
    while (ok && fd >= 0 && ((n = read(fd, buffer, READ_BYTES)) > 0 || (n < 0 && errno == EINTR)))
        if (n > 0) {
            (void)crypto_hash_sha256_update(&state, buffer, (unsigned long long)n);
            *n_bytes += (uint64_t)n;
            ok = goes_on(files, (double)n, err);
        }
    if (ok && (fd < 0 || n < 0))
        error_set(err, ERROR_IO, "%.100s: %s", path, strerror(errno));
    if (fd >= 0)
        (void)close(fd);
    write_hex(&state, hex);
    return ok && fd >= 0 && n == 0;
}

static bool digest_files(const char *path, struct files *files, char hex[65], uint64_t *n_bytes, struct error *err)
{
    crypto_hash_sha256_state state;
    unsigned char *buffer = malloc(READ_BYTES);
    int folder = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    bool ok = buffer && folder >= 0;
    if (!ok)
        error_set(err, ERROR_IO, "%s", strerror(errno));
    (void)crypto_hash_sha256_init(&state);
    for (size_t i = 0; i < files->n; i++)
        files->n_all += (double)files->list[i].size;
    for (size_t i = 0; ok && i < files->n; i++) {
        char own[65];
        ok = digest_file(files, folder, files->list[i].path, buffer, own, n_bytes, err);
        add_text(&state, own, 64);
        add_text(&state, "  ", 2);
        add_text(&state, files->list[i].path, strlen(files->list[i].path));
        add_text(&state, "\n", 1);
    }
    write_hex(&state, hex);
    if (folder >= 0)
        (void)close(folder);
    free(buffer);
    return ok;
}

cJSON *digest_folder(const char *folder, const char *known, const struct digest_watch *watch)
{
    struct files files = { .watch = watch };
    struct error err = { 0 };
    char key[65] = "", revision[65] = "";
    uint64_t n_bytes = 0;
    cJSON *json = cJSON_CreateObject();
    bool ok = walk(folder, &files, &err);
    if (ok) {
        make_key(&files, key);
        if (!known || strcmp(known, key) != 0)
            ok = digest_files(folder, &files, revision, &n_bytes, &err);
    }
    if (ok) {
        cJSON_AddStringToObject(json, "key", key);
        cJSON_AddNumberToObject(json, "n_files", (double)files.n);
        if (revision[0]) {
            cJSON_AddStringToObject(json, "revision", revision);
            cJSON_AddNumberToObject(json, "n_bytes", (double)n_bytes);
        }
    } else {
        cJSON_AddStringToObject(json, "reason", err.text);
    }
    finish(&files);
    return json;
}

void patients_seen(const struct plan_patient *patients, size_t n, char hex[65])
{
    crypto_hash_sha256_state state;
    (void)crypto_hash_sha256_init(&state);
    for (size_t i = 0; i < n; i++) {
        const char *const texts[] = { patients[i].id, patients[i].issuer, patients[i].name, patients[i].birth_date };
        for (size_t k = 0; k < sizeof texts / sizeof texts[0]; k++)
            add_text(&state, texts[k], strlen(texts[k]) + 1);
    }
    write_hex(&state, hex);
}
