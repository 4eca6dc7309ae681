#pragma once
/* Small DICOM files, made byte by byte (PS3.5, PS3.10): for what no real file shows, and so that a test can say where
 * it lies. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/formats/dicom/dicom_file.h"

#define MADE_EXPLICIT "1.2.840.10008.1.2.1"
#define MADE_IMPLICIT "1.2.840.10008.1.2"
#define MADE_BIG_ENDIAN "1.2.840.10008.1.2.2"

struct made_dicom {
    uint8_t *data;
    size_t size, room;
    bool is_implicit, is_big_endian;
};

/* Preamble and file header; transfer_syntax NULL: none at all, the data set stands alone (explicit). */
void made_begin(struct made_dicom *made, const char *transfer_syntax);
void made_finish(struct made_dicom *made); /* frees */
void made_raw(struct made_dicom *made, const void *bytes, size_t n);
/* The file, read whole; fails the test when it is refused. */
struct dicom_file *made_parse(const struct made_dicom *made);
/* Elements; values of text kinds are padded to an even length. */
void made_element(struct made_dicom *made, uint32_t tag, const char *vr, const void *value, size_t n);
void made_text(struct made_dicom *made, uint32_t tag, const char *vr, const char *text);
void made_u16(struct made_dicom *made, uint32_t tag, uint16_t value);
void made_u32(struct made_dicom *made, uint32_t tag, const char *vr, uint32_t value);
/* The head of an element alone: its value follows by made_raw. */
void made_head(struct made_dicom *made, uint32_t tag, const char *vr, uint32_t length);
/* A sequence and its items, without lengths. */
void made_sequence(struct made_dicom *made, uint32_t tag);
void made_sequence_end(struct made_dicom *made);
void made_item(struct made_dicom *made);
void made_item_end(struct made_dicom *made);
void made_words(struct made_dicom *made, const uint16_t *words, size_t n); /* in the file's byte order */
