#pragma once
/* Walks the structure of a DICOM file: finds data set and pixels, and checks that every length fits into its container.
 * Runs before DCMTK sees a byte, because DCMTK recurses without a limit and trusts lengths. Knows tags by number only.
 *
 *   thread  any
 *   source  DICOM PS3.5 2023e sections 7 (data set), A (transfer syntaxes); PS3.10 section 7 (file header) */
#include "core/base/error.h"
#include "core/formats/dicom/dicom_basic.h"

enum {
    DICOM_MAX_ELEMENTS = 1 << 19, /* per file, items and end markers too: DCMTK needs about a second for them */
    DICOM_MAX_DISORDER = 64, /* elements after one with a larger tag: DCMTK searches the place of each from the end */
    DICOM_MAX_INFLATED_MIB = 128 /* size of a deflated data set after inflating */
};

struct dicom_layout {
    char transfer_syntax[DICOM_UID_SIZE]; /* as in the file; "" if not given */
    bool is_implicit, is_big_endian;      /* of the data set, as its bytes show */
    uint8_t *inflated;                    /* the inflated data set if it was deflated, else NULL; the caller frees it */
    const uint8_t *data;                  /* the file's bytes, or inflated; every position below counts from here */
    size_t size;
    size_t begin, end; /* of the elements before the pixels, as far as they are present */
    bool is_cut;       /* DICOM_START: data ends before the pixels and before the end of the data set */
    bool has_pixels, has_float_pixels;
    bool is_encapsulated;
    char pixels_vr[3];    /* "OB" or "OW"; "" for an implicit encoding */
    size_t pixels_at;     /* first byte of the value */
    uint64_t pixels_size; /* native: as the element says, possibly more than is present */
};

/* Errors: as dicom_file_parse. */
NODISCARD bool dicom_walk(const uint8_t *data, size_t size, const char *name, enum dicom_extent extent,
                          struct dicom_layout *layout, struct error *err);

/* A fragment of encapsulated pixels; the first one of a file is the offset table. */
struct dicom_fragment {
    size_t at, size;
};
/* Stores at most `most` fragments in file order; n_fragments is the number of all. Errors: ERROR_FORMAT. */
NODISCARD bool dicom_walk_fragments(const struct dicom_layout *layout, const char *name,
                                    struct dicom_fragment *fragments, size_t most, size_t *n_fragments,
                                    struct error *err);
