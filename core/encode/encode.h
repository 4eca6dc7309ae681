#pragma once
/* Compresses an image to JPEG or PNG bytes. The only module that uses libjpeg-turbo and libspng. */
#include <stddef.h>
#include <stdint.h>

#include "core/base/image.h"

enum encode_codec { ENCODE_JPEG = 1, ENCODE_PNG = 2 }; /* the numbers of proto/frame.md */

struct encoder;
struct encoder *encoder_create(void); /* one per thread */
void encoder_destroy(struct encoder *encoder);

struct encode_options {
    enum encode_codec codec;
    int quality;     /* JPEG: 1..100 */
    bool full_color; /* JPEG: 4:4:4; false: 4:2:0 */
};
struct encoded {
    uint8_t *bytes; /* the caller frees it */
    size_t n_bytes;
};
/* Compresses an image; out->bytes is the caller's.
 *
 *   errors  ERROR_RANGE, ERROR_MEMORY
 *   thread  the encoder's */
NODISCARD bool encode_image(struct encoder *encoder, const struct image *image, const struct encode_options *options,
                            struct encoded *out, struct error *err);
/* The image as a PNG with a text in it, UTF-8, compressed, in an iTXt chunk of this keyword (1 to 79 letters). errors
 * as encode_image. thread: any */
NODISCARD bool encode_png_with_text(const struct image *image, const char *keyword, const char *text,
                                    struct encoded *out, struct error *err);
