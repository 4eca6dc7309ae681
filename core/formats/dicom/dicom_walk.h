#pragma once
/* The bones of a DICOM file: where its data set and its pixels lie, and whether every length fits into what holds it.
 * Run before the library that reads values sees a byte: that one recurses without a limit and believes what lengths
 * say. Knows tags by number only. source  DICOM PS3.5 2023e sections 7 (data set), A (transfer syntaxes); PS3.10
 * section 7 (file header) */
#include "core/base/error.h"
#include "core/formats/dicom/dicom_basic.h"

enum {
    DICOM_MAX_ELEMENTS = 1 << 19, /* in one file, items and end marks included: about a second of the library's time */
    DICOM_MAX_DISORDER =
        64, /* elements behind one with a larger tag; the library looks for the place of each from the end */
    DICOM_MAX_INFLATED_MIB = 128 /* a deflated data set, inflated */
};

struct dicom_layout {
    char transfer_syntax[DICOM_UID_SIZE]; /* as the file says, "" */
    bool is_implicit, is_big_endian;      /* of the data set, as its bytes show */
    uint8_t *inflated;                    /* of a deflated data set, else NULL; the caller's: free */
    const uint8_t *data;                  /* the file's bytes or inflated; all positions count from here */
    size_t size;
    size_t begin, end; /* of the data set's elements before the pixels, or of those that are there */
    bool is_cut;       /* DICOM_START: the data ends before the pixels or the end of the data set */
    bool has_pixels, has_float_pixels;
    bool is_encapsulated;
    char pixels_vr[3];    /* "OB", "OW"; "" when the encoding does not say */
    size_t pixels_at;     /* first byte of the value */
    uint64_t pixels_size; /* native: what the element says, which may be more than there is */
};

/* errors as dicom_file_parse */
NODISCARD bool dicom_walk(const uint8_t *data, size_t size, const char *name, enum dicom_extent extent,
                          struct dicom_layout *layout, struct error *err);

/* Fragments of encapsulated pixels, in order; the first item is the table of offsets. */
struct dicom_fragment {
    size_t at, size;
};
/* Returns how many there are in all; fills at most most. errors ERROR_FORMAT */
NODISCARD bool dicom_walk_fragments(const struct dicom_layout *layout, const char *name,
                                    struct dicom_fragment *fragments, size_t most, size_t *n_fragments,
                                    struct error *err);
