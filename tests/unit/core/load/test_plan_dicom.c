/* Plans of made-up DICOM files: what a folder becomes as a whole. */
#include "core/region/contour/contour.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/made_series.h"
#include "tests/unit/plan_help.h"
#include "tests/unit/rt_files.h"

#define TAG DICOM_TAG

static void put_slices(const char *folder, int n, double pitch_mm)
{
    for (int k = 0; k < n; k++) {
        struct made_slice slice = made_slice_defaults;
        char name[32];
        slice.rows = slice.columns = 40;
        slice.spacing[0] = slice.spacing[1] = 2;
        slice.position[2] = pitch_mm * k;
        slice.thickness = pitch_mm;
        slice.number = k + 1;
        slice.base = -1000;
        snprintf(name, sizeof name, "ct%d.dcm", k);
        made_slice_put(folder, name, &slice);
    }
}

/* Boxes of 20 x 30 mm around (39, 40) on n planes each, every region above the one before; region 0 on the first
 * slices, or on n_of_first planes that lie up to there in steps of a tenth of a millimetre. */
static void put_boxes_but_first(const char *folder, int n_regions, int n_planes, double pitch_mm, int n_of_first)
{
    struct made_dicom made;
    made_rt_begin(&made, "1.2.840.10008.5.1.4.1.1.481.3", "RTSTRUCT", NULL);
    made_sequence(&made, TAG(0x3006, 0x0020));
    for (int r = 0; r < n_regions; r++) {
        char name[16];
        snprintf(name, sizeof name, "Box %d", r);
        made_item(&made);
        made_integer(&made, TAG(0x3006, 0x0022), r);
        made_text(&made, TAG(0x3006, 0x0024), "UI", "1.2.9");
        made_text(&made, TAG(0x3006, 0x0026), "LO", name);
        made_item_end(&made);
    }
    made_sequence_end(&made);
    made_sequence(&made, TAG(0x3006, 0x0039));
    for (int r = 0; r < n_regions; r++) {
        made_item(&made);
        made_sequence(&made, TAG(0x3006, 0x0040));
        for (int k = 0; k < (r == 0 && n_of_first > 0 ? n_of_first : n_planes); k++) {
            double z = r == 0 && n_of_first > 0 ? -0.1 * k : pitch_mm * (r * n_planes + k);
            double box[] = { 29, 25, z, 49, 25, z, 49, 55, z, 29, 55, z };
            made_item(&made);
            made_text(&made, TAG(0x3006, 0x0042), "CS", "CLOSED_PLANAR");
            made_integer(&made, TAG(0x3006, 0x0046), 4);
            made_numbers(&made, TAG(0x3006, 0x0050), box, 12);
            made_item_end(&made);
        }
        made_sequence_end(&made);
        made_integer(&made, TAG(0x3006, 0x0084), r);
        made_item_end(&made);
    }
    made_sequence_end(&made);
    made_sequence(&made, TAG(0x3006, 0x0080));
    for (int r = 0; r < n_regions; r++) {
        made_item(&made);
        made_integer(&made, TAG(0x3006, 0x0084), r);
        made_text(&made, TAG(0x3006, 0x00a4), "CS", r == 2 ? "CTV" : r == 1 ? "AVOIDANCE" : "");
        made_item_end(&made);
    }
    made_sequence_end(&made);
    folder_put(folder, "rtstruct.dcm", made.data, made.size);
    made_finish(&made);
}

static void put_boxes(const char *folder, int n_regions, int n_planes, double pitch_mm)
{
    put_boxes_but_first(folder, n_regions, n_planes, pitch_mm, 0);
}

static void a_region_beyond_a_limit_hides_no_other(void **state)
{
    (void)state;
    char folder[256];
    struct error err;
    folder_make(folder);
    put_slices(folder, 9, 3);
    put_boxes_but_first(folder, 2, 3, 3, CONTOUR_MAX_PLANES + 1);
    struct plan *plan = plan_of_folder(folder, &err);
    if (!plan)
        fail_msg("%s", err.text);
    assert_int_equal(plan->regions.n_regions, 1);
    assert_near(region_of(plan, "box-1")->volume_cm3, 20 * 30 * 9 / 1000.0, 0.01);
    assert_string_equal(report_said(&plan->report, "region.contours-refused"),
                        "\"Box 0\" was left out: contours on 8193 planes; the limit is 8192.");
    plan_destroy(plan);
    folder_remove(folder);
}

/* All on one slice, so that each needs a layer of its own. */
static void regions_that_the_plan_has_no_room_for_are_counted(void **state)
{
    (void)state;
    char folder[256];
    struct error err;
    folder_make(folder);
    put_slices(folder, 2, 3);
    put_boxes(folder, 1100, 1, 0);
    struct plan *plan = plan_of_folder(folder, &err);
    if (!plan)
        fail_msg("%s", err.text);
    assert_int_equal(plan->n_images, 1);
    assert_int_equal(plan->regions.n_regions, REGION_MAX_LAYERS);
    bool has_both[2] = { false, false };
    for (size_t i = 0; i < plan->report.n_lines; i++) {
        has_both[0] |= strstr(plan->report.lines[i].sentence, "76 were left out: Box 1024, Box 1025") != NULL;
        has_both[1] |= strstr(plan->report.lines[i].sentence,
                              "no room for 768 regions of this file, the first is \"Box 256\"") != NULL;
    }
    assert_true(has_both[0] && has_both[1]);
    plan_destroy(plan);
    folder_remove(folder);
}

static void regions_drawn_on_slices_that_are_not_there_are_whole(void **state)
{
    (void)state;
    for (int n_slices = 1; n_slices <= 5; n_slices += 4) {
        char folder[256];
        struct error err;
        folder_make(folder);
        put_slices(folder, n_slices, 3);
        put_boxes(folder, 9, 5, 3); /* 45 planes, of which the image has the first 1 or 5 */
        struct plan *plan = plan_of_folder(folder, &err);
        assert_string_equal(err.text, "");
        const struct grid *image = &plan->images[0].volume->grid;
        assert_int_equal(image->size[0], 40);
        assert_int_equal(image->size[1], 40);
        assert_int_equal(image->size[2], n_slices);
        assert_int_equal(plan->regions.n_regions, 9);
        for (int r = 0; r < 9; r++) {
            const struct region *region = &plan->regions.regions[r];
            assert_near(region->volume_cm3, 2.0 * 3.0 * 1.5, 1e-6);
            assert_int_equal(region->is_target, r == 2); /* by its interpreted type */
            assert_close(region->centre_lps_mm.x, 39, 1e-6);
            assert_close(region->centre_lps_mm.y, 40, 1e-6);
            assert_close(region->centre_lps_mm.z, 3 * (5 * r + 2), 1e-6);
        }
        assert_false(report_has(&plan->report, "region.empty"));
        assert_false(report_has(&plan->report, "region.contours-outside"));
        char beginning[80];
        snprintf(beginning, sizeof beginning, "Contours of %d of 9 regions reach beyond the image",
                 n_slices == 1 ? 9 : 8);
        assert_memory_equal(report_said(&plan->report, "region.contours-beyond"), beginning, strlen(beginning));
        plan_destroy(plan);
        folder_remove(folder);
    }
}

static void put_beam(const char *folder, const char *isocentre)
{
    struct made_dicom made;
    made_rt_begin(&made, "1.2.840.10008.5.1.4.1.1.481.5", "RTPLAN", NULL);
    made_sequence(&made, TAG(0x300a, 0x00b0));
    made_item(&made);
    made_text(&made, TAG(0x300a, 0x00b4), "DS", "1000");
    made_text(&made, TAG(0x300a, 0x00c2), "LO", "Front");
    made_sequence(&made, TAG(0x300a, 0x0111));
    made_item(&made);
    made_text(&made, TAG(0x300a, 0x011e), "DS", "0");
    made_text(&made, TAG(0x300a, 0x012c), "DS", isocentre);
    made_item_end(&made);
    made_sequence_end(&made);
    made_item_end(&made);
    made_sequence_end(&made);
    folder_put(folder, "rtplan.dcm", made.data, made.size);
    made_finish(&made);
}

static void an_isocentre_outside_the_image_is_said(void **state)
{
    (void)state;
    static const char *const isocentres[] = { "40\\40\\6", "40\\-40\\6" }; /* the image begins at -1 */
    for (int i = 0; i < 2; i++) {
        char folder[256];
        struct error err;
        folder_make(folder);
        put_slices(folder, 5, 3);
        put_beam(folder, isocentres[i]);
        struct plan *plan = plan_of_folder(folder, &err);
        assert_string_equal(err.text, "");
        assert_int_equal(plan->n_beams, 1);
        assert_int_equal(report_has(&plan->report, "beam.outside"), i == 1);
        if (i == 1)
            assert_non_null(strstr(report_said(&plan->report, "beam.outside"), "39 mm outside"));
        plan_destroy(plan);
        folder_remove(folder);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_isocentre_outside_the_image_is_said),
        cmocka_unit_test(a_region_beyond_a_limit_hides_no_other),
        cmocka_unit_test(regions_that_the_plan_has_no_room_for_are_counted),
        cmocka_unit_test(regions_drawn_on_slices_that_are_not_there_are_whole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
