#pragma once
/* What all files of core/formats/dicom build on: how a tag is written, the limits of one file, how much of a file is
 * read, what its pixels are. Knows no library. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define DICOM_TAG(group, element) ((uint32_t)(group) << 16 | (uint32_t)(element))

enum {
    DICOM_MAX_FILE_MIB = 1024, /* larger files are refused */
    DICOM_MAX_DEPTH = 16,      /* of sequences in sequences */
    DICOM_MAX_SIDE = 4096,     /* rows, columns: as a volume's */
    DICOM_UID_SIZE = 65
};

enum dicom_extent {
    DICOM_START, /* as many whole elements as data holds: of a first look at a file */
    DICOM_HEAD,  /* elements before the pixel data; data may end anywhere after them */
    DICOM_WHOLE
};

struct dicom_pixels {
    uint32_t rows, columns, n_frames; /* each at least 1 */
    uint32_t bits_allocated;          /* 8, 16 or 32 */
    uint32_t bits_stored, high_bit;
    bool is_signed, is_monochrome1;
    uint32_t n_samples; /* 1; colour is refused */
};

/* What the codestream of the frame read last says of itself: JPEG 2000 alone, else n_bits is 0. */
struct dicom_decoded {
    bool is_lossy; /* by its transform; one without loss may still have been cut */
    bool is_signed;
    uint32_t n_bits; /* of a value */
};

/* "DICM" after the preamble, or a group 0002/0008 element where a file without preamble begins. Needs the first 140
 * bytes. */
bool dicom_looks_like(const uint8_t *data, size_t size);
