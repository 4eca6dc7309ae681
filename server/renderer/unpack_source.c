/* Reads the archive file in blocks, plain or through zlib, for libarchive. */
#define _GNU_SOURCE
#include "server/renderer/unpack_source.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool fail(struct unpack_source *source, enum problem_type type, const char *code, const char *sentence)
{
    return problem_set(&source->problem, type, "", code, "%s", sentence);
}

static bool is_within(struct unpack_source *source, uint64_t n_undone)
{
    if (n_undone <= source->most)
        return true;
    return problem_set(
        &source->problem, PROBLEM_TOO_LARGE, "", "",
        "the archive's %llu bytes unpack to more than %llu by byte %llu; at most so many are allowed for it",
        (unsigned long long)source->n_bytes, (unsigned long long)source->most, (unsigned long long)source->at);
}

static bool refuse_unread(struct unpack_source *source)
{
    return problem_set(&source->problem, PROBLEM_INTERNAL, "", "", "the archive cannot be read: %s", strerror(errno));
}

/* Reads the next block of the file; -1 with source->problem. */
static ssize_t read_block(struct unpack_source *source)
{
    if (source->goes_on && !source->goes_on(source->context))
        return -1;
    ssize_t n;
    do
        n = pread(source->file, source->bytes, sizeof source->bytes, (off_t)source->at);
    while (n < 0 && errno == EINTR);
    if (n < 0) {
        (void)refuse_unread(source);
        return -1;
    }
    source->at += (uint64_t)n;
    source->n_read += (uint64_t)n;
    return n;
}

static la_ssize_t read_plain(struct archive *archive, void *context, const void **bytes)
{
    struct unpack_source *source = context;
    la_int64_t n_undone = archive_filter_bytes(archive, 0);
    *bytes = source->bytes;
    if (!is_within(source, n_undone > 0 ? (uint64_t)n_undone : 0))
        return ARCHIVE_FATAL;
    ssize_t n = read_block(source);
    return n < 0 ? ARCHIVE_FATAL : n;
}

static la_int64_t seek_plain(struct archive *archive, void *context, la_int64_t offset, int whence)
{
    (void)archive;
    struct unpack_source *source = context;
    la_int64_t size = (la_int64_t)source->n_bytes, from = whence == SEEK_SET   ? 0
                                                          : whence == SEEK_CUR ? (la_int64_t)source->at
                                                                               : size;
    if (offset < -from || offset > size - from)
        return ARCHIVE_FATAL;
    source->at = (uint64_t)(from + offset);
    return from + offset;
}

/* After a gzip member: skips zeros, which tapes pad with, and starts the next member or sets *is_end. */
static bool begin_member(struct unpack_source *source, bool *is_end)
{
    z_stream *stream = &source->inflate;
    for (*is_end = false;;) {
        while (stream->avail_in > 0 && *stream->next_in == 0) {
            stream->next_in++;
            stream->avail_in--;
        }
        if (stream->avail_in > 0)
            break;
        ssize_t n = read_block(source);
        if (n < 0)
            return false;
        if (n == 0)
            return *is_end = true;
        stream->next_in = source->bytes;
        stream->avail_in = (uInt)n;
    }
    source->is_between = false;
    return inflateReset(stream) == Z_OK || fail(source, PROBLEM_INTERNAL, "", "gzip cannot be undone");
}

static la_ssize_t read_gzip(struct archive *archive, void *context, const void **bytes)
{
    (void)archive;
    struct unpack_source *source = context;
    z_stream *stream = &source->inflate;
    *bytes = source->plain;
    stream->next_out = source->plain;
    stream->avail_out = sizeof source->plain;
    while (stream->avail_out == sizeof source->plain) {
        bool is_end;
        if (source->is_between) {
            if (!begin_member(source, &is_end))
                return ARCHIVE_FATAL;
            if (is_end)
                return 0;
        }
        if (stream->avail_in == 0) {
            ssize_t n = read_block(source);
            if (n == 0)
                (void)problem_set(
                    &source->problem, PROBLEM_VALIDATION, "", "format",
                    "the archive's gzip data end early, at byte %llu; expected is their check sum at the end",
                    (unsigned long long)source->at);
            if (n <= 0)
                return ARCHIVE_FATAL;
            stream->next_in = source->bytes;
            stream->avail_in = (uInt)n;
        }
        int status = inflate(stream, Z_NO_FLUSH);
        if (status == Z_MEM_ERROR) {
            (void)fail(source, PROBLEM_INTERNAL, "", "no memory to undo gzip");
            return ARCHIVE_FATAL;
        }
        if (status != Z_OK && status != Z_STREAM_END && status != Z_BUF_ERROR) {
            (void)problem_set(&source->problem, PROBLEM_VALIDATION, "", "format",
                              "the archive's gzip data are damaged before byte %llu: %s",
                              (unsigned long long)source->at, stream->msg ? stream->msg : "not gzip");
            return ARCHIVE_FATAL;
        }
        source->is_between = status == Z_STREAM_END;
    }
    size_t n = sizeof source->plain - stream->avail_out;
    source->n_plain += n;
    return is_within(source, source->n_plain) ? (la_ssize_t)n : ARCHIVE_FATAL;
}

size_t unpack_source_first(const struct unpack_source *source, uint8_t *bytes, size_t n)
{
    ssize_t n_read = pread(source->file, bytes, n, 0);
    return n_read > 0 ? (size_t)n_read : 0;
}

bool unpack_source_has(struct unpack_source *source, uint64_t at, const void *expected, size_t n)
{
    uint8_t found[512];
    ssize_t n_read = n <= sizeof found ? pread(source->file, found, n, (off_t)at) : 0;
    if (n_read < 0)
        return refuse_unread(source);
    return n_read == (ssize_t)n && memcmp(found, expected, n) == 0;
}

/* End of central directory record: APPNOTE 4.3.16; a comment of up to 65535 bytes follows it. */
bool unpack_source_zip_entries(const struct unpack_source *source, uint32_t *n_entries)
{
    enum { RECORD = 22, MOST = RECORD + 65535, N_ENTRIES_AT = 10 };
    uint64_t n = source->n_bytes < MOST ? source->n_bytes : MOST;
    uint8_t *tail = malloc(MOST);
    bool is_found = false;
    if (tail && n >= RECORD && pread(source->file, tail, n, (off_t)(source->n_bytes - n)) == (ssize_t)n)
        for (uint64_t at = n - RECORD + 1; at-- > 0 && !is_found;)
            if (memcmp(tail + at, "PK\5\6", 4) == 0) {
                is_found = true;
                *n_entries = tail[at + N_ENTRIES_AT] | (uint32_t)tail[at + N_ENTRIES_AT + 1] << 8;
            }
    free(tail);
    return is_found && *n_entries != 0xffff; /* else the number is in the ZIP64 record */
}

bool unpack_source_drain(struct unpack_source *source)
{
    const void *bytes;
    la_ssize_t n = 0;
    while (source->is_gzip && (n = read_gzip(NULL, source, &bytes)) > 0)
        ;
    return n >= 0;
}

bool unpack_source_open(struct unpack_source *source, struct archive *archive, int file, uint64_t most,
                        bool (*goes_on)(void *context), void *context)
{
    struct stat facts;
    source->file = file;
    source->most = most;
    source->goes_on = goes_on;
    source->context = context;
    if (fstat(file, &facts) != 0 || !S_ISREG(facts.st_mode))
        return fail(source, PROBLEM_INTERNAL, "", "the archive is not a file");
    source->n_bytes = (uint64_t)facts.st_size;
    source->is_gzip = unpack_source_has(source, 0, "\x1f\x8b", 2);
    if (source->problem.type != PROBLEM_NONE)
        return false;
    if (source->is_gzip && inflateInit2(&source->inflate, 15 + 16) != Z_OK)
        return fail(source, PROBLEM_INTERNAL, "", "no memory to undo gzip");
    source->is_open = source->is_gzip;
    (void)archive_read_set_callback_data(archive, source);
    (void)archive_read_set_read_callback(archive, source->is_gzip ? read_gzip : read_plain);
    if (!source->is_gzip)
        (void)archive_read_set_seek_callback(archive, seek_plain);
    return true;
}

void unpack_source_finish(struct unpack_source *source)
{
    if (source->is_open)
        (void)inflateEnd(&source->inflate);
    source->is_open = false;
}
