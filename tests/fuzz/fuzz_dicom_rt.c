/* RT objects, registrations, segmentations and contours, chosen by the first byte. A DICOM file is read as all five
 * kinds, and its regions are filled, also on an image that may not contain them. Other input gives points, contours and
 * a grid directly. */
#include "core/formats/dicom/dicom_registration.h"
#include "core/formats/dicom/dicom_rtdose.h"
#include "core/formats/dicom/dicom_rtplan.h"
#include "core/formats/dicom/dicom_rtstruct.h"
#include "core/formats/dicom/dicom_seg.h"
#include "tests/fuzz/fuzz.h"

static void fill(const struct contour_set *sets, size_t n, const struct grid *grid)
{
    struct contour_choice choices[4];
    struct contour_options options = contour_defaults;
    struct error err = { 0 };
    options.n_threads = 1;
    options.most_voxels = 1 << 16;
    n = n < 4 ? n : 4;
    options.spacing_mm = contour_usual_spacing_mm(sets, n, grid);
    REQUIRE(options.spacing_mm > 0);
    if (!contour_choose_grids(sets, n, grid, &options, choices, &err)) {
        REQUIRE(err.code != ERROR_NONE && err.text[0] != '\0');
        return;
    }
    for (size_t i = 0; i < n; i++) {
        struct contour_facts facts;
        struct mask *mask = contour_fill(&sets[i], &choices[i].grid, &options, &facts, &err);
        REQUIRE(mask || (err.code != ERROR_NONE && err.text[0] != '\0'));
        if (mask) {
            double cm3 = (double)mask_count(mask) * grid_voxel_mm3(&choices[i].grid) / 1000;
            REQUIRE(fabs(cm3 - facts.filled_cm3) <= 1e-9 * (1 + cm3));
            REQUIRE(facts.polygon_cm3 >= 0 && isfinite(facts.polygon_cm3));
        }
        mask_destroy(mask);
    }
}

static void fill_bytes(const uint8_t *data, size_t n)
{
    struct grid grid;
    struct affine map = { { { 1, 0, 0 }, { 0, 1.5, 0 }, { 0, 0, 2 } }, { 0, 0, 0 } };
    double points[2][64][3];
    struct contour contours[2] = { { .points_lps_mm = points[0][0] }, { .points_lps_mm = points[1][0] } };
    struct contour_set set = { contours, 2 };
    if (n < 3 || !grid_init(&grid, (uint32_t[3]){ 70, 20, 10 }, &map, NULL))
        return;
    for (size_t at = 1; at + 3 <= n && at < 3 * 128; at += 3) {
        struct contour *contour = &contours[at % 2];
        if (contour->n_points >= 64)
            continue;
        for (int axis = 0; axis < 3; axis++)
            contour->points_lps_mm[3 * contour->n_points + (size_t)axis] =
                data[0] & 1 && axis == 2 ? data[at + 2] % 4 : data[at + (size_t)axis] / 4.0;
        contour->n_points++;
    }
    if (data[0] & 2 && contours[0].n_points > 0)
        points[0][0][0] = data[0] & 4 ? NAN : data[0] & 8 ? INFINITY : 1e5;
    fill(&set, 1, &grid);
}

static void read_objects(const struct dicom_file *file)
{
    struct report report = { 0 };
    struct error err = { 0 };
    struct rtdose dose;
    if (rtdose_read(file, "fuzz.dcm", &dose, &report, &err)) {
        struct dose doses[1];
        REQUIRE(dose.values->low <= dose.values->high);
        size_t n = rtdose_group(&dose, 1, NULL, NULL, "fuzz.dcm", doses, NULL, 1, &report);
        for (size_t i = 0; i < n; i++)
            dose_finish(&doses[i]);
    } else {
        REQUIRE(err.code != ERROR_NONE && err.text[0] != '\0');
    }
    struct rtplan *plan = rtplan_read(file, "fuzz.dcm", &report, &err);
    for (size_t i = 0; plan && i < plan->n_beams; i++) {
        REQUIRE(vec3_is_finite(plan->beams[i].entry_lps_mm) && vec3_is_finite(plan->beams[i].target_lps_mm));
        REQUIRE(vec3_length(vec3_sub(plan->beams[i].entry_lps_mm, plan->beams[i].target_lps_mm)) > 0);
    }
    rtplan_destroy(plan);
    struct rtstruct *set = rtstruct_read(file, "fuzz.dcm", &report, &err);
    struct grid image;
    struct affine map = { { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 3 } }, { 0, 0, 0 } };
    if (set && set->n_rois > 0) {
        fill(&set->rois[0].contours, 1, NULL);
        fill(&set->rois[0].contours, 1, grid_init(&image, (uint32_t[3]){ 20, 20, 2 }, &map, NULL) ? &image : NULL);
    }
    rtstruct_destroy(set);
    struct dicom_registration found[4];
    size_t n_found = dicom_registration_read(file, "fuzz.dcm", found, 4, &report);
    for (size_t i = 0; i < n_found; i++)
        REQUIRE(fabs(affine_determinant(&found[i].to_from_lps_mm) - 1) < 0.01);
    struct nrrd_layers layers;
    err = (struct error){ 0 };
    if (dicom_seg_read(file, "fuzz.dcm", "", &layers, &report, &err)) {
        for (size_t i = 0; i < layers.n; i++)
            REQUIRE(layers.volumes[i] && layers.names[i].n > 0);
        nrrd_layers_finish(&layers);
    } else {
        REQUIRE(err.code != ERROR_NONE && err.text[0] != '\0');
    }
    report_finish(&report);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    if (n < 1)
        return 0;
    if (data[0] == 'c') {
        fill_bytes(data + 1, n - 1);
        return 0;
    }
    struct error err = { 0 };
    struct dicom_file *file = dicom_file_parse(data + 1, n - 1, "fuzz.dcm", DICOM_WHOLE, &err);
    REQUIRE(file || (err.code != ERROR_NONE && err.text[0] != '\0'));
    if (file)
        read_objects(file);
    dicom_file_destroy(file);
    return 0;
}
