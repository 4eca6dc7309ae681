/* The demo phantom: anatomy, dose and tracks against the paper and formulas; files against their formats. */
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/file_write.h"
#include "core/formats/nifti_write.h"
#include "core/phantom/depth_dose.h"
#include "core/phantom/head.h"
#include "core/phantom/phantom.h"
#include "core/phantom/plan_text.h"
#include "core/phantom/tracks.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"

/* ---- anatomy ---------------------------------------------------------------------------------------------------- */

static void fill(const uint32_t size[3], uint64_t seed, struct volume **ct, struct volume **labels)
{
    struct grid grid;
    struct error err = { 0 };
    assert_true(phantom_image_grid(size, &grid, &err));
    assert_true(phantom_fill_head(&grid, seed, ct, labels, &err));
}

static void each_tissue_has_the_volume_of_its_ellipsoid(void **state)
{
    (void)state;
    struct volume *ct, *labels;
    fill(phantom_defaults.size, 1, &ct, &labels);
    uint64_t n_of[PHANTOM_N_LABELS] = { 0 };
    const uint8_t *label = labels->voxels;
    for (size_t at = 0; at < grid_n_voxels(&labels->grid); at++)
        n_of[label[at]]++;
    /* semi-axes in mm: three from the paper, the others our own. Counting voxel centres is off by less than half a
     * voxel's share of the surface over the square root of the number of voxels crossed: 0.1 % for the head, 1 % for
     * the 3400 voxels of the tumour */
    const double axes_mm[PHANTOM_N_LABELS][3] = { { 0 },          { 73, 103, 88 }, { 68, 98, 83 },
                                                  { 60, 90, 65 }, { 20, 22, 18 },  { 11, 12, 10 } };
    const double share[PHANTOM_N_LABELS] = { 0, 0.001, 0.001, 0.001, 0.005, 0.01 };
    double inner_mm3 = 0;
    for (int i = PHANTOM_TUMOUR; i >= PHANTOM_SCALP; i--) {
        inner_mm3 += (double)n_of[i] * grid_voxel_mm3(&labels->grid);
        assert_near(inner_mm3, 4.0 / 3.0 * MATH_PI * axes_mm[i][0] * axes_mm[i][1] * axes_mm[i][2], share[i]);
    }
    volume_unref(ct);
    volume_unref(labels);
}

static void the_tissues_lie_inside_one_another(void **state)
{
    (void)state;
    /* a point slightly outside an inner ellipsoid is still inside the next outer one */
    for (int inner = PHANTOM_CRANIUM; inner < PHANTOM_N_LABELS; inner++)
        for (int theta = 0; theta <= 36; theta++)
            for (int phi = 0; phi < 72; phi++) {
                const struct ellipsoid *shape = &phantom_tissues[inner].shape;
                double t = theta * MATH_PI / 36, f = phi * MATH_PI / 36;
                struct vec3 p = vec3_add(shape->centre_lps_mm, vec3(1.001 * shape->semi_axes_mm.x * sin(t) * cos(f),
                                                                    1.001 * shape->semi_axes_mm.y * sin(t) * sin(f),
                                                                    1.001 * shape->semi_axes_mm.z * cos(t)));
                assert_int_equal(phantom_label_at(p), inner - 1);
            }
}

static void the_marker_and_the_tumour_are_on_the_left(void **state)
{
    (void)state;
    struct volume *ct, *labels;
    fill((uint32_t[3]){ 128, 128, 64 }, 1, &ct, &labels);
    size_t n_marker = 0, n_tumour = 0;
    for (uint32_t k = 0; k < 64; k++)
        for (uint32_t j = 0; j < 128; j++)
            for (uint32_t i = 0; i < 128; i++) {
                struct vec3 p = affine_point(&ct->grid.lps_mm_from_ijk, vec3(i, j, k));
                if (volume_value(ct, i, j, k) > 1500) {
                    n_marker++;
                    assert_true(p.x > 70); /* LPS: + is left */
                }
                if (volume_label(labels, i, j, k) == PHANTOM_TUMOUR) {
                    n_tumour++;
                    assert_true(p.x > 0 && p.y > 0 && p.z > 0); /* left, behind, above */
                }
            }
    assert_true(n_marker > 20 && n_tumour > 300);
    volume_unref(ct);
    volume_unref(labels);
}

static void noise_follows_the_seed_and_labels_do_not(void **state)
{
    (void)state;
    const uint32_t size[3] = { 64, 64, 32 };
    struct volume *ct[3], *labels[3];
    fill(size, 7, &ct[0], &labels[0]);
    fill(size, 7, &ct[1], &labels[1]);
    fill(size, 8, &ct[2], &labels[2]);
    size_t n = grid_n_voxels(&ct[0]->grid);
    assert_memory_equal(ct[0]->voxels, ct[1]->voxels, 2 * n);
    assert_true(memcmp(ct[0]->voxels, ct[2]->voxels, 2 * n) != 0);
    assert_memory_equal(labels[0]->voxels, labels[2]->voxels, n);
    for (int i = 0; i < 3; i++) {
        volume_unref(ct[i]);
        volume_unref(labels[i]);
    }
}

/* ---- dose ------------------------------------------------------------------------------------------------------- */

static const struct {
    double depth_mm, nitrogen, fast, gamma, boron;
} published[] = {
    { 2, .0913, .1404, .506, .0477 },   { 10, .1565, .1130, .726, .0793 },    { 18, .1974, .0812, .895, .0981 },
    { 22, .2056, .0687, .941, .1016 },  { 26, .2063, .0585, .970, .1015 },    { 30, .2011, .0500, .971, .0986 },
    { 38, .1781, .0372, .937, .0869 },  { 50, .1315, .0246, .800, .0639 },    { 70, .0654, .0131, .533, .0316 },
    { 90, .0279, .00708, .322, .0135 }, { 110, .0112, .00392, .192, .00539 }, { 130, .00411, .00217, .115, .00198 },
};

static const struct phantom_component *component_of(enum dose_quantity quantity)
{
    for (int i = 0; i < PHANTOM_N_COMPONENTS; i++)
        if (phantom_components[i].quantity == quantity)
            return &phantom_components[i];
    fail();
    return NULL;
}

static double sample_on_axis(enum dose_quantity quantity, double depth_mm)
{
    struct grid grid;
    struct error err = { 0 };
    assert_true(phantom_dose_grid(&grid, &err));
    struct volume *volume = phantom_dose_volume(component_of(quantity), &grid, &err);
    double value;
    assert_true(volume_sample(volume, vec3(0, 0, 88 - depth_mm), &value));
    volume_unref(volume);
    return value;
}

static void the_dose_on_the_axis_is_the_published_one(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof published / sizeof *published; i++) { /* float32 is exact to 6 parts in 1e8 */
        assert_near(sample_on_axis(DOSE_NITROGEN, published[i].depth_mm), published[i].nitrogen, 2e-7);
        assert_near(sample_on_axis(DOSE_FAST, published[i].depth_mm), published[i].fast, 2e-7);
        assert_near(sample_on_axis(DOSE_GAMMA, published[i].depth_mm), published[i].gamma, 2e-7);
        assert_near(sample_on_axis(DOSE_BORON, published[i].depth_mm), published[i].boron, 2e-7);
    }
    assert_true(component_of(DOSE_BORON)->is_per_ppm);
    assert_false(component_of(DOSE_GAMMA)->is_per_ppm);
}

static void between_the_published_depths_the_dose_stays_between_the_published_values(void **state)
{
    (void)state;
    for (int c = 0; c < PHANTOM_N_COMPONENTS; c++)
        for (int i = 0; i + 1 < PHANTOM_N_DEPTHS; i++) {
            const struct phantom_component *component = &phantom_components[c];
            double a = component->table[i], b = component->table[i + 1];
            for (int step = 1; step < 20; step++) {
                double depth_mm = phantom_depths_mm[i] + (phantom_depths_mm[i + 1] - phantom_depths_mm[i]) * step / 20;
                double value = phantom_dose(component, depth_mm, 0);
                assert_true(value >= fmin(a, b) * (1 - 1e-12) && value <= fmax(a, b) * (1 + 1e-12));
            }
        }
}

static void off_the_axis_the_dose_only_falls_and_halves_near_the_edge(void **state)
{
    (void)state;
    for (int c = 0; c < PHANTOM_N_COMPONENTS; c++) {
        const struct phantom_component *component = &phantom_components[c];
        for (double depth_mm = 0; depth_mm <= 170; depth_mm += 10) {
            double on_axis = phantom_dose(component, depth_mm, 0), last = on_axis;
            for (double r = 5; r <= 120; r += 5) {
                double value = phantom_dose(component, depth_mm, r);
                assert_true(value > 0 && value < last);
                last = value;
            }
            /* by the formula at r = R: (1 + exp(-R/w)) / 2 of the value on the axis */
            double w = component->edge_mm + component->edge_per_depth * depth_mm;
            assert_near(phantom_dose(component, depth_mm, 50), on_axis * (1 + exp(-50 / w)) / 2, 1e-12);
        }
    }
    const struct phantom_component *gamma = component_of(DOSE_GAMMA);
    assert_close(phantom_dose_at(gamma, vec3(0, 0, 88.5)), 0, 0); /* above the scalp */
    assert_close(phantom_dose_at(gamma, vec3(74, 0, 0)), 0, 0);   /* beside it */
    assert_true(phantom_dose_at(gamma, vec3(0, 0, 87.5)) > 0);
}

/* ---- tracks ----------------------------------------------------------------------------------------------------- */

static void tracks_hold_every_class_and_start_in_the_beam(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 20; seed++) {
        struct track_segment segments[PHANTOM_MAX_TRACKS];
        size_t n_of[TRACK_N_CLASSES] = { 0 }, n = phantom_make_tracks(seed, segments);
        assert_int_equal(n, PHANTOM_MAX_TRACKS);
        for (size_t i = 0; i < n; i++) {
            const struct track_segment *s = &segments[i];
            n_of[s->class]++;
            for (int axis = 0; axis < 3; axis++)
                assert_true(fabsf(s->from_lps_mm[axis]) <= 160 &&
                            fabsf(s->to_lps_mm[axis]) <= 160); /* semi-axis + 40, source at 150 */
            if (s->from_lps_mm[2] > 149.9F) {
                assert_true(hypotf(s->from_lps_mm[0], s->from_lps_mm[1]) <= 50.001F);
                assert_close(s->to_lps_mm[0], s->from_lps_mm[0], 1e-3); /* the beam is parallel */
                assert_true(s->to_lps_mm[2] < s->from_lps_mm[2]);
            }
        }
        for (int class = 0; class < TRACK_N_CLASSES; class ++)
            assert_true(n_of[class] > 0);
        assert_int_equal(n_of[TRACK_BEAM_LINE], 1);
        assert_int_equal(n_of[TRACK_LOST], PHANTOM_N_LOST);
    }
}

static void a_track_is_written_in_fixed_columns_with_posterior_turned_to_anterior(void **state)
{
    (void)state;
    const struct track_segment segments[2] = { { { 1.5F, -2.25F, 3 }, { -100.125F, 20, -30 }, TRACK_GAMMA_LOW, NAN },
                                               { { 0, 0, 150 }, { 0, 0, 10 }, TRACK_BEAM_LINE, NAN } };
    struct error err = { 0 };
    size_t n_bytes;
    char *text = phantom_tracks_text(segments, 2, &n_bytes, &err);
    assert_non_null(text);
    assert_int_equal(n_bytes, strlen(text));
    const char *line = text;
    for (int i = 0; i < 3; i++) {
        assert_int_equal(*line, '#');
        line = strchr(line, '\n') + 1;
    }
    assert_string_equal(line, "   1.5000    2.2500    3.0000 -100.1250  -20.0000  -30.0000  1  3\n"
                              "   0.0000    0.0000  150.0000    0.0000    0.0000   10.0000  2  0\n");
    free(text);
}

/* ---- files ------------------------------------------------------------------------------------------------------ */

static char folder[64];

static int make_folder(void **state)
{
    (void)state;
    snprintf(folder, sizeof folder, "/tmp/beamroom-phantom-XXXXXX");
    return mkdtemp(folder) ? 0 : -1;
}

static void remove_tree(const char *path)
{
    pid_t child = fork();
    if (child == 0) {
        execlp("rm", "rm", "-rf", path, (char *)NULL);
        _exit(1);
    }
    waitpid(child, NULL, 0);
}

static int remove_folder(void **state)
{
    (void)state;
    remove_tree(folder);
    return 0;
}

static char *in_folder(char path[512], const char *name)
{
    snprintf(path, 512, "%s/%s", folder, name);
    return path;
}

static const struct phantom_options small = { { 32, 32, 16 }, 3 };

static void equal_seeds_give_equal_bytes(void **state)
{
    (void)state;
    char a[512], b[512], path_a[600], path_b[600];
    struct error err = { 0 };
    assert_true(phantom_write(in_folder(a, "a"), &small, false, &err));
    sleep(1); /* a time stamp in seconds would differ now */
    assert_true(phantom_write(in_folder(b, "b"), &small, false, &err));
    const char *names[] = { "plan.json",        "README.txt",        "labels.json",       "ct.nii.gz",
                            "labels.nii.gz",    "tracks.pp",         "dose/boron.nii.gz", "dose/nitrogen.nii.gz",
                            "dose/fast.nii.gz", "dose/gamma.nii.gz", "dose/valid.nii.gz" };
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        size_t n, n_b;
        snprintf(path_a, sizeof path_a, "%s/%s", a, names[i]);
        snprintf(path_b, sizeof path_b, "%s/%s", b, names[i]);
        uint8_t *bytes_a = file_bytes(path_a, &n), *bytes_b = file_bytes(path_b, &n_b);
        assert_true(n > 0);
        assert_int_equal(n_b, n);
        assert_memory_equal(bytes_a, bytes_b, n);
        free(bytes_a);
        free(bytes_b);
    }
}

static void the_files_say_the_same_to_another_program(void **state)
{
    (void)state;
    char path[512];
    struct error err = { 0 };
    assert_true(phantom_write(in_folder(path, "default"), &phantom_defaults, false, &err));
    pid_t child = fork();
    if (child == 0) {
        dup2(STDERR_FILENO, STDOUT_FILENO);
        execl("/usr/bin/python3", "python3", "tests/unit/phantom_oracle.py", path, (char *)NULL);
        _exit(77);
    }
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    if (WEXITSTATUS(status) == 77)
        skip();
    assert_int_equal(WEXITSTATUS(status), 0);
}

static void the_plan_says_that_it_is_a_phantom_and_fits_the_plans_limits(void **state)
{
    (void)state;
    struct error err = { 0 };
    const struct phantom_options longest = { { 16, 16, 16 }, UINT64_MAX };
    char *text = phantom_plan_json(&longest, &err);
    assert_non_null(text);
    assert_non_null(strstr(text, "\"phantom\": true"));
    assert_non_null(strstr(text, "\"name\": \"Phantom: "));
    assert_non_null(strstr(text, "\"unit\": \"Gy\", \"per\": \"minute at 1e10 n/cm2/s\""));
    assert_non_null(strstr(
        text,
        "{ \"scalp\": [\"cranium\"], \"cranium\": [\"brain\"], \"brain\": [\"target\"], \"target\": [\"tumour\"] }"));
    assert_non_null(strstr(text, "\"entry_mm\": [0, 0, 88]"));
    const char *note = strstr(text, "\"note\": \"") + strlen("\"note\": \"");
    assert_true(strchr(note, '"') - note < 512); /* plan.h keeps 511 bytes of it */
    free(text);
}

static bool is_there(const char *path)
{
    struct stat what;
    return lstat(path, &what) == 0;
}

static void a_folder_is_replaced_only_when_asked_and_only_when_it_is_a_phantom(void **state)
{
    (void)state;
    char path[512], other[600];
    struct error err = { 0 };
    in_folder(path, "again");
    assert_int_equal(mkdir(path, 0777), 0);
    assert_true(phantom_write(path, &small, false, &err)); /* an empty folder may be used */
    assert_false(phantom_write(path, &small, false, &err));
    assert_int_equal(err.code, ERROR_STATE);
    assert_true(phantom_write(path, &small, true, &err));

    snprintf(other, sizeof other, "%s/dose/mine.txt", path);
    int file = open(other, O_CREAT | O_WRONLY, 0666);
    assert_true(file >= 0);
    close(file);
    assert_false(phantom_write(path, &small, true, &err));
    assert_int_equal(err.code, ERROR_STATE);
    assert_non_null(strstr(err.text, "dose/mine.txt"));
    assert_true(is_there(other));
    size_t n; /* and the existing phantom is complete */
    snprintf(other, sizeof other, "%s/plan.json", path);
    free(file_bytes(other, &n));
    assert_true(n > 100);
}

static void a_phantom_that_cannot_be_written_leaves_nothing_behind(void **state)
{
    (void)state;
    char path[512];
    struct error err = { 0 };
    assert_false(phantom_write(in_folder(path, "no/such/parent"), &small, false, &err));
    assert_int_equal(err.code, ERROR_IO);
    const struct phantom_options thin = { { 256, 256, 15 }, 1 }, wide = { { 1025, 16, 16 }, 1 },
                                 huge = { { 1024, 1024, 1024 }, 1 };
    in_folder(path, "refused");
    assert_false(phantom_write(path, &thin, false, &err));
    assert_int_equal(err.code, ERROR_RANGE);
    assert_false(phantom_write(path, &wide, false, &err));
    assert_int_equal(err.code, ERROR_RANGE);
    assert_false(phantom_write(path, &huge, false, &err));
    assert_int_equal(err.code, ERROR_LIMIT);
    assert_false(is_there(path));
    assert_false(phantom_write("", &small, false, &err));
    assert_int_equal(err.code, ERROR_RANGE);
    char place[FILE_FOLDER_SIZE], partial[PATH_MAX], longest[FILE_FOLDER_SIZE + 2] = { 0 };
    memset(longest, 'a', FILE_FOLDER_SIZE);
    assert_false(file_folder_paths(longest, place, partial, &err));
    assert_non_null(strstr(err.text, "has 1 to 4031 bytes, this one 4032"));
    longest[FILE_FOLDER_SIZE - 1] = '/'; /* slashes at its end do not count */
    assert_true(file_folder_paths(longest, place, partial, &err));
    assert_int_equal(strlen(place), 4031);
}

/* The header's geometry computed by hand, for an oblique, left-handed grid. */
static void an_oblique_left_handed_grid_keeps_its_geometry_in_the_header(void **state)
{
    (void)state;
    double c = cos(MATH_PI / 6), s = sin(MATH_PI / 6);
    struct affine map = { { { c, s, 0 }, { -2 * s, 2 * c, 0 }, { 0, 0, -3 } }, { 10, -20, 30 } };
    struct grid grid;
    struct error err = { 0 };
    assert_true(grid_init(&grid, (uint32_t[3]){ 3, 2, 2 }, &map, &err));
    struct volume *volume = volume_create(&grid, VOXEL_U16, &err);
    assert_non_null(volume);
    volume->slope = 2;
    volume->offset = -5;
    char path[512];
    size_t n;
    assert_true(nifti_write(in_folder(path, "oblique.nii"), volume, "by hand", &err));
    uint8_t *bytes = file_bytes(path, &n);
    assert_int_equal(n, 352 + 12 * 2);
    float srow[12], pixdim[4], quaternion[3], offset[3], scale[2];
    memcpy(srow, bytes + 280, sizeof srow);
    memcpy(pixdim, bytes + 76, sizeof pixdim);
    memcpy(quaternion, bytes + 256, sizeof quaternion);
    memcpy(offset, bytes + 268, sizeof offset);
    memcpy(scale, bytes + 112, sizeof scale);
    /* RAS: the first two patient axes change sign */
    const double expected[12] = { -c, 2 * s, 0, -10, -s, -2 * c, 0, 20, 0, 0, -3, 30 };
    for (int i = 0; i < 12; i++)
        assert_close(srow[i], expected[i], 1e-6);
    assert_close(pixdim[0], -1, 0);
    assert_close(pixdim[1], 1, 1e-6);
    assert_close(pixdim[2], 2, 1e-6);
    assert_close(pixdim[3], 3, 1e-6);
    /* with the third axis reversed, a rotation by 180 + 30 degrees about S: (a, b, c, d) = (cos 105, 0, 0, sin 105),
     * written as its negative so that a >= 0 */
    assert_close(quaternion[0], 0, 1e-6);
    assert_close(quaternion[1], 0, 1e-6);
    assert_close(quaternion[2], -sin(105 * MATH_PI / 180), 1e-6);
    assert_close(offset[0], -10, 0);
    assert_close(offset[1], 20, 0);
    assert_close(offset[2], 30, 0);
    assert_close(scale[0], 2, 0);
    assert_close(scale[1], -5, 0);
    assert_int_equal(bytes[70], (char)0); /* datatype 512, uint16 */
    assert_int_equal(bytes[71], 2);
    assert_string_equal(bytes + 344, "n+1");
    free(bytes);
    volume_unref(volume);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_tissue_has_the_volume_of_its_ellipsoid),
        cmocka_unit_test(the_tissues_lie_inside_one_another),
        cmocka_unit_test(the_marker_and_the_tumour_are_on_the_left),
        cmocka_unit_test(noise_follows_the_seed_and_labels_do_not),
        cmocka_unit_test(the_dose_on_the_axis_is_the_published_one),
        cmocka_unit_test(between_the_published_depths_the_dose_stays_between_the_published_values),
        cmocka_unit_test(off_the_axis_the_dose_only_falls_and_halves_near_the_edge),
        cmocka_unit_test(tracks_hold_every_class_and_start_in_the_beam),
        cmocka_unit_test(a_track_is_written_in_fixed_columns_with_posterior_turned_to_anterior),
        cmocka_unit_test(equal_seeds_give_equal_bytes),
        cmocka_unit_test(the_files_say_the_same_to_another_program),
        cmocka_unit_test(the_plan_says_that_it_is_a_phantom_and_fits_the_plans_limits),
        cmocka_unit_test(a_folder_is_replaced_only_when_asked_and_only_when_it_is_a_phantom),
        cmocka_unit_test(a_phantom_that_cannot_be_written_leaves_nothing_behind),
        cmocka_unit_test(an_oblique_left_handed_grid_keeps_its_geometry_in_the_header),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
