#pragma once
/* One JPEG 2000 picture of one component to stored values. The only door to OpenJPEG. What the codestream's markers say
 * is compared with the image and with limits before the library sees a byte. */
#include "core/base/error.h"
#include "core/formats/dicom/dicom_basic.h"

enum {
    J2K_MAX_TILES = 1024,     /* the library holds some kilobytes for each */
    J2K_MAX_BLOCKS = 1 << 18, /* code-blocks, and precincts, that the picture is cut into */
    J2K_MAX_PACKETS = 1 << 21 /* layers times resolutions times precincts: the library visits each, also without data */
};

/* out: rows * columns cells of pixels->bits_allocated. The codestream says how many bits a value has, pixels->is_signed
 * how they are meant: the lowest bits are taken, and drawn out by their highest one where that is a sign. Fills
 * decoded. errors  ERROR_FORMAT not JPEG 2000, damaged, cut short, of another size; ERROR_UNSUPPORTED what is not read,
 * named; ERROR_LIMIT source  ITU-T T.800 annex A (codestream), I (boxes around it); PS3.5 A.4.4, 8.2.4 */
NODISCARD bool dicom_j2k_decode(const uint8_t *data, size_t size, const struct dicom_pixels *pixels, const char *name,
                                void *out, struct dicom_decoded *decoded, struct error *err);
