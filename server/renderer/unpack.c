/* Walks the entries of an archive, checks each and writes it. */
#define _GNU_SOURCE
#include "server/renderer/unpack.h"

#include <archive.h>
#include <archive_entry.h>
#include <errno.h>
#include <locale.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "server/renderer/unpack_name.h"
#include "server/renderer/unpack_source.h"
#include "server/renderer/unpack_write.h"

enum { HEADER_BYTES = 2048 }; /* headers and padding of one tar entry, at most */

struct unpacker {
    const struct unpack_options *options;
    struct archive *archive;
    struct unpack_source source;
    struct unpack_writer writer;
    struct unpack_names names;
    struct unpack_result result;
    struct problem problem;
    uint64_t most;   /* limit of the bytes of all entries together */
    uint64_t n_read; /* bytes of entries so far, litter included */
    uint32_t n_entries;
    int64_t entry_at;           /* of a tar: offset of the current entry */
    char top[FOLDER_NAME_SIZE]; /* first part of the first name */
    bool has_one_top, is_top_folder;
    char last_parent[FOLDER_NAME_SIZE]; /* a folder that exists with all above it */
    int64_t start_cpu_ms, reported_us;
    double percent;
};

uint64_t unpack_cpu_seconds(uint64_t archive_bytes, uint64_t max_bytes)
{
    return UNPACK_CPU_S + archive_bytes / UNPACK_CPU_BYTES_PER_S + max_bytes / UNPACK_CPU_BYTES_PER_S;
}

static int64_t cpu_ms(void)
{
    struct timespec now;
    return clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now) == 0 ? (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000 : 0;
}

static void report_progress(struct unpacker *unpacker)
{
    int64_t now_us = clock_now_us();
    if (!unpacker->options->progress || now_us - unpacker->reported_us < (int64_t)UNPACK_PERCENT_MS * 1000 ||
        unpacker->source.n_bytes == 0)
        return;
    /* a zip's directory is at its end and is read first, so the offset says nothing: count the bytes read */
    double percent = 100.0 * (double)unpacker->source.n_read / (double)unpacker->source.n_bytes;
    unpacker->reported_us = now_us;
    unpacker->percent = percent < 100.0 ? percent : 100.0;
    unpacker->options->progress(unpacker->options->context, unpacker->percent);
}

/* Called at every block: false with source.problem when cancelled or out of processor time. */
static bool goes_on(void *context)
{
    struct unpacker *unpacker = context;
    struct problem *problem = &unpacker->source.problem;
    const struct unpack_options *options = unpacker->options;
    if (options->is_cancelled && options->is_cancelled(options->context))
        return problem_set(problem, PROBLEM_CANCELLED, "", "", "unpacking was cancelled");
    uint64_t seconds = unpack_cpu_seconds(unpacker->source.n_read, unpacker->n_read);
    if (cpu_ms() - unpacker->start_cpu_ms > (int64_t)seconds * 1000)
        return problem_set(
            problem, PROBLEM_TIMEOUT, "", "",
            "unpacking %llu bytes took more than %llu s of processor time; no honest archive needs as much",
            (unsigned long long)unpacker->n_read, (unsigned long long)seconds);
    report_progress(unpacker);
    return true;
}

/* To be called right after a call of libarchive failed. It reports some failed allocations; others it takes for an
 * unknown kind of archive, or for damage, and leaves only errno. */
static bool lacks_memory(const struct unpacker *unpacker)
{
    return errno == ENOMEM || archive_errno(unpacker->archive) == ENOMEM;
}

static bool refuse_memory(struct unpacker *unpacker)
{
    return problem_set(&unpacker->problem, PROBLEM_INTERNAL, "", "", "no memory to read the archive");
}

/* Refuses an entry of a zip whose method of compression libarchive does not read; it is not damaged. words:
 * libarchive's. */
static bool refuse_method(struct unpacker *unpacker, const char *shown, const char *words)
{
    const char *method = strchr(words, '(');
    if (strstr(words, "64"))
        return problem_set(
            &unpacker->problem, PROBLEM_VALIDATION, "", "unsupported",
            "entry \"%s\": compressed by Deflate64, which is not read here (Windows uses it for large archives); expected is a zip with Deflate, or a tar.gz",
            shown);
    return problem_set(
        &unpacker->problem, PROBLEM_VALIDATION, "", "unsupported",
        "entry \"%s\": its method of compression %s is not read here; expected is a zip with Deflate, or a tar.gz",
        shown, method ? method : "");
}

/* Refuses with what the source or libarchive found wrong. */
static bool refuse_damaged(struct unpacker *unpacker, const char *name)
{
    if (unpacker->source.problem.type != PROBLEM_NONE) {
        unpacker->problem = unpacker->source.problem;
        return false;
    }
    if (lacks_memory(unpacker))
        return refuse_memory(unpacker);
    char shown[UNPACK_SHOWN_SIZE], words[UNPACK_SHOWN_SIZE];
    const char *message = archive_error_string(unpacker->archive);
    unpack_show(name, shown);
    unpack_show(message ? message : "it cannot be read", words);
    if (*shown && strstr(words, "nsupported ZIP compression method"))
        return refuse_method(unpacker, shown, words);
    if (*shown)
        return problem_set(&unpacker->problem, PROBLEM_VALIDATION, "", "format",
                           "entry \"%s\": damaged: %s; expected is an archive that is whole", shown, words);
    return problem_set(
        &unpacker->problem, PROBLEM_VALIDATION, "", "format",
        "the archive is damaged after entry %lu, before byte %llu of %llu: %s; expected is one that is whole",
        (unsigned long)unpacker->n_entries, (unsigned long long)unpacker->source.at,
        (unsigned long long)unpacker->source.n_bytes, words);
}

static bool is_tar(const struct unpacker *unpacker)
{
    return (archive_format(unpacker->archive) & ARCHIVE_FORMAT_BASE_MASK) == ARCHIVE_FORMAT_TAR;
}

/* Adds the number of the entry, and in a tar its offset, to a sentence about it: names may occur twice, be cut or look
 * alike. */
static void add_place(struct unpacker *unpacker)
{
    static const char before[] = "entry \"", many[] = "more than";
    struct problem *problem = &unpacker->problem;
    char sentence[sizeof problem->detail], place[64] = "";
    bool names_it = strncmp(problem->detail, before, sizeof before - 1) == 0;
    if (unpacker->n_entries == 0 || (!names_it && strncmp(problem->detail, many, sizeof many - 1) != 0))
        return;
    memcpy(sentence, problem->detail, sizeof sentence);
    if (is_tar(unpacker))
        (void)snprintf(place, sizeof place, " at byte %lld of the tar", (long long)unpacker->entry_at);
    (void)snprintf(problem->detail, sizeof problem->detail, "entry %lu%s%s%.*s", (unsigned long)unpacker->n_entries,
                   place, names_it ? ", \"" : ": ", (int)(sizeof sentence - sizeof place),
                   sentence + (names_it ? sizeof before - 1 : 0));
    problem->facts = (struct sentence_facts){ 0 }; /* it is another sentence now */
}

static bool refuse_no_file(struct unpacker *unpacker)
{
    return problem_set(&unpacker->problem, PROBLEM_VALIDATION, "", "required",
                       "the archive holds no file in %lu entries; expected are the files of a plan",
                       (unsigned long)unpacker->n_entries);
}

static bool refuse_unknown(struct unpacker *unpacker)
{
    uint32_t n_entries;
    if (lacks_memory(unpacker))
        return refuse_memory(unpacker);
    if (unpack_source_zip_entries(&unpacker->source, &n_entries) && n_entries == 0)
        return refuse_no_file(unpacker);
    if (unpack_source_has(&unpacker->source, 0, "PK\3\4", 4))
        return problem_set(
            &unpacker->problem, PROBLEM_VALIDATION, "", "format",
            "a zip of %llu bytes whose directory at its end is missing or damaged; expected is its end mark, PK 5 6, in the last 65557 bytes: was all of it sent?",
            (unsigned long long)unpacker->source.n_bytes);
    static const struct {
        const char *bytes;
        size_t n;
        const char *words;
    } known[] = { { "Rar!", 4, "a RAR archive" },
                  { "7z\xbc\xaf\x27\x1c", 6, "a 7-Zip archive" },
                  { "\x1f\x8b", 2, "gzip data, of something else" },
                  { "BZh", 3, "bzip2 data, damaged or of something else" },
                  { "\xfd"
                    "7zXZ",
                    5, "xz data, damaged or of something else" },
                  { "\x28\xb5\x2f\xfd", 4, "zstd data, damaged or of something else" },
                  { "MSCF", 4, "a cabinet file" } };
    uint8_t first[4];
    char other[64];
    const char *found = unpacker->source.n_bytes == 0 ? "an empty file" : other;
    size_t n_first = unpack_source_first(&unpacker->source, first, sizeof first);
    size_t n_other = (size_t)snprintf(other, sizeof other, "something else, at byte 0%s", n_first ? "" : " nothing");
    for (size_t i = 0; i < n_first; i++)
        n_other += (size_t)snprintf(other + n_other, sizeof other - n_other, " %02x", first[i]);
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (unpack_source_has(&unpacker->source, 0, known[i].bytes, known[i].n))
            found = known[i].words;
    return problem_set(
        &unpacker->problem, PROBLEM_MEDIA_TYPE, "", "",
        "no archive that is read here: found is %s (%llu bytes), expected a zip, or a tar as it is or within gzip, bzip2, xz or zstd",
        found, (unsigned long long)unpacker->source.n_bytes);
}

static bool refuse_entry(struct unpacker *unpacker, const char *name, const char *code, const char *found,
                         const char *expected)
{
    char shown[UNPACK_SHOWN_SIZE];
    unpack_show(name, shown);
    return problem_set(&unpacker->problem, PROBLEM_VALIDATION, "", code, "entry \"%s\": %s; expected %s", shown, found,
                       expected);
}

static bool check_kind(struct unpacker *unpacker, struct archive_entry *entry, const char *raw, bool *is_folder)
{
    static const char files[] = "are files and folders";
    if (archive_entry_hardlink(entry))
        return refuse_entry(unpacker, raw, "type", "a hard link", files);
    switch (archive_entry_filetype(entry)) {
    case AE_IFREG: *is_folder = false; break;
    case AE_IFDIR: *is_folder = true; break;
    case AE_IFLNK: return refuse_entry(unpacker, raw, "type", "a symbolic link", files);
    case AE_IFCHR:
    case AE_IFBLK: return refuse_entry(unpacker, raw, "type", "a device", files);
    case AE_IFIFO: return refuse_entry(unpacker, raw, "type", "a named pipe", files);
    case AE_IFSOCK: return refuse_entry(unpacker, raw, "type", "a socket", files);
    default: return refuse_entry(unpacker, raw, "type", "of an unknown kind", files);
    }
    if (archive_entry_symlink(entry))
        return refuse_entry(unpacker, raw, "type", "a symbolic link", files);
    if (archive_entry_is_encrypted(entry))
        return refuse_entry(unpacker, raw, "unsupported", "encrypted", "is an archive without a password");
    if (archive_entry_sparse_count(entry) > 0)
        return refuse_entry(unpacker, raw, "unsupported", "a file with holes", "are files that are stored whole");
    return true;
}

/* Makes the missing folders of a path of n bytes. */
static bool make_parents(struct unpacker *unpacker, const char *name, size_t n)
{
    if (strlen(unpacker->last_parent) == n && memcmp(unpacker->last_parent, name, n) == 0)
        return true;
    for (size_t end = 0; end < n; end++) {
        end += strcspn(name + end, "/");
        enum unpack_known known = unpack_names_add(&unpacker->names, name, end, true, &unpacker->problem);
        if (known == UNPACK_REFUSED ||
            (known == UNPACK_NEW && !unpack_make_folder(&unpacker->writer, name, end, &unpacker->problem)))
            return false;
    }
    memcpy(unpacker->last_parent, name, n);
    unpacker->last_parent[n] = 0;
    return true;
}

static void note_top(struct unpacker *unpacker, const char *name, bool is_folder)
{
    size_t n = strcspn(name, "/");
    if (unpacker->top[0] == 0) {
        memcpy(unpacker->top, name, n);
        unpacker->top[n] = 0;
        unpacker->has_one_top = true;
        unpacker->is_top_folder = is_folder || name[n] == '/';
    } else if (strlen(unpacker->top) != n || memcmp(unpacker->top, name, n) != 0) {
        unpacker->has_one_top = false;
    }
}

static bool is_within(struct unpacker *unpacker, const char *name)
{
    if (unpacker->n_read <= unpacker->most)
        return true;
    char shown[UNPACK_SHOWN_SIZE];
    unpack_show(name, shown);
    if (unpacker->most == unpacker->options->max_bytes)
        return problem_set(
            &unpacker->problem, PROBLEM_TOO_LARGE, "", "",
            "entry \"%s\": more than %llu bytes come out of the archive by then; at most so many are allowed", shown,
            (unsigned long long)unpacker->most);
    return problem_set(
        &unpacker->problem, PROBLEM_TOO_LARGE, "", "",
        "entry \"%s\": more than %llu bytes come out of an archive of %llu; at most %d times its size is allowed",
        shown, (unsigned long long)unpacker->most, (unsigned long long)unpacker->source.n_bytes, UNPACK_MAX_RATIO);
}

/* Reads an entry's data to the end and writes them to file; file -1: only verifies their check sum. */
static bool copy_data(struct unpacker *unpacker, struct archive_entry *entry, const char *name, int file,
                      uint64_t *n_bytes)
{
    *n_bytes = 0;
    for (;;) {
        const void *data;
        size_t n;
        la_int64_t at;
        int status = archive_read_data_block(unpacker->archive, &data, &n, &at);
        if (status == ARCHIVE_EOF)
            break;
        if (status != ARCHIVE_OK)
            return refuse_damaged(unpacker, name);
        if (n == 0)
            continue;
        if (at < 0 || (uint64_t)at != *n_bytes)
            return refuse_entry(unpacker, name, "unsupported", "a file with holes", "are files that are stored whole");
        *n_bytes += n;
        unpacker->n_read += n;
        if (!is_within(unpacker, name))
            return false;
        if (file >= 0 && !unpack_write(file, name, data, n, &unpacker->problem))
            return false;
    }
    if (!archive_entry_size_is_set(entry) || (uint64_t)archive_entry_size(entry) == *n_bytes)
        return true;
    char found[96], expected[64];
    (void)snprintf(found, sizeof found, "%llu bytes of data", (unsigned long long)*n_bytes);
    (void)snprintf(expected, sizeof expected, "are %lld, as its header says", (long long)archive_entry_size(entry));
    return refuse_entry(unpacker, name, "format", found, expected);
}

static bool write_file(struct unpacker *unpacker, struct archive_entry *entry, const char *name)
{
    const char *slash = strrchr(name, '/');
    if (!make_parents(unpacker, name, slash ? (size_t)(slash - name) : 0))
        return false;
    if (unpack_names_add(&unpacker->names, name, strlen(name), false, &unpacker->problem) != UNPACK_NEW)
        return false;
    int file;
    uint64_t n_bytes;
    if (!unpack_make_file(&unpacker->writer, name, &file, &unpacker->problem))
        return false;
    bool is_done = copy_data(unpacker, entry, name, file, &n_bytes);
    if (file >= 0 && close(file) != 0 && is_done)
        is_done = problem_set(&unpacker->problem, PROBLEM_STORAGE, "", "", "a file cannot be written to its end");
    unpacker->result.n_files++;
    unpacker->result.n_bytes += n_bytes;
    return is_done;
}

static bool handle_entry(struct unpacker *unpacker, struct archive_entry *entry)
{
    if (++unpacker->n_entries > UNPACK_MAX_ENTRIES)
        return problem_set(&unpacker->problem, PROBLEM_TOO_LARGE, "", "",
                           "the archive has more than %d entries; at most so many are allowed", UNPACK_MAX_ENTRIES);
    char name[FOLDER_NAME_SIZE];
    unpacker->entry_at = archive_read_header_position(unpacker->archive);
    const char *raw = archive_entry_pathname(entry);
    bool is_folder = false;
    uint64_t n_bytes;
    if (!raw)
        return problem_set(&unpacker->problem, PROBLEM_VALIDATION, "", "pattern",
                           "entry %lu has no name that can be read; expected is UTF-8",
                           (unsigned long)unpacker->n_entries);
    if (!check_kind(unpacker, entry, raw, &is_folder) || !unpack_name(raw, is_folder, name, &unpacker->problem))
        return false;
    if (unpack_is_litter(name))
        return copy_data(unpacker, entry, name, -1, &n_bytes);
    if (name[0])
        note_top(unpacker, name, is_folder);
    if (!is_folder)
        return write_file(unpacker, entry, name);
    if (!copy_data(unpacker, entry, name, -1, &n_bytes))
        return false;
    if (n_bytes > 0)
        return refuse_entry(unpacker, raw, "format", "a folder with data", "is none");
    return make_parents(unpacker, name, strlen(name));
}

/* Finds truncation and overlap that libarchive does not report. A tar cut between two entries lacks only the zeros at
 * its end. A zip may list the same bytes as several files, of which libarchive gives the first. */
static bool check_end(struct unpacker *unpacker)
{
    static const uint8_t zeros[512];
    uint32_t n_listed;
    if (!is_tar(unpacker) && unpack_source_zip_entries(&unpacker->source, &n_listed) &&
        n_listed != (unpacker->n_entries & 0xffff)) /* older programs write the count modulo 65536 */
        return problem_set(&unpacker->problem, PROBLEM_VALIDATION, "", "format",
                           "the zip's directory says that it holds %lu entries; found are %lu that do not overlap",
                           (unsigned long)n_listed, (unsigned long)unpacker->n_entries);
    bool is_bare = !unpacker->source.is_gzip && archive_filter_count(unpacker->archive) <= 1;
    uint64_t n_bytes = unpacker->source.n_bytes;
    if (is_tar(unpacker) && is_bare &&
        (n_bytes < sizeof zeros || !unpack_source_has(&unpacker->source, n_bytes - sizeof zeros, zeros, sizeof zeros)))
        return unpacker->source.problem.type != PROBLEM_NONE
                   ? refuse_damaged(unpacker, "")
                   : problem_set(
                         &unpacker->problem, PROBLEM_VALIDATION, "", "format",
                         "the tar ends at byte %llu, after entry %lu, without its end mark, 512 bytes of zero; was all of it sent?",
                         (unsigned long long)n_bytes, (unsigned long)unpacker->n_entries);
    if (!unpack_source_drain(&unpacker->source))
        return refuse_damaged(unpacker, "");
    return true;
}

static bool walk(struct unpacker *unpacker)
{
    struct archive *archive = unpacker->archive;
    errno = 0;
    int status = archive_read_open1(archive);
    while (status == ARCHIVE_OK) {
        struct archive_entry *entry;
        status = archive_read_next_header(archive, &entry);
        if (status == ARCHIVE_OK && archive_filter_count(archive) > (unpacker->source.is_gzip ? 1 : 2))
            return problem_set(
                &unpacker->problem, PROBLEM_MEDIA_TYPE, "", "",
                "compressed more than once, from byte 0 on; expected is a zip, or a tar as it is or within gzip, bzip2, xz or zstd");
        if (status == ARCHIVE_OK && !goes_on(unpacker))
            return refuse_damaged(unpacker, "");
        if (status == ARCHIVE_OK && !handle_entry(unpacker, entry))
            return false;
    }
    if (status != ARCHIVE_EOF)
        return archive_format(archive) == 0 && unpacker->source.problem.type == PROBLEM_NONE
                   ? refuse_unknown(unpacker)
                   : refuse_damaged(unpacker, "");
    if (!check_end(unpacker))
        return false;
    if (unpacker->result.n_files == 0)
        return refuse_no_file(unpacker);
    return !unpacker->has_one_top || !unpacker->is_top_folder ||
           unpack_lift(&unpacker->writer, unpacker->top, &unpacker->problem);
}

/* Enables the formats and filters that are read, and no others; none of them runs another program. */
static bool choose_kinds(struct archive *archive)
{
    /* zips only by the directory at their end: without it a link cannot be told from a file, nor a cut zip from a whole
     * one */
    return archive_read_support_format_zip_seekable(archive) == ARCHIVE_OK &&
           archive_read_support_format_tar(archive) == ARCHIVE_OK &&
           archive_read_support_filter_bzip2(archive) == ARCHIVE_OK &&
           archive_read_support_filter_xz(archive) == ARCHIVE_OK &&
           archive_read_support_filter_zstd(archive) == ARCHIVE_OK &&
           archive_read_set_option(archive, "tar", "read_concatenated_archives", "1") ==
               ARCHIVE_OK; /* to the end of the file, so that all of it is checked */
}

static bool run(struct unpacker *unpacker, int archive, int folder)
{
    struct stat facts;
    struct problem *problem = &unpacker->problem;
    uint64_t n_bytes = fstat(archive, &facts) == 0 && facts.st_size > 0 ? (uint64_t)facts.st_size : 0;
    uint64_t by_ratio = n_bytes > UINT64_MAX / UNPACK_MAX_RATIO ? UINT64_MAX : n_bytes * UNPACK_MAX_RATIO;
    if (by_ratio < UNPACK_FREE_BYTES)
        by_ratio = UNPACK_FREE_BYTES;
    unpacker->most = unpacker->options->max_bytes < by_ratio ? unpacker->options->max_bytes : by_ratio;
    uint64_t headers = (uint64_t)UNPACK_MAX_ENTRIES * HEADER_BYTES, around = n_bytes > headers ? n_bytes : headers;
    uint64_t undone = unpacker->most > UINT64_MAX - around ? UINT64_MAX : unpacker->most + around;
    if (folder >= 0 && !unpack_is_empty(folder, problem))
        return false;
    unpacker->archive = archive_read_new();
    bool is_ready = unpacker->archive && choose_kinds(unpacker->archive);
    bool is_done =
        is_ready || problem_set(problem, PROBLEM_INTERNAL, "", "", "the library that reads archives does not start");
    if (is_done && !unpack_source_open(&unpacker->source, unpacker->archive, archive, undone, goes_on, unpacker))
        is_done = refuse_damaged(unpacker, "");
    is_done = is_done && walk(unpacker);
    if (!is_done)
        add_place(unpacker);
    (void)archive_read_free(unpacker->archive);
    unpack_source_finish(&unpacker->source);
    unpack_writer_finish(&unpacker->writer);
    if (!is_done && folder >= 0 && !unpack_clear(folder))
        log_warn("something of the archive stayed behind");
    return is_done;
}

bool unpack(int archive, int folder, const struct unpack_options *options, struct unpack_result *result,
            struct problem *problem)
{
    struct unpacker *unpacker = calloc(1, sizeof *unpacker);
    *result = (struct unpack_result){ 0 };
    if (!unpacker)
        return problem_set(problem, PROBLEM_INTERNAL, "", "", "no memory to unpack");
    unpacker->options = options;
    unpacker->start_cpu_ms = cpu_ms();
    unpacker->reported_us = clock_now_us();
    unpack_writer_init(&unpacker->writer, folder);
    /* libarchive converts names to the locale's encoding, and towlower depends on it: set UTF-8, for this thread only
     */
    locale_t utf8 = newlocale(LC_CTYPE_MASK, "C.UTF-8", (locale_t)0), before = utf8 ? uselocale(utf8) : (locale_t)0;
    bool is_done = run(unpacker, archive, folder);
    if (utf8) {
        (void)uselocale(before);
        freelocale(utf8);
    }
    if (is_done)
        *result = unpacker->result;
    else if (problem)
        *problem = unpacker->problem;
    unpack_names_finish(&unpacker->names);
    free(unpacker);
    return is_done;
}
