/* NRRD files written by hand after Teem's definition of the format, and real ones with numbers numpy and Eclipse gave.
 */
#include "core/formats/nrrd.h"
#include "core/load/load.h"
#include "core/load/summary.h"
#include "core/plan/plan.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/nifti_bytes.h"
#include "tests/unit/plan_help.h"

#define LPS "space: left-posterior-superior\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\n"
#define BYTES "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n"
static const uint8_t eight[8] = { 0, 1, 2, 3, 4, 5, 6, 7 };

static struct bytes make(const char *header, const void *data, size_t n)
{
    size_t length = strlen(header);
    struct bytes file = { malloc(length + n + 1), length + n };
    memcpy(file.data, header, length);
    memcpy(file.data + length, data, n);
    return file;
}

static struct volume *read_from(const char *head, const void *data, size_t n, enum raw_use use, struct report *report,
                                struct error *err)
{
    struct bytes file = make(head, data, n);
    struct nrrd_header header;
    *err = (struct error){ 0 };
    struct volume *volume = NULL;
    if (nrrd_parse_header(file.data, file.size, "a.nrrd", &header, report, err))
        volume = nrrd_read(&header, &file, "a.nrrd", use, report, err);
    nrrd_header_finish(&header);
    bytes_free(&file);
    return volume;
}

static void expect_refusal(const char *head, size_t n, enum error_code code, const char *words)
{
    struct error err;
    struct report report = { 0 };
    static const uint8_t zeros[4096];
    struct volume *volume = read_from(head, zeros, n, RAW_IMAGE, &report, &err);
    if (volume || err.code != code || !strstr(err.text, words) || !strstr(err.text, "a.nrrd"))
        fail_msg("%s: found %s, \"%s\"", words, error_word(err.code), err.text);
    report_finish(&report);
}

static void the_space_says_how_the_axes_lie_in_the_patient(void **state)
{
    (void)state;
    /* index (1,1,1) with directions (1,0,0) (0,2,0) (0,0,3) and origin (10,20,30) is (11,22,33) of the space */
    static const struct {
        const char *space;
        double x, y, z;
        const char *letters;
    } cases[] = { { "left-posterior-superior", 11, 22, 33, "LPS" },    { "LPS", 11, 22, 33, "LPS" },
                  { "right-anterior-superior", -11, -22, 33, "RAS" },  { "RAS", -11, -22, 33, "RAS" },
                  { "left-anterior-superior", 11, -22, 33, "LAS" },    { "LAS", 11, -22, 33, "LAS" },
                  { "Right-Posterior-Inferior", -11, 22, -33, "RPI" }, { "SLP", 22, 33, 11, "SLP" } };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char head[400], letters[4];
        snprintf(head, sizeof head,
                 BYTES "space: %s\nspace directions: (1,0,0) (0,2,0) (0,0,3)\nspace origin: (10,20,30)\n\n",
                 cases[i].space);
        struct error err;
        struct report report = { 0 };
        struct volume *volume = read_from(head, eight, 8, RAW_IMAGE, &report, &err);
        assert_string_equal(err.text, "");
        assert_point(affine_point(&volume->grid.lps_mm_from_ijk, vec3(1, 1, 1)), cases[i].x, cases[i].y, cases[i].z,
                     1e-9);
        grid_letters(&volume->grid, letters);
        assert_string_equal(letters, cases[i].letters);
        assert_int_equal(report.n_lines, 0);
        assert_close(volume_value(volume, 1, 0, 0), 1, 0);
        assert_close(volume_value(volume, 0, 1, 0), 2, 0);
        assert_close(volume_value(volume, 0, 0, 1), 4, 0);
        volume_unref(volume);
    }
}

static void a_left_handed_grid_keeps_its_handedness(void **state)
{
    (void)state;
    struct error err;
    struct volume *volume =
        read_from(BYTES "space: left-posterior-superior\nspace directions: (0.5,0,0) (0,-0.5,0) (0,0,6)\n"
                        "space origin: (-99,99,-78)\n\n",
                  eight, 8, RAW_IMAGE, NULL, &err);
    assert_string_equal(err.text, "");
    assert_true(affine_determinant(&volume->grid.lps_mm_from_ijk) < 0);
    assert_point(affine_point(&volume->grid.lps_mm_from_ijk, vec3(1, 1, 1)), -98.5, 98.5, -72, 1e-9);
    volume_unref(volume);
}

static void what_the_file_leaves_open_is_reported(void **state)
{
    (void)state;
    static const struct {
        const char *fields, *words;
        double x, y, z; /* of index (1,1,1) */
    } cases[] = {
        { "", "1 mm apart. Left and right may be wrong", 1, 1, 1 },
        { "spacings: 2 3 4\n", "Left and right may be wrong", 2, 3, 4 },
        { "space: RAS\nspacings: 2 3 4\n", "no directions", -2, -3, 4 },
        { "space dimension: 3\nspace directions: (2,0,0) (0,3,0) (0,0,4)\nspace origin: (1,1,1)\n",
          "axes of its space lie", 3, 4, 5 },
        { "space: scanner-xyz\nspace directions: (2,0,0) (0,3,0) (0,0,4)\nspace origin: (1,1,1)\n",
          "axes of its space lie", 3, 4, 5 },
        { "space: LPS\nspace directions: (2,0,0) (0,3,0) (0,0,4)\n", "where its first voxel lies", 2, 3, 4 },
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char head[400];
        snprintf(head, sizeof head, BYTES "%s\n", cases[i].fields);
        struct error err;
        struct report report = { 0 };
        struct volume *volume = read_from(head, eight, 8, RAW_IMAGE, &report, &err);
        assert_string_equal(err.text, "");
        const char *sentence = report_said(&report, "geometry.assumed");
        if (!strstr(sentence, cases[i].words))
            fail_msg("%s: \"%s\"", cases[i].fields, sentence);
        assert_point(affine_point(&volume->grid.lps_mm_from_ijk, vec3(1, 1, 1)), cases[i].x, cases[i].y, cases[i].z,
                     1e-9);
        volume_unref(volume);
        report_finish(&report);
    }
}

static void units_of_the_space_become_millimetres(void **state)
{
    (void)state;
    struct error err;
    struct report report = { 0 };
    struct volume *volume =
        read_from(BYTES LPS "space units: \"cm\" \"cm\" \"cm\"\n\n", eight, 8, RAW_IMAGE, &report, &err);
    assert_point(affine_point(&volume->grid.lps_mm_from_ijk, vec3(1, 1, 1)), 10, 10, 10, 1e-9);
    assert_int_equal(report.n_lines, 0);
    volume_unref(volume);
    volume = read_from(BYTES LPS "space units: \"furlong\" \"mm\" \"mm\"\n\n", eight, 8, RAW_IMAGE, &report, &err);
    assert_non_null(strstr(report_said(&report, "geometry.unit-assumed"), "Line 9: the unit \"furlong\""));
    volume_unref(volume);
    report_finish(&report);
}

static void every_scalar_type_is_read_in_both_byte_orders(void **state)
{
    (void)state;
    static const struct {
        const char *word;
        int bytes;
        uint64_t raw[2]; /* the bits of the two values */
        double values[2];
        enum voxel_type expected;
    } cases[] = { { "signed char", 1, { 0x80, 0x7f }, { -128, 127 }, VOXEL_I16 },
                  { "unsigned char", 1, { 0, 0xff }, { 0, 255 }, VOXEL_U8 },
                  { "short", 2, { 0x8000, 0x7fff }, { -32768, 32767 }, VOXEL_I16 },
                  { "ushort", 2, { 1, 0xffff }, { 1, 65535 }, VOXEL_U16 },
                  { "int", 4, { 0xfffffffe, 300 }, { -2, 300 }, VOXEL_I16 },
                  { "uint32_t", 4, { 7, 70000 }, { 7, 70000 }, VOXEL_F32 },
                  { "long long", 8, { 0xffffffffffffffff, 5 }, { -1, 5 }, VOXEL_I16 },
                  { "uint64", 8, { 3, 4 }, { 3, 4 }, VOXEL_U8 },
                  { "float", 4, { 0x3fc00000, 0xc0200000 }, { 1.5, -2.5 }, VOXEL_F32 },
                  { "double", 8, { 0x3ff8000000000000, 0xc004000000000000 }, { 1.5, -2.5 }, VOXEL_F32 } };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        for (int is_big = 0; is_big < 2; is_big++) {
            char head[400];
            uint8_t data[16];
            int width = cases[i].bytes;
            snprintf(head, sizeof head,
                     "NRRD0005\ntype: %s\ndimension: 3\nsizes: 2 1 1\nencoding: raw\nendian: %s\n" LPS "\n",
                     cases[i].word, is_big ? "big" : "little");
            for (int b = 0; b < 2 * width; b++) {
                int at = is_big ? width - 1 - b % width : b % width;
                data[b] = (uint8_t)(cases[i].raw[b / width] >> (8 * at));
            }
            struct error err;
            struct volume *volume = read_from(head, data, (size_t)(2 * width), RAW_IMAGE, NULL, &err);
            assert_string_equal(err.text, "");
            assert_int_equal(volume->type, cases[i].expected);
            assert_close(volume_value(volume, 0, 0, 0), cases[i].values[0], 0);
            assert_close(volume_value(volume, 1, 0, 0), cases[i].values[1], 0);
            volume_unref(volume);
        }
}

static void gzip_skips_and_line_ends_of_either_kind_are_understood(void **state)
{
    (void)state;
    struct error err;
    struct bytes packed = nifti_bytes_pack(eight, 8);
    struct volume *volume =
        read_from("NRRD0004\r\n# a comment: with colon\r\ntype: uchar\r\ndimension: 3\r\nsizes: 2 2 2\r\n"
                  "encoding: gzip\r\nspace: LPS\r\nspace directions: (1, 0, 0) (0, 1, 0) (0, 0, 1)\r\n"
                  "space origin: (0,0,0)\r\nkey:=value: with = all\r\n\r\n",
                  packed.data, packed.size, RAW_IMAGE, NULL, &err);
    assert_string_equal(err.text, "");
    assert_close(volume_value(volume, 1, 1, 1), 7, 0);
    volume_unref(volume);
    bytes_free(&packed);
    static const struct {
        const char *field, *data;
        size_t n;
    } cases[] = { { "line skip: 2\nbyte skip: 1\n", "one\ntwo\nx\0\1\2\3\4\5\6\7", 17 },
                  { "byteskip: -1\n", "anything\0\1\2\3\4\5\6\7", 16 } };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char head[400];
        snprintf(head, sizeof head, BYTES LPS "%s\n", cases[i].field);
        volume = read_from(head, cases[i].data, cases[i].n, RAW_IMAGE, NULL, &err);
        assert_string_equal(err.text, "");
        assert_close(volume_value(volume, 1, 0, 0), 1, 0);
        assert_close(volume_value(volume, 1, 1, 1), 7, 0);
        volume_unref(volume);
    }
}

static void a_header_that_is_wrong_is_refused_with_its_line(void **state)
{
    (void)state;
#define SIZED(sizes) "NRRD0004\ntype: uchar\ndimension: 3\nsizes: " sizes "\nencoding: raw\n"
    expect_refusal("NRRD0009\n\n", 8, ERROR_FORMAT, "line 1: expected NRRD0001");
    expect_refusal("", 8, ERROR_FORMAT, "not a NRRD file");
    expect_refusal(BYTES LPS, 0, ERROR_FORMAT, "line 8: the header has no end");
    expect_refusal(BYTES "what is this\n\n", 8, ERROR_FORMAT, "line 6: expected \"field: value\"");
    expect_refusal(BYTES "type: short\n\n", 8, ERROR_FORMAT, "line 6: \"type\" is there twice, first in line 2");
    expect_refusal("NRRD0004\ntype: block\n\n", 8, ERROR_UNSUPPORTED, "line 2: type is \"block\"");
    expect_refusal("NRRD0004\ntype: uchar\n\n", 8, ERROR_FORMAT, "the header has no \"encoding\"");
    expect_refusal("NRRD0004\ntype: uchar\nencoding: bzip2\n\n", 8, ERROR_UNSUPPORTED,
                   "line 3: encoding is \"bzip2\", expected raw or gzip");
    expect_refusal("NRRD0004\ntype: short\nencoding: raw\n\n", 8, ERROR_FORMAT,
                   "the header has no \"endian\", expected little or big");
    expect_refusal("NRRD0004\ntype: uchar\nencoding: raw\ndimension: 2\n\n", 8, ERROR_UNSUPPORTED,
                   "line 4: dimension is \"2\"");
    expect_refusal("NRRD0004\ntype: uchar\nencoding: raw\ndimension: 99\n\n", 8, ERROR_LIMIT, "line 4: dimension");
    expect_refusal(SIZED("2 2") "\n", 8, ERROR_FORMAT, "line 4: sizes is \"2 2\"");
    expect_refusal(SIZED("2 2 2 2") "\n", 8, ERROR_FORMAT, "line 4: sizes");
    expect_refusal(SIZED("2 -2 2") "\n", 8, ERROR_FORMAT, "line 4: sizes");
    expect_refusal(SIZED("2 1e99 2") "\n", 8, ERROR_FORMAT, "line 4: sizes");
    expect_refusal(SIZED("65535 65535 2") "\n", 8, ERROR_LIMIT, "line 4: sizes: 65535; at most 4096");
    expect_refusal(SIZED("4096 4096 4096") LPS "\n", 8, ERROR_LIMIT, "line 4: sizes: 68719476736 voxels of 1 bytes");
    expect_refusal(SIZED("1024 1024 1024") LPS "\n", 8, ERROR_FORMAT, "cut short");
    expect_refusal(BYTES LPS "byte skip: 2000000000\n\n", 8, ERROR_LIMIT, "line 9: byte skip");
    expect_refusal(BYTES LPS "line skip: 5\n\n", 8, ERROR_FORMAT, "\"line skip\" is 5");
    expect_refusal(BYTES "space: up-down-sideways\n\n", 8, ERROR_UNSUPPORTED, "line 6: space is \"up-down-sideways\"");
    expect_refusal(BYTES "space: left-right-superior\n\n", 8, ERROR_UNSUPPORTED, "one along each");
    expect_refusal(BYTES "space: L-P\n\n", 8, ERROR_UNSUPPORTED, "line 6: space");
    expect_refusal(BYTES "space: left-posterior-superior-time\n\n", 8, ERROR_UNSUPPORTED, "line 6: space");
    expect_refusal(BYTES "space: LPS\nspace directions: (nan,0,0) (0,1,0) (0,0,1)\n\n", 8, ERROR_RANGE,
                   "line 7: space directions");
    expect_refusal(BYTES "space: LPS\nspace directions: (1,0,0) (0,1,0) (0,1,0)\n\n", 8, ERROR_RANGE, "line 7");
    expect_refusal(BYTES "space: LPS\nspace directions: (1,0) (0,1) (1,1)\n\n", 8, ERROR_RANGE,
                   "line 7: space directions");
    expect_refusal(BYTES "space: LPS\nspace directions: (1,0,0) none (0,0,1)\n\n", 8, ERROR_UNSUPPORTED, "axis 1");
    expect_refusal(BYTES "spacings: 1 nan 1\n\n", 8, ERROR_RANGE, "line 6: spacings");
    expect_refusal(BYTES "spacings: 1 1 0\n\n", 8, ERROR_RANGE, "line 6");
    expect_refusal(BYTES LPS "kinds: RGB-color domain domain\n\n", 8, ERROR_UNSUPPORTED, "line 9: axis 0 (RGB-color)");
    expect_refusal("NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: gzip\n" LPS "\n", 8, ERROR_FORMAT,
                   "expected a gzip stream");
    expect_refusal("NRRD0004\ntype: uchar\ndimension: 4\nsizes: 2 2 2 1\nencoding: raw\n\n", 8, ERROR_UNSUPPORTED,
                   "line 3: four axes");
    expect_refusal(
        "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 2 2 1 2\nencoding: raw\nkinds: domain domain list domain\n\n", 8,
        ERROR_UNSUPPORTED, "number 2, expected the first or the last");
    expect_refusal(
        "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 2 2 1 2\nencoding: raw\nkinds: domain domain domain time\n\n", 8,
        ERROR_UNSUPPORTED, "kind \"time\"");
    expect_refusal(BYTES LPS "data file: /etc/passwd\n\n", 8, ERROR_RANGE, "line 9: data file");
    expect_refusal(BYTES LPS "data file: ../../x.raw\n\n", 8, ERROR_RANGE, "line 9: data file");
    expect_refusal(BYTES LPS "data file: LIST\nx.raw\n\n", 8, ERROR_FORMAT, "line 10");
    expect_refusal(BYTES LPS "data file: x%03d.raw 1 9 1\n\n", 8, ERROR_UNSUPPORTED, "line 9: data file");
}

static void long_headers_and_long_values_end_somewhere(void **state)
{
    (void)state;
    size_t n = NRRD_HEAD_BYTES + 100;
    char *head = malloc(n + 1);
    memset(head, '#', n);
    memcpy(head, "NRRD0004\n", 9);
    head[n] = 0;
    expect_refusal(head, 0, ERROR_LIMIT, "does not end within 1048576 bytes");
    memset(head + 9, '1', n - 9);
    memcpy(head + 9, "sizes: ", 7);
    memcpy(head + 9 + 7 + NRRD_MAX_VALUE, "\n\n", 3);
    expect_refusal(head, 0, ERROR_LIMIT, "line 2: the value of \"sizes\" has 4096 characters; at most 4095");
    /* a note of any length, as Slicer writes them, is no trouble */
    static const char start[] = BYTES LPS "Segmentation_ConversionParameters:=";
    memcpy(head, start, sizeof start - 1);
    memset(head + sizeof start - 1, 'x', 100000);
    memcpy(head + sizeof start - 1 + 100000, "\n\n", 3);
    struct error err;
    struct volume *volume = read_from(head, eight, 8, RAW_IMAGE, NULL, &err);
    assert_string_equal(err.text, "");
    volume_unref(volume);
    free(head);
}

/* Two layers of 2 x 2 x 1, in the patient at 10 mm a voxel. Layer 0: 1 1 0 2; layer 1: 0 1 1 0: the two overlap at
 * (1,0). */
#define SEGMENTS \
    "Segment0_ID:=a\nSegment0_Name:=Tum\xc3\xb6r\\nleft\nSegment0_Color:=1 0.5 0\nSegment0_LabelValue:=1\nSegment0_Layer:=0\n" \
    "Segment0_Extent:=0 1 0 1 0 0\nSegment1_ID:=Brain\nSegment1_LabelValue:=2\nSegment1_Layer:=0\n" \
    "Segment2_Name:=Margin\nSegment2_LabelValue:=1\nSegment2_Layer:=1\nSegment2_Color:=2 0 0\n" \
    "Segment3_Name:=Lost\nSegment3_LabelValue:=1\nSegment3_Layer:=7\nSegment4_Name:=Wrong\nSegment4_LabelValue:=zero\n"
#define SEG_HEAD \
    "NRRD0004\ntype: uchar\ndimension: 4\nspace: left-posterior-superior\nsizes: 2 2 2 1\nspace directions: none (10,0,0) (0,10,0) " \
    "(0,0,10)\nkinds: list domain domain domain\nencoding: raw\nspace origin: (0,0,0)\n"
static const uint8_t seg_layers_together[8] = { 1, 0, 1, 1, 0, 1, 2, 0 };

static void overlapping_segments_come_as_layers_with_names_and_colours(void **state)
{
    (void)state;
    static const struct {
        const char *head;
        uint8_t data[8];
    } cases[] = {
        { SEG_HEAD SEGMENTS "\n", { 1, 0, 1, 1, 0, 1, 2, 0 } },
        { "NRRD0004\ntype: uchar\ndimension: 4\nspace: left-posterior-superior\nsizes: 2 2 1 2\nspace directions: (10,0,0) "
          "(0,10,0) (0,0,10) none\nencoding: raw\nspace origin: (0,0,0)\n" SEGMENTS "\n",
          { 1, 1, 0, 2, 0, 1, 1, 0 } }
    };
    for (size_t c = 0; c < 2; c++) {
        struct bytes file = make(cases[c].head, cases[c].data, 8);
        struct nrrd_header header;
        struct nrrd_layers layers = { 0 };
        struct report report = { 0 };
        struct error err = { 0 };
        assert_true(nrrd_parse_header(file.data, file.size, "a.seg.nrrd", &header, &report, &err));
        assert_true(nrrd_read_layers(&header, &file, "a.seg.nrrd", &layers, NULL, &err));
        assert_int_equal(layers.n, 2);
        static const uint16_t expected[2][4] = { { 1, 1, 0, 2 }, { 0, 1, 1, 0 } };
        for (uint32_t layer = 0; layer < 2; layer++)
            for (uint32_t i = 0; i < 4; i++)
                assert_int_equal(volume_label(layers.volumes[layer], i % 2, i / 2, 0), expected[layer][i]);
        assert_int_equal(layers.names[0].n, 2);
        const struct label_name *first = &layers.names[0].labels[0];
        assert_string_equal(first->name, "Tum\xc3\xb6r left");
        assert_int_equal(first->value, 1);
        assert_true(first->has_color);
        assert_int_equal(first->rgb[0], 255);
        assert_int_equal(first->rgb[1], 128);
        assert_int_equal(first->rgb[2], 0);
        assert_string_equal(layers.names[0].labels[1].name, "Brain");
        assert_int_equal(layers.names[0].labels[1].value, 2);
        assert_false(layers.names[0].labels[1].has_color);
        assert_int_equal(layers.names[1].n, 1);
        assert_string_equal(layers.names[1].labels[0].name, "Margin");
        assert_false(layers.names[1].labels[0].has_color);
        assert_int_equal(report.n_lines,
                         3); /* a colour above 1, a layer that is not there, a label that is no number */
        report_finish(&report);
        nrrd_layers_finish(&layers);
        nrrd_header_finish(&header);
        bytes_free(&file);
    }
}

static struct plan *load(const char *folder, struct error *err)
{
    *err = (struct error){ 0 };
    return plan_load(folder, "p", NULL, err);
}

static void segments_and_detached_headers_open_as_a_plan(void **state)
{
    (void)state;
    char folder[256];
    struct error err;
    folder_make(folder);
    struct bytes seg = make(SEG_HEAD SEGMENTS "\n", seg_layers_together, 8);
    folder_put(folder, "x.seg.nrrd", seg.data, seg.size);
    folder_put_text(folder, "mr/i.nhdr", BYTES LPS "data file: i.raw\n"); /* no empty line: nothing follows it */
    folder_put(folder, "mr/i.raw", eight, 8);
    folder_put_text(
        folder, "plan.json",
        "{\"format\":\"beamroom-plan\",\"version\":1,\"images\":[{\"path\":\"mr/i.nhdr\"}],\"regions\":[{\"path\":"
        "\"x.seg.nrrd\"},{\"path\":\"mr/i.nhdr\",\"name\":\"All\"}],\"doses\":[{\"path\":\"mr/i.nhdr\",\"mask\":\"mr/i.nhdr\"}]}");
    struct plan *plan = load(folder, &err);
    assert_string_equal(err.text, "");
    assert_int_equal(plan->regions.n_regions, 4);
    const struct region *tumour = &plan->regions.regions[0], *margin = &plan->regions.regions[2];
    assert_string_equal(tumour->name, "Tum\xc3\xb6r left");
    assert_close(tumour->volume_cm3, 2, 1e-9); /* two voxels of 1 cm3 */
    assert_true(tumour->has_file_color);
    assert_string_equal(margin->name, "Margin");
    assert_int_not_equal(margin->layer, tumour->layer);
    assert_point(margin->centre_lps_mm, 5, 5, 0, 1e-9); /* (1,0) and (0,1) */
    assert_int_equal(plan->regions.regions[3].n_voxels, 7);
    assert_close(plan->images[0].volume->high, 7, 0);
    assert_int_equal(plan->n_doses, 1);
    assert_string_equal(plan->doses[0].unit, ""); /* nobody said it */
    assert_true(report_has(&plan->report, "dose.no-unit"));
    plan_destroy(plan);
    struct plan_summary summary;
    plan_summarize(folder, &summary);
    assert_true(summary.is_readable);
    assert_string_equal(summary.parts[0], "1 image");
    assert_string_equal(summary.parts[1], "1 region");
    assert_string_equal(summary.parts[2], "3 named labels");
    folder_remove(folder);

    folder_make(folder); /* without a plan.json: what names segments is regions, whatever it is called */
    folder_put(folder, "x.nrrd", seg.data, seg.size);
    folder_put_text(folder, "i.nhdr", BYTES LPS "data file: ./i.raw\n");
    plan_summarize(folder, &summary);
    assert_true(summary.is_readable); /* nobody named the one without its voxels: it is left out, and said */
    assert_int_equal(summary.n_parts, 1);
    plan = load(folder, &err);
    assert_string_equal(err.text, "");
    assert_int_equal(plan->n_images, 0);
    assert_non_null(
        strstr(report_said(&plan->report, "plan.ignored-file"), "i.nhdr: its data file i.raw is not there"));
    plan_destroy(plan);
    folder_put(folder, "i.raw", eight, 8);
    plan = load(folder, &err);
    assert_string_equal(err.text, "");
    assert_int_equal(plan->n_images, 1);
    assert_int_equal(plan->regions.n_regions, 3);
    plan_destroy(plan);
    folder_remove(folder);
    bytes_free(&seg);
}

static void a_real_left_handed_mr_lies_where_its_header_puts_it(void **state)
{
    (void)state;
    char path[512], letters[4];
    struct error err;
    if (!data_path("mr-tumour-nrrd", path, sizeof path))
        skip();
    struct plan *plan = load(path, &err);
    assert_string_equal(err.text, "");
    const struct volume *mr = plan->images[0].volume;
    grid_letters(&mr->grid, letters);
    assert_string_equal(letters, "LAS");
    /* numpy on the same bytes: 4137 voxels; their mean index is (186.98549674, 106.35629683, 14.38917090); the header's
     * directions and origin, by hand, make that the place below; value at (187, 106, 14) 677, the largest 3057 */
    const struct region *lesion = &plan->regions.regions[0];
    assert_int_equal(lesion->n_voxels, 4137);
    assert_close(lesion->centre_lps_mm.x, -99.609375 + 0.78125 * 186.98549674, 1e-5);
    assert_close(lesion->centre_lps_mm.y, 99.609375 - 0.78125 * 106.35629683, 1e-5);
    assert_close(lesion->centre_lps_mm.z, -78 + 6.5 * 14.38917090, 1e-5);
    assert_close(volume_value(mr, 187, 106, 14), 677, 0);
    assert_close(mr->high, 3057, 0);
    plan_destroy(plan);
}

/* Mean dose from a cumulative histogram in percent: the area under it. column: of the dose; the percent follow. */
static double table_mean(const char *path, int column)
{
    FILE *file = fopen(path, "r");
    char line[4096];
    double mean = 0, last_dose = 0, last_share = 1;
    assert_non_null(file);
    assert_non_null(fgets(line, sizeof line, file));
    while (fgets(line, sizeof line, file)) {
        const char *at = line;
        for (int i = 0; i < column; i++)
            at = strchr(at, ',') + 1;
        char *end;
        double dose = strtod(at, &end);
        double share = strtod(end + 1, NULL) / 100;
        if (end == at)
            break;
        mean += (dose - last_dose) * (share + last_share) / 2;
        last_dose = dose;
        last_share = share;
    }
    fclose(file);
    return mean;
}

static double region_mean(const struct plan *plan, const char *id)
{
    const struct region *region = region_find(&plan->regions, id);
    assert_non_null(region);
    const struct volume *layer = plan->regions.layers[region->layer], *dose = plan->doses[0].components[0].values;
    double sum = 0;
    for (uint32_t k = region->low_ijk[2]; k <= region->high_ijk[2]; k++)
        for (uint32_t j = region->low_ijk[1]; j <= region->high_ijk[1]; j++)
            for (uint32_t i = region->low_ijk[0]; i <= region->high_ijk[0]; i++) {
                double value = 0;
                if (volume_label(layer, i, j, k) != region->label)
                    continue;
                assert_true(volume_sample(dose, affine_point(&layer->grid.lps_mm_from_ijk, vec3(i, j, k)), &value));
                sum += value;
            }
    return sum / (double)region->n_voxels;
}

static void doses_in_regions_are_those_of_the_planning_system(void **state)
{
    (void)state;
    char path[512], table[600];
    struct error err;
    if (!data_path("eclipse-ent-dose", path, sizeof path))
        skip();
    struct plan *plan = load(path, &err);
    assert_string_equal(err.text, "");
    assert_string_equal(plan->doses[0].unit, "Gy"); /* plan.json says so, the NRRD does not */
    snprintf(table, sizeof table, "%s/EclipseEnt_DvhTable_Eclipse.csv", path);
    /* Eclipse works on the contours, we on 2.5 mm voxels of them: large regions within 1 %, small ones in a gradient
     * within 6 %. With left and right exchanged PTV1 would have 6 Gy. */
    static const struct {
        const char *id;
        int column;
        double share;
    } regions[] = { { "brain", 2, 0.01 },  { "ptv1", 26, 0.01 },       { "ctv", 6, 0.01 },
                    { "brstem", 4, 0.04 }, { "orbit-left", 22, 0.02 }, { "orbit-right", 24, 0.06 } };
    for (size_t i = 0; i < sizeof regions / sizeof regions[0]; i++)
        assert_near(region_mean(plan, regions[i].id), table_mean(table, regions[i].column), regions[i].share);
    plan_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_space_says_how_the_axes_lie_in_the_patient),
        cmocka_unit_test(a_left_handed_grid_keeps_its_handedness),
        cmocka_unit_test(what_the_file_leaves_open_is_reported),
        cmocka_unit_test(units_of_the_space_become_millimetres),
        cmocka_unit_test(every_scalar_type_is_read_in_both_byte_orders),
        cmocka_unit_test(gzip_skips_and_line_ends_of_either_kind_are_understood),
        cmocka_unit_test(a_header_that_is_wrong_is_refused_with_its_line),
        cmocka_unit_test(long_headers_and_long_values_end_somewhere),
        cmocka_unit_test(overlapping_segments_come_as_layers_with_names_and_colours),
        cmocka_unit_test(segments_and_detached_headers_open_as_a_plan),
        cmocka_unit_test(a_real_left_handed_mr_lies_where_its_header_puts_it),
        cmocka_unit_test(doses_in_regions_are_those_of_the_planning_system),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
