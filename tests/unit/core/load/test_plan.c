/* Plans opened from folders made here: hierarchy, layers, refusals, cancelling. */
#include <sys/stat.h>
#include <unistd.h>

#include "core/load/load.h"
#include "core/load/summary.h"
#include "core/plan/plan.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/nifti_bytes.h"
#include "tests/unit/plan_help.h"

/* 8 x 8 x 8 voxels of 10 mm, LPS origin 0: nested boxes 1 (2..6), 2 (3..5), 3 (4) as bytes. */
static struct nifti_bytes nested_boxes(void)
{
    const double rows[3][4] = { { -10, 0, 0, 0 }, { 0, -10, 0, 0 }, { 0, 0, 10, 0 } };
    struct nifti_bytes file = nifti_bytes_make(8, 8, 8, 2, 8, 512, false);
    nifti_put_sform(&file, rows);
    for (int k = 0; k < 8; k++)
        for (int j = 0; j < 8; j++)
            for (int i = 0; i < 8; i++) {
                int far = abs(i - 4) > abs(j - 4) ? abs(i - 4) : abs(j - 4);
                far = far > abs(k - 4) ? far : abs(k - 4);
                file.data[352 + (k * 8 + j) * 8 + i] = (uint8_t)(far <= 2 ? 3 - far : 0);
            }
    return file;
}

#define PLAN(parts) "{\"format\":\"beamroom-plan\",\"version\":1," parts "}"

/* A folder with the boxes in a file of this name. */
static void make_folder_of_boxes(char folder[256], const char *name)
{
    folder_make(folder);
    struct nifti_bytes file = nested_boxes();
    folder_put(folder, name, file.data, file.size);
    nifti_bytes_free(&file);
}

static void a_plan_without_a_tree_gets_one_from_what_encloses_what(void **state)
{
    (void)state;
    char folder[256];
    struct error err;
    make_folder_of_boxes(folder, "labels.nii");
    folder_put_text(
        folder, "names.json",
        "{\"labels\":[{\"value\":1,\"name\":\"Skin\",\"color\":\"#ff8000\"},{\"value\":2,\"name\":\"Skull\"},"
        "{\"value\":3,\"name\":\"Brain\",\"color\":[0,0.5,1]},{\"value\":9,\"name\":\"none\"}]}");
    folder_put_text(
        folder, "plan.json",
        "{\"format\":\"beamroom-plan\",\"version\":1,\"name\":\"boxes\",\"phantom\":true,\"regions\":[{\"path\":\"labels.nii\","
        "\"names\":\"names.json\"}],\"colour\":1}");
    struct plan *plan = plan_of_folder(folder, &err);
    assert_string_equal(err.text, "");
    assert_true(plan->is_phantom);
    assert_int_equal(plan->regions.n_regions, 3);
    assert_int_equal(plan->regions.hierarchy, HIERARCHY_DERIVED);
    assert_string_equal(parent_of(plan, "brain"), "skull");
    assert_string_equal(parent_of(plan, "skull"), "skin");
    assert_string_equal(parent_of(plan, "skin"), "");
    const struct region *skin = region_of(plan, "skin"), *skull = region_of(plan, "skull");
    assert_int_equal(skin->n_voxels, 5 * 5 * 5 - 3 * 3 * 3);
    assert_close(skull->volume_cm3, 26, 1e-9); /* 27 - 1 voxels of 1 cm3 */
    assert_int_equal(skull->low_ijk[0], 3);
    assert_int_equal(skull->high_ijk[2], 5);
    assert_close(skull->centre_lps_mm.y, 40, 1e-9);
    assert_false(skin->touches_edge);
    assert_true(skin->has_file_color);
    assert_int_equal(skin->rgb[0], 255);
    assert_int_equal(skin->rgb[1], 128);
    assert_int_equal(region_of(plan, "brain")->rgb[1], 128);
    assert_true(report_has(&plan->report, "hierarchy.derived"));
    assert_true(report_has(&plan->report, "region.unused-names"));
    assert_true(report_has(&plan->report, "plan.unknown-key"));
    assert_close(plan->bounds_lps_mm.low.x, 15, 1e-9);
    assert_close(plan->bounds_lps_mm.high.z, 65, 1e-9);

    struct plan_probe probe;
    plan_probe(plan, vec3(40, 40, 40), &probe);
    assert_int_equal(probe.n_regions, 3);
    assert_string_equal(plan->regions.regions[probe.regions[0]].id, "brain");
    assert_string_equal(plan->regions.regions[probe.regions[2]].id, "skin");
    plan_probe(plan, vec3(54, 40, 40), &probe);
    assert_int_equal(probe.n_regions, 2);
    plan_probe(plan, vec3(0, 0, 0), &probe);
    assert_int_equal(probe.n_regions, 0);
    plan_probe(plan, vec3(NAN, 0, 0), &probe);
    assert_int_equal(probe.n_regions, 0);
    plan_destroy(plan);
    folder_remove(folder);
}

static void a_tree_from_the_plan_wins_and_unknown_names_and_circles_are_reported(void **state)
{
    (void)state;
    char folder[256];
    struct error err;
    make_folder_of_boxes(folder, "labels.nii");
    folder_put_text(folder, "plan.json",
                    "{\"format\":\"beamroom-plan\",\"version\":1,\"regions\":[{\"path\":\"labels.nii\"}],"
                    "\"hierarchy\":{\"label 3\":[\"label 1\",\"nobody\"],\"label 1\":[\"label 3\",\"label 2\"]}}");
    struct plan *plan = plan_of_folder(folder, &err);
    assert_string_equal(err.text, "");
    assert_int_equal(plan->regions.hierarchy, HIERARCHY_FILE);
    assert_string_equal(parent_of(plan, "label-1"), "label-3");
    assert_string_equal(parent_of(plan, "label-2"), "label-1");
    assert_string_equal(parent_of(plan, "label-3"), "");
    assert_true(report_has(&plan->report, "hierarchy.cycle"));
    assert_true(report_has(&plan->report, "hierarchy.unknown-name"));
    assert_true(report_has(&plan->report, "region.unnamed"));
    plan_destroy(plan);
    folder_remove(folder);
}

/* A mask of one 4 x 1 x 1 row. */
static void put_row(const char *folder, const char *name, const uint8_t row[4], double step)
{
    const double rows[3][4] = { { step, 0, 0, 0 }, { 0, 1, 0, 0 }, { 0, 0, 1, 0 } };
    struct nifti_bytes file = nifti_bytes_make(4, 1, 1, 2, 8, 4, false);
    nifti_put_sform(&file, rows);
    memcpy(file.data + 352, row, 4);
    folder_put(folder, name, file.data, file.size);
    nifti_bytes_free(&file);
}

static void masks_share_a_layer_until_they_overlap_or_their_grids_differ(void **state)
{
    (void)state;
    char folder[256];
    struct error err;
    folder_make(folder);
    put_row(folder, "a.nii", (const uint8_t[4]){ 1, 0, 0, 0 }, 1);
    put_row(folder, "b.nii", (const uint8_t[4]){ 0, 1, 1, 0 }, 1);
    put_row(folder, "c.nii", (const uint8_t[4]){ 0, 0, 1, 1 }, 1);
    put_row(folder, "d.nii", (const uint8_t[4]){ 0, 0, 0, 1 }, 2);
    put_row(folder, "e.nii", (const uint8_t[4]){ 0, 0, 0, 0 }, 1);
    folder_put_text(
        folder, "plan.json",
        "{\"format\":\"beamroom-plan\",\"version\":1,\"regions\":[{\"path\":\"a.nii\",\"name\":\"A\"},{\"path\":\"b.nii\",\"name\":"
        "\"B\"},{\"path\":\"c.nii\",\"name\":\"C\"},{\"path\":\"d.nii\",\"name\":\"D\"},{\"path\":\"e.nii\",\"name\":\"A\"}]}");
    struct plan *plan = plan_of_folder(folder, &err);
    assert_string_equal(err.text, "");
    assert_int_equal(plan->regions.n_layers, 3); /* a with b and e; c; d */
    assert_int_equal(region_of(plan, "b")->n_voxels, 2);
    assert_int_equal(region_of(plan, "c")->n_voxels, 2);
    assert_int_equal(region_of(plan, "a-2")->n_voxels, 0);
    assert_int_not_equal(region_of(plan, "b")->layer, region_of(plan, "c")->layer);
    assert_true(report_has(&plan->report, "region.empty"));
    assert_true(report_has(&plan->report, "region.renamed"));
    plan_destroy(plan);
    folder_remove(folder);
}

static void expect_refused(const char *folder, const char *json, enum error_code code, const char *said)
{
    struct error err;
    folder_put_text(folder, "plan.json", json);
    struct plan *plan = plan_of_folder(folder, &err);
    if (plan || err.code != code || !strstr(err.text, said))
        fail_msg("%s\n  gave %s: %s\n  expected %s with \"%s\"", json, error_word(err.code), err.text, error_word(code),
                 said);
}

static void a_plan_never_leaves_its_folder(void **state)
{
    (void)state;
    char folder[256], outside[256], link[600], target[600];
    folder_make(folder);
    folder_make(outside);
    struct nifti_bytes file = nested_boxes();
    folder_put(outside, "secret.nii", file.data, file.size);
    expect_refused(folder, PLAN("\"images\":[{\"path\":\"/etc/passwd\"}]"), ERROR_RANGE, "images[0].path: /etc/passwd");
    expect_refused(folder, PLAN("\"images\":[{\"path\":\"../x/secret.nii\"}]"), ERROR_RANGE, "\"..\"");
    expect_refused(folder, PLAN("\"images\":[{\"path\":\"a/../../secret.nii\"}]"), ERROR_RANGE, "\"..\"");
    expect_refused(folder, PLAN("\"images\":[{\"path\":\"\"}]"), ERROR_RANGE, "empty");
    expect_refused(folder, PLAN("\"hierarchy\":\"/etc/passwd\""), ERROR_RANGE, "hierarchy");
    snprintf(link, sizeof link, "%s/link.nii", folder);
    snprintf(target, sizeof target, "%s/secret.nii", outside);
    assert_int_equal(symlink(target, link), 0);
    struct error err;
    folder_put_text(folder, "plan.json", PLAN("\"images\":[{\"path\":\"link.nii\"}]"));
    assert_null(plan_of_folder(folder, &err));
    assert_non_null(strstr(err.text, "link.nii"));
    unlink(link);
    folder_put(folder, "inside.nii", file.data, file.size); /* a link that stays inside is fine */
    assert_int_equal(symlink("inside.nii", link), 0);
    struct plan *plan = plan_of_folder(folder, &err);
    assert_string_equal(err.text, "");
    plan_destroy(plan);
    unlink(link);
    assert_int_equal(mkfifo(link, 0600), 0); /* a pipe must not hang the reader */
    assert_null(plan_of_folder(folder, &err));
    nifti_bytes_free(&file);
    folder_remove(folder);
    folder_remove(outside);
}

static void a_plan_that_is_wrong_is_refused_with_the_place(void **state)
{
    (void)state;
    char folder[256];
    make_folder_of_boxes(folder, "a.nii");
    expect_refused(folder, "{\n\"format\": \"beamroom-plan\",\n oops }", ERROR_FORMAT, "plan.json: line 3");
    expect_refused(folder, "[]", ERROR_FORMAT, "expected an object");
    expect_refused(folder, "{\"version\":1}", ERROR_FORMAT, "format");
    expect_refused(folder, "{\"format\":\"beamroom-plan\",\"version\":2}", ERROR_UNSUPPORTED, "version");
    expect_refused(folder, PLAN("\"name\":\"empty\""), ERROR_FORMAT, "one part is required");
    expect_refused(folder, PLAN("\"images\":{}"), ERROR_FORMAT, "images: expected a list");
    expect_refused(folder, PLAN("\"images\":[{\"id\":\"x\"}]"), ERROR_FORMAT, "images[0].path: is missing");
    expect_refused(folder, PLAN("\"images\":[{\"path\":\"b.nii\"}]"), ERROR_NOT_FOUND, "b.nii");
    expect_refused(folder, PLAN("\"images\":[{\"path\":\"a.nii\",\"modality\":4}]"), ERROR_FORMAT,
                   "images[0].modality");
    expect_refused(folder, PLAN("\"regions\":[{\"path\":\"a.nii\",\"name\":\"x\",\"names\":\"y.json\"}]"), ERROR_FORMAT,
                   "not both");
    expect_refused(folder, PLAN("\"doses\":[{\"path\":\"a.nii\",\"quantity\":\"alpha\"}]"), ERROR_RANGE,
                   "doses[0].quantity");
    expect_refused(folder, PLAN("\"doses\":[{\"path\":\"a.nii\",\"quantity\":\"fast\",\"per_ppm\":true}]"), ERROR_RANGE,
                   "per_ppm");
    expect_refused(folder, PLAN("\"doses\":[{\"path\":\"a.nii\",\"quantity\":\"boron\",\"boron_ppm\":1}]"), ERROR_RANGE,
                   "boron_ppm");
    expect_refused(folder, PLAN("\"doses\":[{\"path\":\"a.nii\",\"boron_ppm\":-1}]"), ERROR_RANGE, "boron_ppm");
    expect_refused(folder, PLAN("\"doses\":[{\"path\":\"a.nii\",\"boron_ppm\":1000001}]"), ERROR_RANGE, "0 to 1e6");
    expect_refused(folder, PLAN("\"doses\":[{\"path\":\"a.nii\",\"frame_of_reference\":\"other\"}]"), ERROR_RANGE,
                   "same, unknown or differs");
    expect_refused(folder, PLAN("\"doses\":[{\"components\":[{\"path\":\"a.nii\"},{\"path\":\"a.nii\"}]}]"),
                   ERROR_RANGE, "doses[0].components[1].quantity: is there twice");
    expect_refused(folder,
                   PLAN("\"images\":[{\"path\":\"a.nii\"}],\"beams\":[{\"entry_mm\":[1,2,3],\"target_mm\":[1,2,3]}]"),
                   ERROR_RANGE, "same point");
    expect_refused(folder,
                   PLAN("\"images\":[{\"path\":\"a.nii\"}],\"beams\":[{\"entry_mm\":[1,2],\"target_mm\":[1,2,3]}]"),
                   ERROR_FORMAT, "beams[0].entry_mm");
    expect_refused(folder, PLAN("\"images\":[{\"path\":\"a.nii\"}],\"tracks\":[{\"path\":\"a.pp\",\"unit\":\"m\"}]"),
                   ERROR_RANGE, "tracks[0].unit");
    folder_put_text(folder, "c.dcm", "not one");
    expect_refused(folder, PLAN("\"images\":[{\"path\":\"c.dcm\"}]"), ERROR_UNSUPPORTED,
                   "c.dcm: no DICOM image series");
    struct nifti_bytes file = nested_boxes();
    folder_put(folder, "cut.nii", file.data, 400);
    nifti_bytes_free(&file);
    expect_refused(folder, PLAN("\"images\":[{\"path\":\"cut.nii\"}]"), ERROR_FORMAT, "cut.nii: cut short");
    folder_remove(folder);
}

/* One bad part of a plan.json beside a good image: the image opens, and an error line names the part. */
static void a_part_that_cannot_be_read_is_left_out_and_the_rest_opens(void **state)
{
    (void)state;
    static const struct {
        const char *parts, *where, *said;
    } cases[] = {
        { "\"images\":[{\"path\":\"a.nii\"},{\"path\":\"cut.nii\"}]", "cut.nii", "cut short" },
        { "\"images\":[{\"path\":\"a.nii\"},{\"path\":\"b.nii\"}]", "b.nii", "no such file" },
        { "\"images\":[{\"path\":\"a.nii\"},{\"path\":\"c.dcm\"}]", "c.dcm", "no DICOM image series" },
        { "\"images\":[{\"path\":\"a.nii\"}],\"regions\":[{\"path\":\"cut.nii\"}]", "cut.nii", "cut short" },
        { "\"images\":[{\"path\":\"a.nii\"}],\"regions\":[{\"path\":\"b.nii\",\"name\":\"x\"}]", "b.nii",
          "no such file" },
        { "\"images\":[{\"path\":\"a.nii\"}],\"regions\":[{\"path\":\"a.nii\",\"names\":\"y.json\"}]", "y.json",
          "numbers" },
        { "\"images\":[{\"path\":\"a.nii\"}],\"hierarchy\":\"b.info\"", "b.info", "b.info" },
        { "\"images\":[{\"path\":\"a.nii\"}],\"doses\":[{\"path\":\"cut.nii\"}]", "cut.nii", "cut short" },
        { "\"images\":[{\"path\":\"a.nii\"}],\"doses\":[{\"path\":\"a.nii\",\"mask\":\"cut.nii\"}]", "cut.nii",
          "cut short" },
        { "\"images\":[{\"path\":\"a.nii\"}],\"doses\":[{\"path\":\"a.nii\",\"error\":\"cut.nii\"}]", "cut.nii",
          "cut short" },
        { "\"images\":[{\"path\":\"a.nii\"}],\"doses\":[{\"components\":[{\"path\":\"a.nii\",\"quantity\":\"gamma\"},"
          "{\"path\":\"b.nii\",\"quantity\":\"fast\"}]}]",
          "a.nii", "b.nii" },
        { "\"images\":[{\"path\":\"a.nii\"}],\"beams\":[{\"path\":\"c.dcm\"}]", "c.dcm", "no DICOM treatment plan" },
        { "\"images\":[{\"path\":\"a.nii\"}],\"tracks\":[{\"path\":\"b.pp\"}]", "b.pp", "no such file" },
    };
    char folder[256], json[600];
    make_folder_of_boxes(folder, "a.nii");
    struct nifti_bytes file = nested_boxes();
    folder_put(folder, "cut.nii", file.data, 400);
    nifti_bytes_free(&file);
    folder_put_text(folder, "c.dcm", "not one");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct error err;
        snprintf(json, sizeof json, "{\"format\":\"beamroom-plan\",\"version\":1,%s}", cases[i].parts);
        folder_put_text(folder, "plan.json", json);
        struct plan *plan = plan_of_folder(folder, &err);
        if (!plan)
            fail_msg("%s\n  is refused: %s", json, err.text);
        assert_string_equal(plan->images[0].id, "a");
        bool is_said = false;
        for (size_t l = 0; l < plan->report.n_lines; l++) {
            const struct report_line *line = &plan->report.lines[l];
            is_said |= line->severity == REPORT_ERROR && strcmp(line->where, cases[i].where) == 0 &&
                       strstr(line->sentence, cases[i].said);
        }
        if (!is_said)
            fail_msg("%s\n  no error line about %s with \"%s\"", json, cases[i].where, cases[i].said);
        plan_destroy(plan);
    }
    folder_remove(folder);
}

static void a_dose_in_a_format_not_read_is_left_out_and_said(void **state)
{
    (void)state;
    char folder[256];
    struct error err;
    make_folder_of_boxes(folder, "a.nii");
    folder_put_text(folder, "d.uvh", "not one");
    folder_put_text(
        folder, "plan.json",
        PLAN(
            "\"images\":[{\"path\":\"a.nii\",\"modality\":\"CT\"}],\"doses\":[{\"id\":\"x\",\"path\":\"d.uvh\"},"
            "{\"id\":\"Run 1\",\"unit\":\"Gy\",\"per\":\"fraction\",\"mask\":\"a.nii\",\"components\":[{\"quantity\":\"boron\","
            "\"path\":\"a.nii\",\"per_ppm\":true},{\"quantity\":\"gamma\",\"path\":\"a.nii\"}]}],"
            "\"beams\":[{\"id\":\"B\",\"entry_mm\":[0,0,0],\"target_mm\":[0,0,9],\"aperture_mm\":120},"
            "{\"entry_mm\":[0,0,1],\"target_mm\":[0,0,9]}]"));
    struct plan *plan = plan_of_folder(folder, &err);
    assert_string_equal(err.text, "");
    assert_true(report_has(&plan->report, "dose.unsupported"));
    assert_int_equal(plan->n_doses, 1);
    assert_string_equal(plan->doses[0].id, "run-1");
    assert_int_equal(plan->doses[0].n_components, 2);
    assert_true(plan->doses[0].components[0].is_per_ppm);
    assert_non_null(plan->doses[0].mask);
    assert_string_equal(plan->images[0].id, "a");
    assert_string_equal(plan->images[0].unit, "HU");
    assert_close(plan->images[0].window_width, 400, 0);
    assert_int_equal(plan->n_beams, 2);
    assert_close(plan->beams[0].aperture_mm, 120, 0);
    assert_true(isnan(plan->beams[1].aperture_mm));
    assert_string_equal(plan->beams[1].id, "beam");
    struct plan_probe probe;
    plan_probe(plan, vec3(40, 40, 40), &probe);
    assert_int_equal(probe.n_doses, 2);
    assert_close(probe.doses[1].value, 3, 1e-6);
    assert_true(probe.has_image[0]);
    plan_probe(plan, vec3(0, 0, 0), &probe); /* the mask is 0 there: no dose, but an image */
    assert_int_equal(probe.n_doses, 0);
    assert_true(probe.has_image[0]);
    plan_destroy(plan);
    struct plan_summary summary;
    plan_summarize(folder, &summary);
    assert_true(summary.is_readable);
    assert_string_equal(summary.parts[0], "CT");
    assert_string_equal(summary.parts[1], "2 dose components");
    folder_remove(folder);
}

static void an_image_beside_the_regions_is_reported(void **state)
{
    (void)state;
    char folder[256];
    struct error err;
    folder_make(folder);
    put_row(folder, "mask.nii", (const uint8_t[4]){ 1, 1, 0, 0 }, 1);
    put_row(folder, "near.nii", (const uint8_t[4]){ 1, 2, 3, 4 }, 1);
    put_row(folder, "mirrored.nii", (const uint8_t[4]){ 1, 2, 3, 4 }, -1);
    folder_put_text(folder, "plan.json",
                    PLAN("\"images\":[{\"path\":\"near.nii\"}],\"regions\":[{\"path\":\"mask.nii\",\"name\":\"x\"}]"));
    struct plan *plan = plan_of_folder(folder, &err);
    assert_false(report_has(&plan->report, "geometry.apart"));
    plan_destroy(plan);
    put_row(folder, "mask.nii", (const uint8_t[4]){ 0, 0, 1, 1 }, 1);
    folder_put_text(
        folder, "plan.json",
        PLAN("\"images\":[{\"path\":\"mirrored.nii\"}],\"regions\":[{\"path\":\"mask.nii\",\"name\":\"x\"}]"));
    plan = plan_of_folder(folder, &err);
    assert_true(report_has(&plan->report, "geometry.apart"));
    assert_close(plan->bounds_lps_mm.high.x, -1.5, 1e-9); /* of the region alone: RAS x 1.5 .. 3.5 */
    plan_destroy(plan);
    folder_remove(folder);
}

static void loading_can_be_cancelled(void **state)
{
    (void)state;
    char folder[256];
    make_folder_of_boxes(folder, "a.nii");
    atomic_bool cancel = true;
    struct plan_load_options options = { .progress.cancel = &cancel };
    struct error err = { 0 };
    assert_null(plan_load(folder, "p", &options, &err));
    assert_int_equal(err.code, ERROR_CANCELLED);
    folder_remove(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_plan_without_a_tree_gets_one_from_what_encloses_what),
        cmocka_unit_test(a_tree_from_the_plan_wins_and_unknown_names_and_circles_are_reported),
        cmocka_unit_test(masks_share_a_layer_until_they_overlap_or_their_grids_differ),
        cmocka_unit_test(a_plan_never_leaves_its_folder),
        cmocka_unit_test(a_plan_that_is_wrong_is_refused_with_the_place),
        cmocka_unit_test(a_part_that_cannot_be_read_is_left_out_and_the_rest_opens),
        cmocka_unit_test(a_dose_in_a_format_not_read_is_left_out_and_said),
        cmocka_unit_test(an_image_beside_the_regions_is_reported),
        cmocka_unit_test(loading_can_be_cancelled),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
