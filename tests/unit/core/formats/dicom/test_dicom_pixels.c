/* Pixels of DICOM files, native and compressed. Expected values: the cells written here (PS3.5), images encoded by
 * other programs, and the equality of eight encodings of one image. */
#include <dirent.h>

#include "core/formats/dicom/dicom_series.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/made_dicom.h"

static void made_image(struct made_dicom *made, const char *encoding, uint16_t bits, uint16_t stored, uint16_t high,
                       bool is_signed)
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
        { 12,
          11,
          false,
          { 0xF001, 0x0FFF, 0x1000, 0x0800, 5, 0 },
          { 1, 4095, 0, 2048, 5, 0 } }, /* an overlay above the value */
        { 12, 11, true, { 0xF001, 0x0FFF, 0x1000, 0x0800, 5, 0 }, { 1, -1, 0, -2048, 5, 0 } },
        { 12,
          15,
          false,
          { 0x0010, 0xFFF0, 0x800F, 0, 0x10, 0x20 },
          { 1, 4095, 2048, 0, 1, 2 } }, /* values at the top of the cell */
        { 12, 13, true, { 0x2000, 0x0004, 0xC003, 0x3FFC, 0, 0 }, { -2048, 1, 0, -1, 0, 0 } },
    };
    static const char *const native[] = { MADE_EXPLICIT, MADE_IMPLICIT, MADE_BIG_ENDIAN };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        for (size_t e = 0; e < 3; e++) {
            struct made_dicom made;
            made_image(&made, native[e], 16, cases[i].stored, cases[i].high, cases[i].is_signed);
            made_head(&made, DICOM_TAG(0x7FE0, 0x0010), "OW", 12);
            made_words(&made, cases[i].cells, 6);
            struct dicom_file *file = made_parse(&made);
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
            made_raw(&made, "\x01\x02\x03\x04\x05\x06", 6); /* bytes have no byte order */
        else
            made_words(&made, (uint16_t[]){ 0x0201, 0x0403, 0x0605 },
                       3); /* the first pixel is the low byte: PS3.5 8.1.1 */
        struct dicom_file *file = made_parse(&made);
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
        { DICOM_TAG(0x0028, 0x0010), 4096, ERROR_FORMAT,
          "pixel data of 12 bytes; 3 x 4096 x 1 pixels of 16 bits need 24576" },
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
        struct dicom_file *file = made_parse(&made);
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

static void the_lossless_encodings_of_one_picture_decode_to_the_same_pixels(void **state)
{
    (void)state;
    char path[1024];
    if (!data_path("dicom-transfer-syntaxes", path, sizeof path))
        skip();
    enum { N = 512 * 512 };
    int16_t *first = NULL;
    int n_equal = 0, n_lossy = 0;
    DIR *folder = opendir(path);
    for (struct dirent *entry; (entry = readdir(folder));) {
        if (!strstr(entry->d_name, ".dcm_"))
            continue;
        char name[2048];
        snprintf(name, sizeof name, "%s/%s", path, entry->d_name);
        size_t size;
        uint8_t *data = file_bytes(name, &size);
        struct error err = { 0 };
        struct dicom_file *file = dicom_file_parse(data, size, entry->d_name, DICOM_WHOLE, &err);
        assert_string_equal(err.text, "");
        int16_t *values = malloc(N * sizeof *values);
        if (!dicom_pixels_read(file, 0, values, &err))
            fail_msg("%s", err.text);
        int worst = 0;
        for (int i = 0; first && i < N; i++)
            worst = abs(values[i] - first[i]) > worst ? abs(values[i] - first[i]) : worst;
        if (strstr(entry->d_name, "1.2.4.51")) {
            n_lossy++; /* the first one has nothing to compare with */
            free(values);
        } else {
            if (first && worst == 0)
                n_equal++;
            if (first)
                free(values);
            else
                first = values;
        }
        dicom_file_destroy(file);
        free(data);
    }
    closedir(folder);
    free(first);
    assert_int_equal(n_equal, 7); /* eight lossless ones */
    assert_int_equal(n_lossy, 1);
}

/* Writes two frames of 8 x 8 pixels in four fragments: each a JPEG-LS image cut in two. has_table: with an offset
 * table. is_mute: the second image has no start marker. */
static void made_fragments(struct made_dicom *made, const uint8_t *picture, size_t n, bool has_table, bool is_mute)
{
    size_t half = n / 2 / 2 * 2, rest = n - half;
    made_begin(made, "1.2.840.10008.1.2.4.80");
    made_text(made, DICOM_TAG(0x0028, 0x0008), "IS", "2");
    made_u16(made, DICOM_TAG(0x0028, 0x0010), 8);
    made_u16(made, DICOM_TAG(0x0028, 0x0011), 8);
    made_u16(made, DICOM_TAG(0x0028, 0x0100), 16);
    made_u16(made, DICOM_TAG(0x0028, 0x0101), 16);
    made_u16(made, DICOM_TAG(0x0028, 0x0102), 15);
    made_u16(made, DICOM_TAG(0x0028, 0x0103), 1);
    made_head(made, DICOM_TAG(0x7FE0, 0x0010), "OB", UINT32_MAX);
    made_head(made, DICOM_TAG(0xFFFE, 0xE000), "", has_table ? 8 : 0);
    uint32_t second = (uint32_t)(8 + half + 8 + rest);
    if (has_table)
        made_words(made, (uint16_t[]){ 0, 0, (uint16_t)second, (uint16_t)(second >> 16) }, 4);
    for (int f = 0; f < 2; f++) {
        made_head(made, DICOM_TAG(0xFFFE, 0xE000), "", (uint32_t)half);
        made_raw(made, picture, half);
        if (is_mute && f == 1)
            made->data[made->size - half] = 0;
        made_head(made, DICOM_TAG(0xFFFE, 0xE000), "", (uint32_t)rest);
        made_raw(made, picture + half, rest);
    }
    made_sequence_end(made);
}

static void frames_in_several_fragments_are_found_by_the_table_of_offsets_or_by_their_marks(void **state)
{
    (void)state;
    size_t size;
    /* stored values 10 y + x, encoded by another program */
    uint8_t *seed = file_bytes("tests/fuzz/corpus/dicom/jpeg-ls", &size);
    size_t at = size;
    while (at > 2 && !(seed[at - 2] == 0xFF && seed[at - 1] == 0xD8))
        at--;
    assert_true(at > 2);
    size_t n = size - (at - 2) - 8; /* without the sequence's end marker */
    enum { TABLE, MARKS, NEITHER, N_WAYS };
    for (int way = TABLE; way < N_WAYS; way++) {
        struct made_dicom made;
        made_fragments(&made, seed + at - 2, n, way == TABLE, way == NEITHER);
        struct dicom_file *file = made_parse(&made);
        for (uint32_t f = 0; f < 2; f++) {
            int16_t values[64];
            struct error err = { 0 };
            bool is_read = dicom_pixels_read(file, f, values, &err);
            if (way == NEITHER) {
                assert_false(is_read);
                assert_non_null(
                    strstr(err.text,
                           "4 fragments for 2 frames, and no table of offsets says which are whose; 1 of them begin"));
                continue;
            }
            assert_string_equal(err.text, "");
            for (int i = 0; i < 64; i++)
                assert_int_equal(values[i], 10 * (i / 8) + i % 8);
        }
        dicom_file_destroy(file);
        made_finish(&made);
    }
    free(seed);
}

static void a_file_of_more_frames_than_slices_are_read_is_refused_before_memory_is_taken(void **state)
{
    (void)state;
    struct made_dicom made;
    made_image(&made, MADE_EXPLICIT, 8, 8, 7, false);
    struct made_dicom with = { 0 }; /* the same with a number of frames, in front of the rows */
    static const uint8_t rows[] = { 0x28, 0x00, 0x10, 0x00 };
    size_t at = 0;
    while (memcmp(made.data + at, rows, sizeof rows) != 0)
        at++;
    made_raw(&with, made.data, at);
    made_text(&with, DICOM_TAG(0x0028, 0x0008), "IS", "5000");
    made_raw(&with, made.data + at, made.size - at);
    made_sequence(&with, DICOM_TAG(0x5200, 0x9230));
    made_sequence_end(&with);
    static const uint8_t pixels[6 * 5000];
    made_element(&with, DICOM_TAG(0x7FE0, 0x0010), "OB", pixels, sizeof pixels);
    char path[256];
    struct folder folder;
    struct error err = { 0 };
    folder_make(path);
    folder_put(path, "frames", with.data, with.size);
    assert_true(folder_open(&folder, path, &err));
    struct dicom_index *index = dicom_index_scan(&folder, NULL, 0, NULL, NULL, &err);
    assert_non_null(index);
    assert_int_equal(index->n_stacks, 1);
    assert_null(dicom_series_read(&folder, index, 0, NULL, NULL, NULL, &err));
    assert_int_equal(err.code, ERROR_LIMIT);
    assert_non_null(strstr(err.text, "5000 frames; at most 4096 are read"));
    dicom_index_destroy(index);
    folder_close(&folder);
    folder_remove(path);
    made_finish(&with);
    made_finish(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pixels_come_without_their_unused_bits_and_with_their_sign),
        cmocka_unit_test(two_pixels_of_8_bits_share_a_word_in_either_byte_order),
        cmocka_unit_test(pixels_that_contradict_themselves_are_refused),
        cmocka_unit_test(the_lossless_encodings_of_one_picture_decode_to_the_same_pixels),
        cmocka_unit_test(frames_in_several_fragments_are_found_by_the_table_of_offsets_or_by_their_marks),
        cmocka_unit_test(a_file_of_more_frames_than_slices_are_read_is_refused_before_memory_is_taken),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
