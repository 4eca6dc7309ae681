/* Writes DICOM files byte by byte. */
#include "tests/unit/made_dicom.h"

#include "tests/check.h"

void made_raw(struct made_dicom *made, const void *bytes, size_t n)
{
    if (made->size + n > made->room) {
        made->room = 2 * (made->size + n) + 256;
        made->data = realloc(made->data, made->room);
        if (!made->data)
            abort();
    }
    if (n > 0)
        memcpy(made->data + made->size, bytes, n);
    made->size += n;
}

static void put16(struct made_dicom *made, uint32_t value)
{
    uint8_t low = (uint8_t)value, high = (uint8_t)(value >> 8);
    made_raw(made, made->is_big_endian ? (uint8_t[]){ high, low } : (uint8_t[]){ low, high }, 2);
}

static void put32(struct made_dicom *made, uint32_t value)
{
    put16(made, made->is_big_endian ? value >> 16 : value & 0xFFFF);
    put16(made, made->is_big_endian ? value & 0xFFFF : value >> 16);
}

void made_head(struct made_dicom *made, uint32_t tag, const char *vr, uint32_t length)
{
    put16(made, tag >> 16);
    put16(made, tag & 0xFFFF);
    if (made->is_implicit || tag >> 16 == 0xFFFE) {
        put32(made, length);
        return;
    }
    made_raw(made, vr, 2);
    bool is_long = strstr("OB OW OF OD OL SQ UC UN UR UT", vr) != NULL;
    if (is_long)
        put16(made, 0);
    if (is_long)
        put32(made, length);
    else
        put16(made, length);
}

void made_element(struct made_dicom *made, uint32_t tag, const char *vr, const void *value, size_t n)
{
    made_head(made, tag, vr, (uint32_t)(n + n % 2));
    made_raw(made, value, n);
    if (n % 2)
        made_raw(made, strcmp(vr, "UI") == 0 || vr[0] == 'O' ? "\0" : " ", 1);
}

void made_text(struct made_dicom *made, uint32_t tag, const char *vr, const char *text)
{
    made_element(made, tag, vr, text, strlen(text));
}

void made_u16(struct made_dicom *made, uint32_t tag, uint16_t value)
{
    made_head(made, tag, "US", 2);
    put16(made, value);
}

void made_u32(struct made_dicom *made, uint32_t tag, const char *vr, uint32_t value)
{
    made_head(made, tag, vr, 4);
    put32(made, value);
}

void made_sequence(struct made_dicom *made, uint32_t tag)
{
    made_head(made, tag, "SQ", UINT32_MAX);
}
void made_sequence_end(struct made_dicom *made)
{
    made_head(made, DICOM_TAG(0xFFFE, 0xE0DD), "", 0);
}
void made_item(struct made_dicom *made)
{
    made_head(made, DICOM_TAG(0xFFFE, 0xE000), "", UINT32_MAX);
}
void made_item_end(struct made_dicom *made)
{
    made_head(made, DICOM_TAG(0xFFFE, 0xE00D), "", 0);
}

void made_words(struct made_dicom *made, const uint16_t *words, size_t n)
{
    for (size_t i = 0; i < n; i++)
        put16(made, words[i]);
}

void made_begin(struct made_dicom *made, const char *transfer_syntax)
{
    *made = (struct made_dicom){ 0 };
    if (!transfer_syntax)
        return;
    static const uint8_t preamble[128];
    made_raw(made, preamble, sizeof preamble);
    made_raw(made, "DICM", 4);
    size_t length = strlen(transfer_syntax) + strlen(transfer_syntax) % 2;
    made_head(made, DICOM_TAG(2, 0), "UL", 4);
    put32(made, (uint32_t)length + 8);
    made_text(made, DICOM_TAG(2, 0x10), "UI", transfer_syntax);
    made->is_implicit = strcmp(transfer_syntax, MADE_IMPLICIT) == 0;
    made->is_big_endian = strcmp(transfer_syntax, MADE_BIG_ENDIAN) == 0;
}

void made_finish(struct made_dicom *made)
{
    free(made->data);
    *made = (struct made_dicom){ 0 };
}

struct dicom_file *made_parse(const struct made_dicom *made)
{
    struct error err = { 0 };
    struct dicom_file *file = dicom_file_parse(made->data, made->size, "made.dcm", DICOM_WHOLE, &err);
    assert_string_equal(err.text, "");
    assert_non_null(file);
    return file;
}
