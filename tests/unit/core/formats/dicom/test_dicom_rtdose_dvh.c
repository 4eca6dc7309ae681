/* Histograms that an RT Dose object carries: their figures, and those that are left out. */
#include "core/formats/dicom/dicom_rtdose.h"
#include "tests/check.h"
#include "tests/unit/made_dose.h"
#include "tests/unit/plan_help.h"

#define TAG DICOM_TAG

struct item {
    int roi;
    const char *contribution, *units, *type, *scaling, *volume_units, *data, *low, *mean, *high;
};

static void put_item(struct made_dicom *made, const struct item *item)
{
    char number[16];
    snprintf(number, sizeof number, "%d", item->roi);
    made_item(made);
    made_text(made, TAG(0x3004, 0x0001), "CS", item->type);
    made_text(made, TAG(0x3004, 0x0002), "CS", item->units);
    made_text(made, TAG(0x3004, 0x0052), "DS", item->scaling);
    made_text(made, TAG(0x3004, 0x0054), "CS", item->volume_units);
    if (item->data)
        made_text(made, TAG(0x3004, 0x0058), "DS", item->data);
    made_sequence(made, TAG(0x3004, 0x0060));
    made_item(made);
    made_text(made, TAG(0x3004, 0x0062), "CS", item->contribution);
    made_text(made, TAG(0x3006, 0x0084), "IS", number);
    made_item_end(made);
    made_sequence_end(made);
    if (item->low)
        made_text(made, TAG(0x3004, 0x0070), "DS", item->low);
    if (item->high)
        made_text(made, TAG(0x3004, 0x0072), "DS", item->high);
    if (item->mean)
        made_text(made, TAG(0x3004, 0x0074), "DS", item->mean);
    made_item_end(made);
}

static void stored_histograms_give_figures_of_their_regions(void **state)
{
    static const struct item items[] = {
        { 7, "INCLUDED", "GY", "CUMULATIVE", "1", "CM3", "1\\10", "0.25", "1.125", "2" },
        /* 12 cm3: 4 from 0 to 1 Gy, 8 from 1 to 2: mean (4 0.5 + 8 1.5) / 12 */
        { 3, "INCLUDED", "GY", "CUMULATIVE", "0.5", "CM3", "2\\12\\2\\8", NULL, NULL, "2" },
        { 4, "INCLUDED", "GY", "DIFFERENTIAL", "1", "PERCENT", "1\\25\\1\\75", NULL, NULL, NULL }, /* 1.25 */
        { 5, "EXCLUDED", "GY", "CUMULATIVE", "1", "CM3", "1\\10", "0", "1", "2" },
        { 6, "INCLUDED", "RELATIVE", "CUMULATIVE", "1", "CM3", "1\\10", "0", "1", "2" },
        { 8, "INCLUDED", "GY", "NATURAL", "1", "CM3", "1\\10", NULL, NULL, NULL },
        { 9, "INCLUDED", "GY", "CUMULATIVE", "1", "CM3", "1\\10\\1\\11", NULL, NULL, NULL }, /* grows */
    };
    (void)state;
    struct made_dicom made;
    struct report report = { 0 };
    struct error err = { 0 };
    struct rtdose read, objects[1];
    struct dose doses[1];
    made_dose_begin(&made, 1);
    made_sequence(&made, TAG(0x3004, 0x0050));
    for (size_t i = 0; i < sizeof items / sizeof *items; i++)
        put_item(&made, &items[i]);
    made_sequence_end(&made);
    made_dose_end(&made, 1);
    struct dicom_file *file = dicom_file_parse(made.data, made.size, "made", DICOM_WHOLE, &err);
    assert_string_equal(err.text, "");
    if (!rtdose_read(file, "made", &read, &report, &err))
        fail_msg("%s", err.text);
    assert_int_equal(read.n_stated, 3);
    assert_int_equal(read.stated[0].number, 7);
    assert_close(read.stated[0].low, 0.25, 0);
    assert_close(read.stated[0].mean, 1.125, 0);
    assert_close(read.stated[0].volume_cm3, 10, 0);
    assert_int_equal(read.stated[1].number, 3);
    assert_close(read.stated[1].mean, 14.0 / 12, 1e-12);
    assert_close(read.stated[1].volume_cm3, 12, 0);
    assert_true(isnan(read.stated[1].low));
    assert_close(read.stated[2].mean, 1.25, 1e-12);
    assert_true(isnan(read.stated[2].volume_cm3));
    assert_true(report_has(&report, "dose.histograms-left-out"));
    objects[0] = read;
    assert_int_equal(rtdose_group(objects, 1, NULL, NULL, "made", doses, NULL, 1, &report), 1);
    assert_int_equal(doses[0].n_stated, 3);
    dose_finish(&doses[0]);
    report_finish(&report);
    dicom_file_destroy(file);
    made_finish(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(stored_histograms_give_figures_of_their_regions) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
