#pragma once
/* Definitions shared by all files of core/formats/dicom: tags, the limits of one file, how much of a file is parsed,
 * and the format of its pixels. Independent of DCMTK. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define DICOM_TAG(group, element) ((uint32_t)(group) << 16 | (uint32_t)(element))

enum {
    DICOM_MAX_FILE_MIB = 1024, /* larger files are refused */
    DICOM_MAX_DEPTH = 16,      /* nesting depth of sequences */
    DICOM_MAX_SIDE = 4096,     /* rows or columns of a frame; same as a volume's side */
    DICOM_UID_SIZE = 65
};

enum dicom_extent {
    DICOM_START, /* first look at a file: as many whole elements as data holds */
    DICOM_HEAD,  /* all elements before the pixel data; data may end anywhere after them */
    DICOM_WHOLE
};

struct dicom_pixels {
    uint32_t rows, columns, n_frames; /* each at least 1 */
    uint32_t bits_allocated;          /* 8, 16 or 32 */
    uint32_t bits_stored, high_bit;
    bool is_signed, is_monochrome1;
    uint32_t n_samples;     /* always 1; colour is refused */
    uint64_t surplus_bytes; /* of native pixel data beyond the frames, without the byte that makes it even */
};

/* Properties of the values in the JPEG 2000 codestream of the last frame read. n_bits is 0 for every other encoding. */
struct dicom_decoded {
    bool is_lossy; /* the codestream uses the irreversible transform; a reversible one may still have been truncated */
    bool is_signed;
    uint32_t n_bits; /* per value */
};

/* Returns true for "DICM" after the 128-byte preamble, or for an element of group 0002 or 0008 at byte 0 (a file
 * without preamble). Pass at least the first 140 bytes. */
bool dicom_looks_like(const uint8_t *data, size_t size);
