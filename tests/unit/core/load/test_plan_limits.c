/* plan.json that names more than a plan holds: what is over a limit is left out and said, or the plan is refused;
 * nothing is written beyond. */
#include "core/plan/plan.h"
#include "tests/check.h"
#include "tests/made_plan.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/made_dose.h"
#include "tests/unit/plan_help.h"

static void put_rtdose(const char *folder, int number, const char *ending)
{
    struct made_dicom made;
    char name[64];
    made_dose(&made, number);
    snprintf(name, sizeof name, "doses/%02d%s", number, ending);
    folder_put(folder, name, made.data, made.size);
    made_finish(&made);
}

static void put_grid(const char *folder, const char *name)
{
    struct grid grid = made_cube_grid(2);
    struct error err = { 0 };
    struct volume *volume = volume_create(&grid, VOXEL_U8, &err);
    assert_non_null(volume);
    memset(volume->voxels, 1, 8);
    folder_put_volume(folder, name, volume);
}

static void a_dose_beyond_the_limit_is_left_out_and_named_whatever_came_before_it(void **state)
{
    (void)state;
    char folder[256];
    struct error err;
    folder_make(folder);
    for (int i = 0; i < PLAN_MAX_DOSES; i++)
        put_rtdose(folder, i, ".dcm");
    put_grid(folder, "last.nii.gz");
    put_grid(folder, "valid.nii.gz");
    folder_put_text(
        folder, "plan.json",
        "{\"format\": \"beamroom-plan\", \"version\": 1, \"doses\": [{\"path\": \"doses\"},"
        "{\"id\": \"one-more\", \"path\": \"last.nii.gz\", \"unit\": \"Gy\", \"per\": \"fraction\", \"mask\": \"valid.nii.gz\"}]}");
    struct plan *plan = plan_of_folder(folder, &err);
    assert_string_equal(err.text, "");
    assert_int_equal(plan->n_doses, PLAN_MAX_DOSES);
    for (size_t i = 0; i < plan->n_doses; i++) {
        assert_int_equal(plan->doses[i].n_components, 1);
        assert_null(plan->doses[i].mask);
    }
    assert_int_equal(plan->n_beams, 0); /* lies behind the doses */
    const struct report_line *line = NULL;
    for (size_t i = 0; i < plan->report.n_lines; i++)
        if (strcmp(plan->report.lines[i].code, "plan.ignored-file") == 0)
            line = &plan->report.lines[i];
    assert_non_null(line);
    assert_int_equal(line->severity, REPORT_WARNING);
    assert_string_equal(line->where, "last.nii.gz");
    assert_string_equal(line->sentence, "More than 16 doses; \"one-more\" was left out.");
    plan_destroy(plan);
    folder_remove(folder);
}

/* The objects of a folder are DICOM by what they hold. Read by their names they would all be the one component of this
 * entry. */
static void doses_of_a_dicom_folder_are_dicom_whatever_their_files_are_called(void **state)
{
    (void)state;
    char folder[256];
    struct error err;
    folder_make(folder);
    put_rtdose(folder, 0, ".dcm");
    put_rtdose(folder, 1, ".nii");
    put_rtdose(folder, 2, ".nrrd");
    folder_put_text(folder, "plan.json",
                    "{\"format\": \"beamroom-plan\", \"version\": 1, \"doses\": [{\"path\": \"doses\"}]}");
    struct plan *plan = plan_of_folder(folder, &err);
    assert_string_equal(err.text, "");
    assert_int_equal(plan->n_doses, 3);
    for (size_t i = 0; i < plan->n_doses; i++)
        assert_close(plan->doses[i].components[0].values->high, 2, 0); /* 4 times the scaling of 0.5 */
    plan_destroy(plan);
    folder_remove(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_dose_beyond_the_limit_is_left_out_and_named_whatever_came_before_it),
        cmocka_unit_test(doses_of_a_dicom_folder_are_dicom_whatever_their_files_are_called),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
