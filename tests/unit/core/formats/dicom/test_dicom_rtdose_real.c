/* Real RT Doses: the maxima of their planning system; damaged copies. */
#include "core/formats/dicom/dicom_rtdose.h"

#include "core/formats/dicom/dicom_rtplan.h"
#include "core/formats/dicom/dicom_rtstruct.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/plan_help.h"
#include "tests/unit/rt_files.h"

static void the_oncentra_doses_have_their_maxima(void **state)
{
    (void)state;
    char folder[512], path[1024];
    if (!data_path("dicomrt-oncentra-phantom", folder, sizeof folder) || !rt_find(folder, "RP", 0, path, sizeof path))
        skip();
    struct error err = { 0 };
    struct rt_file file = rt_file_open(path);
    struct rtplan *plan = rtplan_read(file.file, "rp.dcm", NULL, &err);
    rt_file_close(&file);
    assert_non_null(plan);
    struct rtdose objects[4];
    for (size_t i = 0; i < 4; i++) {
        assert_true(rt_find(folder, "RD", i, path, sizeof path));
        file = rt_file_open(path);
        if (!rtdose_read(file.file, "rd.dcm", &objects[i], NULL, &err))
            fail_msg("%s", err.text);
        rt_file_close(&file);
        assert_memory_equal(objects[i].values->grid.size, ((uint32_t[]){ 22, 22, 5 }), 12);
        assert_close(objects[i].values->grid.lps_mm_from_ijk.origin.x, -45.006909, 1e-9);
        assert_close(objects[i].values->grid.lps_mm_from_ijk.columns[2].z, 75, 1e-9);
    }
    struct report report = { 0 };
    struct dose doses[8];
    size_t n = rtdose_group(objects, 4, rtplan_beam_name, plan, "", doses, NULL, 8, &report);
    assert_int_equal(n, 3);
    assert_true(report_has(&report, "dose.all-zero") && report_has(&report, "dose.not-summed"));
    const struct {
        const char *id;
        double high;
    } expected[] = { { "Dose for Testplan, B1_photons", 6.252 },
                     { "Dose for Testplan, B2_photons_MLC", 5.527 },
                     { "Dose for Testplan, B3_electrons", 6.042 } };
    for (size_t e = 0; e < 3; e++) {
        size_t at = 0;
        while (at < n && strcmp(doses[at].id, expected[e].id) != 0)
            at++;
        assert_true(at < n);
        assert_close(doses[at].components[0].values->high, expected[e].high, 5e-4);
    }
    for (size_t i = 0; i < n; i++)
        dose_finish(&doses[i]);
    report_finish(&report);
    rtplan_destroy(plan);
}

/* ---- damaged files ---------------------------------------------------------------------------------------------- */

static void read_whatever(const uint8_t *data, size_t size)
{
    struct error err = { 0 };
    struct dicom_file *file = dicom_file_parse(data, size, "x.dcm", DICOM_WHOLE, &err);
    if (!file) {
        assert_true(err.code != ERROR_NONE && err.text[0]);
        return;
    }
    struct report report = { 0 };
    struct rtdose dose;
    if (rtdose_read(file, "x.dcm", &dose, &report, &err))
        rtdose_finish(&dose);
    rtplan_destroy(rtplan_read(file, "x.dcm", &report, &err));
    rtstruct_destroy(rtstruct_read(file, "x.dcm", &report, &err));
    report_finish(&report);
    dicom_file_destroy(file);
}

static void cut_and_flipped_copies_of_real_files_are_read_or_refused(void **state)
{
    (void)state;
    char folder[512], path[1024];
    if (!data_path("dicomrt-oncentra-phantom", folder, sizeof folder))
        skip();
    static const char *const kinds[] = { "RD", "RP", "RS" };
    uint64_t random = 88172645463325252u;
    for (int kind = 0; kind < 3; kind++) {
        assert_true(rt_find(folder, kinds[kind], 0, path, sizeof path));
        struct rt_file real = rt_file_open(path);
        size_t size = real.bytes.size;
        uint8_t *copy = malloc(size);
        assert_non_null(copy);
        for (size_t cut = 0; cut < 60;
             cut++) { /* a buffer of exactly the remaining length, so that reading past its end is detected */
            size_t n = size * cut / 60;
            uint8_t *rest = malloc(n + 1);
            assert_non_null(rest);
            memcpy(rest, real.bytes.data, n);
            read_whatever(rest, n);
            free(rest);
        }
        for (int round = 0; round < 200; round++) {
            memcpy(copy, real.bytes.data, size);
            for (int flip = 0; flip < 1 + round % 8; flip++) {
                random ^= random << 13;
                random ^= random >> 7;
                random ^= random << 17;
                copy[random % size] ^= (uint8_t)(1u << (random >> 32) % 8);
            }
            read_whatever(copy, size);
        }
        free(copy);
        rt_file_close(&real);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_oncentra_doses_have_their_maxima),
        cmocka_unit_test(cut_and_flipped_copies_of_real_files_are_read_or_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
