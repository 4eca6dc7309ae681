#include "core/formats/zlib_stream.h"

#include <stdlib.h>
#include <zlib.h>

#include "core/formats/gzip.h"
#include "core/formats/text.h"

enum { SMALLEST_STREAM = 8, FIRST_CAPACITY = 1 << 16 };

/* Doubles the buffer up to most; false when it has reached that or there is no memory, told apart by capacity. */
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

/* Where the stream ended: at its end, at the end of the room, or broken. */
static int inflate_into(z_stream *stream, const uint8_t *data, size_t size, struct bytes *out, uint64_t *capacity, uint64_t most)
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
        return error_set(err, ERROR_FORMAT, "%s: begins with %02x %02x, expected a zlib stream (78 01 or its like)", name, data[0], data[1]);
    /* one byte over the limit tells that there is more */
    uint64_t most = (gzip_most(size) < limit ? gzip_most(size) : limit) + 1, capacity = FIRST_CAPACITY < most ? FIRST_CAPACITY : most;
    z_stream stream = { 0 };
    out->data = malloc((size_t)capacity + 1);
    if (!out->data || inflateInit(&stream) != Z_OK) {
        bytes_free(out);
        return error_set(err, ERROR_MEMORY, "%s: no memory to unpack", name);
    }
    int result = inflate_into(&stream, data, size, out, &capacity, most);
    inflateEnd(&stream);
    if (result == Z_STREAM_END && out->size <= limit) {
        out->data[out->size] = 0;
        return true;
    }
    size_t n = out->size;
    bytes_free(out);
    if (n > limit)
        return error_set(err, ERROR_LIMIT, "%s: more than the %llu bytes expected inside", name, (unsigned long long)limit);
    if (result == Z_BUF_ERROR || result == Z_MEM_ERROR)
        return error_set(err, ERROR_MEMORY, "%s: no memory to unpack", name);
    return error_set(err, ERROR_FORMAT, "%s: the zlib stream is cut short or damaged after %zu unpacked bytes", name, n);
}

bool sera_unpack(const struct bytes *file, const char *name, uint64_t limit, bool *is_packed, struct bytes *out, struct error *err)
{
    *out = (struct bytes){ 0 };
    bool is_gzip = gzip_is(file->data, file->size);
    *is_packed = is_gzip || text_has_ending(name, ".sz");
    if (!*is_packed)
        return true;
    return is_gzip ? gzip_all(file->data, file->size, name, limit, out, err) : zlib_all(file->data, file->size, name, limit, out, err);
}
