/* RT Doses: made-up ones for every convention. */
#include "core/formats/dicom/dicom_rtdose.h"

#include "core/formats/dicom/dicom_rtplan.h"
#include "core/formats/dicom/dicom_rtstruct.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/made_j2k.h"
#include "tests/unit/oracle.h"
#include "tests/unit/plan_help.h"
#include "tests/unit/rt_files.h"

#define RTDOSE "1.2.840.10008.5.1.4.1.1.481.2"
#define TAG DICOM_TAG

/* A grid of 3 rows, 4 columns and some frames. The stored value is 100 k + 10 j + i (times 1000 for 32 bits). */
struct made_dose {
    const char *position, *orientation, *spacing, *offsets, *scaling, *type, *summation, *description, *comment;
    uint32_t n_frames, n_surplus; /* frames declared, and those in the pixel data beyond them */
    int bits;
    bool is_zero;
    int beam;
    const char *syntax; /* transfer syntax, explicit; NULL: implicit little-endian */
};
static const struct made_dose plain = { .position = "10\\20\\30",
                                        .orientation = "1\\0\\0\\0\\1\\0",
                                        .spacing = "2\\5",
                                        .offsets = "0\\3\\6",
                                        .scaling = "0.5",
                                        .type = "PHYSICAL",
                                        .summation = "PLAN",
                                        .n_frames = 3,
                                        .bits = 16 };

static void put_dose(struct made_dicom *made, const struct made_dose *dose)
{
    char n_frames[16];
    if (dose->syntax) {
        made_begin(made, dose->syntax);
        made_text(made, TAG(0x0008, 0x0016), "UI", RTDOSE);
        made_text(made, TAG(0x0008, 0x0018), "UI", "1.2.3.4");
        made_text(made, TAG(0x0008, 0x0060), "CS", "RTDOSE");
    } else {
        made_rt_begin(made, RTDOSE, "RTDOSE", "ISO_IR 192");
    }
    if (dose->description)
        made_text(made, TAG(0x0008, 0x103e), "LO", dose->description);
    if (dose->position)
        made_text(made, TAG(0x0020, 0x0032), "DS", dose->position);
    if (dose->orientation)
        made_text(made, TAG(0x0020, 0x0037), "DS", dose->orientation);
    made_text(made, TAG(0x0020, 0x0052), "UI", "1.2.3");
    made_u16(made, TAG(0x0028, 0x0002), 1);
    made_text(made, TAG(0x0028, 0x0004), "CS", "MONOCHROME2");
    snprintf(n_frames, sizeof n_frames, "%u", dose->n_frames);
    made_text(made, TAG(0x0028, 0x0008), "IS", n_frames);
    made_u16(made, TAG(0x0028, 0x0010), 3);
    made_u16(made, TAG(0x0028, 0x0011), 4);
    if (dose->spacing)
        made_text(made, TAG(0x0028, 0x0030), "DS", dose->spacing);
    made_u16(made, TAG(0x0028, 0x0100), (uint16_t)dose->bits);
    made_u16(made, TAG(0x0028, 0x0101), (uint16_t)dose->bits);
    made_u16(made, TAG(0x0028, 0x0102), (uint16_t)(dose->bits - 1));
    made_u16(made, TAG(0x0028, 0x0103), 0);
    made_text(made, TAG(0x3004, 0x0002), "CS", "GY");
    made_text(made, TAG(0x3004, 0x0004), "CS", dose->type);
    if (dose->comment)
        made_text(made, TAG(0x3004, 0x0006), "LO", dose->comment);
    made_text(made, TAG(0x3004, 0x000a), "CS", dose->summation);
    if (dose->offsets)
        made_text(made, TAG(0x3004, 0x000c), "DS", dose->offsets);
    if (dose->scaling)
        made_text(made, TAG(0x3004, 0x000e), "DS", dose->scaling);
    if (dose->beam > 0) {
        made_sequence(made, TAG(0x300c, 0x0002));
        made_item(made);
        made_sequence(made, TAG(0x300c, 0x0020));
        made_item(made);
        made_sequence(made, TAG(0x300c, 0x0004));
        made_item(made);
        made_integer(made, TAG(0x300c, 0x0006), dose->beam);
        made_item_end(made);
        made_sequence_end(made);
        made_item_end(made);
        made_sequence_end(made);
        made_item_end(made);
        made_sequence_end(made);
    }
    uint8_t bytes[3 * 4 * 8 * 4];
    size_t n = 0;
    for (uint32_t k = 0; k < dose->n_frames + dose->n_surplus; k++)
        for (uint32_t at = 0; at < 12; at++) {
            uint32_t value = dose->is_zero ? 0 : (100 * k + 10 * (at / 4) + at % 4) * (dose->bits == 32 ? 1000 : 1);
            for (int byte = 0; byte < dose->bits / 8; byte++)
                bytes[n++] = (uint8_t)(value >> 8 * byte);
        }
    made_element(made, TAG(0x7fe0, 0x0010), "OW", bytes, n);
}

static bool read_dose(const struct made_dose *dose, struct rtdose *read, struct report *report, struct error *err)
{
    struct made_dicom made;
    put_dose(&made, dose);
    struct rt_file file = rt_file_of(&made);
    bool is_read = rtdose_read(file.file, "rd.dcm", read, report, err);
    rt_file_close(&file);
    made_finish(&made);
    return is_read;
}

static struct rtdose read_good(const struct made_dose *dose, struct report *report)
{
    struct rtdose read;
    struct error err = { 0 };
    if (!read_dose(dose, &read, report, &err))
        fail_msg("%s", err.text);
    return read;
}

static void assert_dose_at(const struct rtdose *dose, double x, double y, double z, double expected)
{
    double value;
    if (!volume_sample(dose->values, vec3(x, y, z), &value))
        fail_msg("no dose at %g %g %g", x, y, z);
    assert_close(value, expected, 1e-4);
}

static void values_lie_where_rows_columns_and_offsets_put_them(void **state)
{
    (void)state;
    struct report report = { 0 };
    struct made_dose made = plain;
    struct rtdose dose = read_good(&made, &report);
    assert_int_equal(dose.values->type, VOXEL_U16);
    assert_dose_at(&dose, 10 + 5 * 3, 20 + 2 * 1, 30 + 3 * 2, 0.5 * 213); /* rows are 2 mm apart, columns 5 */
    rtdose_finish(&dose);
    made.offsets = "0\\-3\\-6";
    dose = read_good(&made, &report);
    assert_dose_at(&dose, 10 + 5 * 3, 20 + 2 * 1, 30 - 3 * 2, 0.5 * 213);
    rtdose_finish(&dose);
    made.offsets = "30\\33\\36"; /* z of each plane */
    dose = read_good(&made, &report);
    assert_dose_at(&dose, 10, 20 + 2 * 2, 33, 0.5 * 120);
    rtdose_finish(&dose);
    made.offsets = "30\\27\\24";
    dose = read_good(&made, &report);
    assert_dose_at(&dose, 10, 20 + 2 * 2, 27, 0.5 * 120);
    rtdose_finish(&dose);
    made.orientation = "-1\\0\\0\\0\\1\\0"; /* normal downward: relative offsets descend, absolute ones do not change */
    made.offsets = "0\\3\\6";
    dose = read_good(&made, &report);
    assert_dose_at(&dose, 10 - 5 * 3, 20, 27, 0.5 * 103);
    rtdose_finish(&dose);
    made.offsets = "30\\33\\36";
    dose = read_good(&made, &report);
    assert_dose_at(&dose, 10 - 5 * 3, 20, 33, 0.5 * 103);
    rtdose_finish(&dose);
    made = plain;
    made.orientation = "0\\1\\0\\0\\0\\-1"; /* sagittal, head up: rows run posterior, columns inferior, frames to the
                                               patient's right */
    dose = read_good(&made, &report);
    assert_dose_at(&dose, 10 - 3 * 2, 20 + 5 * 3, 30 - 2 * 1, 0.5 * 213);
    rtdose_finish(&dose);
    assert_int_equal(report.n_lines, 0);
    made = plain;
    made.bits = 32;
    made.scaling = "0.001";
    dose = read_good(&made, &report);
    assert_int_equal(dose.values->type, VOXEL_F32);
    assert_dose_at(&dose, 10, 20, 36, 200);
    assert_close(dose.values->high, 223, 1e-4);
    rtdose_finish(&dose);
}

static void uneven_frames_are_interpolated_and_said(void **state)
{
    (void)state;
    struct report report = { 0 };
    struct made_dose made = plain;
    made.offsets = "0\\2\\8";
    struct rtdose dose = read_good(&made, &report);
    assert_true(report_has(&report, "dose.offsets-uneven"));
    assert_int_equal(dose.values->grid.size[2], 5);
    assert_dose_at(&dose, 10, 20, 32, 50);            /* a frame: 100 stored */
    assert_dose_at(&dose, 10, 20, 34, 50 + 50 / 3.0); /* a third of the way to 200 stored */
    assert_dose_at(&dose, 10, 20, 38, 100);
    rtdose_finish(&dose);
    report_finish(&report);
    made.offsets = "7\\9\\11";
    dose = read_good(&made, &report);
    assert_true(report_has(&report, "dose.offsets-doubtful"));
    assert_dose_at(&dose, 10, 20, 32, 50);
    rtdose_finish(&dose);
    report_finish(&report);
    made.n_frames = 1;
    made.offsets = NULL;
    dose = read_good(&made, &report);
    assert_true(report_has(&report, "dose.single-plane"));
    rtdose_finish(&dose);
    report_finish(&report);
}

static void frames_beyond_the_declared_ones_are_said(void **state)
{
    (void)state;
    for (uint32_t n_surplus = 0; n_surplus < 3; n_surplus++) {
        struct report report = { 0 };
        struct made_dose made = plain;
        made.n_surplus = n_surplus;
        struct rtdose read = read_good(&made, &report);
        assert_int_equal(read.values->grid.size[2], 3);
        size_t n = 0;
        for (size_t i = 0; i < report.n_lines; i++)
            n += strcmp(report.lines[i].code, "dicom.surplus-pixels") == 0;
        assert_int_equal(n, n_surplus > 0);
        rtdose_finish(&read);
        report_finish(&report);
    }
}

static void what_is_no_dose_is_refused_with_a_sentence(void **state)
{
    (void)state;
    struct {
        struct made_dose made;
        const char *words;
    } cases[] = { { plain, "Dose Grid Scaling (3004,000e)" },
                  { plain, "expected a number above 0" },
                  { plain, "value 1 is nan" },
                  { plain, "expected two unit vectors" },
                  { plain, "has 2 values, expected 3" },
                  { plain, "frame 3 is 0 mm" },
                  { plain, "expected frames that go one way" },
                  { plain, "is no number of a patient" },
                  { plain, "expected 16 or 32" },
                  { plain, "has 0 values, expected 3" },
                  { plain, "spacing 0 mm" },
                  { plain, "even planes; the limit is 4096" } };
    cases[0].made.scaling = NULL;
    cases[1].made.scaling = "-1";
    cases[2].made.position = "x\\0\\0";
    cases[3].made.orientation = "1\\0\\0\\1\\0\\0";
    cases[4].made.offsets = "0\\3";
    cases[5].made.offsets = "0\\3\\3";
    cases[6].made.offsets = "0\\3\\1";
    cases[7].made.offsets = "0\\3\\1e9";
    cases[8].made.bits = 8;
    cases[9].made.position = NULL;
    cases[10].made.spacing = "0\\0";
    cases[11].made.offsets = "0\\0.001\\1000";
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct rtdose dose;
        struct error err = { 0 };
        if (read_dose(&cases[i].made, &dose, NULL, &err))
            fail_msg("case %zu was read", i);
        if (!strstr(err.text, cases[i].words))
            fail_msg("case %zu says: %s", i, err.text);
    }
}

static void descriptions_name_components(void **state)
{
    (void)state;
    const struct {
        const char *text;
        int quantity; /* -1: none */
        double ppm;
        bool is_stated;
    } cases[] = { { "BNCT:boron;ppm=1", DOSE_BORON, 1, true },
                  { "BNCT:gamma", DOSE_GAMMA, NAN, true },
                  { "BNCT:fast; note=x ;ppm=2", DOSE_FAST, 2, true },
                  { "BNCT:sugar", -1, NAN, false },
                  { "B-10 dose (15.5 ppm)", DOSE_BORON, 15.5, false },
                  { "10B", DOSE_BORON, NAN, false },
                  { "Boron neutron capture", DOSE_BORON, NAN, false },
                  { "N-14", DOSE_NITROGEN, NAN, false },
                  { "Thermal neutron dose", DOSE_NITROGEN, NAN, false },
                  { "Fast Neutrons", DOSE_FAST, NAN, false },
                  { "proton recoil", DOSE_FAST, NAN, false },
                  { "PHOTON", DOSE_GAMMA, NAN, false },
                  { "gamma and boron", -1, NAN, false },
                  { "Total", DOSE_TOTAL, NAN, false },
                  { "Breakfast", -1, NAN, false },
                  { "", -1, NAN, false } };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        enum dose_quantity quantity;
        double ppm;
        bool is_stated;
        bool is_found = rtdose_component_from_text(cases[i].text, &quantity, &ppm, &is_stated);
        if (is_found != (cases[i].quantity >= 0))
            fail_msg("\"%s\"", cases[i].text);
        if (!is_found)
            continue;
        assert_int_equal(quantity, cases[i].quantity);
        assert_int_equal(is_stated, cases[i].is_stated);
        assert_true(isnan(cases[i].ppm) ? isnan(ppm) : ppm == cases[i].ppm);
    }
}

static const char *name_of_beam(void *context, int64_t number)
{
    (void)context;
    return number == 1 ? "Front" : NULL;
}

static size_t group(const struct made_dose *made, size_t n, struct dose *doses, struct report *report)
{
    struct rtdose objects[8];
    for (size_t i = 0; i < n; i++)
        objects[i] = read_good(&made[i], NULL);
    return rtdose_group(objects, n, name_of_beam, NULL, "", doses, NULL, 8, report);
}

static void what_is_said_of_a_dose_names_its_own_file(void **state)
{
    (void)state;
    struct made_dose made[2] = { plain, plain };
    made[1].type = "ERROR";
    struct report report = { 0 };
    struct dose doses[8];
    struct rtdose objects[2] = { read_good(&made[0], NULL), read_good(&made[1], NULL) };
    objects[0].where = "a.dcm";
    objects[1].where = "b.dcm";
    assert_int_equal(rtdose_group(objects, 2, NULL, NULL, "a.dcm", doses, NULL, 8, &report), 2);
    for (size_t i = 0; i < report.n_lines; i++)
        if (strcmp(report.lines[i].code, "dose.type") == 0)
            assert_string_equal(report.lines[i].where, "b.dcm");
    assert_true(report_has(&report, "dose.type"));
    dose_finish(&doses[0]);
    dose_finish(&doses[1]);
    report_finish(&report);
}

static void components_that_agree_become_one_dose(void **state)
{
    (void)state;
    struct made_dose made[5] = { plain, plain, plain, plain, plain };
    made[0].comment = "BNCT:boron;ppm=10";
    made[1].comment = "BNCT:nitrogen";
    made[2].comment = "BNCT:gamma";
    made[2].summation = "FRACTION"; /* does not agree */
    made[3].type = "EFFECTIVE";
    made[3].description = "Weighted";
    made[4].is_zero = true;
    struct report report = { 0 };
    struct dose doses[8];
    assert_int_equal(group(made, 5, doses, &report), 3);
    assert_int_equal(doses[0].n_components, 2);
    assert_int_equal(doses[0].components[0].quantity, DOSE_BORON);
    assert_true(doses[0].components[0].is_per_ppm);
    assert_close(volume_value(doses[0].components[0].values, 3, 1, 2), 213 * 0.5 / 10, 1e-9);
    assert_int_equal(doses[0].components[1].quantity, DOSE_NITROGEN);
    assert_string_equal(doses[0].id, "BNCT");
    assert_string_equal(doses[0].per, "plan");
    assert_string_equal(doses[0].unit, "Gy");
    assert_int_equal(doses[1].components[0].quantity, DOSE_GAMMA);
    assert_string_equal(doses[1].id, "BNCT (2)");
    assert_string_equal(doses[1].per, "fraction");
    assert_int_equal(doses[2].components[0].quantity, DOSE_WEIGHTED_TOTAL);
    assert_string_equal(doses[2].id, "Weighted");
    assert_true(report_has(&report, "dose.all-zero") && report_has(&report, "dose.components") &&
                report_has(&report, "dose.per-ppm"));
    for (int i = 0; i < 3; i++)
        dose_finish(&doses[i]);
    report_finish(&report);
}

static void a_word_alone_makes_no_component_and_beams_are_not_added(void **state)
{
    (void)state;
    struct made_dose made[3] = { plain, plain, plain };
    for (int i = 0; i < 3; i++) {
        made[i].description = "6 MV photons";
        made[i].summation = "BEAM";
        made[i].beam = i < 2 ? 1 : 2;
    }
    struct report report = { 0 };
    struct dose doses[8];
    assert_int_equal(group(made, 3, doses, &report), 3);
    assert_string_equal(doses[0].id, "6 MV photons, Front");
    assert_string_equal(doses[1].id, "6 MV photons, Front (2)");
    assert_string_equal(doses[2].id, "6 MV photons, beam 2");
    for (int i = 0; i < 3; i++) {
        assert_int_equal(doses[i].n_components, 1);
        assert_int_equal(doses[i].components[0].quantity, DOSE_TOTAL);
        assert_string_equal(doses[i].per, "beam");
        dose_finish(&doses[i]);
    }
    assert_true(report_has(&report, "dose.not-summed"));
    report_finish(&report);
    made[0].description = "Boron";
    made[1].description = "Photons";
    assert_int_equal(group(made, 2, doses, NULL), 1); /* words for two components, same beam */
    assert_int_equal(doses[0].n_components, 2);
    dose_finish(&doses[0]);
}

/* A photon plan and a neutron boost, whose words are those of gamma and fast dose, stay two doses and a question; with
 * boron on the same grid words join, on another grid they do not. */
static void words_join_only_with_boron_or_nitrogen_and_on_one_grid(void **state)
{
    (void)state;
    struct made_dose made[3] = { plain, plain, plain };
    struct report report = { 0 };
    struct dose doses[8];
    made[0].description = "Photon plan";
    made[1].description = "Neutron boost";
    size_t n = group(made, 2, doses, &report);
    assert_int_equal(n, 2);
    for (size_t i = 0; i < n; i++) {
        assert_int_equal(doses[i].components[0].quantity, DOSE_TOTAL);
        dose_finish(&doses[i]);
    }
    assert_non_null(strstr(report_said(&report, "dose.words-not-joined"), "Neutron boost"));
    report_finish(&report);
    made[0].description = "ホウ素線量";
    made[1].description = "γ線";
    made[2].description = "速中性子";
    n = group(made, 3, doses, &report);
    assert_int_equal(n, 1);
    assert_int_equal(doses[0].n_components, 3);
    assert_false(report_has(&report, "dose.words-not-joined"));
    assert_non_null(strstr(report_said(&report, "dose.components"), "plan.json"));
    dose_finish(&doses[0]);
    report_finish(&report);
    made[1].spacing = "2\\2";
    n = group(made, 2, doses, &report);
    assert_int_equal(n, 2);
    assert_non_null(strstr(report_said(&report, "dose.words-not-joined"), "different grids"));
    for (size_t i = 0; i < n; i++)
        dose_finish(&doses[i]);
    report_finish(&report);
}

static int32_t dose_value(uint32_t x, uint32_t y)
{
    return (int32_t)(100 * y + 10 * x);
}
static int32_t next_dose_value(uint32_t x, uint32_t y)
{
    return dose_value(x, y) + 1000;
}

static void put_fragment(struct made_dicom *made, const uint8_t *bytes, size_t n)
{
    made_head(made, TAG(0xFFFE, 0xE000), "", (uint32_t)n);
    made_raw(made, bytes, n);
}

/* Two frames with different values, each in two fragments, without an offset table. */
static void a_dose_in_jpeg_2000_keeps_its_frames_apart_and_says_loss_and_other_bits(void **state)
{
    (void)state;
    for (int way = 0; way < 3; way++) { /* correct; lossy; other bits */
        const struct made_j2k like = { 4, 3, way == 2 ? 12 : 16, false, way == 1, false, 0 };
        struct made_dose said = plain;
        struct made_dicom made = { 0 };
        said.n_frames = 2;
        said.offsets = "0\\3";
        said.syntax = "1.2.840.10008.1.2.4.91";
        put_dose(&made, &said);
        made.size -= 12 + 2 * 3 * 4 * 2; /* without its pixels */
        made_head(&made, TAG(0x7FE0, 0x0010), "OB", UINT32_MAX);
        made_head(&made, TAG(0xFFFE, 0xE000), "", 0);
        for (int f = 0; f < 2; f++) {
            size_t size;
            uint8_t *bytes = made_j2k_bytes(&like, f ? next_dose_value : dose_value, &size);
            put_fragment(&made, bytes, 64);
            bytes = realloc(bytes, size + 1);
            bytes[size] = 0;
            put_fragment(&made, bytes + 64, size + size % 2 - 64);
            free(bytes);
        }
        made_sequence_end(&made);
        struct report report = { 0 };
        struct error err = { 0 };
        struct rtdose dose;
        struct rt_file file = rt_file_of(&made);
        if (!rtdose_read(file.file, "dose.dcm", &dose, &report, &err))
            fail_msg("%s", err.text);
        for (uint32_t k = 0; k < 2; k++)
            for (uint32_t y = 0; y < 3; y++)
                for (uint32_t x = 0; x < 4; x++)
                    assert_close(volume_value(dose.values, x, y, k),
                                 0.5 * (k ? next_dose_value(x, y) : dose_value(x, y)), way == 1 ? 2 : 1e-9);
        assert_int_equal(report_has(&report, "image.lossy"), way == 1);
        assert_int_equal(report_has(&report, "image.coded-otherwise"), way == 2);
        if (way == 1)
            assert_non_null(strstr(report_said(&report, "image.lossy"), "2 of 2 frames were compressed with loss"));
        if (way == 2)
            assert_non_null(
                strstr(report_said(&report, "image.coded-otherwise"), "2 of 2 frames holds values of 12 bits"));
        rtdose_finish(&dose);
        rt_file_close(&file);
        report_finish(&report);
        made_finish(&made);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_lie_where_rows_columns_and_offsets_put_them),
        cmocka_unit_test(a_dose_in_jpeg_2000_keeps_its_frames_apart_and_says_loss_and_other_bits),
        cmocka_unit_test(uneven_frames_are_interpolated_and_said),
        cmocka_unit_test(frames_beyond_the_declared_ones_are_said),
        cmocka_unit_test(what_is_no_dose_is_refused_with_a_sentence),
        cmocka_unit_test(descriptions_name_components),
        cmocka_unit_test(what_is_said_of_a_dose_names_its_own_file),
        cmocka_unit_test(components_that_agree_become_one_dose),
        cmocka_unit_test(a_word_alone_makes_no_component_and_beams_are_not_added),
        cmocka_unit_test(words_join_only_with_boron_or_nitrogen_and_on_one_grid),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
