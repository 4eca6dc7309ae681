#pragma once
/* Decodes one JPEG 2000 image of one component to stored values. The only use of OpenJPEG. The codestream's markers are
 * checked against the image and against limits before OpenJPEG sees a byte. */
#include "core/base/error.h"
#include "core/formats/dicom/dicom_basic.h"

enum {
    J2K_MAX_TILES = 1024,     /* OpenJPEG keeps some kilobytes per tile */
    J2K_MAX_BLOCKS = 1 << 18, /* code-blocks, and likewise precincts, of the whole image */
    J2K_MAX_PACKETS = 1 << 21 /* layers x resolutions x precincts: OpenJPEG visits each packet, also the empty ones */
};

/* The number of bits of a value comes from the codestream, the sign from pixels->is_signed: the lowest bits are taken,
 * and sign-extended where the values are signed.
 *
 *   out      rows * columns cells of pixels->bits_allocated
 *   decoded  filled with what the codestream says about its values
 *   errors   ERROR_FORMAT not JPEG 2000, damaged, truncated, another size; ERROR_UNSUPPORTED a feature that is not read
 *            (named); ERROR_LIMIT
 *   thread   any
 *   source   ITU-T T.800 annex A (codestream), annex I (JP2 boxes); DICOM PS3.5 A.4.4, 8.2.4 */
NODISCARD bool dicom_j2k_decode(const uint8_t *data, size_t size, const struct dicom_pixels *pixels, const char *name,
                                void *out, struct dicom_decoded *decoded, struct error *err);
