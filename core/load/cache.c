/* Keeps an opened plan in one file, and reads it back. */
#define _GNU_SOURCE
#include "core/load/cache.h"

#include <errno.h>
#include <fcntl.h>
#include <libdeflate.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/load/cache_fields.h"

/* Layout of the file: struct file_start; the head, which holds the sources, the plan's fields and a checksum for each
 * piece of voxels; then the voxels of each volume, aligned. Numbers are in the machine's byte order; a file of another
 * order is refused like one of another version. */
enum { PIECE_BYTES = 8 << 20, ALIGNED = 4096 };
#define MAX_BYTES ((uint64_t)PLAN_CACHE_MAX_MIB << 20)

struct file_start {
    char magic[8];
    uint32_t order, format;
    char version[24];
    uint64_t head_bytes;
    uint32_t head_check, none;
};

struct plan_sources {
    struct folder_tree tree;
};

struct plan_sources *plan_sources_create(struct folder_tree *tree)
{
    if (tree->is_cut) {
        folder_tree_finish(tree);
        return NULL;
    }
    struct plan_sources *sources = mem_new(sizeof *sources);
    sources->tree = *tree;
    *tree = (struct folder_tree){ 0 };
    return sources;
}

void plan_sources_destroy(struct plan_sources *sources)
{
    if (!sources)
        return;
    folder_tree_finish(&sources->tree);
    free(sources);
}

static struct file_start make_start(const struct fields *head)
{
    struct file_start start = {
        .magic = "BEAMPLAN", .order = 0x01020304, .format = PLAN_CACHE_FORMAT, .head_bytes = head->size
    };
    snprintf(start.version, sizeof start.version, "%s", BEAMROOM_VERSION);
    start.head_check = libdeflate_crc32(0, head->data, head->size);
    return start;
}

static uint64_t voxel_bytes(const struct volume *volume)
{
    return (uint64_t)grid_n_voxels(&volume->grid) * voxel_size(volume->type);
}

static uint64_t aligned(uint64_t at)
{
    return (at + ALIGNED - 1) / ALIGNED * ALIGNED;
}

/* When writing: stores the list of files. When reading: compares it, and sets is_bad where a file differs. */
static void fields_sources(struct fields *fields, const struct plan_sources *sources)
{
    uint64_t n = sources->tree.n_files;
    fields_u64(fields, &n);
    fields->is_bad |= n != sources->tree.n_files;
    for (size_t i = 0; i < sources->tree.n_files && !fields->is_bad; i++) {
        const struct folder_file *file = &sources->tree.files[i];
        struct folder_file found = *file;
        char name[FOLDER_NAME_SIZE];
        snprintf(name, sizeof name, "%s", file->name);
        fields_text(fields, name, sizeof name);
        fields_u64(fields, &found.bytes);
        fields_u64(fields, &found.inode);
        fields_bytes(fields, &found.modified_ns, sizeof found.modified_ns);
        fields->is_bad |= strcmp(name, file->name) != 0 || found.bytes != file->bytes || found.inode != file->inode ||
                          found.modified_ns != file->modified_ns;
    }
}

/* ---- pieces of voxels, by several threads ----------------------------------------------------------------------- */

struct pieces {
    int fd;
    bool is_reading;
    struct volume *const *volumes;
    size_t n_volumes, n_pieces;
    uint64_t *voxels_at; /* [n_volumes] offset in the file */
    size_t *first;       /* [n_volumes] index of each volume's first piece */
    uint32_t *checks;    /* [n_pieces] */
    const struct plan_cache_reading *reading;
    atomic_size_t next;
    atomic_bool has_failed;
};

static void count_pieces(struct pieces *pieces)
{
    pieces->voxels_at = mem_new((pieces->n_volumes + 1) * sizeof *pieces->voxels_at);
    pieces->first = mem_new((pieces->n_volumes + 1) * sizeof *pieces->first);
    for (size_t v = 0; v < pieces->n_volumes; v++) {
        pieces->first[v] = pieces->n_pieces;
        pieces->n_pieces += (size_t)((voxel_bytes(pieces->volumes[v]) + PIECE_BYTES - 1) / PIECE_BYTES);
    }
    pieces->checks = mem_new((pieces->n_pieces + 1) * sizeof *pieces->checks);
}

/* Computes the places of the voxels behind a head of head_bytes. Returns the size of the file. */
static uint64_t place_voxels(struct pieces *pieces, uint64_t head_bytes)
{
    uint64_t at = aligned(sizeof(struct file_start) + head_bytes);
    for (size_t v = 0; v < pieces->n_volumes; v++) {
        pieces->voxels_at[v] = at;
        at = aligned(at + voxel_bytes(pieces->volumes[v]));
    }
    return at;
}

static void finish_pieces(struct pieces *pieces)
{
    free(pieces->voxels_at);
    free(pieces->first);
    free(pieces->checks);
}

static bool transfer(int fd, bool is_reading, uint8_t *bytes, size_t n, uint64_t at)
{
    while (n > 0) {
        ssize_t done = is_reading ? pread(fd, bytes, n, (off_t)at) : pwrite(fd, bytes, n, (off_t)at);
        if (done < 0 && errno == EINTR)
            continue;
        if (done <= 0)
            return false;
        bytes += done;
        n -= (size_t)done;
        at += (uint64_t)done;
    }
    return true;
}

static bool move_piece(struct pieces *pieces, size_t piece)
{
    size_t v = pieces->n_volumes - 1;
    while (pieces->first[v] > piece)
        v--;
    uint64_t from = (uint64_t)(piece - pieces->first[v]) * PIECE_BYTES, left = voxel_bytes(pieces->volumes[v]) - from;
    size_t n = left < PIECE_BYTES ? (size_t)left : PIECE_BYTES;
    uint8_t *voxels = (uint8_t *)pieces->volumes[v]->voxels + from;
    if (!transfer(pieces->fd, pieces->is_reading, voxels, n, pieces->voxels_at[v] + from))
        return false;
    uint32_t check = libdeflate_crc32(0, voxels, n);
    if (!pieces->is_reading)
        pieces->checks[piece] = check;
    else if (pieces->reading->step)
        pieces->reading->step(pieces->reading->context, n);
    return pieces->checks[piece] == check;
}

static void move_some(void *context, int part, int n_parts)
{
    (void)part;
    (void)n_parts;
    struct pieces *pieces = context;
    for (size_t piece; (piece = atomic_fetch_add(&pieces->next, 1)) < pieces->n_pieces;) {
        bool is_cancelled = pieces->is_reading && pieces->reading->cancel && atomic_load(pieces->reading->cancel);
        if (is_cancelled || atomic_load(&pieces->has_failed) || !move_piece(pieces, piece))
            atomic_store(&pieces->has_failed, true);
    }
}

static bool move_pieces(struct pieces *pieces)
{
    atomic_init(&pieces->next, 0);
    atomic_init(&pieces->has_failed, false);
    parallel_run(parallel_cores(), move_some, pieces);
    return !atomic_load(&pieces->has_failed);
}

/* ---- writing ---------------------------------------------------------------------------------------------------- */

/* True if a file of n_bytes is within the process's limit on file size and leaves PLAN_CACHE_LEAVES_MIB on the disk. */
static bool has_room(int folder, uint64_t n_bytes)
{
    struct rlimit limit;
    struct statvfs disk;
    bool is_allowed =
        getrlimit(RLIMIT_FSIZE, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY || n_bytes <= limit.rlim_cur;
    return is_allowed && (fstatvfs(folder, &disk) != 0 ||
                          (uint64_t)disk.f_bavail * disk.f_frsize >= n_bytes + ((uint64_t)PLAN_CACHE_LEAVES_MIB << 20));
}

static bool write_file(int fd, const struct plan *plan, const struct plan_sources *sources, uint64_t *n_bytes)
{
    union { /* fields_plan does not change the plan when it writes */
        const struct plan *frozen;
        struct plan *plan;
    } of = { plan };
    struct fields fields = { 0 }, head = { 0 };
    fields_plan(&fields, of.plan);
    struct pieces pieces = { .fd = fd, .volumes = fields.volumes, .n_volumes = fields.n_volumes };
    count_pieces(&pieces);
    fields_sources(&head, sources);
    uint64_t n_fields = fields.size;
    fields_u64(&head, &n_fields);
    fields_bytes(&head, fields.data, fields.size);
    uint64_t head_bytes = head.size + pieces.n_pieces * sizeof *pieces.checks;
    *n_bytes = place_voxels(&pieces, head_bytes);
    bool is_written = !fields.is_bad && !head.is_bad && *n_bytes <= MAX_BYTES &&
                      head_bytes <= (uint64_t)PLAN_CACHE_MAX_HEAD_MIB << 20 && has_room(fd, *n_bytes) &&
                      move_pieces(&pieces);
    if (is_written) {
        fields_bytes(&head, pieces.checks, pieces.n_pieces * sizeof *pieces.checks);
        struct file_start start = make_start(&head);
        is_written = !head.is_bad && transfer(fd, false, head.data, head.size, sizeof start) &&
                     transfer(fd, false, (uint8_t *)&start, sizeof start, 0) && ftruncate(fd, (off_t)*n_bytes) == 0;
    }
    finish_pieces(&pieces);
    free(fields.data);
    free(head.data);
    if (fields.lacks_memory || head.lacks_memory)
        errno = ENOMEM;
    return is_written;
}

bool plan_cache_store(const struct plan *plan, const struct plan_sources *sources, const char *cache_folder,
                      struct error *err)
{
    static const char partial[] = PLAN_CACHE_NAME ".part";
    if (!sources || plan->is_from_cache)
        return true;
    int folder = open(cache_folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder < 0)
        return error_set(err, ERROR_IO, "the cache folder cannot be entered: %s", strerror(errno));
    (void)unlinkat(folder, partial, 0);
    uint64_t n_bytes = 0;
    int fd = openat(folder, partial, O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
    bool is_written = fd >= 0 && write_file(fd, plan, sources, &n_bytes);
    int reason = errno;
    if (fd >= 0 && close(fd) != 0)
        is_written = false;
    is_written = is_written && renameat(folder, partial, folder, PLAN_CACHE_NAME) == 0;
    if (!is_written) {
        (void)unlinkat(folder, partial, 0);
        if (n_bytes > MAX_BYTES)
            error_set(err, ERROR_LIMIT, "%llu bytes are more than are kept, %d MiB", (unsigned long long)n_bytes,
                      PLAN_CACHE_MAX_MIB);
        else if (!has_room(folder, n_bytes))
            error_set(err, ERROR_LIMIT,
                      "%llu bytes are more than a file may have here, or than leave %d MiB on the disk",
                      (unsigned long long)n_bytes, PLAN_CACHE_LEAVES_MIB);
        else
            error_set(err, reason == ENOMEM ? ERROR_MEMORY : ERROR_IO, "the opened plan cannot be kept: %s",
                      strerror(reason));
    }
    close(folder);
    return is_written;
}

/* ---- reading ---------------------------------------------------------------------------------------------------- */

/* Reads the head and checks version and checksum. The caller frees head->data, also after a failure. */
static bool read_head(int fd, uint64_t file_bytes, struct fields *head)
{
    struct file_start start, expected;
    if (file_bytes < sizeof start || file_bytes > MAX_BYTES ||
        !transfer(fd, true, (uint8_t *)&start, sizeof start, 0) || start.head_bytes > file_bytes - sizeof start ||
        start.head_bytes > (uint64_t)PLAN_CACHE_MAX_HEAD_MIB << 20)
        return false;
    uint8_t *data = mem_array((size_t)start.head_bytes + 1, 1, UINT64_MAX, NULL);
    if (!data)
        return false;
    *head = (struct fields){ .is_reading = true, .data = data, .size = (size_t)start.head_bytes };
    if (!transfer(fd, true, data, head->size, sizeof start))
        return false;
    expected = make_start(head);
    return memcmp(&start, &expected, sizeof start) == 0;
}

static bool read_voxels(int fd, uint64_t file_bytes, struct fields *head, const struct fields *plan_fields,
                        const struct plan_cache_reading *reading)
{
    struct pieces pieces = { .fd = fd,
                             .is_reading = true,
                             .volumes = plan_fields->volumes,
                             .n_volumes = plan_fields->n_volumes,
                             .reading = reading };
    uint64_t n_bytes = 0;
    for (size_t v = 0; v < pieces.n_volumes; v++) {
        n_bytes += voxel_bytes(pieces.volumes[v]);
        if (n_bytes > file_bytes || (reading->max_bytes > 0 && n_bytes > reading->max_bytes))
            return false; /* checked before any voxels are allocated */
    }
    count_pieces(&pieces);
    bool is_read = head->size - head->at == pieces.n_pieces * sizeof *pieces.checks &&
                   place_voxels(&pieces, head->size) == file_bytes;
    if (is_read)
        fields_bytes(head, pieces.checks, pieces.n_pieces * sizeof *pieces.checks);
    if (is_read && reading->begin)
        reading->begin(reading->context, n_bytes);
    for (size_t v = 0; is_read && v < pieces.n_volumes; v++) {
        struct volume *volume = pieces.volumes[v];
        volume->voxels =
            mem_large_array(grid_n_voxels(&volume->grid), voxel_size(volume->type), VOLUME_MAX_BYTES, NULL);
        is_read = volume->voxels != NULL;
    }
    is_read = is_read && move_pieces(&pieces);
    finish_pieces(&pieces);
    return is_read;
}

static void release_parts(struct plan *plan)
{
    for (size_t i = 0; i < PLAN_MAX_IMAGES; i++)
        volume_unref(plan->images[i].volume);
    region_set_finish(&plan->regions);
    for (size_t d = 0; d < PLAN_MAX_DOSES; d++) {
        for (size_t c = 0; c < DOSE_N_QUANTITIES; c++) {
            volume_unref(plan->doses[d].components[c].values);
            volume_unref(plan->doses[d].components[c].error);
        }
        volume_unref(plan->doses[d].mask);
    }
    track_set_finish(&plan->tracks);
    free(plan->region_origins);
    for (size_t c = 0; c < PLAN_MAX_CURVES; c++)
        dose_curve_finish(&plan->curves[c]);
    report_finish(&plan->report);
}

static bool read_file(int fd, const struct plan_sources *sources, const struct plan_cache_reading *reading,
                      struct plan *plan)
{
    struct stat about;
    struct fields head = { 0 };
    if (fstat(fd, &about) != 0 || !S_ISREG(about.st_mode))
        return false;
    bool is_read = read_head(fd, (uint64_t)about.st_size, &head);
    uint64_t n_fields = 0;
    if (is_read) {
        fields_sources(&head, sources);
        fields_u64(&head, &n_fields);
        is_read = !head.is_bad && n_fields <= head.size - head.at;
    }
    if (is_read) {
        struct fields fields = { .is_reading = true, .data = head.data + head.at, .size = (size_t)n_fields };
        head.at += (size_t)n_fields;
        fields_plan(&fields, plan);
        is_read = !fields.is_bad && read_voxels(fd, (uint64_t)about.st_size, &head, &fields, reading);
    }
    free(head.data);
    return is_read;
}

bool plan_cache_read(const char *cache_folder, const struct plan_sources *sources,
                     const struct plan_cache_reading *reading, struct plan *plan)
{
    char path[PATH_MAX];
    int n = snprintf(path, sizeof path, "%s/%s", cache_folder, PLAN_CACHE_NAME);
    int fd = n > 0 && n < (int)sizeof path ? open(path, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC) : -1;
    if (fd < 0)
        return false;
    struct plan *read = mem_new(sizeof *read);
    bool is_read = read_file(fd, sources, reading, read);
    close(fd);
    if (is_read) {
        region_set_measure(&read->regions);
        memcpy(read->id, plan->id, sizeof read->id);
        *plan = *read;
    } else {
        release_parts(read);
    }
    free(read);
    return is_read;
}
