/* Compresses images with libjpeg-turbo (JPEG) and libspng (PNG). */
#include "core/encode/encode.h"

#include <spng.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <turbojpeg.h>

#include "core/base/mem.h"

/* Up to this quality the fast DCT is not visibly worse than the exact one; above it, fidelity counts more than speed.
 */
enum { FAST_TRANSFORM_MAX_QUALITY = 85, PNG_COMPRESSION_LEVEL = 1 };

/* Up to this size, memory for the largest possible JPEG is allocated at once: 6 bytes per pixel. Above, it grows with
 * the JPEG, which is about a tenth of that. */
enum { AT_ONCE_MAX_PX = 4000000 };

struct encoder {
    tjhandle jpeg;
};

struct encoder *encoder_create(void)
{
    /* the compressor is created at first use, where a failure can be reported */
    return mem_new(sizeof(struct encoder));
}

void encoder_destroy(struct encoder *encoder)
{
    if (!encoder)
        return;
    if (encoder->jpeg)
        tjDestroy(encoder->jpeg);
    free(encoder);
}

static bool encode_jpeg(struct encoder *encoder, const struct image *image, const struct encode_options *options,
                        struct encoded *out, struct error *err)
{
    if (options->quality < 1 || options->quality > 100)
        return error_set(err, ERROR_RANGE, "JPEG quality %d: must be 1 to 100", options->quality);
    if (!encoder->jpeg && !(encoder->jpeg = tjInitCompress()))
        return error_set(err, ERROR_MEMORY, "no JPEG compressor: %s", tjGetErrorStr2(NULL));

    int sampling = options->full_color ? TJSAMP_444 : TJSAMP_420;
    unsigned long n_bytes = tjBufSize(image->width_px, image->height_px, sampling);
    if (n_bytes == (unsigned long)-1)
        return error_set(err, ERROR_RANGE, "a JPEG of %d x %d pixels is too large", image->width_px, image->height_px);
    bool grows = (int64_t)image->width_px * image->height_px > AT_ONCE_MAX_PX;
    unsigned char *bytes = grows ? NULL : malloc(n_bytes);
    if (!bytes && !grows)
        return error_set(err, ERROR_MEMORY, "a JPEG of %d x %d pixels: no memory for %lu bytes", image->width_px,
                         image->height_px, n_bytes);
    if (grows)
        n_bytes = 0;
    int flags = (grows ? 0 : TJFLAG_NOREALLOC) |
                (options->quality <= FAST_TRANSFORM_MAX_QUALITY ? TJFLAG_FASTDCT : TJFLAG_ACCURATEDCT);
    if (tjCompress2(encoder->jpeg, image->rgba, image->width_px, 0, image->height_px, TJPF_RGBX, &bytes, &n_bytes,
                    sampling, options->quality, flags) != 0) {
        error_set(err, ERROR_MEMORY, "a JPEG of %d x %d pixels: %s", image->width_px, image->height_px,
                  tjGetErrorStr2(encoder->jpeg));
        free(bytes);
        return false;
    }
    unsigned char *fitted = realloc(bytes, n_bytes);
    *out = (struct encoded){ fitted ? fitted : bytes, n_bytes };
    return true;
}

/* text: NULL: none */
static bool encode_png(const struct image *image, struct spng_text *text, struct encoded *out, struct error *err)
{
    spng_ctx *png = spng_ctx_new(SPNG_CTX_ENCODER);
    if (!png)
        return error_set(err, ERROR_MEMORY, "no memory for a PNG of %d x %d pixels", image->width_px, image->height_px);
    struct spng_ihdr header = { .width = (uint32_t)image->width_px,
                                .height = (uint32_t)image->height_px,
                                .bit_depth = 8,
                                .color_type = SPNG_COLOR_TYPE_TRUECOLOR_ALPHA };
    size_t n_raw = (size_t)image->width_px * (size_t)image->height_px * 4, n_bytes = 0;
    int status = spng_set_option(png, SPNG_ENCODE_TO_BUFFER, 1);
    if (!status)
        status = spng_set_option(png, SPNG_IMG_COMPRESSION_LEVEL, PNG_COMPRESSION_LEVEL);
    if (!status)
        status = spng_set_option(png, SPNG_FILTER_CHOICE, SPNG_FILTER_CHOICE_SUB | SPNG_FILTER_CHOICE_UP);
    if (!status)
        status = spng_set_ihdr(png, &header);
    if (!status && text)
        status = spng_set_text(png, text, 1);
    if (!status)
        status = spng_encode_image(png, image->rgba, n_raw, SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE);
    uint8_t *bytes = status ? NULL : spng_get_png_buffer(png, &n_bytes, &status);
    spng_ctx_free(png);
    if (!bytes)
        return error_set(err, ERROR_MEMORY, "a PNG of %d x %d pixels: %s", image->width_px, image->height_px,
                         spng_strerror(status));
    *out = (struct encoded){ bytes, n_bytes };
    return true;
}

static bool check_size(const struct image *image, struct error *err)
{
    return (image->width_px >= 1 && image->height_px >= 1 && image->width_px <= IMAGE_MAX_SIDE_PX &&
            image->height_px <= IMAGE_MAX_SIDE_PX) ||
           error_set(err, ERROR_RANGE, "a picture of %d x %d pixels: each side must be 1 to %d", image->width_px,
                     image->height_px, IMAGE_MAX_SIDE_PX);
}

bool encode_png_with_text(const struct image *image, const char *keyword, const char *text, struct encoded *out,
                          struct error *err)
{
    size_t length = strlen(text);
    char none[] = "", *copy = mem_array(length + 1, 1, UINT64_MAX, err); /* libspng wants them writable */
    *out = (struct encoded){ 0 };
    if (!copy)
        return false;
    memcpy(copy, text, length);
    struct spng_text chunk = { .type = SPNG_ITXT,
                               .length = length,
                               .text = copy,
                               .compression_flag = 1,
                               .language_tag = none,
                               .translated_keyword = none };
    (void)snprintf(chunk.keyword, sizeof chunk.keyword, "%s", keyword);
    bool is_done = check_size(image, err) && encode_png(image, &chunk, out, err);
    free(copy);
    return is_done;
}

bool encode_image(struct encoder *encoder, const struct image *image, const struct encode_options *options,
                  struct encoded *out, struct error *err)
{
    *out = (struct encoded){ 0 };
    if (!check_size(image, err))
        return false;
    switch (options->codec) {
    case ENCODE_JPEG: return encode_jpeg(encoder, image, options, out, err);
    case ENCODE_PNG: return encode_png(image, NULL, out, err);
    }
    return error_set(err, ERROR_RANGE, "no picture format has the number %d", (int)options->codec);
}
