/* MetaImage: real files of five programs against the answers of another reader, places worked out by hand, and what is
 * refused with its line. */
#include <zlib.h>

#include "core/formats/metaimage.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/plan_help.h"

static struct volume *read_real(const char *name, const char *data_name, struct report *report)
{
    char path[512], other[512];
    size_t size, data_size = 0;
    struct metaimage_header header;
    struct error err = { 0 };
    snprintf(other, sizeof other, "formats/metaimage/%s", name);
    if (!data_path(other, path, sizeof path))
        return NULL;
    uint8_t *bytes = file_bytes(path, &size), *data = NULL;
    if (!metaimage_parse_header(bytes, size, name, &header, report, &err))
        fail_msg("%s", err.text);
    assert_string_equal(header.data_file, data_name);
    if (data_name[0]) {
        snprintf(other, sizeof other, "formats/metaimage/%s", data_name);
        assert_true(data_path(other, path, sizeof path));
        data = file_bytes(path, &data_size);
    }
    struct bytes from = { data ? data : bytes, data ? data_size : size };
    struct volume *volume = metaimage_read(&header, &from, name, RAW_IMAGE, report, &err);
    if (!volume)
        fail_msg("%s", err.text);
    free(bytes);
    free(data);
    return volume;
}

static double sum_of(const struct volume *volume)
{
    double sum = 0;
    for (uint32_t k = 0; k < volume->grid.size[2]; k++)
        for (uint32_t j = 0; j < volume->grid.size[1]; j++)
            for (uint32_t i = 0; i < volume->grid.size[0]; i++)
                sum += volume_value(volume, i, j, k);
    return sum;
}

static void real_files_read_as_another_reader_reads_them(void **state)
{
    (void)state;
    static const struct {
        const char *name, *data;
        uint32_t size[3];
        double spacing[3], origin[3], low, high, sum;
        bool is_assumed;
    } files[] = {
        { "3DCT_lung_baseline_small.mha",
          "",
          { 57, 78, 64 },
          { 2.732, 2.732, 5 },
          { -152.461, -148.986, -1432 },
          -1130,
          1379,
          -99576319,
          false },
        { "3DCT_lung_followup_segmentation.mha",
          "",
          { 115, 166, 131 },
          { 1.366, 1.366, 2.5 },
          { -161.831, -162.449, -1399.5 },
          0,
          137,
          12965680,
          false },
        { "elastix2d/moving.mhd", "elastix2d/moving.raw", { 256, 256, 1 }, { 1, 1, 1 }, { 0 }, 0, 251, 5027809, true },
        { "fred/Phantom.Dose.mhd",
          "",
          { 10, 20, 10 },
          { 10, 10, 10 },
          { -45, 95, 45 },
          0,
          .00432785,
          .2538053841,
          false },
        { "fred/CTpatient.mhd", "fred/CTpatient.raw", { 10, 20, 10 }, { 10, 10, 10 }, { 0 }, -1000, 0, -848000, false },
        { "mcsquare/Dose.mhd",
          "mcsquare/Dose.raw",
          { 10, 20, 10 },
          { 10, 10, 10 },
          { 0 },
          0,
          2.12256e6,
          113459851.6,
          true },
        { "vtkVolumeReconstructorFloatType1OutputCompare.mha",
          "",
          { 145, 47, 100 },
          { .5, .5, .5 },
          { -74.3917, 195.063, 31.2199 },
          0,
          249.748,
          3299200.551,
          false },
    };
    for (size_t f = 0; f < sizeof files / sizeof *files; f++) {
        struct report report = { 0 };
        struct volume *volume = read_real(files[f].name, files[f].data, &report);
        if (!volume)
            skip();
        struct vec3 spacing = grid_spacing_mm(&volume->grid);
        assert_memory_equal(volume->grid.size, files[f].size, sizeof files[f].size);
        assert_point(spacing, files[f].spacing[0], files[f].spacing[1], files[f].spacing[2], 1e-9);
        assert_point(volume->grid.lps_mm_from_ijk.origin, files[f].origin[0], files[f].origin[1], files[f].origin[2],
                     1e-9);
        assert_near(volume->low, files[f].low, 1e-5);
        assert_near(volume->high, files[f].high, 1e-5);
        assert_near(sum_of(volume), files[f].sum, 1e-7);
        assert_int_equal(report_has(&report, "image.place-assumed"), files[f].is_assumed);
        volume_unref(volume);
        report_finish(&report);
    }
}

/* FRED turns y and z round: the second voxel along y lies 10 mm towards the front. */
static void the_first_numbers_of_the_matrix_are_the_way_of_the_first_index(void **state)
{
    (void)state;
    struct report report = { 0 };
    struct volume *volume = read_real("fred/Phantom.Dose.mhd", "", &report);
    if (!volume)
        skip();
    assert_point(affine_point(&volume->grid.lps_mm_from_ijk, vec3(1, 2, 3)), -35, 75, 15, 1e-9);
    volume_unref(volume);
    report_finish(&report);
    /* x towards P, y towards S, z towards L */
    static const char head[] =
        "NDims = 3\nDimSize = 2 3 4\nElementSpacing = 1 2 3\nOffset = 10 20 30\n"
        "TransformMatrix = 0 1 0 0 0 1 1 0 0\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n";
    struct metaimage_header header;
    struct error err = { 0 };
    assert_true(metaimage_parse_header((const uint8_t *)head, strlen(head), "it", &header, NULL, &err));
    assert_point(affine_point(&header.grid.lps_mm_from_ijk, vec3(1, 1, 1)), 10 + 3, 20 + 1, 30 + 2, 1e-12);
}

#define HEAD "NDims = 3\nDimSize = 2 1 2\nElementType = MET_SHORT\n"

static struct volume *read_text(const char *head, const void *data, size_t n, enum raw_use use, struct error *err)
{
    struct metaimage_header header;
    size_t n_head = strlen(head);
    uint8_t *file = malloc(n_head + n + 1);
    assert_non_null(file);
    memcpy(file, head, n_head);
    memcpy(file + n_head, data, n);
    struct volume *volume = NULL;
    *err = (struct error){ 0 };
    if (metaimage_parse_header(file, n_head + n, "it", &header, NULL, err))
        volume = metaimage_read(&header, &(struct bytes){ file, n_head + n }, "it", use, NULL, err);
    free(file);
    return volume;
}

static void byte_order_packing_and_skipped_bytes_are_as_the_header_says(void **state)
{
    (void)state;
    const int16_t values[4] = { -2, 300, 0, 7 };
    const uint8_t big[8] = { 0xff, 0xfe, 1, 0x2c, 0, 0, 0, 7 };
    uint8_t packed[64], behind[12] = { 9, 9, 9, 9 };
    uLongf n_packed = sizeof packed;
    struct error err;
    memcpy(behind + 4, values, 8);
    assert_int_equal(compress(packed, &n_packed, (const Bytef *)values, sizeof values), Z_OK);
    struct volume *volumes[] = {
        read_text(HEAD "ElementDataFile = LOCAL\n", values, 8, RAW_IMAGE, &err),
        read_text(HEAD "BinaryDataByteOrderMSB = True\r\nElementDataFile = LOCAL\n", big, 8, RAW_IMAGE, &err),
        read_text(HEAD "ElementByteOrderMSB = True\nElementDataFile = Local\n", big, 8, RAW_IMAGE, &err),
        read_text(HEAD "CompressedData = True\nElementDataFile = LOCAL\n", packed, n_packed, RAW_IMAGE, &err),
        read_text(HEAD "HeaderSize = 4\nElementDataFile = LOCAL\n", behind, 12, RAW_IMAGE, &err),
        read_text(HEAD "DistanceUnits = mm\nElementToIntensityFunctionSlope = 1\nElementDataFile = LOCAL\n", values, 8,
                  RAW_IMAGE, &err),
        read_text(HEAD "HeaderSize = -1\nElementDataFile = LOCAL\n", behind, 12, RAW_IMAGE, &err),
    };
    for (size_t i = 0; i < sizeof volumes / sizeof *volumes; i++) {
        assert_non_null(volumes[i]);
        for (uint32_t at = 0; at < 4; at++)
            assert_close(volume_value(volumes[i], at % 2, 0, at / 2), values[at], 0);
        volume_unref(volumes[i]);
    }
}

static void refuse(const char *head, size_t n, enum error_code code, const char *word)
{
    static const uint8_t data[64] = { 0x78 };
    struct error err;
    assert_null(read_text(head, data, n, RAW_IMAGE, &err));
    if (err.code != code || !strstr(err.text, word))
        fail_msg("'%s', expected '%s'", err.text, word);
}

static void a_header_that_is_wrong_is_refused_with_its_line(void **state)
{
    (void)state;
    refuse("", 0, ERROR_FORMAT, "no ElementDataFile");
    refuse("NDims\n", 0, ERROR_FORMAT, "line 1: expected KEY = VALUE");
    refuse("NDims = 3\nNDims = 3\n", 0, ERROR_FORMAT, "line 2: NDims is there twice");
    refuse(HEAD "ElementDataFile = LOCAL\n", 7, ERROR_FORMAT, "cut short");
    refuse("NDims = 3\nElementDataFile = LOCAL\n", 8, ERROR_FORMAT, "gives no DimSize");
    refuse("NDims = 4\nDimSize = 1 1 1 1\nElementType = MET_SHORT\nElementDataFile = LOCAL\n", 8, ERROR_UNSUPPORTED,
           "line 1: NDims is '4', expected 2 or 3");
    refuse("NDims = 3\nDimSize = 2 0 2\nElementType = MET_SHORT\nElementDataFile = LOCAL\n", 8, ERROR_LIMIT,
           "line 2: DimSize");
    refuse("NDims = 3\nDimSize = 2 2\nElementType = MET_SHORT\nElementDataFile = LOCAL\n", 8, ERROR_FORMAT,
           "3 numbers");
    refuse("NDims = 3\nDimSize = 2 1 2\nElementType = MET_SHORT_ARRAY\nElementDataFile = LOCAL\n", 8, ERROR_UNSUPPORTED,
           "line 3: ElementType");
    refuse(HEAD "ElementNumberOfChannels = 3\nElementDataFile = LOCAL\n", 24, ERROR_UNSUPPORTED,
           "line 4: ElementNumberOf");
    refuse(HEAD "BinaryData = False\nElementDataFile = LOCAL\n", 8, ERROR_UNSUPPORTED, "line 4: BinaryData");
    refuse(HEAD "DistanceUnits = cm\nElementDataFile = LOCAL\n", 8, ERROR_UNSUPPORTED,
           "line 4: DistanceUnits is 'cm', expected mm");
    refuse(HEAD "ElementToIntensityFunctionSlope = 0.01\nElementDataFile = LOCAL\n", 8, ERROR_UNSUPPORTED,
           "line 4: ElementToIntensityFunctionSlope is '0.01', expected 1");
    refuse(HEAD "ElementToIntensityFunctionOffset = -1024\nElementDataFile = LOCAL\n", 8, ERROR_UNSUPPORTED,
           "line 4: ElementToIntensityFunctionOffset is '-1024', expected 0");
    refuse(HEAD "CompressedData = perhaps\nElementDataFile = LOCAL\n", 8, ERROR_FORMAT, "True or False");
    refuse(HEAD "CompressedData = True\nElementDataFile = LOCAL\n", 8, ERROR_FORMAT, "it");
    refuse(HEAD "TransformMatrix = 1 0 0 0 1 0 0 0 0\nElementDataFile = LOCAL\n", 8, ERROR_RANGE, "it");
    refuse(HEAD "HeaderSize = -2\nElementDataFile = LOCAL\n", 8, ERROR_LIMIT, "HeaderSize");
    refuse(HEAD "ElementDataFile = LIST\n", 8, ERROR_UNSUPPORTED, "one file");
    refuse(HEAD "ElementDataFile = slice%03d.raw 1 9 1\n", 8, ERROR_UNSUPPORTED, "one file");
    refuse(HEAD "ElementDataFile = ../it.raw\n", 8, ERROR_RANGE, "in the plan's folder");
    refuse(HEAD "ElementDataFile = /it.raw\n", 8, ERROR_RANGE, "in the plan's folder");
}

static void a_folder_of_metaimages_is_a_plan(void **state)
{
    (void)state;
    char folder[256], path[512];
    struct error err = { 0 };
    if (!data_path("formats/metaimage/fred/CTpatient.mhd", path, sizeof path))
        skip();
    folder_make(folder);
    folder_put_data(folder, "fred/CTpatient.mhd", "formats/metaimage/fred/CTpatient.mhd");
    folder_put_data(folder, "fred/CTpatient.raw", "formats/metaimage/fred/CTpatient.raw");
    folder_put_data(folder, "fred/Phantom.Dose.mhd", "formats/metaimage/fred/Phantom.Dose.mhd");
    folder_put_data(folder, "lung_segmentation.mha", "formats/metaimage/3DCT_lung_followup_segmentation.mha");
    struct plan *plan = plan_of_folder(folder, &err);
    if (!plan)
        fail_msg("%s", err.text);
    assert_int_equal(plan->n_images, 1);
    assert_int_equal(plan->n_doses, 1);
    assert_close(plan->doses[0].components[0].values->high, .00432785, 1e-8);
    assert_true(plan->regions.n_regions > 0);
    plan_destroy(plan);
    folder_remove(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(real_files_read_as_another_reader_reads_them),
        cmocka_unit_test(the_first_numbers_of_the_matrix_are_the_way_of_the_first_index),
        cmocka_unit_test(byte_order_packing_and_skipped_bytes_are_as_the_header_says),
        cmocka_unit_test(a_header_that_is_wrong_is_refused_with_its_line),
        cmocka_unit_test(a_folder_of_metaimages_is_a_plan),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
