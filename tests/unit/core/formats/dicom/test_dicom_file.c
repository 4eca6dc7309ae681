/* Parsing DICOM: elements, texts, numbers, sequences, and what is refused. Expected values: the bytes written here
 * (PS3.5). */
#include "core/formats/dicom/dicom_file.h"

#include <sys/wait.h>
#include <unistd.h>

#include "core/formats/dicom/dicom_walk.h"
#include "server/renderer/confine.h"
#include "tests/check.h"
#include "tests/unit/made_dicom.h"

static const char *const encodings[] = { MADE_EXPLICIT, MADE_IMPLICIT, MADE_BIG_ENDIAN };

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
        struct dicom_file *file = made_parse(&made);
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
    made_text(&made, DICOM_TAG(0x0020, 0x0032), "DS",
              "1.\\.5\\-0\\1E+3\\\\1,5\\abc\\inf\\nan\\ 12.25 \\0x10\\1e999\\--1\\+-1\\-inf\\-nan\\-.5\\.\\-\\0.1"
              "\\123456789012345\\-0.00000000000001\\12345.678901234567");
    struct dicom_file *file = made_parse(&made);
    double v[24] = { 0 };
    assert_int_equal(dicom_numbers(dicom_root(file), DICOM_TAG(0x0020, 0x0032), v, 24), 23);
    assert_close(v[0], 1, 0);
    assert_close(v[1], 0.5, 0);
    assert_close(v[2], 0, 0);
    assert_close(v[3], 1000, 0);
    assert_close(v[9], 12.25, 0);
    /* as the compiler reads the same digits: decimal numbers are rounded once */
    assert_close(v[16], -.5, 0);
    assert_close(v[19], 0.1, 0);
    assert_close(v[20], 123456789012345.0, 0);
    assert_close(v[21], -0.00000000000001, 0);
    assert_close(v[22], 12345.678901234567, 0);
    static const int bad[] = { 4, 5, 6, 7, 8, 10, 11, 12, 13, 14, 15, 17, 18 };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        assert_true(isnan(v[bad[i]]));
    /* returns the number of all values, however many are stored; also when none are */
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
    made_begin(&made, MADE_IMPLICIT); /* implicit: an explicit DS cannot have such a length */
    made_text(&made, DICOM_TAG(0x3006, 0x0050), "DS", text);
    struct dicom_file *file = made_parse(&made);
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
        { "ISO_IR 192",
          "Hirnstamm \xC3\xA4u\xC3\x9F"
          "ere",
          "Hirnstamm \xC3\xA4u\xC3\x9F"
          "ere" },
        { "ISO_IR 144", "\xBC\xDE\xD7\xD3", "\xD0\x9C\xD0\xBE\xD0\xB7\xD0\xB3" },
        { "\\ISO 2022 IR 87", "\x1B$B;3ED\x1B(B", "\xE5\xB1\xB1\xE7\x94\xB0" },
        { "\\ISO 2022 IR 149", "\x1B$)C\xB1\xE8\xC8\xF1", "\xEA\xB9\x80\xED\x9D\xAC" },
        { "GB18030", "\xCD\xF5", "\xE7\x8E\x8B" },
        { "", "T\xC3\xBCr", "T\xC3\xBCr" }, /* no character set, valid UTF-8 */
        { "", "T\xFCr", "T\xC3\xBCr" },     /* no character set, not UTF-8 */
        { "NO SUCH SET", "T\xFCr", "T<0xFC>r" },
        { "NO SUCH SET", "T\xC3\xBCr", "T\xC3\xBCr" },
        { "ISO_IR 192", "T\xFCr", "T<0xFC>r" },
        { "ISO 2022 IR 13\\ISO 2022 IR 87", "\xBC\xAD\xD6\xB3 \x1B$B<pag\x1B(J", "ｼｭﾖｳ 腫瘍" },
        { "ISO 2022 IR 13\\ISO 2022 IR 87", "\x1B$B<pag\x1B(J GTV", "腫瘍 GTV" },
        { "\\ISO 2022 IR 87", "\x1B$B<pa\x1B(B", "腫<0x61>" },      /* half a character */
        { "\\ISO 2022 IR 87", "\x8E\xEE GTV", "<0x8E><0xEE> GTV" }, /* Shift JIS under another set's name */
        { "\\ISO 2022 IR 87", "\x1B%G GTV", "<0x1B>%G GTV" },       /* no sequence of DICOM's */
        /* annex K.2 and K.3; pydicom 2.3 leaves these escape sequences in the text */
        { "\\ISO 2022 IR 58", "Zhang^XiaoDong=\x1B$)A\xD5\xC5^\x1B$)A\xD0\xA1\xB6\xAB=", "Zhang^XiaoDong=张^小东=" },
        { "\\ISO 2022 IR 58", "1. \x1B$)A\xB5\xDA\xD2\xBB\xD0\xD0\xCE\xC4\xD7\xD6\xA1\xA3", "1. 第一行文字。" },
        { "GBK", "\xD6\xD7\xC1\xF6\x80\xFF", "肿瘤<0x80><0xFF>" },
        { "ISO_IR 13", "\xBC\xAD\xD6\xB3~", "ｼｭﾖｳ‾" },
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct made_dicom made;
        made_begin(&made, MADE_EXPLICIT);
        if (cases[i].set[0])
            made_text(&made, DICOM_TAG(0x0008, 0x0005), "CS", cases[i].set);
        made_text(&made, DICOM_TAG(0x0008, 0x103E), "LO", cases[i].bytes);
        struct dicom_file *file = made_parse(&made);
        char text[64];
        assert_true(dicom_text(dicom_root(file), DICOM_TAG(0x0008, 0x103E), text, sizeof text));
        assert_string_equal(text, cases[i].utf8);
        assert_int_equal(dicom_text_is_broken(file), strstr(text, "<0x") != NULL);
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
    struct dicom_file *file = made_parse(&made);
    char text[64], small[8];
    assert_true(dicom_text(dicom_root(file), DICOM_TAG(0x0008, 0x103E), text, sizeof text));
    assert_string_equal(text, "ab c\xC3\xA4\xC3\xA4");
    /* room for 7 bytes: the second letter needs 2 */
    assert_true(dicom_text(dicom_root(file), DICOM_TAG(0x0008, 0x103E), small, 8));
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
        struct dicom_file *file = made_parse(&made);
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
        dicom_file_destroy(made_parse(&made));
        made_finish(&made);
        made_begin(&made, encodings[e]);
        nest(&made, DICOM_MAX_DEPTH + 1);
        is_refused(&made, ERROR_LIMIT, "nested more than 16 deep");
        made_finish(&made);
    }
}

/* DCMTK also enters sequences with defined lengths, and those in implicit or unknown (UN) values: their depth
 * counts. */
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

/* DCMTK searches the place of each element from the end of its list: ten thousand in reverse are a hundred million
 * steps. */
static void a_few_elements_may_be_out_of_order_and_not_many(void **state)
{
    (void)state;
    for (int n = DICOM_MAX_DISORDER; n <= DICOM_MAX_DISORDER + 1; n++) {
        struct made_dicom made;
        made_begin(&made, MADE_EXPLICIT);
        made_text(&made, DICOM_TAG(0x0008, 0x0060), "CS", "CT");
        for (int i = n; i >= 0; i--)
            made_text(&made, DICOM_TAG(0x0009, 0x1000 + i), "LO", "");
        made_text(&made, DICOM_TAG(0x0020, 0x0013), "IS", "5");
        if (n > DICOM_MAX_DISORDER) {
            is_refused(&made, ERROR_FORMAT, "more than 64 are not in order");
        } else {
            struct dicom_file *file = made_parse(&made);
            int64_t number = 0;
            assert_true(dicom_integer(dicom_root(file), DICOM_TAG(0x0020, 0x0013), &number) && number == 5);
            assert_true(dicom_has(dicom_root(file), DICOM_TAG(0x0009, 0x1000)));
            dicom_file_destroy(file);
        }
        made_finish(&made);
    }
}

static void more_elements_than_any_plan_has_are_refused(void **state)
{
    (void)state;
    struct made_dicom made;
    made_begin(&made, MADE_EXPLICIT);
    made_sequence(&made, DICOM_TAG(0x3006, 0x0020));
    for (int i = 0; i <= DICOM_MAX_ELEMENTS; i++)
        made_head(&made, DICOM_TAG(0xFFFE, 0xE000), "", 0);
    made_sequence_end(&made);
    is_refused(&made, ERROR_LIMIT, "more than 524288 elements");
    made_finish(&made);
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
            uint8_t *copy = malloc(n + 1); /* allocated exactly, so that a sanitizer detects a read beyond the end */
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
        assert_int_equal(n_whole, 2); /* a cut after the first or the second element cannot be detected */
        made_finish(&made);
    }
}

/* In a process without access to files: DCMTK finds the files it needs, loaded before or not. */
static int read_confined(bool is_prepared)
{
    struct made_dicom made;
    made_begin(&made, MADE_IMPLICIT); /* implicit: VRs come from the dictionary */
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
                   strcmp(text, "r\xC3\xA9siduelle") == 0 &&
                   dicom_integer(dicom_root(file), DICOM_TAG(0x0028, 0x0010), &rows) && rows == 513;
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
        cmocka_unit_test(a_confined_process_reads_dicom), /* first: its children start without a dictionary */
        cmocka_unit_test(each_encoding_gives_the_same_values),
        cmocka_unit_test(numbers_are_read_as_people_write_them_and_the_rest_is_not_a_number),
        cmocka_unit_test(a_contour_of_100000_numbers_is_read_whole),
        cmocka_unit_test(texts_come_out_as_utf8_whatever_the_character_set),
        cmocka_unit_test(a_text_is_cut_at_a_whole_character_and_has_no_control_characters),
        cmocka_unit_test(sequences_are_entered_item_by_item_and_items_inherit_the_character_set),
        cmocka_unit_test(sequences_may_be_nested_16_deep_and_no_deeper),
        cmocka_unit_test(nesting_in_bytes_of_a_known_length_counts),
        cmocka_unit_test(a_few_elements_may_be_out_of_order_and_not_many),
        cmocka_unit_test(more_elements_than_any_plan_has_are_refused),
        cmocka_unit_test(what_is_longer_than_what_holds_it_is_refused_with_its_place),
        cmocka_unit_test(every_beginning_of_a_file_is_read_or_refused_with_a_sentence),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
