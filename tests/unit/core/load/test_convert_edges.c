/* Values at the limits of a plan come back from its conversion, and a conversion that fails leaves nothing. */
#include <dirent.h>
#include <signal.h>
#include <stdio.h>
#include <sys/resource.h>

#include "core/formats/folder.h"
#include "core/load/write_plan.h"
#include "tests/check.h"
#include "tests/made_plan.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/plan_help.h"
#include "tests/unit/same_plan.h"

#define EXACT_MM 1e-6
enum { N_REGIONS = 300, SIDE = 20 };

static struct plan *load(const char *folder)
{
    struct error err = { 0 };
    struct plan *plan = plan_of_folder(folder, &err);
    assert_string_equal(err.text, "");
    return plan;
}

static struct volume *cube(enum voxel_type type)
{
    struct error err = { 0 };
    struct grid grid =
        made_grid(SIDE, SIDE, SIDE, (struct affine){ { { 2, 0, 0 }, { 0, 2, 0 }, { 0, 0, 3 } }, { -20, -20, -30 } });
    struct volume *volume = volume_create(&grid, type, &err);
    assert_string_equal(err.text, "");
    return volume;
}

/* A label for each of 300 runs of 16 voxels. */
static struct volume *boxes(void)
{
    struct volume *labels = cube(VOXEL_U16);
    for (size_t i = 0; i < (size_t)N_REGIONS * 16; i++)
        ((uint16_t *)labels->voxels)[i] = (uint16_t)(i / 16 + 1);
    return labels;
}

/* A plan of an image, a label map of 300 regions and two doses; loaded, so that what is measured is measured. */
static struct plan *load_made(const char *folder)
{
    static const char text[] =
        "{\"format\": \"beamroom-plan\", \"version\": 1, \"name\": \"\xe6\x82\xa3\xe8\x80\x85 / \xc3\x84\xc3\x96\",\n"
        "\"images\": [{\"path\": \"image.nii.gz\"}], \"regions\": [{\"path\": \"labels.nii.gz\"}],\n"
        "\"doses\": [{\"id\": \"a\", \"unit\": \"Gy\", \"per\": \"fraction\", \"components\": [{\"quantity\": \"blood-boron\", \"path\": \"1.nii\"},\n"
        "    {\"quantity\": \"weighted-total\", \"path\": \"2.nii\", \"reference\": 12.3456789012345678}]},\n"
        "  {\"id\": \"a-blood\", \"unit\": \"cGy\", \"components\": [{\"quantity\": \"boron\", \"path\": \"2.nii\"}]},\n"
        "  {\"id\": \"a-weighted\", \"unit\": \"cGy\", \"components\": [{\"quantity\": \"total\", \"path\": \"1.nii\"}]}]}";
    struct volume *image = cube(VOXEL_F32), *one = cube(VOXEL_F32), *two = cube(VOXEL_F32);
    for (size_t i = 0; i < grid_n_voxels(&image->grid); i++) {
        ((float *)image->voxels)[i] = (float)(i % 97) * 1e30F;
        ((float *)one->voxels)[i] = (float)i;
        ((float *)two->voxels)[i] = -(float)i / 3;
    }
    folder_put_text(folder, "plan.json", text);
    folder_put_volume(folder, "image.nii.gz", image);
    folder_put_volume(folder, "labels.nii.gz", boxes());
    folder_put_volume(folder, "1.nii", one);
    folder_put_volume(folder, "2.nii", two);
    struct plan *plan = load(folder);
    assert_int_equal(plan->regions.n_regions, N_REGIONS);
    assert_int_equal(plan->n_doses, 3);
    return plan;
}

static void assert_comes_back(const struct plan *plan, const char *folder, size_t n_lost)
{
    char out[300];
    struct error err = { 0 };
    struct report lost = { 0 };
    snprintf(out, sizeof out, "%s/\xc3\xa4 out", folder);
    bool is_written = plan_write(plan, out, &lost, &err);
    assert_string_equal(err.text, "");
    assert_true(is_written);
    assert_int_equal(lost.n_lines, n_lost);
    struct plan *again = load(out);
    assert_same_plan(again, plan, EXACT_MM);
    assert_false(report_has(&again->report, "plan.unknown-key"));
    plan_destroy(again);
    report_finish(&lost);
}

/* Names in every script and with every mark; ids that are other regions' names; each region inside the one before. */
static void name_regions(struct region_set *set)
{
    static const char *const names[] = { "\xce\xb3-Knife / left",
                                         "\xe8\x84\xb3\xe8\x85\xab\xe7\x98\xa4",
                                         "\"quoted\" \\ back",
                                         "../../etc/passwd",
                                         "a\xcc\x88",
                                         "%s%n" };
    for (size_t r = 0; r < set->n_regions; r++) {
        struct region *region = &set->regions[r];
        snprintf(region->name, sizeof region->name, "%s %zu", names[r % 6], r);
        snprintf(region->id, sizeof region->id, "r-%zu", (r + 1) % set->n_regions);
        region->has_file_color = r % 2 == 0;
        if (region->has_file_color)
            memcpy(region->rgb, (uint8_t[3]){ (uint8_t)r, (uint8_t)(r * 7), 255 }, 3);
        region->file_opacity = r % 3 == 0 ? 1.0 / 3 : 0;
        region->is_target = r % 5 == 0;
        region->parent = (int)r - 1;
        region->boron_ratio = r % 4 == 0 ? 1e6 : NAN;
        region->rbe_gamma = r % 4 == 1 ? 0 : NAN;
    }
    snprintf(set->regions[0].name, sizeof set->regions[0].name,
             "r-7"); /* the id of the seventh, which the tree speaks of */
    set->hierarchy = HIERARCHY_FILE;
}

static void three_hundred_regions_of_any_name_come_back(void **state)
{
    (void)state;
    char folder[256];
    folder_make(folder);
    struct plan *plan = load_made(folder);
    name_regions(&plan->regions);
    plan->images[0].is_inverted = true;
    assert_comes_back(plan, folder, 0);
    plan_destroy(plan);
    folder_remove(folder);
}

static void voxels_that_are_not_written_are_said(void **state)
{
    (void)state;
    char folder[256], out[300];
    struct error err = { 0 };
    struct report lost = { 0 };
    folder_make(folder);
    struct plan *plan = load_made(folder);
    struct region_set *set = &plan->regions;
    set->regions[100] =
        set->regions[--set->n_regions]; /* the sixteen voxels of the one that was there now belong to none */
    region_palette(100, set->regions[100].rgb);
    snprintf(out, sizeof out, "%s/out", folder);
    assert_true(plan_write(plan, out, &lost, &err));
    assert_int_equal(lost.n_lines, 1);
    assert_string_equal(lost.lines[0].code, "write.labels-cleared");
    assert_string_equal(lost.lines[0].where, "regions/labels-1.nii.gz");
    assert_int_equal(strncmp(lost.lines[0].sentence, "16 voxels ", 10), 0);
    struct plan *again = load(out);
    assert_same_plan(again, plan, EXACT_MM);
    plan_destroy(again);
    plan_destroy(plan);
    report_finish(&lost);
    folder_remove(folder);
}

/* 3 x 3 points, some of the first one's values none. Three of those as SERA's Fortran prints them, three of 15 columns
 * and two with a sign would make a first line of 114 characters, by which readers know SERA's own columns. */
static void add_curve(struct plan *plan, const char *name, size_t n_gaps)
{
    enum { N = 3 };
    static const enum dose_quantity columns[] = { DOSE_TOTAL,
                                                  DOSE_BORON,
                                                  DOSE_GAMMA,
                                                  DOSE_NITROGEN,
                                                  DOSE_FAST,
                                                  DOSE_FAST_FLUENCE,
                                                  DOSE_EPITHERMAL_FLUENCE,
                                                  DOSE_THERMAL_FLUENCE };
    struct dose_curve *curve = &plan->curves[plan->n_curves++];
    snprintf(curve->id, sizeof curve->id, "curve-%zu", plan->n_curves);
    snprintf(curve->name, sizeof curve->name, "%s", name);
    snprintf(curve->unit, sizeof curve->unit, "cGy");
    snprintf(curve->per, sizeof curve->per, "MW\xc2\xb7min");
    curve->n_depths = curve->n_radii = N;
    curve->n_columns = 8;
    curve->depths_mm = mem_new(N * sizeof(double));
    curve->radii_mm = mem_new(N * sizeof(double));
    curve->center_lps_mm = vec3(1.234567 * 10, -0.1 * 10, 7.7777777 * 10);
    for (int i = 0; i < N; i++) {
        curve->depths_mm[i] = i / 3.0 * 10; /* needs all 17 digits */
        curve->radii_mm[i] = 0.3 * i * 10;
    }
    for (size_t c = 0; c < 8; c++) {
        curve->quantities[c] = columns[c];
        curve->is_per_ppm[c] = columns[c] == DOSE_BORON;
        curve->values[c] = mem_new(N * N * sizeof(float));
        for (size_t p = 0; p < N * N; p++)
            curve->values[c][p] =
                p == 4 || (p == 0 && c < n_gaps) ? NAN : 1.23456789F * (c > 5 ? -1 : 1) * (float)(c + 1) + (float)p;
    }
}

static void curves_and_preferences_come_back_to_the_last_bit(void **state)
{
    (void)state;
    char folder[256];
    folder_make(folder);
    struct plan *plan = load_made(folder);
    for (size_t gaps = 0; gaps <= 8; gaps++)
        add_curve(plan,
                  gaps % 2 ? "\xc3\x9c"
                             "ber/Tiefe \"B\""
                           : "curve",
                  gaps);
    for (size_t i = 0; i < PLAN_MAX_LEVELS; i++)
        plan->preferences.levels[plan->preferences.n_levels++] =
            (struct plan_level){ 1000.0 / (double)(3 * i + 1), { (uint8_t)i, 255, (uint8_t)(9 * i) } };
    for (size_t i = 0; i < PLAN_MAX_COLORS; i++)
        memcpy(plan->preferences.colors[plan->preferences.n_colors++],
               (uint8_t[3]){ (uint8_t)i, (uint8_t)(255 - i), 3 }, 3);
    assert_comes_back(plan, folder, 0);
    plan_destroy(plan);
    folder_remove(folder);
}

static void add_beam(struct plan *plan, const char *name, struct vec3 entry, double aperture_mm)
{
    struct beam *beam = &plan->beams[plan->n_beams++];
    *beam = (struct beam){ .entry_lps_mm = entry,
                           .target_lps_mm = vec3(0.1, -1.0 / 3, 2e5),
                           .aperture_mm = aperture_mm,
                           .has_delivery = true };
    snprintf(beam->id, sizeof beam->id, "beam-%zu", plan->n_beams);
    snprintf(beam->name, sizeof beam->name, "%s", name);
    struct beam_delivery *d = &beam->delivery;
    *d = (struct beam_delivery){ .number = -999999999999,
                                 .patient_position = PATIENT_FFDL,
                                 .gantry_deg = 0.1,
                                 .collimator_deg = 36000,
                                 .couch_deg = -0.7,
                                 .energy_mev = 1e200,
                                 .gantry_stop_deg = 359.9999999999999,
                                 .gantry_travel_deg = -1234.5,
                                 .n_control_points = 100000,
                                 .sad_mm = 1e5,
                                 .ssd_mm = NAN,
                                 .jaws_x_mm = { NAN, 50.3 },
                                 .jaws_y_mm = { -1e12, NAN },
                                 .opening_x_mm = { NAN, NAN },
                                 .opening_y_mm = { -1.1, 1.1 },
                                 .opening_cm2 = 4e9,
                                 .collimator_x_lps = { 0.6, 0.8, 0 },
                                 .collimator_y_lps = { -0.8, 0.6, 0 },
                                 .dose_gy = 1e10,
                                 .meterset = 12345678901.5,
                                 .n_fractions = 2147483647 };
    d->outline = (struct beam_outline){ .kind = BEAM_OUTLINE_LEAVES,
                                        .n_polygons = 2,
                                        .ends = { 3, BEAM_OUTLINE_MAX_POINTS },
                                        .points_mm = { { -1e4F, 0.1F }, { 1.F / 3, 1e-30F }, { 7, 1e4F } } };
    for (int i = 3; i < BEAM_OUTLINE_MAX_POINTS; i++)
        d->outline.points_mm[i][0] = 0.37F * (float)i;
    snprintf(d->radiation, sizeof d->radiation, "NEUTRON");
    snprintf(d->machine, sizeof d->machine, "B\xc3\xbcndel");
    snprintf(d->meterset_unit, sizeof d->meterset_unit, "MINUTE");
}

static void add_tracks(struct plan *plan)
{
    enum { N = 16 };
    plan->tracks.segments = mem_new(N * sizeof *plan->tracks.segments);
    for (size_t i = 0; i < N; i++) {
        float far = i == 3 ? 1e6F : 0.1F * (float)i;
        plan->tracks.segments[plan->tracks.n_segments++] =
            (struct track_segment){ .from_lps_mm = { far, -1e-30F, 16777217.F / 16777219.F },
                                    .to_lps_mm = { 1e-38F, -far, 3 },
                                    .class = (uint8_t)(i % TRACK_N_CLASSES),
                                    .energy_mev = NAN };
        plan->tracks.n_of_class[i % TRACK_N_CLASSES]++;
    }
}

static void beams_and_tracks_at_their_limits_come_back(void **state)
{
    (void)state;
    char folder[256];
    folder_make(folder);
    struct plan *plan = load_made(folder);
    add_beam(plan, "\xd0\x9b\xd0\xb5\xd0\xb2\xd1\x8b\xd0\xb9 / \"1\"", vec3(1e6, -1e6, 7), BEAM_MAX_APERTURE_MM);
    add_beam(plan, "", vec3(0.1, -1.0 / 3, 2e5 + 1e-5), NAN);
    while (plan->n_beams < PLAN_MAX_BEAMS)
        add_beam(plan, "more", vec3(1, 2, 3), 1e-9);
    add_tracks(plan);
    assert_comes_back(plan, folder, 0);
    plan_destroy(plan);
    folder_remove(folder);
}

static size_t n_entries(const char *folder)
{
    DIR *directory = opendir(folder);
    size_t n = 0;
    assert_non_null(directory);
    while (readdir(directory))
        n++;
    closedir(directory);
    return n - 2;
}

/* No file may be larger than a few bytes, as on a full disk. */
static bool write_limited(const struct plan *plan, const char *out, rlim_t most, struct error *err)
{
    struct rlimit before;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &(struct rlimit){ most, before.rlim_max }), 0);
    bool is_written = plan_write(plan, out, NULL, err);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
    signal(SIGXFSZ, handler);
    return is_written;
}

static void a_disk_that_takes_no_more_leaves_nothing_and_is_said(void **state)
{
    (void)state;
    char folder[256], out[300];
    folder_make(folder);
    struct plan *plan = load_made(folder);
    size_t before = n_entries(folder);
    snprintf(out, sizeof out, "%s/out", folder);
    static const rlim_t most[] = { 0, 100, 3000 }; /* nothing at all, not a volume, not the larger ones */
    for (size_t i = 0; i < sizeof most / sizeof most[0]; i++) {
        struct error err = { 0 };
        assert_false(write_limited(plan, out, most[i], &err));
        assert_int_equal(err.code, ERROR_IO);
        assert_non_null(strstr(err.text, "cannot be written"));
        assert_int_equal(strncmp(err.text, out, strlen(out)), 0); /* by the name asked for */
        assert_int_equal(err.text[strlen(out)], '/');
        assert_int_equal(n_entries(folder), before);
    }
    assert_comes_back(plan, folder, 0);
    plan_destroy(plan);
    folder_remove(folder);
}

/* A plan that no reader would take is not written: here with a beam without a length. */
static void a_plan_that_would_not_open_again_is_not_written(void **state)
{
    (void)state;
    char folder[256], out[300];
    struct error err = { 0 };
    folder_make(folder);
    struct plan *plan = load_made(folder);
    size_t before = n_entries(folder);
    add_beam(plan, "none", vec3(0, 0, 0), 100);
    plan->beams[0].entry_lps_mm = plan->beams[0].target_lps_mm;
    snprintf(out, sizeof out, "%s/out", folder);
    assert_false(plan_write(plan, out, NULL, &err));
    assert_string_equal(err.text, "plan.json: beams[0].target_mm: is the same point as entry_mm");
    assert_int_equal(n_entries(folder), before);
    plan_destroy(plan);
    folder_remove(folder);
}

/* The unit "cm" takes them beyond; the two others are 1 km and 3 cm away. */
static void tracks_that_end_beyond_a_kilometre_are_left_out_and_said(void **state)
{
    (void)state;
    static const char
        tracks[] = "0 0 0 100000 0 0 0 1\n0 0 0 0 -100001 0 0 2\n1 2 3 4 5 6 1 0\n",
        text[] = "{\"format\": \"beamroom-plan\", \"version\": 1, \"regions\": [{\"path\": \"labels.nii.gz\"}],\n"
                 "\"tracks\": [{\"path\": \"t.pp\", \"unit\": \"cm\"}]}";
    char folder[256];
    folder_make(folder);
    folder_put_text(folder, "plan.json", text);
    folder_put_text(folder, "t.pp", tracks);
    folder_put_volume(folder, "labels.nii.gz", boxes());
    struct plan *plan = load(folder);
    assert_int_equal(plan->tracks.n_segments, 2);
    assert_int_equal(plan->tracks.n_of_class[TRACK_NEUTRON_MEDIUM], 0);
    assert_close((double)plan->tracks.segments[0].to_lps_mm[0], 1e6, 0);
    assert_close((double)plan->tracks.segments[1].to_lps_mm[0], 40, 0);
    assert_string_equal(report_said(&plan->report, "tracks.far"),
                        "1 of 3 segments end more than 1000 m away and were left out.");
    assert_comes_back(plan, folder, 0);
    plan_destroy(plan);
    folder_remove(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(three_hundred_regions_of_any_name_come_back),
        cmocka_unit_test(voxels_that_are_not_written_are_said),
        cmocka_unit_test(curves_and_preferences_come_back_to_the_last_bit),
        cmocka_unit_test(beams_and_tracks_at_their_limits_come_back),
        cmocka_unit_test(a_disk_that_takes_no_more_leaves_nothing_and_is_said),
        cmocka_unit_test(a_plan_that_would_not_open_again_is_not_written),
        cmocka_unit_test(tracks_that_end_beyond_a_kilometre_are_left_out_and_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
