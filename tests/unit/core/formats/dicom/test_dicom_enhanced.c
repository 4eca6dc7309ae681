/* Enhanced images: many frames in one file. */
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/made_series.h"

static void check_point(const struct volume *volume, double i, double j, double k, double x, double y, double z)
{
    assert_point(affine_point(&volume->grid.lps_mm_from_ijk, vec3(i, j, k)), x, y, z, 1e-9);
}

/* One file of four frames at positions in the sequence 2, 0, 3, 1; orientation and spacing shared, position and rescale
 * per frame. */
/* is_packed: RLE (PS3.5 annex G), one fragment per frame. */
static void put_enhanced(const char *folder, bool has_all_places, bool is_packed)
{
    static const int order[] = { 2, 0, 3, 1 };
    struct made_dicom made;
    made_begin(&made, is_packed ? "1.2.840.10008.1.2.5" : MADE_EXPLICIT);
    made_text(&made, DICOM_TAG(0x0008, 0x0016), "UI", "1.2.840.10008.5.1.4.1.1.4.1");
    made_text(&made, DICOM_TAG(0x0008, 0x0018), "UI", "1.2.3.4");
    made_text(&made, DICOM_TAG(0x0008, 0x0060), "CS", "MR");
    made_text(&made, DICOM_TAG(0x0020, 0x000E), "UI", "1.2.3");
    made_u16(&made, DICOM_TAG(0x0028, 0x0002), 1);
    made_text(&made, DICOM_TAG(0x0028, 0x0004), "CS", "MONOCHROME2");
    made_text(&made, DICOM_TAG(0x0028, 0x0008), "IS", "4");
    made_u16(&made, DICOM_TAG(0x0028, 0x0010), 1);
    made_u16(&made, DICOM_TAG(0x0028, 0x0011), 2);
    made_u16(&made, DICOM_TAG(0x0028, 0x0100), 16);
    made_u16(&made, DICOM_TAG(0x0028, 0x0101), 16);
    made_u16(&made, DICOM_TAG(0x0028, 0x0102), 15);
    made_u16(&made, DICOM_TAG(0x0028, 0x0103), 0);
    made_sequence(&made, DICOM_TAG(0x5200, 0x9229));
    made_item(&made);
    made_sequence(&made, DICOM_TAG(0x0020, 0x9116));
    made_item(&made);
    /* sagittal: rows run posterior, columns inferior; the normal is to the right */
    made_text(&made, DICOM_TAG(0x0020, 0x0037), "DS", "0\\1\\0\\0\\0\\-1");
    made_item_end(&made);
    made_sequence_end(&made);
    made_sequence(&made, DICOM_TAG(0x0028, 0x9110));
    made_item(&made);
    made_text(&made, DICOM_TAG(0x0018, 0x0050), "DS", "5");
    made_text(&made, DICOM_TAG(0x0028, 0x0030), "DS", "2\\0.5");
    made_item_end(&made);
    made_sequence_end(&made);
    made_item_end(&made);
    made_sequence_end(&made);
    made_sequence(&made, DICOM_TAG(0x5200, 0x9230));
    for (int f = 0; f < 4; f++) {
        double position[3] = { -5.0 * order[f], 1, 2 }, slope = 1 + (f == 3);
        made_item(&made);
        made_sequence(&made, DICOM_TAG(0x0020, 0x9113));
        made_item(&made);
        if (has_all_places || f != 2)
            made_number(&made, DICOM_TAG(0x0020, 0x0032), "DS", position, 3);
        made_item_end(&made);
        made_sequence_end(&made);
        made_sequence(&made, DICOM_TAG(0x0028, 0x9145));
        made_item(&made);
        made_text(&made, DICOM_TAG(0x0028, 0x1052), "DS", "-3");
        made_number(&made, DICOM_TAG(0x0028, 0x1053), "DS", &slope, 1);
        made_item_end(&made);
        made_sequence_end(&made);
        made_item_end(&made);
    }
    made_sequence_end(&made);
    made_head(&made, DICOM_TAG(0x7FE0, 0x0010), is_packed ? "OB" : "OW", is_packed ? UINT32_MAX : 16);
    if (is_packed)
        made_head(&made, DICOM_TAG(0xFFFE, 0xE000), "", 0);
    for (int f = 0; f < 4; f++) {
        uint16_t cells[2] = { (uint16_t)(100 * order[f]), (uint16_t)(100 * order[f] + 1) };
        if (is_packed) { /* two byte planes, high bytes first, each one literal run of two and a padding byte */
            made_head(&made, DICOM_TAG(0xFFFE, 0xE000), "", 64 + 8);
            made_words(&made, (uint16_t[32]){ 2, 0, 64, 0, 68, 0 }, 32);
            made_raw(&made, (uint8_t[]){ 1, (uint8_t)(cells[0] >> 8), (uint8_t)(cells[1] >> 8), 128 }, 4);
            made_raw(&made, (uint8_t[]){ 1, (uint8_t)cells[0], (uint8_t)cells[1], 128 }, 4);
        } else {
            made_words(&made, cells, 2);
        }
    }
    if (is_packed)
        made_sequence_end(&made);
    folder_put(folder, "enhanced", made.data, made.size);
    made_finish(&made);
}

static void frames_of_an_enhanced_image_are_placed_one_by_one(void **state)
{
    (void)state;
    struct scanned s = { 0 };
    for (int is_packed = 0; is_packed < 2; is_packed++) {
        folder_make(s.path);
        put_enhanced(s.path, true, is_packed);
        scanned_open(&s);
        assert_int_equal(s.index->n_stacks, 1);
        assert_int_equal(s.index->stacks[0].n_slices, 4);
        struct volume *volume = scanned_read(&s, 0);
        assert_int_equal(volume->grid.size[2], 4);
        for (uint32_t k = 0; k < 4; k++)
            for (uint32_t i = 0; i < 2; i++)
                assert_close(volume_value(volume, i, 0, k), (100.0 * k + i) * (k == 1 ? 2 : 1) - 3,
                             0); /* the last frame is slice 1 */
        check_point(volume, 0, 0, 0, 0, 1, 2);
        check_point(volume, 2, 0, 0, 0, 2, 2); /* along the row, 0.5 mm between columns */
        check_point(volume, 0, 1, 0, 0, 1, 0); /* down, 2 mm between rows */
        check_point(volume, 0, 0, 3, -15, 1, 2);
        volume_unref(volume);
        scanned_finish(&s);
    }
    folder_make(s.path);
    put_enhanced(s.path, false, false);
    scanned_open(&s);
    struct error err = { 0 };
    assert_null(dicom_series_read(&s.folder, s.index, 0, NULL, NULL, &s.report, &err));
    assert_int_equal(err.code, ERROR_FORMAT);
    assert_non_null(strstr(err.text, "enhanced: frame 3 of 4 does not say where it lies"));
    scanned_finish(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_of_an_enhanced_image_are_placed_one_by_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
