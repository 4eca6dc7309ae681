/* Registrations between frames of reference: read, applied to every kind of part, and refused where not rigid. */
#include "core/formats/dicom/dicom_registration.h"
#include "core/plan/fit.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/made_parts.h"
#include "tests/unit/plan_help.h"

static const struct made_owner ct = { .id = "1", .name = "Voss^Anna", .study = "1.2.31", .frame = "1.2.41" };
static const struct made_owner mr = { .id = "1", .name = "Voss^Anna", .study = "1.2.31", .frame = "1.2.42" };
static const struct made_owner other = { .id = "2", .name = "Ruf^Bert", .study = "1.2.31", .frame = "1.2.42" };

/* A quarter turn about z, x to y, then a shift: (x, y, z) to (10 - y, 2 + x, 1 + z). */
#define TURN "0\\-1\\0\\10\\1\\0\\0\\2\\0\\0\\1\\1\\0\\0\\0\\1"
/* The inverse: (x, y, z) to (y - 2, 10 - x, z - 1). */
#define TURN_BACK "0\\1\\0\\-2\\-1\\0\\0\\10\\0\\0\\1\\-1\\0\\0\\0\\1"

static struct plan *open_plan(const char *folder)
{
    struct error err = { 0 };
    struct plan *plan = plan_of_folder(folder, &err);
    assert_string_equal(err.text, "");
    return plan;
}

/* A CT of 5 slices; an image, a dose, regions and a beam in the frame of another scan. */
static void put_case(const char *folder, const struct made_owner *of_others)
{
    made_part_images(folder, "ct", &ct, "1.2.51", 5);
    made_part_images(folder, "mr", of_others, "1.2.52", 4);
    made_part_structs(folder, "structs.dcm", of_others, "1.2.61", "1.2.52");
    made_part_plan(folder, "plan.dcm", of_others,
                   &(struct made_part_plan){ .uid = "1.2.71", .has_frame = true, .beams = { "Front" } });
    made_part_dose(folder, "dose.dcm", of_others,
                   &(struct made_part_dose){ .uid = "1.2.81", .plan_uid = "1.2.71", .summation = "PLAN" });
}

static void assert_at(struct vec3 found, double x, double y, double z)
{
    assert_close(found.x, x, 1e-9);
    assert_close(found.y, y, 1e-9);
    assert_close(found.z, z, 1e-9);
}

static void assert_moved(const struct plan *plan)
{
    const struct part_origin *origins[] = { &plan->image_origins[1], &plan->dose_origins[0], &plan->region_origins[0],
                                            &plan->beam_origins[0] };
    for (int i = 0; i < 4; i++) {
        assert_string_equal(origins[i]->frame_uid, "1.2.41");
        assert_true(origins[i]->is_registered);
    }
    assert_false(plan->image_origins[0].is_registered);
    /* voxel (1, 0, 0) of the image was at (2, 0, 0), of the dose at (6, 0, 0) */
    assert_at(affine_point(&plan->images[1].volume->grid.lps_mm_from_ijk, vec3(1, 0, 0)), 10, 4, 1);
    assert_at(affine_point(&plan->doses[0].components[0].values->grid.lps_mm_from_ijk, vec3(1, 0, 0)), 10, 8, 1);
    assert_at(plan->beams[0].target_lps_mm, 10 - 7, 2 + 7, 4); /* was (7, 7, 3) */
    const struct region *box = &plan->regions.regions[0];
    assert_int_equal(box->n_voxels,
                     18); /* 3 x 3 voxels of 2 mm on 2 slices, centred on (6, 6, 4.5) or within a voxel */
    assert_close(box->centre_lps_mm.x, 4, 1.01);
    assert_close(box->centre_lps_mm.y, 8, 1.01);
    assert_close(box->centre_lps_mm.z, 5.5, 1e-9);
    struct fit fit = fit_of(plan, (struct fit_part){ FIT_DOSE, 0 }, (struct fit_part){ FIT_IMAGE, 0 });
    assert_int_equal(fit.relation, FIT_REGISTERED);
    assert_true(report_has(&plan->report, "registration.applied"));
    assert_non_null(strstr(report_said(&plan->report, "registration.applied"), "90 degrees"));
    assert_false(report_has(&plan->report, "geometry.frames-differ"));
}

static void parts_are_brought_into_the_first_images_frame_in_both_directions(void **state)
{
    (void)state;
    for (int is_back = 0; is_back < 2; is_back++) {
        char folder[256];
        folder_make(folder);
        put_case(folder, &mr);
        if (is_back)
            made_part_registration(folder, "reg.dcm", &ct, "1.2.41", "1.2.42", "RIGID", TURN_BACK);
        else
            made_part_registration(folder, "reg.dcm", &ct, "1.2.42", "1.2.41", "RIGID", TURN);
        struct plan *plan = open_plan(folder);
        assert_int_equal(plan->n_registrations, 1);
        assert_moved(plan);
        plan_destroy(plan);
        folder_remove(folder);
    }
}

static void assert_nothing_moved(const struct made_owner *of_others, const char *type, const char *matrix, bool is_said)
{
    char folder[256];
    folder_make(folder);
    put_case(folder, of_others);
    made_part_registration(folder, "reg.dcm", &ct, "1.2.42", "1.2.41", type, matrix);
    struct plan *plan = open_plan(folder);
    assert_at(affine_point(&plan->images[1].volume->grid.lps_mm_from_ijk, vec3(1, 0, 0)), 2, 0, 0);
    assert_at(affine_point(&plan->doses[0].components[0].values->grid.lps_mm_from_ijk, vec3(1, 0, 0)), 6, 0, 0);
    assert_at(plan->beams[0].target_lps_mm, 7, 7, 3);
    assert_string_equal(plan->dose_origins[0].frame_uid, "1.2.42");
    assert_int_equal(report_has(&plan->report, "registration.not-applied"), is_said);
    assert_false(report_has(&plan->report, "registration.applied"));
    assert_true(report_has(&plan->report, "geometry.frames-differ"));
    plan_destroy(plan);
    folder_remove(folder);
}

static void what_is_not_rigid_or_not_a_number_is_not_applied(void **state)
{
    (void)state;
    static const char *const matrices[] = {
        "1.001\\0\\0\\10\\0\\1\\0\\20\\0\\0\\1\\30\\0\\0\\0\\1", /* scaled */
        "-1\\0\\0\\10\\0\\1\\0\\20\\0\\0\\1\\30\\0\\0\\0\\1",    /* mirrored */
        "1\\0.01\\0\\10\\0\\1\\0\\20\\0\\0\\1\\30\\0\\0\\0\\1",  /* sheared */
        "1\\0\\0\\10\\0\\1\\0\\20\\0\\0\\1\\30\\0\\0\\0.1\\1",   /* projective */
        "1\\0\\0\\1e9\\0\\1\\0\\20\\0\\0\\1\\30\\0\\0\\0\\1",    /* far away */
        "0\\0\\0\\0\\0\\0\\0\\0\\0\\0\\0\\0\\0\\0\\0\\0",        "1\\0\\0\\10\\0\\1\\0\\20\\0\\0\\1\\30\\0\\0\\0",
        "1\\0\\0\\x\\0\\1\\0\\20\\0\\0\\1\\30\\0\\0\\0\\1",
    };
    for (size_t i = 0; i < sizeof matrices / sizeof matrices[0]; i++)
        assert_nothing_moved(&mr, "RIGID", matrices[i], true);
    assert_nothing_moved(&mr, "RIGID_SCALE", TURN, true);
    assert_nothing_moved(&mr, "AFFINE", TURN, true);
}

/* Two registrations of the same frames: of one turn in both directions, or one of them 3 mm off. */
static void registrations_that_contradict_each_other_are_not_applied(void **state)
{
    (void)state;
    static const char *const back[] = { TURN_BACK, "0\\1\\0\\-2\\-1\\0\\0\\13\\0\\0\\1\\-1\\0\\0\\0\\1" };
    for (int is_off = 0; is_off < 2; is_off++) {
        char folder[256];
        folder_make(folder);
        put_case(folder, &mr);
        made_part_registration(folder, "a.dcm", &ct, "1.2.42", "1.2.41", "RIGID", TURN);
        made_part_registration(folder, "b.dcm", &ct, "1.2.41", "1.2.42", "RIGID", back[is_off]);
        struct plan *plan = open_plan(folder);
        assert_int_equal(plan->n_registrations, is_off ? 0 : 2);
        assert_int_equal(report_has(&plan->report, "registration.not-applied"), is_off);
        assert_int_equal(report_has(&plan->report, "registration.applied"), !is_off);
        if (is_off) {
            assert_non_null(strstr(report_said(&plan->report, "registration.not-applied"), "differ by up to 3 mm"));
            assert_at(plan->beams[0].target_lps_mm, 7, 7, 3);
            assert_string_equal(plan->dose_origins[0].frame_uid, "1.2.42");
        } else
            assert_moved(plan);
        plan_destroy(plan);
        folder_remove(folder);
    }
}

static void a_registration_moves_no_part_of_another_patient(void **state)
{
    (void)state;
    assert_nothing_moved(&other, "RIGID", TURN, false);
}

static void parts_come_to_the_first_image_of_the_shown_patient(void **state)
{
    (void)state;
    char folder[256];
    struct made_owner stranger = other;
    stranger.frame = "1.2.49";
    folder_make(folder);
    put_case(folder, &mr);                                  /* the treatment plan is of this patient */
    made_part_images(folder, "aa", &stranger, "1.2.50", 9); /* the first image */
    made_part_registration(folder, "reg.dcm", &ct, "1.2.42", "1.2.41", "RIGID", TURN);
    struct plan *plan = open_plan(folder);
    assert_int_equal(plan->n_images, 3);
    assert_string_equal(plan->image_origins[0].frame_uid, "1.2.49");
    assert_string_equal(plan->dose_origins[0].frame_uid, "1.2.41");
    assert_at(affine_point(&plan->doses[0].components[0].values->grid.lps_mm_from_ijk, vec3(1, 0, 0)), 10, 8, 1);
    plan_destroy(plan);
    folder_remove(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parts_are_brought_into_the_first_images_frame_in_both_directions),
        cmocka_unit_test(what_is_not_rigid_or_not_a_number_is_not_applied),
        cmocka_unit_test(registrations_that_contradict_each_other_are_not_applied),
        cmocka_unit_test(a_registration_moves_no_part_of_another_patient),
        cmocka_unit_test(parts_come_to_the_first_image_of_the_shown_patient),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
