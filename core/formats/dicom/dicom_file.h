#pragma once
/* One DICOM file, parsed: elements, sequences, pixels. The only door to DCMTK: plain C outside, C++ behind
 * (dicom_file.cc). Knows tags and encodings, not what a CT or a plan is. Reads memory only; never a file, never the
 * network. thread  any number of files at once; one file, one thread at a time */
#include "core/formats/dicom/dicom_basic.h"
#include "core/formats/folder.h"

struct dicom_file;
struct dicom_item; /* the data set or an item of a sequence; borrowed from its file */

/* Loads what the library under this takes from files of its own (the dictionary), registers decoders, silences it. Call
 * before the process gives up its rights to files; every other call does it when nobody has. Any thread. */
void dicom_prepare(void);

/* data is borrowed as long as the file lives: pixels of native encodings are not copied.
 *   errors  ERROR_FORMAT not DICOM, cut short, an element longer than what holds it, too deep; ERROR_LIMIT,
 * ERROR_MEMORY; the text names file, tag, position, found, expected */
NODISCARD struct dicom_file *dicom_file_parse(const uint8_t *data, size_t size, const char *name,
                                              enum dicom_extent extent, struct error *err);
void dicom_file_destroy(struct dicom_file *file);
const struct dicom_item *dicom_root(const struct dicom_file *file);
const char *dicom_transfer_syntax(const struct dicom_file *file); /* UID; "" when the file does not say */
const char *dicom_uid_word(const char *uid); /* "RTImageStorage"; "" for one the library does not know */
bool dicom_is_cut(
    const struct dicom_file *file); /* DICOM_START: there are more elements before the pixels than data held */

bool dicom_has(const struct dicom_item *item, uint32_t tag); /* present, with or without a value */
/* The whole value as UTF-8 (by SpecificCharacterSet), without the padding, cut at a whole character; false and "" when
 * it is absent or empty. Control characters become blanks. */
bool dicom_text(const struct dicom_item *item, uint32_t tag, char *out, size_t size);
bool dicom_text_at(const struct dicom_item *item, uint32_t tag, size_t index, char *out,
                   size_t size); /* one of several values */
/* Values of DS, IS, FD, FL, US, SS, UL, SL, AT as numbers; what is no number becomes not-a-number. Fills at most most
 * of them and returns how many the element has. */
size_t dicom_numbers(const struct dicom_item *item, uint32_t tag, double *values, size_t most);
bool dicom_number(const struct dicom_item *item, uint32_t tag, double *value);   /* the first, finite */
bool dicom_integer(const struct dicom_item *item, uint32_t tag, int64_t *value); /* the first, whole */
/* A value of kind DS or IS (whole) that is no such number. */
struct dicom_bad_number {
    uint32_t tag;
    char place[100]; /* "(300A,00B0) item 1, (300A,0111) item 2, (300A,011E)"; the end of it where it is longer */
    char found[24];  /* beginning of the value, or of the one among several, printable */
};
/* Looks through an item, and with is_deep through what lies in its sequences. Private elements and those of the tag
 * but_not are passed over. Fills at most most and returns how many there are. */
size_t dicom_bad_numbers(const struct dicom_item *item, bool is_deep, uint32_t but_not, struct dicom_bad_number *bad,
                         size_t most);
size_t dicom_n_items(const struct dicom_item *item, uint32_t tag); /* of a sequence; 0 when absent */
const struct dicom_item *dicom_item_at(const struct dicom_item *item, uint32_t tag, size_t index);

/* What the image pixel module says, checked against what is there before anything is allocated.
 *   errors ERROR_FORMAT missing or contradicting, pixel data shorter than they say; ERROR_UNSUPPORTED colour, float
 * pixels, an encoding that cannot be decoded (named); ERROR_LIMIT a side over DICOM_MAX_SIDE */
NODISCARD bool dicom_pixels_look(const struct dicom_file *file, struct dicom_pixels *pixels, struct error *err);
/* Stored values of one frame, [rows][columns] of bits_allocated, machine order, unused high bits cleared or
 * sign-extended; out holds rows * columns * bits_allocated / 8 bytes. Decodes what is compressed. errors as above and
 * ERROR_MEMORY */
NODISCARD bool dicom_pixels_read(const struct dicom_file *file, uint32_t frame, void *out, struct error *err);

struct dicom_decoded dicom_pixels_decoded(const struct dicom_file *file);

/* Where native pixels lie in the file, for a reader that takes them from there into its own memory: frame after frame,
 * as in dicom_pixels_read but in the file's byte order and with the unused bits as they are. false: none, compressed or
 * deflated. */
struct dicom_stored {
    uint64_t at, size;
    bool is_swapped; /* not this machine's byte order */
};
bool dicom_pixels_stored(const struct dicom_file *file, struct dicom_stored *stored);
/* Native pixels where they lie in memory, also of a deflated file: for pixels of one bit, which the calls above do not
 * read. NULL: none, or compressed. The file was parsed whole. */
const uint8_t *dicom_pixels_bytes(const struct dicom_file *file, uint64_t *size, bool *is_swapped);
