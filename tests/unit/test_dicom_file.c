/* The door to DICOM: elements, texts, numbers, sequences, pixels, and what is refused. Expected values: the bytes written here
 * (PS3.5), and pixels that eight encodings of one picture have in common. */
#include "core/formats/dicom/dicom_file.h"

#include <dirent.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/formats/dicom/dicom_walk.h"
#include "server/renderer/confine.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/made_dicom.h"

static const char *const encodings[] = { MADE_EXPLICIT, MADE_IMPLICIT, MADE_BIG_ENDIAN };

static struct dicom_file *parse(const struct made_dicom *made)
{
    struct error err = { 0 };
    struct dicom_file *file = dicom_file_parse(made->data, made->size, "made.dcm", DICOM_WHOLE, &err);
    assert_string_equal(err.text, "");
    assert_non_null(file);
    return file;
}

static void is_refused(const struct made_dicom *made, enum error_code code, const char *words)
{
    struct error err = { 0 };
    struct dicom_file *file = dicom_file_parse(made->data, made->size, "made.dcm", DICOM_WHOLE, &err);
    assert_null(file);
    if (err.code != code)
        fail_msg("%s, expected %s", err.text, error_word(code));
    if (!strstr(err.text, words))
        fail_msg("\"%s\" does not say \"%s\"", err.text, words);
    assert_non_null(strstr(err.text, "made.dcm"));
}

static void each_encoding_gives_the_same_values(void **state)
{
    (void)state;
    for (size_t e = 0; e < 3; e++) {
        struct made_dicom made;
        made_begin(&made, encodings[e]);
        made_text(&made, DICOM_TAG(0x0008, 0x0060), "CS", "CT");
        made_text(&made, DICOM_TAG(0x0020, 0x0032), "DS", "-1.5\\2e2 \\ +3");
        made_text(&made, DICOM_TAG(0x0020, 0x0013), "IS", "7");
        made_u16(&made, DICOM_TAG(0x0028, 0x0010), 513);
        made_u32(&made, DICOM_TAG(0x300A, 0x0000), "UL", 70000); /* group length: a UL */
        struct dicom_file *file = parse(&made);
        const struct dicom_item *root = dicom_root(file);
        char text[64];
        double numbers[4] = { 0 };
        int64_t whole = 0;
        assert_string_equal(dicom_transfer_syntax(file), encodings[e]);
        assert_true(dicom_text(root, DICOM_TAG(0x0008, 0x0060), text, sizeof text));
        assert_string_equal(text, "CT");
        assert_int_equal(dicom_numbers(root, DICOM_TAG(0x0020, 0x0032), numbers, 4), 3);
        assert_close(numbers[0], -1.5, 0);
        assert_close(numbers[1], 200, 0);
        assert_close(numbers[2], 3, 0);
        assert_true(dicom_integer(root, DICOM_TAG(0x0020, 0x0013), &whole) && whole == 7);
        assert_true(dicom_integer(root, DICOM_TAG(0x0028, 0x0010), &whole) && whole == 513);
        assert_true(dicom_has(root, DICOM_TAG(0x0028, 0x0010)));
        assert_false(dicom_has(root, DICOM_TAG(0x0028, 0x0011)));
        assert_false(dicom_text(root, DICOM_TAG(0x0028, 0x0011), text, sizeof text));
        assert_string_equal(text, "");
        dicom_file_destroy(file);
        made_finish(&made);
    }
}

static void numbers_are_read_as_people_write_them_and_the_rest_is_not_a_number(void **state)
{
    (void)state;
    struct made_dicom made;
    made_begin(&made, MADE_EXPLICIT);
    made_text(&made, DICOM_TAG(0x0020, 0x0032), "DS", "1.\\.5\\-0\\1E+3\\\\1,5\\abc\\inf\\nan\\ 12.25 \\0x10\\1e999\\--1\\+-1\\-inf\\-nan\\-.5\\.\\-\\0.1"
                                                     "\\123456789012345\\-0.00000000000001\\12345.678901234567");
    struct dicom_file *file = parse(&made);
    double v[24] = { 0 };
    assert_int_equal(dicom_numbers(dicom_root(file), DICOM_TAG(0x0020, 0x0032), v, 24), 23);
    assert_close(v[0], 1, 0);
    assert_close(v[1], 0.5, 0);
    assert_close(v[2], 0, 0);
    assert_close(v[3], 1000, 0);
    assert_close(v[9], 12.25, 0);
    /* what the compiler reads from the same digits: rounded once, as a decimal number should be */
    assert_close(v[16], -.5, 0);
    assert_close(v[19], 0.1, 0);
    assert_close(v[20], 123456789012345.0, 0);
    assert_close(v[21], -0.00000000000001, 0);
    assert_close(v[22], 12345.678901234567, 0);
    static const int bad[] = { 4, 5, 6, 7, 8, 10, 11, 12, 13, 14, 15, 17, 18 };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        assert_true(isnan(v[bad[i]]));
    /* the count is of all, whatever is filled; one number may be asked for alone */
    assert_int_equal(dicom_numbers(dicom_root(file), DICOM_TAG(0x0020, 0x0032), v, 2), 23);
    assert_int_equal(dicom_numbers(dicom_root(file), DICOM_TAG(0x0020, 0x0032), NULL, 0), 23);
    dicom_file_destroy(file);
    made_finish(&made);
}

static void a_contour_of_100000_numbers_is_read_whole(void **state)
{
    (void)state;
    enum { N = 100000 };
    char *text = malloc(N * 12 + 1);
    size_t n = 0;
    for (int i = 0; i < N; i++)
        n += (size_t)snprintf(text + n, 13, "%s%.2f", i ? "\\" : "", i * 0.01 - 500);
    struct made_dicom made;
    made_begin(&made, MADE_IMPLICIT); /* explicit cannot say the length of so long a DS */
    made_text(&made, DICOM_TAG(0x3006, 0x0050), "DS", text);
    struct dicom_file *file = parse(&made);
    double *values = malloc(N * sizeof *values);
    assert_int_equal(dicom_numbers(dicom_root(file), DICOM_TAG(0x3006, 0x0050), values, N), N);
    for (int i = 0; i < N; i++)
        assert_close(values[i], i * 0.01 - 500, 1e-9);
    free(values);
    free(text);
    dicom_file_destroy(file);
    made_finish(&made);
}

static void texts_come_out_as_utf8_whatever_the_character_set(void **state)
{
    (void)state;
    /* PS3.5 annexes H and I give the Japanese and Korean names byte by byte */
    static const struct {
        const char *set, *bytes, *utf8;
    } cases[] = {
        { "", "plain", "plain" },
        { "ISO_IR 100", "Hypophyse r\xE9siduelle", "Hypophyse r\xC3\xA9siduelle" },
        { "ISO_IR 192", "Hirnstamm \xC3\xA4u\xC3\x9F" "ere", "Hirnstamm \xC3\xA4u\xC3\x9F" "ere" },
        { "ISO_IR 144", "\xBC\xDE\xD7\xD3", "\xD0\x9C\xD0\xBE\xD0\xB7\xD0\xB3" },
        { "\\ISO 2022 IR 87", "\x1B$B;3ED\x1B(B", "\xE5\xB1\xB1\xE7\x94\xB0" },
        { "\\ISO 2022 IR 149", "\x1B$)C\xB1\xE8\xC8\xF1", "\xEA\xB9\x80\xED\x9D\xAC" },
        { "GB18030", "\xCD\xF5", "\xE7\x8E\x8B" },
        { "", "T\xC3\xBCr", "T\xC3\xBCr" },                  /* says nothing, is UTF-8 */
        { "", "T\xFCr", "T\xC3\xBCr" },                       /* says nothing, is not */
        { "NO SUCH SET", "T\xFCr", "T\xC3\xBCr" },
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct made_dicom made;
        made_begin(&made, MADE_EXPLICIT);
        if (cases[i].set[0])
            made_text(&made, DICOM_TAG(0x0008, 0x0005), "CS", cases[i].set);
        made_text(&made, DICOM_TAG(0x0008, 0x103E), "LO", cases[i].bytes);
        struct dicom_file *file = parse(&made);
        char text[64];
        assert_true(dicom_text(dicom_root(file), DICOM_TAG(0x0008, 0x103E), text, sizeof text));
        assert_string_equal(text, cases[i].utf8);
        dicom_file_destroy(file);
        made_finish(&made);
    }
}

static void a_text_is_cut_at_a_whole_character_and_has_no_control_characters(void **state)
{
    (void)state;
    struct made_dicom made;
    made_begin(&made, MADE_EXPLICIT);
    made_text(&made, DICOM_TAG(0x0008, 0x0005), "CS", "ISO_IR 192");
    made_text(&made, DICOM_TAG(0x0008, 0x103E), "LO", "  ab\nc\xC3\xA4\xC3\xA4  ");
    made_text(&made, DICOM_TAG(0x0008, 0x0008), "CS", "ORIGINAL\\PRIMARY \\AXIAL");
    struct dicom_file *file = parse(&made);
    char text[64], small[8];
    assert_true(dicom_text(dicom_root(file), DICOM_TAG(0x0008, 0x103E), text, sizeof text));
    assert_string_equal(text, "ab c\xC3\xA4\xC3\xA4");
    assert_true(dicom_text(dicom_root(file), DICOM_TAG(0x0008, 0x103E), small, 8)); /* room for 7 bytes: the second letter has 2 */
    assert_string_equal(small, "ab c\xC3\xA4");
    assert_true(dicom_text_at(dicom_root(file), DICOM_TAG(0x0008, 0x0008), 1, text, sizeof text));
    assert_string_equal(text, "PRIMARY");
    assert_true(dicom_text_at(dicom_root(file), DICOM_TAG(0x0008, 0x0008), 2, text, sizeof text));
    assert_string_equal(text, "AXIAL");
    assert_false(dicom_text_at(dicom_root(file), DICOM_TAG(0x0008, 0x0008), 3, text, sizeof text));
    dicom_file_destroy(file);
    made_finish(&made);
}

static void sequences_are_entered_item_by_item_and_items_inherit_the_character_set(void **state)
{
    (void)state;
    for (size_t e = 0; e < 3; e++) {
        struct made_dicom made;
        made_begin(&made, encodings[e]);
        made_text(&made, DICOM_TAG(0x0008, 0x0005), "CS", "ISO_IR 100");
        made_sequence(&made, DICOM_TAG(0x3006, 0x0020));
        for (int i = 0; i < 3; i++) {
            made_item(&made);
            made_text(&made, DICOM_TAG(0x3006, 0x0022), "IS", i == 0 ? "10" : i == 1 ? "11" : "12");
            made_text(&made, DICOM_TAG(0x3006, 0x0026), "LO", "\xC4rea");
            made_item_end(&made);
        }
        made_sequence_end(&made);
        struct dicom_file *file = parse(&made);
        const struct dicom_item *root = dicom_root(file);
        assert_int_equal(dicom_n_items(root, DICOM_TAG(0x3006, 0x0020)), 3);
        for (size_t i = 0; i < 3; i++) {
            const struct dicom_item *item = dicom_item_at(root, DICOM_TAG(0x3006, 0x0020), i);
            int64_t number = 0;
            char name[16];
            assert_true(dicom_integer(item, DICOM_TAG(0x3006, 0x0022), &number));
            assert_int_equal(number, 10 + i);
            assert_true(dicom_text(item, DICOM_TAG(0x3006, 0x0026), name, sizeof name));
            assert_string_equal(name, "\xC3\x84rea");
        }
        assert_null(dicom_item_at(root, DICOM_TAG(0x3006, 0x0020), 3));
        assert_int_equal(dicom_n_items(root, DICOM_TAG(0x3006, 0x0039)), 0);
        assert_int_equal(dicom_n_items(root, DICOM_TAG(0x0008, 0x0005)), 0); /* not a sequence */
        dicom_file_destroy(file);
        made_finish(&made);
    }
}

static void nest(struct made_dicom *made, int depth)
{
    for (int i = 0; i < depth; i++) {
        made_sequence(made, DICOM_TAG(0x0008, 0x1140));
        made_item(made);
    }
    for (int i = 0; i < depth; i++) {
        made_item_end(made);
        made_sequence_end(made);
    }
}

static void sequences_may_be_nested_16_deep_and_no_deeper(void **state)
{
    (void)state;
    for (size_t e = 0; e < 3; e++) {
        struct made_dicom made;
        made_begin(&made, encodings[e]);
        nest(&made, DICOM_MAX_DEPTH);
        dicom_file_destroy(parse(&made));
        made_finish(&made);
        made_begin(&made, encodings[e]);
        nest(&made, DICOM_MAX_DEPTH + 1);
        is_refused(&made, ERROR_LIMIT, "nested more than 16 deep");
        made_finish(&made);
    }
}

/* With their lengths given and as implicit or unknown (UN) bytes, the library below still enters them: they count as well. */
static void nesting_in_bytes_of_a_known_length_counts(void **state)
{
    (void)state;
    for (int is_unknown = 0; is_unknown < 2; is_unknown++) {
        struct made_dicom inner = { .is_implicit = true };
        for (int i = 0; i < 2000; i++) {
            struct made_dicom outer = { .is_implicit = true };
            made_head(&outer, DICOM_TAG(0x0008, 0x1140), "SQ", (uint32_t)inner.size + 8);
            made_head(&outer, DICOM_TAG(0xFFFE, 0xE000), "", (uint32_t)inner.size);
            made_raw(&outer, inner.data, inner.size);
            made_finish(&inner);
            inner = outer;
        }
        struct made_dicom made;
        made_begin(&made, is_unknown ? MADE_EXPLICIT : MADE_IMPLICIT);
        if (is_unknown)
            made_element(&made, DICOM_TAG(0x0008, 0x1140), "UN", inner.data + 8, inner.size - 8); /* the items */
        else
            made_raw(&made, inner.data, inner.size);
        is_refused(&made, ERROR_LIMIT, "nested more than 16 deep");
        made_finish(&made);
        made_finish(&inner);
    }
}

static void what_is_longer_than_what_holds_it_is_refused_with_its_place(void **state)
{
    (void)state;
    struct made_dicom made;
    made_begin(&made, MADE_EXPLICIT);
    made_text(&made, DICOM_TAG(0x0008, 0x0060), "CS", "CT");
    size_t at = made.size;
    made_head(&made, DICOM_TAG(0x0008, 0x103E), "LO", 100);
    made_raw(&made, "short", 5);
    char place[40];
    snprintf(place, sizeof place, "byte %zu: element (0008,103E)", at);
    is_refused(&made, ERROR_FORMAT, place);
    is_refused(&made, ERROR_FORMAT, "says 100 bytes, but the file ends after 5");
    made_finish(&made);

    made_begin(&made, MADE_EXPLICIT);
    made_sequence(&made, DICOM_TAG(0x3006, 0x0020));
    made_head(&made, DICOM_TAG(0xFFFE, 0xE000), "", 20);
    made_head(&made, DICOM_TAG(0x3006, 0x0026), "LO", 16);
    made_raw(&made, "0123456789ABCDEF", 16);
    made_sequence_end(&made);
    is_refused(&made, ERROR_FORMAT, "but what holds it ends after 12");
    made_finish(&made);

    made_begin(&made, MADE_EXPLICIT);
    made_sequence(&made, DICOM_TAG(0x3006, 0x0020));
    made_text(&made, DICOM_TAG(0x3006, 0x0022), "IS", "10");
    is_refused(&made, ERROR_FORMAT, "expected an item of a sequence");
    made_finish(&made);
}

static void every_beginning_of_a_file_is_read_or_refused_with_a_sentence(void **state)
{
    (void)state;
    for (size_t e = 0; e < 3; e++) {
        struct made_dicom made;
        made_begin(&made, encodings[e]);
        made_text(&made, DICOM_TAG(0x0008, 0x0060), "CS", "CT");
        nest(&made, 2);
        made_text(&made, DICOM_TAG(0x0008, 0x103E), "LO", "a longer text");
        size_t n_whole = 0;
        for (size_t n = 0; n < made.size; n++) {
            uint8_t *copy = malloc(n + 1); /* its own block, so that a sanitizer sees a step beyond */
            memcpy(copy, made.data, n);
            struct error err = { 0 };
            struct dicom_file *file = dicom_file_parse(copy, n, "cut.dcm", DICOM_WHOLE, &err);
            assert_true(file || err.text[0]);
            n_whole += file != NULL;
            dicom_file_destroy(file);
            err = (struct error){ 0 };
            file = dicom_file_parse(copy, n, "cut.dcm", DICOM_START, &err);
            assert_true(file || err.text[0]);
            char text[8];
            if (file && dicom_text(dicom_root(file), DICOM_TAG(0x0008, 0x0060), text, sizeof text))
                assert_string_equal(text, "CT");
            dicom_file_destroy(file);
            free(copy);
        }
        assert_int_equal(n_whole, 2); /* cut behind the first and behind the second element: nothing shows it */
        made_finish(&made);
    }
}

static void made_image(struct made_dicom *made, const char *encoding, uint16_t bits, uint16_t stored, uint16_t high, bool is_signed)
{
    made_begin(made, encoding);
    made_text(made, DICOM_TAG(0x0008, 0x0060), "CS", "CT");
    made_u16(made, DICOM_TAG(0x0028, 0x0002), 1);
    made_text(made, DICOM_TAG(0x0028, 0x0004), "CS", "MONOCHROME2");
    made_u16(made, DICOM_TAG(0x0028, 0x0010), 2);
    made_u16(made, DICOM_TAG(0x0028, 0x0011), 3);
    made_u16(made, DICOM_TAG(0x0028, 0x0100), bits);
    made_u16(made, DICOM_TAG(0x0028, 0x0101), stored);
    made_u16(made, DICOM_TAG(0x0028, 0x0102), high);
    made_u16(made, DICOM_TAG(0x0028, 0x0103), is_signed);
}

static void pixels_come_without_their_unused_bits_and_with_their_sign(void **state)
{
    (void)state;
    static const struct {
        uint16_t stored, high;
        bool is_signed;
        uint16_t cells[6];
        int expected[6];
    } cases[] = {
        { 16, 15, true, { 0, 1, 0xFFFF, 0x8000, 0x7FFF, 0xFC18 }, { 0, 1, -1, -32768, 32767, -1000 } },
        { 16, 15, false, { 0, 1, 0xFFFF, 0x8000, 0x7FFF, 0xFC18 }, { 0, 1, 65535, 32768, 32767, 64536 } },
        { 12, 11, false, { 0xF001, 0x0FFF, 0x1000, 0x0800, 5, 0 }, { 1, 4095, 0, 2048, 5, 0 } },   /* an overlay above the value */
        { 12, 11, true, { 0xF001, 0x0FFF, 0x1000, 0x0800, 5, 0 }, { 1, -1, 0, -2048, 5, 0 } },
        { 12, 15, false, { 0x0010, 0xFFF0, 0x800F, 0, 0x10, 0x20 }, { 1, 4095, 2048, 0, 1, 2 } }, /* values at the top of the cell */
        { 12, 13, true, { 0x2000, 0x0004, 0xC003, 0x3FFC, 0, 0 }, { -2048, 1, 0, -1, 0, 0 } },
    };
    static const char *const native[] = { MADE_EXPLICIT, MADE_IMPLICIT, MADE_BIG_ENDIAN };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        for (size_t e = 0; e < 3; e++) {
            struct made_dicom made;
            made_image(&made, native[e], 16, cases[i].stored, cases[i].high, cases[i].is_signed);
            made_head(&made, DICOM_TAG(0x7FE0, 0x0010), "OW", 12);
            made_words(&made, cases[i].cells, 6);
            struct dicom_file *file = parse(&made);
            struct dicom_pixels pixels;
            struct error err = { 0 };
            assert_true(dicom_pixels_look(file, &pixels, &err));
            assert_int_equal(pixels.rows, 2);
            assert_int_equal(pixels.columns, 3);
            assert_int_equal(pixels.n_frames, 1);
            uint16_t values[6];
            assert_true(dicom_pixels_read(file, 0, values, &err));
            for (int v = 0; v < 6; v++)
                assert_int_equal(cases[i].is_signed ? (int)(int16_t)values[v] : (int)values[v], cases[i].expected[v]);
            assert_false(dicom_pixels_read(file, 1, values, &err));
            assert_int_equal(err.code, ERROR_RANGE);
            dicom_file_destroy(file);
            made_finish(&made);
        }
}

static void two_pixels_of_8_bits_share_a_word_in_either_byte_order(void **state)
{
    (void)state;
    static const char *const native[] = { MADE_EXPLICIT, MADE_BIG_ENDIAN, MADE_BIG_ENDIAN };
    for (int e = 0; e < 3; e++) {
        struct made_dicom made;
        made_image(&made, native[e], 8, 8, 7, false);
        made_head(&made, DICOM_TAG(0x7FE0, 0x0010), e == 2 ? "OB" : "OW", 6);
        if (e == 2)
            made_raw(&made, "\x01\x02\x03\x04\x05\x06", 6); /* bytes have no order */
        else
            made_words(&made, (uint16_t[]){ 0x0201, 0x0403, 0x0605 }, 3); /* the first pixel is the low byte: PS3.5 8.1.1 */
        struct dicom_file *file = parse(&made);
        uint8_t values[6];
        struct error err = { 0 };
        assert_true(dicom_pixels_read(file, 0, values, &err));
        for (int v = 0; v < 6; v++)
            assert_int_equal(values[v], v + 1);
        dicom_file_destroy(file);
        made_finish(&made);
    }
}

static void pixels_that_contradict_themselves_are_refused(void **state)
{
    (void)state;
    static const struct {
        uint32_t tag;
        uint16_t value;
        enum error_code code;
        const char *words;
    } cases[] = {
        { DICOM_TAG(0x0028, 0x0010), 0, ERROR_FORMAT, "rows: found 0, expected 1 to 4096" },
        { DICOM_TAG(0x0028, 0x0011), 65535, ERROR_LIMIT, "columns: found 65535, expected 1 to 4096" },
        { DICOM_TAG(0x0028, 0x0010), 4096, ERROR_FORMAT, "pixel data of 12 bytes; 3 x 4096 x 1 pixels of 16 bits need 24576" },
        { DICOM_TAG(0x0028, 0x0100), 12, ERROR_UNSUPPORTED, "expected 8, 16 or 32" },
        { DICOM_TAG(0x0028, 0x0101), 17, ERROR_FORMAT, "17 bits up to bit 15 do not fit into 16" },
        { DICOM_TAG(0x0028, 0x0102), 3, ERROR_FORMAT, "do not fit" },
        { DICOM_TAG(0x0028, 0x0002), 3, ERROR_UNSUPPORTED, "a colour picture" },
    };
    static const uint32_t tags[] = { DICOM_TAG(0x0028, 0x0002), DICOM_TAG(0x0028, 0x0010), DICOM_TAG(0x0028, 0x0011),
                                     DICOM_TAG(0x0028, 0x0100), DICOM_TAG(0x0028, 0x0101), DICOM_TAG(0x0028, 0x0102) };
    static const uint16_t good[] = { 1, 2, 3, 16, 16, 15 };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct made_dicom made;
        made_begin(&made, MADE_EXPLICIT);
        for (size_t t = 0; t < 6; t++)
            made_u16(&made, tags[t], tags[t] == cases[i].tag ? cases[i].value : good[t]);
        made_element(&made, DICOM_TAG(0x7FE0, 0x0010), "OW", "0123456789AB", 12);
        struct dicom_file *file = parse(&made);
        struct dicom_pixels pixels;
        struct error err = { 0 };
        assert_false(dicom_pixels_look(file, &pixels, &err));
        if (err.code != cases[i].code || !strstr(err.text, cases[i].words))
            fail_msg("%s: expected %s with \"%s\"", err.text, error_word(cases[i].code), cases[i].words);
        uint16_t values[6];
        assert_false(dicom_pixels_read(file, 0, values, &err));
        dicom_file_destroy(file);
        made_finish(&made);
    }
}

static uint8_t *read_file(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    *size = (size_t)ftell(file);
    rewind(file);
    uint8_t *data = malloc(*size + 1);
    assert_int_equal(fread(data, 1, *size, file), *size);
    fclose(file);
    return data;
}

static void the_lossless_encodings_of_one_picture_decode_to_the_same_pixels(void **state)
{
    (void)state;
    char path[1024];
    if (!data_path("dicom-transfer-syntaxes", path, sizeof path))
        skip();
    enum { N = 512 * 512 };
    int16_t *first = NULL;
    int n_equal = 0, n_refused = 0, n_lossy = 0;
    DIR *folder = opendir(path);
    for (struct dirent *entry; (entry = readdir(folder));) {
        if (!strstr(entry->d_name, ".dcm_"))
            continue;
        char name[2048];
        snprintf(name, sizeof name, "%s/%s", path, entry->d_name);
        size_t size;
        uint8_t *data = read_file(name, &size);
        struct error err = { 0 };
        struct dicom_file *file = dicom_file_parse(data, size, entry->d_name, DICOM_WHOLE, &err);
        assert_string_equal(err.text, "");
        struct dicom_pixels pixels;
        if (!dicom_pixels_look(file, &pixels, &err)) {
            assert_int_equal(err.code, ERROR_UNSUPPORTED);
            assert_non_null(strstr(err.text, "JPEG 2000"));
            n_refused++;
        } else {
            int16_t *values = malloc(N * sizeof *values);
            assert_true(dicom_pixels_read(file, 0, values, &err));
            int worst = 0;
            for (int i = 0; first && i < N; i++)
                worst = abs(values[i] - first[i]) > worst ? abs(values[i] - first[i]) : worst;
            if (strstr(entry->d_name, "1.2.4.51")) {
                n_lossy++; /* may come first: nothing to compare with */
                free(values);
            } else {
                if (first && worst == 0)
                    n_equal++;
                if (first)
                    free(values);
                else
                    first = values;
            }
        }
        dicom_file_destroy(file);
        free(data);
    }
    closedir(folder);
    free(first);
    assert_int_equal(n_equal, 6); /* seven lossless ones that are read */
    assert_int_equal(n_lossy, 1);
    assert_int_equal(n_refused, 1);
}

/* In a process that has given up its files: what the library needs of its own is found, before or after. */
static int read_confined(bool is_prepared)
{
    struct made_dicom made;
    made_begin(&made, MADE_IMPLICIT); /* kinds of values come from the dictionary */
    made_text(&made, DICOM_TAG(0x0008, 0x0005), "CS", "ISO_IR 100");
    made_text(&made, DICOM_TAG(0x0008, 0x103E), "LO", "r\xE9siduelle");
    made_u16(&made, DICOM_TAG(0x0028, 0x0010), 513);
    if (is_prepared)
        dicom_prepare();
    char got[128], text[64] = "";
    confine(&(struct confine_options){ .plan_folder = "/tmp" }, got);
    struct dicom_file *file = dicom_file_parse(made.data, made.size, "made.dcm", DICOM_WHOLE, NULL);
    int64_t rows = 0;
    bool is_read = file && dicom_text(dicom_root(file), DICOM_TAG(0x0008, 0x103E), text, sizeof text) &&
                   strcmp(text, "r\xC3\xA9siduelle") == 0 && dicom_integer(dicom_root(file), DICOM_TAG(0x0028, 0x0010), &rows) && rows == 513;
    dicom_file_destroy(file);
    made_finish(&made);
    return is_read ? 0 : 1;
}

static void a_confined_process_reads_dicom(void **state)
{
    (void)state;
    for (int is_prepared = 0; is_prepared < 2; is_prepared++) {
        pid_t child = fork();
        assert_true(child >= 0);
        if (child == 0) {
            (void)unsetenv("DCMDICTPATH");
            _exit(read_confined(is_prepared));
        }
        int status = 0;
        assert_int_equal(waitpid(child, &status, 0), child);
        assert_true(WIFEXITED(status));
        assert_int_equal(WEXITSTATUS(status), 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_confined_process_reads_dicom), /* first: the children begin without a dictionary */
        cmocka_unit_test(each_encoding_gives_the_same_values),
        cmocka_unit_test(numbers_are_read_as_people_write_them_and_the_rest_is_not_a_number),
        cmocka_unit_test(a_contour_of_100000_numbers_is_read_whole),
        cmocka_unit_test(texts_come_out_as_utf8_whatever_the_character_set),
        cmocka_unit_test(a_text_is_cut_at_a_whole_character_and_has_no_control_characters),
        cmocka_unit_test(sequences_are_entered_item_by_item_and_items_inherit_the_character_set),
        cmocka_unit_test(sequences_may_be_nested_16_deep_and_no_deeper),
        cmocka_unit_test(nesting_in_bytes_of_a_known_length_counts),
        cmocka_unit_test(what_is_longer_than_what_holds_it_is_refused_with_its_place),
        cmocka_unit_test(every_beginning_of_a_file_is_read_or_refused_with_a_sentence),
        cmocka_unit_test(pixels_come_without_their_unused_bits_and_with_their_sign),
        cmocka_unit_test(two_pixels_of_8_bits_share_a_word_in_either_byte_order),
        cmocka_unit_test(pixels_that_contradict_themselves_are_refused),
        cmocka_unit_test(the_lossless_encodings_of_one_picture_decode_to_the_same_pixels),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
