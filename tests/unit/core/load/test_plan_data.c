/* Every folder of real data: it opens, or is refused for the reason written here. Archives are unpacked by tar into a
 * folder of their own. */
#define _GNU_SOURCE
#include <ftw.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/load/load.h"
#include "core/load/write_plan.h"
#include "core/plan/plan.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/oracle.h"
#include "tests/unit/same_plan.h"

/* Expectations of a folder; reason NULL: it opens with these numbers. */
struct expected {
    const char *name, *reason;
    size_t n_images, n_regions, n_doses, n_beams;
};

static const struct expected folders[] = {
    { "ct-totalseg", NULL, 1, 41, 0, 0 },
    { "dicom-head-phantom", NULL, 1, 0, 0, 0 },
    { "dicom-mr-head", NULL, 1, 0, 0, 0 },
    { "dicom-transfer-syntaxes", NULL, 2, 0, 0, 0 }, /* the lossless slice, and the lossy one that derives from it */
    { "dicomrt-lung-phantom", NULL, 1, 3, 0, 0 },
    { "dicomrt-oncentra-phantom", NULL, 1, 7, 3, 3 }, /* the fourth dose is all zero */
    { "dicomrt-plans", NULL, 0, 0, 0, 12 },
    { "dicomrt-sts001", NULL, 3, 6, 0, 0 }, /* three structure sets, three reference masks */
    { "eclipse-ent-dose", NULL, 0, 16, 1, 0 },
    { "gbm-brats2013", NULL, 2, 5, 0, 0 },
    { "glioma-tcga-du7294", NULL, 2, 4, 0, 0 },
    { "head-colin27", NULL, 1, 116, 0, 0 },
    { "hostile", NULL, 0, 0, 1, 0 }, /* rtdose_1frame.dcm is whole; another object only says that it has its UID */
    { "hostile/empty_dose", "is 0 everywhere", 0, 0, 0, 0 },
    { "hostile-dicom", "", 0, 0, 0, 0 },
    { "matrad-phantoms", "no plan itself, but the folder BOXPHANTOM in it is one", 0, 0, 0, 0 },
    { "matrad-phantoms/BOXPHANTOM", NULL, 1, 2, 0, 0 },
    { "matrad-phantoms/PHANTOM_control_350_RealLung", NULL, 1, 3, 0, 0 },
    { "mr-tumour-nrrd", NULL, 1, 1, 0, 0 },
    { "openkbp-pt99", NULL, 1, 10, 1, 0 },
    { "sera-head", NULL, 1, 3, 2, 1 },
    { "sera-st", NULL, 1, 3, 0, 0 },
    { "tracks-and-beams", "no file in the folder is an image", 0, 0, 0, 0 },
    { "trip98-tst003", "no file in the folder is an image", 0, 0, 0, 0 },
};
enum { N_FOLDERS = sizeof folders / sizeof folders[0] };

static char unpacked[256];
static bool has_no_unpacker; /* asked once: the copy takes its time */
enum { UNPACKER_MISSING = 1 };

static int unpack_one(const char *path, const struct stat *about, int kind, struct FTW *where)
{
    (void)about;
    (void)kind;
    (void)where;
    const char *ending = strstr(path, ".tar.xz");
    char folder[1024];
    if (!ending || ending[7])
        return 0;
    snprintf(folder, sizeof folder, "%.*s", (int)(ending - path), path);
    mkdir(folder, 0700);
    return oracle_unpack(path, folder) ? unlink(path) : UNPACKER_MISSING;
}

/* A copy of the data's folders with their archives unpacked; false: no data here, or nothing to unpack them with. */
static bool unpack_all(void)
{
    char path[512], answer[64], cp[] = "cp", how[] = "-r", chmod_word[] = "chmod", all[] = "-R", mode[] = "u+w";
    if (unpacked[0])
        return true;
    if (has_no_unpacker || !data_path(".", path, sizeof path))
        return false;
    folder_make(unpacked);
    for (int i = 0; i < N_FOLDERS; i++) {
        if (strchr(folders[i].name, '/') || !data_path(folders[i].name, path, sizeof path))
            continue;
        char *copy[] = { cp, how, path, unpacked, NULL };
        assert_int_equal(oracle_run(copy, answer, sizeof answer), 0);
    }
    char *writable[] = { chmod_word, all, mode, unpacked, NULL };
    assert_int_equal(oracle_run(writable, answer, sizeof answer), 0);
    int stopped = nftw(unpacked, unpack_one, 16, FTW_PHYS);
    if (stopped == UNPACKER_MISSING) {
        folder_remove(unpacked);
        unpacked[0] = 0;
        has_no_unpacker = true;
        return false;
    }
    assert_int_equal(stopped, 0);
    return true;
}

static struct plan *load(const char *name, struct error *err)
{
    char path[512];
    snprintf(path, sizeof path, "%s/%s", unpacked, name);
    *err = (struct error){ 0 };
    return access(path, R_OK) == 0 ? plan_load(path, "p", NULL, err) : NULL;
}

static bool is_there(const char *name)
{
    char path[512];
    snprintf(path, sizeof path, "%s/%s", unpacked, name);
    return unpack_all() && (snprintf(path, sizeof path, "%s/%s", unpacked, name), access(path, R_OK) == 0);
}

static void every_folder_opens_or_is_refused_for_a_stated_reason(void **state)
{
    (void)state;
    if (!unpack_all())
        skip();
    for (int i = 0; i < N_FOLDERS; i++) {
        const struct expected *e = &folders[i];
        struct error err;
        if (!is_there(e->name))
            continue;
        struct plan *plan = load(e->name, &err);
        print_message("%s: %s\n", e->name, plan ? "opens" : err.text);
        if (e->reason && (plan || !err.text[0] || !strstr(err.text, e->reason)))
            fail_msg("%s: %s instead of \"%s\"", e->name, plan ? "opens" : err.text, e->reason);
        if (!e->reason && !plan)
            fail_msg("%s: %s", e->name, err.text);
        if (plan && (plan->n_images != e->n_images || plan->regions.n_regions != e->n_regions ||
                     plan->n_doses != e->n_doses || plan->n_beams != e->n_beams))
            fail_msg("%s: %zu images, %zu regions, %zu doses, %zu beams", e->name, plan->n_images,
                     plan->regions.n_regions, plan->n_doses, plan->n_beams);
        plan_destroy(plan);
    }
}

static const struct region *region_of(const struct plan *plan, const char *name)
{
    for (size_t i = 0; i < plan->regions.n_regions; i++)
        if (strcmp(plan->regions.regions[i].name, name) == 0)
            return &plan->regions.regions[i];
    fail_msg("there is no region %s", name);
    return NULL;
}

/* Oracle: the masks that upstream's own program rasterised from the same structure sets; the voxels, one by one. */
static void structure_sets_fill_the_voxels_of_the_reference_masks(void **state)
{
    (void)state;
    static const struct {
        const char *set, *mask;
        uint64_t n;
    } pairs[] = { { "GTV_Mass_CT", "CT_reference_mask", 117145 },
                  { "GTV_Mass_MR_T1", "MR_T1_reference_mask", 117145 },
                  { "GTV_Mass_PET", "PET_reference_mask", 5095 } };
    struct error err;
    if (!is_there("dicomrt-sts001"))
        skip();
    struct plan *plan = load("dicomrt-sts001", &err);
    assert_string_equal(err.text, "");
    for (int p = 0; p < 3; p++) {
        const struct region *set = region_of(plan, pairs[p].set), *mask = region_of(plan, pairs[p].mask);
        const struct volume *a = plan->regions.layers[set->layer], *b = plan->regions.layers[mask->layer];
        assert_int_equal(set->n_voxels, pairs[p].n);
        assert_int_equal(mask->n_voxels, pairs[p].n);
        size_t n_different = 0;
        for (uint32_t k = 0; k < b->grid.size[2]; k++)
            for (uint32_t j = 0; j < b->grid.size[1]; j++)
                for (uint32_t i = 0; i < b->grid.size[0]; i++) {
                    uint32_t at[3];
                    struct vec3 point = affine_point(&b->grid.lps_mm_from_ijk, vec3(i, j, k));
                    bool is_inside =
                        volume_voxel_at(a, point, at) && volume_label(a, at[0], at[1], at[2]) == set->label;
                    n_different += is_inside != (volume_label(b, i, j, k) == mask->label);
                }
        print_message("%s: %zu voxels differ\n", pairs[p].set, n_different);
        assert_int_equal(n_different, 0);
    }
    plan_destroy(plan);
}

/* Counted from the file: a body of 35.4 l and a ball of a tumour of radius 20 mm (33.5 cm3), as its maker's program
 * describes it. */
static void the_lung_phantom_has_its_three_regions(void **state)
{
    (void)state;
    struct error err;
    if (!is_there("dicomrt-lung-phantom"))
        skip();
    struct plan *plan = load("dicomrt-lung-phantom", &err);
    assert_string_equal(err.text, "");
    assert_string_equal(plan->images[0].modality, "CT");
    assert_int_equal(plan->images[0].volume->grid.size[2], 100);
    assert_string_equal(region_of(plan, "Tumor")->id, "tumor");
    assert_int_equal(region_of(plan, "Lung")->parent, region_of(plan, "Body") - plan->regions.regions);
    assert_near(region_of(plan, "Tumor")->volume_cm3, 4.0 / 3 * 3.14159265 * 8, 0.06);
    plan_destroy(plan);
}

/* The value of the dose whose largest value this is. */
static double dose_at(const struct plan *plan, double largest, struct vec3 point)
{
    for (size_t d = 0; d < plan->n_doses; d++) {
        double value;
        const struct volume *values = plan->doses[d].components[0].values;
        if (fabs(values->high - largest) < 1e-6 && volume_sample(values, point, &value))
            return value;
    }
    fail_msg("no dose with a maximum of %g Gy at %g %g %g", largest, point.x, point.y, point.z);
    return 0;
}

static void check_beam(const struct plan *plan, const char *name, struct vec3 isocentre, double gantry_deg)
{
    for (size_t b = 0; b < plan->n_beams; b++) {
        const struct beam *beam = &plan->beams[b];
        if (strcmp(beam->name, name) != 0)
            continue;
        assert_close(vec3_length(vec3_sub(beam->target_lps_mm, isocentre)), 0, 1e-6);
        assert_close(beam->delivery.gantry_deg, gantry_deg, 1e-9);
        /* head first, supine, table straight: gantry 0 shines from the front, 90 from the patient's left */
        struct vec3 from = vec3_normalize(vec3_sub(beam->entry_lps_mm, isocentre));
        double turn = gantry_deg * 3.14159265358979 / 180;
        assert_close(from.x, sin(turn), 1e-6);
        assert_close(from.y, -cos(turn), 1e-6);
        assert_close(from.z, 0, 1e-6);
        return;
    }
    fail_msg("no beam %s", name);
}

/* Oracle: pydicom and numpy. Doses at voxel centres within 1e-6 Gy; beams within 1e-6 mm; volumes of regions without
 * holes within 1 %. */
static void check_against_pydicom(const char *folder, size_t least_doses, size_t least_regions, size_t least_beams)
{
    char path[512], script[] = "tests/oracle/rt_plan.py", *answer = malloc(1 << 20), *rest = NULL;
    struct error err;
    size_t n_doses = 0, n_regions = 0, n_beams = 0;
    struct plan *plan = load(folder, &err);
    assert_string_equal(err.text, "");
    snprintf(path, sizeof path, "%s/%s", unpacked, folder);
    char *arguments[] = { oracle_python(), script, path, NULL };
    int status = oracle_run(arguments, answer, 1 << 20);
    for (char *line = strtok_r(answer, "\n", &rest); status == 0 && line; line = strtok_r(NULL, "\n", &rest)) {
        char *at = NULL, *kind = strtok_r(line, "\t", &at), *name = strtok_r(NULL, "\t", &at);
        double v[4] = { 0 };
        for (int i = 0; i < 4; i++) {
            char *word = strtok_r(NULL, "\t", &at);
            v[i] = word ? strtod(word, NULL) : 0;
        }
        if (strcmp(kind, "dose") == 0 && ++n_doses)
            assert_close(dose_at(plan, strtod(name, NULL), vec3(v[0], v[1], v[2])), v[3], 1e-6);
        else if (strcmp(kind, "beam") == 0 && ++n_beams)
            check_beam(plan, name, vec3(v[0], v[1], v[2]), v[3]);
        else if (strcmp(kind, "region") == 0 && ++n_regions)
            assert_near(region_of(plan, name)->volume_cm3, v[0], 0.01);
    }
    plan_destroy(plan);
    free(answer);
    if (status == ORACLE_MISSING)
        skip();
    assert_int_equal(status, 0);
    assert_true(n_doses >= least_doses && n_regions >= least_regions && n_beams >= least_beams);
}

static void oncentras_phantom_is_what_pydicom_says(void **state)
{
    (void)state;
    if (!is_there("dicomrt-oncentra-phantom"))
        skip();
    check_against_pydicom("dicomrt-oncentra-phantom", 60, 5, 3);
}

static void the_lung_phantom_is_what_pydicom_says(void **state)
{
    (void)state;
    if (!is_there("dicomrt-lung-phantom"))
        skip();
    check_against_pydicom("dicomrt-lung-phantom", 0, 2, 0);
}

/* Images on grids of their own: the same patient point has a value in each. */
static void images_keep_their_own_grids(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        size_t n_images;
        struct vec3 point;
    } plans[] = { { "glioma-tcga-du7294", 2, { 0, 0, 0 } }, { "dicomrt-sts001", 3, { 70, 12, -791 } } };
    for (size_t i = 0; i < sizeof plans / sizeof plans[0]; i++) {
        struct error err;
        struct plan_probe probe;
        if (!is_there(plans[i].name))
            skip();
        struct plan *plan = load(plans[i].name, &err);
        assert_string_equal(err.text, "");
        assert_int_equal(plan->n_images, plans[i].n_images);
        assert_int_not_equal(plan->images[0].volume->grid.size[0], plan->images[1].volume->grid.size[0]);
        struct vec3 point = plans[i].point;
        if (i == 0) { /* the middle of the first image */
            struct box3 box = grid_bounds_lps_mm(&plan->images[0].volume->grid);
            point = vec3_scale(vec3_add(box.low, box.high), 0.5);
        }
        plan_probe(plan, point, &probe);
        for (size_t image = 0; image < plan->n_images; image++) {
            double value;
            assert_true(probe.has_image[image]);
            assert_true(volume_sample(plan->images[image].volume, point, &value));
            assert_close(probe.image_value[image], value, 0);
        }
        plan_destroy(plan);
    }
}

/* DICOM to NIfTI and plan.json, and back: the same plan, matrices to 1e-6 mm. */
static void dicom_plans_come_back_from_their_conversion(void **state)
{
    (void)state;
    static const char *const names[] = { "dicomrt-oncentra-phantom", "dicomrt-sts001", "dicom-mr-head",
                                         "dicomrt-lung-phantom", "dicomrt-plans" };
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        char out[300];
        struct error err;
        if (!is_there(names[i]))
            skip();
        struct plan *plan = load(names[i], &err);
        assert_string_equal(err.text, "");
        snprintf(out, sizeof out, "%s/converted-%zu", unpacked, i);
        assert_true(plan_write(plan, out, NULL, &err));
        struct plan *again = plan_load(out, "p", NULL, &err);
        assert_string_equal(err.text, "");
        if (plan->n_patients < 2)
            assert_same_plan(again, plan, 1e-6);
        else /* the two plans of "dicomrt-plans" are of two patients: the beams of one are carried over */
            assert_int_equal(again->n_beams, 2);
        plan_destroy(plan);
        plan_destroy(again);
    }
}

static int remove_all(void **state)
{
    (void)state;
    if (unpacked[0])
        folder_remove(unpacked);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_folder_opens_or_is_refused_for_a_stated_reason),
        cmocka_unit_test(structure_sets_fill_the_voxels_of_the_reference_masks),
        cmocka_unit_test(the_lung_phantom_has_its_three_regions),
        cmocka_unit_test(oncentras_phantom_is_what_pydicom_says),
        cmocka_unit_test(the_lung_phantom_is_what_pydicom_says),
        cmocka_unit_test(images_keep_their_own_grids),
        cmocka_unit_test(dicom_plans_come_back_from_their_conversion),
    };
    return cmocka_run_group_tests(tests, NULL, remove_all);
}
