#pragma once
/* One parsed DICOM file: elements, sequences, pixels. The only access to DCMTK: this header is plain C; dicom_file.cc
 * and dicom_pixels.cc behind it are C++. Knows tags and encodings, not what a CT or a plan is. Works on bytes in
 * memory; opens no file and no network connection.
 *
 *   thread  any number of files at the same time; each file in one thread at a time */
#include "core/formats/dicom/dicom_basic.h"
#include "core/formats/folder.h"

struct dicom_file;
struct dicom_item; /* the data set, or an item of a sequence; owned by its file */

/* Loads the data dictionary that DCMTK reads from its own files, registers the decoders, silences DCMTK's log. Call it
 * before the process gives up access to files. Every other function calls it if it has not run yet. Any thread. */
void dicom_prepare(void);

/* Parses a file. data is borrowed for the life of the result: native pixels are not copied.
 *
 *   errors  ERROR_FORMAT not DICOM, truncated, an element longer than its container, sequences nested too deep;
 *           ERROR_LIMIT; ERROR_MEMORY. The text names file, tag, byte position, value found and value expected. */
NODISCARD struct dicom_file *dicom_file_parse(const uint8_t *data, size_t size, const char *name,
                                              enum dicom_extent extent, struct error *err);
void dicom_file_destroy(struct dicom_file *file);
const struct dicom_item *dicom_root(const struct dicom_file *file);
const char *dicom_transfer_syntax(const struct dicom_file *file); /* UID; "" when the file does not say */
/* Name in the UID dictionary, e.g. "RTImageStorage"; "" for an unknown UID. */
const char *dicom_uid_word(const char *uid);
/* True if, after DICOM_START, the data ended before the last element in front of the pixels. */
bool dicom_is_cut(const struct dicom_file *file);

bool dicom_has(const struct dicom_item *item, uint32_t tag); /* the element is present, with or without a value */
/* Copies the whole value as UTF-8 (converted from SpecificCharacterSet), without padding, truncated at a whole
 * character. Control characters become blanks, bytes without a meaning in the character set "<0x8E>". Returns false
 * and "" if the element is absent or empty. */
bool dicom_text(const struct dicom_item *item, uint32_t tag, char *out, size_t size);
/* Like dicom_text, for value number index (from 0) of a multi-valued element. */
bool dicom_text_at(const struct dicom_item *item, uint32_t tag, size_t index, char *out, size_t size);
/* True if a text that was read so far has bytes without a meaning in its character set. */
bool dicom_text_is_broken(const struct dicom_file *file);
/* Values of DS, IS, FD, FL, US, SS, UL, SL or AT as numbers; a malformed value becomes NaN. Stores at most `most`
 * values and returns how many the element has. */
size_t dicom_numbers(const struct dicom_item *item, uint32_t tag, double *values, size_t most);
bool dicom_number(const struct dicom_item *item, uint32_t tag, double *value); /* first value; false unless finite */
/* Stores the first value; returns false if it is not a whole number. */
bool dicom_integer(const struct dicom_item *item, uint32_t tag, int64_t *value);
/* A DS value that is not a number, or an IS value that is not a whole number. */
struct dicom_bad_number {
    uint32_t tag;
    char place[100]; /* "(300A,00B0) item 1, (300A,0111) item 2, (300A,011E)"; only the end of a longer path */
    char found[24];  /* beginning of the bad value, printable characters only */
};
/* Finds the malformed DS and IS values of an item; with is_deep also those of the items nested in it. Skips private
 * elements and elements of tag but_not. Stores at most `most` of them and returns how many there are. */
size_t dicom_bad_numbers(const struct dicom_item *item, bool is_deep, uint32_t but_not, struct dicom_bad_number *bad,
                         size_t most);
size_t dicom_n_items(const struct dicom_item *item, uint32_t tag); /* items of a sequence; 0 when absent */
const struct dicom_item *dicom_item_at(const struct dicom_item *item, uint32_t tag, size_t index);

/* Reads the image pixel module and checks it against the pixel data that is present, before anything is allocated.
 *
 *   errors  ERROR_FORMAT elements missing or contradicting each other, pixel data shorter than they require;
 *           ERROR_UNSUPPORTED colour, float pixels, an encoding that cannot be decoded (named); ERROR_LIMIT a side over
 *           DICOM_MAX_SIDE */
NODISCARD bool dicom_pixels_look(const struct dicom_file *file, struct dicom_pixels *pixels, struct error *err);
/* Reads or decodes one frame as stored values (before rescaling).
 *
 *   out     [rows][columns] of bits_allocated, this machine's byte order, unused high bits zeroed or sign-extended;
 *           room for rows * columns * bits_allocated / 8 bytes
 *   errors  as dicom_pixels_look, and ERROR_MEMORY */
NODISCARD bool dicom_pixels_read(const struct dicom_file *file, uint32_t frame, void *out, struct error *err);

struct dicom_decoded dicom_pixels_decoded(const struct dicom_file *file);

/* Where the native pixels are in the file, for a caller that reads them from the file into memory of its own: frames
 * one after the other as from dicom_pixels_read, but in the file's byte order and with the unused bits unchanged.
 * Returns false if there are no pixels, or if they are compressed or deflated. */
struct dicom_stored {
    uint64_t at, size;
    bool is_swapped; /* the byte order is not this machine's */
};
bool dicom_pixels_stored(const struct dicom_file *file, struct dicom_stored *stored);
/* The native pixel bytes in memory, also those of a deflated data set. For pixels of one bit, which the functions above
 * do not read. The file must have been parsed with DICOM_WHOLE. NULL if there are no pixels or they are compressed. */
const uint8_t *dicom_pixels_bytes(const struct dicom_file *file, uint64_t *size, bool *is_swapped);
