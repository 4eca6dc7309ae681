/* Unpacks bare zlib streams, and files as SERA packs them. */
#include "core/formats/zlib_stream.h"

#include <stdio.h>
#include <stdlib.h>
#include <zlib.h>

#include "core/formats/gzip.h"
#include "core/formats/text.h"

enum { SMALLEST_STREAM = 8, FIRST_CAPACITY = 1 << 16 };

/* Doubles the buffer, up to most. Returns false when capacity is most already, or there is no memory. */
static bool grow(struct bytes *out, uint64_t *capacity, uint64_t most)
{
    if (*capacity >= most)
        return false;
    uint64_t wanted = *capacity * 2 < most ? *capacity * 2 : most;
    uint8_t *data = realloc(out->data, (size_t)wanted + 1);
    if (!data)
        return false;
    out->data = data;
    *capacity = wanted;
    return true;
}

/* Unpacks and returns zlib's code: the stream ended, the room ended, or the stream is damaged. n_used: bytes of data
 * that were read. zlib compares the Adler-32 at the end. */
static int inflate_into(z_stream *stream, const uint8_t *data, size_t size, struct bytes *out, uint64_t *capacity,
                        uint64_t most, size_t *n_used)
{
    size_t used = 0;
    for (;;) {
        if (stream->avail_in == 0 && used < size) {
            size_t more = size - used < 1u << 30 ? size - used : 1u << 30;
            stream->next_in = (Bytef *)(uintptr_t)(data + used);
            stream->avail_in = (uInt)more;
            used += more;
        }
        if (out->size == *capacity && !grow(out, capacity, most))
            return Z_BUF_ERROR;
        size_t room = (size_t)*capacity - out->size < 1u << 30 ? (size_t)*capacity - out->size : 1u << 30;
        stream->next_out = out->data + out->size;
        stream->avail_out = (uInt)room;
        int result = inflate(stream, Z_NO_FLUSH);
        out->size += room - stream->avail_out;
        *n_used = used - stream->avail_in;
        if (result == Z_STREAM_END || (result != Z_OK && result != Z_BUF_ERROR))
            return result;
        if (stream->avail_in == 0 && used == size && stream->avail_out > 0)
            return Z_DATA_ERROR; /* cut short */
    }
}

bool zlib_all(const uint8_t *data, size_t size, const char *name, uint64_t limit, struct bytes *out, struct error *err)
{
    *out = (struct bytes){ 0 };
    if (size < SMALLEST_STREAM)
        return error_set(err, ERROR_FORMAT, "%s: %zu bytes are too few for a zlib stream", name, size);
    if ((data[0] & 15) != 8 || ((unsigned)data[0] << 8 | data[1]) % 31 != 0)
        return error_set(err, ERROR_FORMAT, "%s: begins with %02x %02x, expected a zlib stream (78 01 or its like)",
                         name, data[0], data[1]);
    /* room for one byte beyond the limit shows that there is more */
    uint64_t most = (gzip_most(size) < limit ? gzip_most(size) : limit) + 1,
             capacity = FIRST_CAPACITY < most ? FIRST_CAPACITY : most;
    z_stream stream = { 0 };
    out->data = malloc((size_t)capacity + 1);
    if (!out->data || inflateInit(&stream) != Z_OK) {
        bytes_free(out);
        return error_set(err, ERROR_MEMORY, "%s: no memory to unpack", name);
    }
    size_t n_used = 0;
    int result = inflate_into(&stream, data, size, out, &capacity, most, &n_used);
    char reason[64];
    snprintf(reason, sizeof reason, "%s", stream.msg ? stream.msg : "the stream does not end");
    inflateEnd(&stream);
    bool is_alone = gzip_is_padding(data + n_used, size - n_used);
    if (result == Z_STREAM_END && out->size <= limit && is_alone) {
        out->data[out->size] = 0;
        return true;
    }
    size_t n = out->size;
    bytes_free(out);
    if (n > limit)
        return error_set(err, ERROR_LIMIT, "%s: more than the %llu bytes expected inside", name,
                         (unsigned long long)limit);
    if (result == Z_BUF_ERROR || result == Z_MEM_ERROR)
        return error_set(err, ERROR_MEMORY, "%s: no memory to unpack", name);
    if (result == Z_STREAM_END)
        return error_set(
            err, ERROR_FORMAT,
            "%s: the zlib stream ends at byte %zu, and %zu more bytes follow that are not padding with zeros", name,
            n_used, size - n_used);
    return error_set(err, ERROR_FORMAT,
                     "%s: the zlib stream is cut short or damaged near byte %zu of %zu, after %zu unpacked bytes: %s",
                     name, n_used, size, n, reason);
}

bool sera_unpack(const struct bytes *file, const char *name, uint64_t limit, bool *is_packed, struct bytes *out,
                 struct error *err)
{
    *out = (struct bytes){ 0 };
    bool is_gzip = gzip_is(file->data, file->size), is_named_gzip = text_has_ending(name, ".gz");
    *is_packed = is_gzip || is_named_gzip || text_has_ending(name, ".sz");
    if (!*is_packed)
        return true;
    if (is_named_gzip && !is_gzip)
        return error_set(err, ERROR_FORMAT, "%s: begins with %02x %02x, expected a gzip stream, 1f 8b", name,
                         file->size > 0 ? file->data[0] : 0, file->size > 1 ? file->data[1] : 0);
    return is_gzip ? gzip_all(file->data, file->size, name, limit, out, err)
                   : zlib_all(file->data, file->size, name, limit, out, err);
}
