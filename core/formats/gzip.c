/* Unpacks gzip streams in memory. */
#include "core/formats/gzip.h"

#include <libdeflate.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { WINDOW_GZIP = 15 + 16, SCRATCH_BYTES = 1 << 16, SMALLEST_STREAM = 18 };

bool gzip_is(const uint8_t *data, size_t size)
{
    return size >= 2 && data[0] == 0x1f && data[1] == 0x8b;
}

uint64_t gzip_most(uint64_t compressed_bytes)
{
    return compressed_bytes * 1032 + 1024;
}

bool gzip_is_padding(const uint8_t *data, size_t size)
{
    while (size > 0 && data[size - 1] == 0)
        size--;
    return size == 0;
}

static uInt at_most_int(size_t n)
{
    return n > UINT_MAX ? UINT_MAX : (uInt)n;
}

enum outcome { WHOLE, FULL, CUT, BROKEN, FOLLOWED, NO_MEMORY };

/* How far a stream was read: bytes of it, and bytes unpacked from it. reason: zlib's message when it is BROKEN. */
struct gzip_reading {
    enum outcome outcome;
    size_t in;
    uint64_t have;
    const char *reason;
};

/* Unpacks with zlib, piece by piece: writes the first capacity bytes to out, checks and discards the rest. FULL: more
 * than most bytes inside. zlib checks checksum and length of every member that ends within most. */
static struct gzip_reading inflate_slowly(const uint8_t *data, size_t size, uint8_t *out, size_t capacity,
                                          uint64_t most)
{
    uint8_t scratch[SCRATCH_BYTES];
    struct gzip_reading reading = { NO_MEMORY, 0, 0, "" };
    z_stream stream = { 0 };
    if (inflateInit2(&stream, WINDOW_GZIP) != Z_OK)
        return reading;
    for (;;) {
        bool is_kept = reading.have < capacity;
        stream.next_in = (Bytef *)(uintptr_t)(data + reading.in);
        stream.avail_in = at_most_int(size - reading.in);
        stream.next_out = is_kept ? out + reading.have : scratch;
        stream.avail_out = is_kept ? at_most_int(capacity - (size_t)reading.have) : SCRATCH_BYTES;
        uInt in_before = stream.avail_in, out_before = stream.avail_out;
        int status = inflate(&stream, Z_NO_FLUSH);
        reading.in += in_before - stream.avail_in;
        reading.have += out_before - stream.avail_out;
        bool is_stuck = in_before == stream.avail_in && out_before == stream.avail_out;
        if (reading.have > most) {
            reading.outcome = FULL;
        } else if (status == Z_STREAM_END && gzip_is(data + reading.in, size - reading.in)) {
            reading.outcome = NO_MEMORY;
            if (inflateReset(&stream) == Z_OK)
                continue;
        } else if (status == Z_STREAM_END) {
            reading.outcome = gzip_is_padding(data + reading.in, size - reading.in) ? WHOLE : FOLLOWED;
        } else if (status == Z_OK && !is_stuck) {
            continue;
        } else if (status == Z_OK || status == Z_BUF_ERROR) {
            reading.outcome = CUT;
        } else {
            reading.outcome = status == Z_MEM_ERROR ? NO_MEMORY : BROKEN;
            reading.reason = stream.msg ? stream.msg : "";
        }
        break;
    }
    inflateEnd(&stream);
    return reading;
}

size_t gzip_head(const uint8_t *data, size_t size, uint8_t *out, size_t capacity)
{
    z_stream stream = { 0 };
    if (inflateInit2(&stream, WINDOW_GZIP) != Z_OK) {
        error_set(NULL, ERROR_MEMORY, "no memory to undo compression");
        return 0;
    }
    size_t in = 0, have = 0;
    while (have < capacity && in < size) {
        stream.next_in = (Bytef *)(uintptr_t)(data + in);
        stream.avail_in = at_most_int(size - in);
        stream.next_out = out + have;
        stream.avail_out = at_most_int(capacity - have);
        uInt in_before = stream.avail_in, out_before = stream.avail_out;
        int status = inflate(&stream, Z_NO_FLUSH);
        in += in_before - stream.avail_in;
        have += out_before - stream.avail_out;
        if (status == Z_STREAM_END) {
            if (!gzip_is(data + in, size - in) || inflateReset(&stream) != Z_OK)
                break;
        } else if (status == Z_MEM_ERROR) {
            error_set(NULL, ERROR_MEMORY, "no memory to undo compression");
            have = 0;
            break;
        } else if (status != Z_OK || (in_before == stream.avail_in && out_before == stream.avail_out)) {
            break;
        }
    }
    inflateEnd(&stream);
    return have;
}

/* Unpacks all members with libdeflate into capacity bytes and checks their checksums and lengths. FULL: more than
 * capacity inside. BROKEN: damaged, cut short, or followed by something else. */
static enum outcome inflate_members(const uint8_t *data, size_t size, uint8_t *out, size_t capacity, size_t *n)
{
    struct libdeflate_decompressor *decompressor = libdeflate_alloc_decompressor();
    if (!decompressor)
        return NO_MEMORY;
    size_t in = 0, have = 0;
    enum outcome outcome = WHOLE;
    while (outcome == WHOLE && (in == 0 || gzip_is(data + in, size - in))) {
        size_t used = 0, made = 0;
        enum libdeflate_result result = libdeflate_gzip_decompress_ex(decompressor, data + in, size - in, out + have,
                                                                      capacity - have, &used, &made);
        if (result != LIBDEFLATE_SUCCESS)
            outcome = result == LIBDEFLATE_INSUFFICIENT_SPACE ? FULL : BROKEN;
        in += used;
        have += made;
    }
    libdeflate_free_decompressor(decompressor);
    *n = have;
    return outcome == WHOLE && !gzip_is_padding(data + in, size - in) ? BROKEN : outcome;
}

/* Replaces a message of zlib that is meaningless to users. */
static const char *plain_reason(const char *reason)
{
    if (strcmp(reason, "incorrect data check") == 0)
        return "the checksum (CRC-32) does not fit what was unpacked";
    if (strcmp(reason, "incorrect length check") == 0)
        return "the length at its end is not what was unpacked";
    return reason[0] ? reason : "no gzip stream";
}

/* Sets the error for a stream that was not read to its end. */
static bool refuse(const struct gzip_reading *reading, size_t size, const char *name, uint64_t most, struct error *err)
{
    unsigned long long have = (unsigned long long)reading->have;
    switch (reading->outcome) {
    case NO_MEMORY: return error_set(err, ERROR_MEMORY, "%s: no memory to unpack", name);
    case FULL: return error_set(err, ERROR_LIMIT, "%s: more than %llu bytes inside", name, (unsigned long long)most);
    case CUT:
        return error_set(err, ERROR_FORMAT, "%s: the gzip stream is cut short at byte %zu, after %llu unpacked bytes",
                         name, size, have);
    case FOLLOWED:
        return error_set(
            err, ERROR_FORMAT,
            "%s: the gzip stream ends at byte %zu, and %zu more bytes follow that are neither another one nor "
            "padding with zeros",
            name, reading->in, size - reading->in);
    case BROKEN:
    case WHOLE: break;
    }
    return error_set(err, ERROR_FORMAT,
                     "%s: the gzip stream is damaged near byte %zu of %zu, after %llu unpacked bytes: %s", name,
                     reading->in, size, have, plain_reason(reading->reason));
}

bool gzip_exact(const uint8_t *data, size_t size, const char *name, uint8_t *out, size_t n, uint64_t *n_more,
                struct error *err)
{
    size_t have = 0;
    *n_more = 0;
    if (inflate_members(data, size, out, n, &have) == WHOLE && have == n)
        return true;
    /* more inside than n, or damaged: zlib finds out which */
    uint64_t most = (uint64_t)n + GZIP_MOST_MORE;
    struct gzip_reading reading = inflate_slowly(data, size, out, n, most);
    if (reading.outcome != WHOLE)
        return refuse(&reading, size, name, most, err);
    if (reading.have < n)
        return error_set(err, ERROR_FORMAT, "%s: cut short before it was packed: %llu bytes inside, %zu expected", name,
                         (unsigned long long)reading.have, n);
    *n_more = reading.have - n;
    return true;
}

bool gzip_all(const uint8_t *data, size_t size, const char *name, uint64_t limit, struct bytes *out, struct error *err)
{
    *out = (struct bytes){ 0 };
    if (size < SMALLEST_STREAM)
        return error_set(err, ERROR_FORMAT, "%s: %zu bytes are too few for a gzip stream", name, size);
    uint64_t most = gzip_most(size) < limit ? gzip_most(size) : limit;
    uint64_t hint = (uint64_t)data[size - 4] | (uint64_t)data[size - 3] << 8 | (uint64_t)data[size - 2] << 16 |
                    (uint64_t)data[size - 1] << 24;
    uint64_t capacity = hint > 0 && hint <= most ? hint : size * (uint64_t)4;
    for (;;) {
        capacity = capacity < most ? capacity : most;
        uint8_t *buffer = malloc((size_t)capacity + 1);
        if (!buffer)
            return error_set(err, ERROR_MEMORY, "%s: no memory for %llu bytes", name, (unsigned long long)capacity);
        size_t have = 0;
        enum outcome outcome = inflate_members(data, size, buffer, (size_t)capacity, &have);
        if (outcome == WHOLE) {
            buffer[have] = 0;
            *out = (struct bytes){ buffer, have };
            return true;
        }
        free(buffer);
        if (outcome != FULL || capacity >= most) {
            struct gzip_reading reading = { NO_MEMORY, 0, 0, "" };
            if (outcome != NO_MEMORY)
                reading = inflate_slowly(data, size, NULL, 0, most);
            return refuse(&reading, size, name, most, err);
        }
        capacity *= 2;
    }
}
