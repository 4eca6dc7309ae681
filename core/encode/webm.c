/* Writes WebM: webm.h. */
#include "core/encode/webm.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

/* Elements by their names in RFC 8794 and RFC 9559. */
enum {
    EBML = 0x1A45DFA3,
    EBML_VERSION = 0x4286,
    EBML_READ_VERSION = 0x42F7,
    EBML_MAX_ID_LENGTH = 0x42F2,
    EBML_MAX_SIZE_LENGTH = 0x42F3,
    DOC_TYPE = 0x4282,
    DOC_TYPE_VERSION = 0x4287,
    DOC_TYPE_READ_VERSION = 0x4285,
    SEGMENT = 0x18538067,
    INFO = 0x1549A966,
    TIMESTAMP_SCALE = 0x2AD7B1,
    DURATION = 0x4489,
    MUXING_APP = 0x4D80,
    WRITING_APP = 0x5741,
    TRACKS = 0x1654AE6B,
    TRACK_ENTRY = 0xAE,
    TRACK_NUMBER = 0xD7,
    TRACK_UID = 0x73C5,
    TRACK_TYPE = 0x83,
    FLAG_LACING = 0x9C,
    DEFAULT_DURATION = 0x23E383,
    CODEC_ID = 0x86,
    VIDEO = 0xE0,
    PIXEL_WIDTH = 0xB0,
    PIXEL_HEIGHT = 0xBA,
    COLOUR = 0x55B0,
    MATRIX_COEFFICIENTS = 0x55B1,
    RANGE = 0x55B9,
    TRANSFER_CHARACTERISTICS = 0x55BA,
    PRIMARIES = 0x55BB,
    CUES = 0x1C53BB6B,
    CUE_POINT = 0xBB,
    CUE_TIME = 0xB3,
    CUE_TRACK_POSITIONS = 0xB7,
    CUE_TRACK = 0xF7,
    CUE_CLUSTER_POSITION = 0xF1,
    CLUSTER = 0x1F43B675,
    TIMESTAMP = 0xE7,
    SIMPLE_BLOCK = 0xA3
};
enum { BT709 = 1, STUDIO_RANGE = 1, SIZE_BYTES = 8, KEY_FRAME = 0x80, TRACK = 1 };

/* Bytes that grow. No memory: is_short, and nothing is written any more. */
struct bytes {
    uint8_t *list;
    size_t n, capacity;
    bool is_short;
};

static void put(struct bytes *bytes, const void *from, size_t n)
{
    if (bytes->n + n > bytes->capacity && !bytes->is_short) {
        const size_t capacity = 2 * bytes->capacity + n + 4096;
        uint8_t *more = realloc(bytes->list, capacity);
        bytes->is_short = !more;
        if (more) {
            bytes->list = more;
            bytes->capacity = capacity;
        }
    }
    if (bytes->is_short)
        return;
    memcpy(bytes->list + bytes->n, from, n);
    bytes->n += n;
}

static void put_big_endian(struct bytes *bytes, uint64_t value, int n)
{
    uint8_t text[8];
    for (int i = 0; i < n; i++)
        text[i] = (uint8_t)(value >> 8 * (n - 1 - i));
    put(bytes, text, (size_t)n);
}

/* An id has its length in it. */
static void put_id(struct bytes *bytes, uint32_t id)
{
    put_big_endian(bytes, id, id > 0xFFFFFF ? 4 : id > 0xFFFF ? 3 : id > 0xFF ? 2 : 1);
}

/* Always of eight bytes, so that positions are known before what stands there. */
static void put_size(struct bytes *bytes, uint64_t size)
{
    put_big_endian(bytes, size | UINT64_C(1) << 56, SIZE_BYTES);
}

static void put_number(struct bytes *bytes, uint32_t id, uint64_t value)
{
    put_id(bytes, id);
    put_size(bytes, 8);
    put_big_endian(bytes, value, 8);
}

static void put_float(struct bytes *bytes, uint32_t id, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_number(bytes, id, bits);
}

static void put_text(struct bytes *bytes, uint32_t id, const char *text)
{
    put_id(bytes, id);
    put_size(bytes, strlen(text));
    put(bytes, text, strlen(text));
}

/* An element that holds others: begin, what it holds, end. */
static size_t begin(struct bytes *bytes, uint32_t id)
{
    put_id(bytes, id);
    put_size(bytes, 0);
    return bytes->n;
}

static void end(struct bytes *bytes, size_t began)
{
    struct bytes size = { 0 };
    put_size(&size, bytes->n - began);
    if (size.list && !bytes->is_short)
        memcpy(bytes->list + began - SIZE_BYTES, size.list, SIZE_BYTES);
    bytes->is_short |= !size.list;
    free(size.list);
}

static uint64_t time_ms(const struct webm *webm, size_t frame)
{
    return (uint64_t)frame * 1000 / (uint64_t)webm->fps;
}

static void put_head(struct bytes *bytes)
{
    const size_t began = begin(bytes, EBML);
    put_number(bytes, EBML_VERSION, 1);
    put_number(bytes, EBML_READ_VERSION, 1);
    put_number(bytes, EBML_MAX_ID_LENGTH, 4);
    put_number(bytes, EBML_MAX_SIZE_LENGTH, 8);
    put_text(bytes, DOC_TYPE, "webm");
    put_number(bytes, DOC_TYPE_VERSION, 4);
    put_number(bytes, DOC_TYPE_READ_VERSION, 2);
    end(bytes, began);
}

static void put_info(struct bytes *bytes, const struct webm *webm)
{
    const size_t began = begin(bytes, INFO);
    put_number(bytes, TIMESTAMP_SCALE, 1000000); /* ns: times are in ms */
    put_float(bytes, DURATION, 1000.0 * (double)webm->n_frames / webm->fps);
    put_text(bytes, MUXING_APP, "beamroom");
    put_text(bytes, WRITING_APP, "beamroom");
    end(bytes, began);
}

static void put_tracks(struct bytes *bytes, const struct webm *webm)
{
    const size_t tracks = begin(bytes, TRACKS), entry = begin(bytes, TRACK_ENTRY);
    put_number(bytes, TRACK_NUMBER, TRACK);
    put_number(bytes, TRACK_UID, TRACK);
    put_number(bytes, TRACK_TYPE, 1); /* pictures */
    put_number(bytes, FLAG_LACING, 0);
    put_number(bytes, DEFAULT_DURATION, UINT64_C(1000000000) / (uint64_t)webm->fps);
    put_text(bytes, CODEC_ID, "V_VP9");
    const size_t video = begin(bytes, VIDEO);
    put_number(bytes, PIXEL_WIDTH, (uint64_t)webm->width_px);
    put_number(bytes, PIXEL_HEIGHT, (uint64_t)webm->height_px);
    const size_t colour = begin(bytes, COLOUR);
    put_number(bytes, MATRIX_COEFFICIENTS, BT709);
    put_number(bytes, RANGE, STUDIO_RANGE);
    put_number(bytes, TRANSFER_CHARACTERISTICS, BT709);
    put_number(bytes, PRIMARIES, BT709);
    end(bytes, colour);
    end(bytes, video);
    end(bytes, entry);
    end(bytes, tracks);
}

static size_t end_of_cluster(const struct webm *webm, size_t first)
{
    size_t to = first + 1;
    while (to < webm->n_frames && !webm->frames[to].is_key)
        to++;
    return to;
}

/* Where the clusters will stand, counted from the start of the segment's content. */
static void put_cues(struct bytes *bytes, const struct webm *webm, size_t segment)
{
    const size_t head = 4 + SIZE_BYTES, number = 1 + SIZE_BYTES + 8; /* ids of four bytes, and of one */
    size_t n_cues = 0;
    for (size_t i = 0; i < webm->n_frames; i = end_of_cluster(webm, i))
        n_cues++;
    const size_t cue = 1 + SIZE_BYTES + number + 1 + SIZE_BYTES + 2 * number, began = begin(bytes, CUES);
    size_t at = bytes->n - segment + n_cues * cue;
    for (size_t i = 0; i < webm->n_frames; i = end_of_cluster(webm, i)) {
        const size_t point = begin(bytes, CUE_POINT);
        put_number(bytes, CUE_TIME, time_ms(webm, i));
        const size_t positions = begin(bytes, CUE_TRACK_POSITIONS);
        put_number(bytes, CUE_TRACK, TRACK);
        put_number(bytes, CUE_CLUSTER_POSITION, at);
        end(bytes, positions);
        end(bytes, point);
        at += head + number;
        for (size_t k = i; k < end_of_cluster(webm, i); k++)
            at += 1 + SIZE_BYTES + 4 + webm->frames[k].n;
    }
    end(bytes, began);
}

static void put_clusters(struct bytes *bytes, const struct webm *webm)
{
    for (size_t i = 0; i < webm->n_frames; i = end_of_cluster(webm, i)) {
        const size_t began = begin(bytes, CLUSTER);
        put_number(bytes, TIMESTAMP, time_ms(webm, i));
        for (size_t k = i; k < end_of_cluster(webm, i); k++) {
            const struct webm_frame *frame = &webm->frames[k];
            put_id(bytes, SIMPLE_BLOCK);
            put_size(bytes, 4 + frame->n);
            put_big_endian(bytes, 0x80 | TRACK, 1); /* a track's number in one byte */
            put_big_endian(bytes, time_ms(webm, k) - time_ms(webm, i), 2);
            put_big_endian(bytes, frame->is_key ? KEY_FRAME : 0, 1);
            put(bytes, webm->bytes + frame->at, frame->n);
        }
        end(bytes, began);
    }
}

bool webm_write(const struct webm *webm, struct encoded *out, struct error *err)
{
    struct bytes bytes = { 0 };
    put_head(&bytes);
    const size_t segment = begin(&bytes, SEGMENT);
    put_info(&bytes, webm);
    put_tracks(&bytes, webm);
    put_cues(&bytes, webm, segment);
    put_clusters(&bytes, webm);
    end(&bytes, segment);
    if (bytes.is_short) {
        free(bytes.list);
        return error_set(err, ERROR_MEMORY, "no memory for a film");
    }
    *out = (struct encoded){ bytes.list, bytes.n };
    return true;
}
