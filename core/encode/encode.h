#pragma once
/* An image to JPEG or PNG bytes. The only module that knows libjpeg-turbo and libspng. */
#include <stddef.h>
#include <stdint.h>

#include "core/base/image.h"

enum encode_codec { ENCODE_JPEG = 1, ENCODE_PNG = 2 }; /* numbers of proto/frame.md */

struct encoder;
struct encoder *encoder_create(void); /* one a thread */
void encoder_destroy(struct encoder *encoder);

struct encode_options {
    enum encode_codec codec;
    int quality;     /* JPEG 1..100 */
    bool full_color; /* 4:4:4, else 4:2:0 */
};
struct encoded {
    uint8_t *bytes; /* free() */
    size_t n_bytes;
};
/* errors ERROR_RANGE, ERROR_MEMORY */
NODISCARD bool encode_image(struct encoder *encoder, const struct image *image, const struct encode_options *options,
                            struct encoded *out, struct error *err);
