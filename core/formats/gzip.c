#include "core/formats/gzip.h"

#include <libdeflate.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { WINDOW_GZIP = 15 + 16 };

bool gzip_is(const uint8_t *data, size_t size)
{
    return size >= 2 && data[0] == 0x1f && data[1] == 0x8b;
}

uint64_t gzip_most(uint64_t compressed_bytes)
{
    return compressed_bytes * 1032 + 1024;
}

static uInt at_most_int(size_t n)
{
    return n > UINT_MAX ? UINT_MAX : (uInt)n;
}

/* The slow, streaming way: as many bytes as there are up to capacity, over several members. */
static size_t inflate_some(const uint8_t *data, size_t size, uint8_t *out, size_t capacity)
{
    z_stream stream = { 0 };
    if (inflateInit2(&stream, WINDOW_GZIP) != Z_OK)
        return 0;
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
        } else if (status != Z_OK || (in_before == stream.avail_in && out_before == stream.avail_out)) {
            break;
        }
    }
    inflateEnd(&stream);
    return have;
}

size_t gzip_head(const uint8_t *data, size_t size, uint8_t *out, size_t capacity)
{
    return inflate_some(data, size, out, capacity);
}

enum outcome { WHOLE, FULL, BROKEN, NO_MEMORY };

/* The fast way: all members, into capacity bytes. FULL: there is more than that. */
static enum outcome inflate_members(const uint8_t *data, size_t size, uint8_t *out, size_t capacity, size_t *n)
{
    struct libdeflate_decompressor *decompressor = libdeflate_alloc_decompressor();
    if (!decompressor)
        return NO_MEMORY;
    size_t in = 0, have = 0;
    enum outcome outcome = WHOLE;
    while (in < size && (in == 0 || gzip_is(data + in, size - in))) {
        size_t used = 0, made = 0;
        enum libdeflate_result result =
            libdeflate_gzip_decompress_ex(decompressor, data + in, size - in, out + have, capacity - have, &used, &made);
        if (result != LIBDEFLATE_SUCCESS) {
            outcome = result == LIBDEFLATE_INSUFFICIENT_SPACE ? FULL : BROKEN;
            break;
        }
        in += used;
        have += made;
    }
    libdeflate_free_decompressor(decompressor);
    *n = have;
    return outcome;
}

bool gzip_exact(const uint8_t *data, size_t size, const char *name, uint8_t *out, size_t n, struct error *err)
{
    size_t have = 0;
    enum outcome outcome = inflate_members(data, size, out, n, &have);
    if (outcome == NO_MEMORY)
        return error_set(err, ERROR_MEMORY, "%s: no memory to unpack", name);
    if (outcome == WHOLE && have == n)
        return true;
    /* more inside than asked for, or damaged: the streaming reader tells how far the good bytes go */
    have = inflate_some(data, size, out, n);
    if (have == n && outcome != BROKEN)
        return true;
    if (have == n)
        return error_set(err, ERROR_FORMAT, "%s: the gzip stream is damaged: its checksum or its end is wrong", name);
    return error_set(err, ERROR_FORMAT, "%s: the gzip stream is cut short or damaged: %zu bytes unpacked, %zu expected", name, have,
                     n);
}

bool gzip_all(const uint8_t *data, size_t size, const char *name, uint64_t limit, struct bytes *out, struct error *err)
{
    *out = (struct bytes){ 0 };
    if (size < 18)
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
        if (outcome == NO_MEMORY)
            return error_set(err, ERROR_MEMORY, "%s: no memory to unpack", name);
        if (outcome == BROKEN)
            return error_set(err, ERROR_FORMAT, "%s: the gzip stream is cut short or damaged", name);
        if (capacity >= most)
            return error_set(err, ERROR_LIMIT, "%s: more than %llu bytes inside", name, (unsigned long long)most);
        capacity *= 2;
    }
}
