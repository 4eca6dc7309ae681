#pragma once
/* Small DICOM files, written byte by byte (PS3.5, PS3.10): for cases that no real file has, and so that a test can use
 * wrong values. */
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

/* Writes preamble and file header. transfer_syntax NULL: neither, the file is a bare data set (explicit). */
void made_begin(struct made_dicom *made, const char *transfer_syntax);
void made_finish(struct made_dicom *made); /* frees */
void made_raw(struct made_dicom *made, const void *bytes, size_t n);
/* Parses the file with DICOM_WHOLE; fails the test if it is refused. */
struct dicom_file *made_parse(const struct made_dicom *made);
/* Write elements; text values are padded to an even length. */
void made_element(struct made_dicom *made, uint32_t tag, const char *vr, const void *value, size_t n);
void made_text(struct made_dicom *made, uint32_t tag, const char *vr, const char *text);
void made_u16(struct made_dicom *made, uint32_t tag, uint16_t value);
void made_u32(struct made_dicom *made, uint32_t tag, const char *vr, uint32_t value);
/* Writes tag, VR and length of an element; made_raw adds the value. */
void made_head(struct made_dicom *made, uint32_t tag, const char *vr, uint32_t length);
/* Begins and ends a sequence and its items, of undefined length. */
void made_sequence(struct made_dicom *made, uint32_t tag);
void made_sequence_end(struct made_dicom *made);
void made_item(struct made_dicom *made);
void made_item_end(struct made_dicom *made);
void made_words(struct made_dicom *made, const uint16_t *words, size_t n); /* in the file's byte order */
