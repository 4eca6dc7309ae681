/* Fields of Monte Carlo codes: real files against the answers of other readers, where each number lies, what is
 * refused, and that a plan shows them with the person's normalisation. */
#include "core/formats/plan/tally_file.h"
#include "core/formats/tally/meshtal.h"
#include "core/formats/tally/phits_tally.h"
#include "core/load/load.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/plan_help.h"

static const struct tally_choice unsaid = { 0, TALLY_ENERGY_UNSAID };

static double sum_of(const float *values, const struct tally *tally)
{
    double sum = 0;
    for (size_t i = 0; i < (size_t)tally->size[0] * tally->size[1] * tally->size[2]; i++)
        sum += (double)values[i];
    return sum;
}

static double at(const struct tally *tally, uint32_t x, uint32_t y, uint32_t z)
{
    return (double)tally->values[((size_t)z * tally->size[1] + y) * tally->size[0] + x];
}

static uint8_t *real(const char *name, size_t *size)
{
    char path[512];
    return data_path(name, path, sizeof path) ? file_bytes(path, size) : NULL;
}

static bool read_mesh(const char *name, const struct tally_choice *choice, struct tally *tally, struct error *err)
{
    size_t size;
    char path[128];
    snprintf(path, sizeof path, "formats/mcnp-meshtal/%s", name);
    uint8_t *bytes = real(path, &size);
    if (!bytes)
        skip();
    assert_true(meshtal_is(bytes, size) && !phits_tally_is(bytes, size));
    bool is_read = meshtal_read(bytes, size, name, choice, tally, err);
    free(bytes);
    return is_read;
}

/* Values count from 1 in the order of MCNP's rows, z fastest, then y; errors grow by .002 from .076: the same mesh in
 * five arrangements. */
static void five_arrangements_of_a_mesh_tally_are_one_field(void **state)
{
    (void)state;
    static const char *const names[] = { "fmesh_104.msht", "fmesh_204.msht", "fmesh_304.msht", "fmesh_404.msht",
                                         "fmesh_504.msht" };
    for (int f = 0; f < 5; f++) {
        struct tally tally;
        struct error err = { 0 };
        if (!read_mesh(names[f], &unsaid, &tally, &err))
            fail_msg("%s", err.text);
        assert_true(tally.size[0] == 4 && tally.size[1] == 2 && tally.size[2] == 3);
        assert_close(tally.step_cm[0], 3.75, 1e-9);
        assert_close(tally.step_cm[1], 3, 1e-9);
        assert_close(tally.step_cm[2], 5, 1e-9);
        for (uint32_t x = 0; x < 4; x++)
            for (uint32_t y = 0; y < 2; y++)
                for (uint32_t z = 0; z < 3; z++) {
                    double n = (x * 2 + y) * 3 + z + 1;
                    assert_close(at(&tally, x, y, z), n, 1e-4);
                    assert_near(tally.errors[(z * 2 + y) * 4 + x], n * (.074 + .002 * n), 1e-3);
                }
        assert_close(sum_of(tally.values, &tally), 300, 1e-3);
        tally_finish(&tally);
    }
}

static void energies_have_to_be_chosen_and_several_times_count_by_their_total(void **state)
{
    (void)state;
    struct tally tally;
    struct error err = { 0 };
    assert_false(read_mesh("fmesh_314.msht", &unsaid, &tally, &err));
    assert_string_equal(
        err.text,
        "fmesh_314.msht: mesh tally 314 has 2 energy bins; \"energy\" has to say which, from 1, or \"total\"");
    assert_false(read_mesh("fmesh_314.msht", &(struct tally_choice){ 0, 3 }, &tally, &err));
    assert_false(read_mesh("fmesh_314.msht", &(struct tally_choice){ 313, 1 }, &tally, &err));
    assert_string_equal(err.text, "fmesh_314.msht: no mesh tally 313; there are 1, the first is 314");
    /* Columns count on over times: three of 24, then their total. */
    err = (struct error){ 0 };
    assert_true(read_mesh("fmesh_114.msht", &(struct tally_choice){ 114, 1 }, &tally, &err));
    assert_close(at(&tally, 0, 0, 0), 73, 1e-4);
    assert_close(at(&tally, 3, 1, 2), 96, 1e-4);
    tally_finish(&tally);
    for (long energy = 1; energy <= 2; energy++) {
        struct tally columns;
        assert_true(read_mesh("fmesh_114.msht", &(struct tally_choice){ 114, energy }, &columns, &err));
        assert_true(read_mesh("fmesh_314.msht", &(struct tally_choice){ 314, energy }, &tally, &err));
        for (int i = 0; i < 24; i++)
            assert_close(tally.values[i], columns.values[i], 1e-4);
        tally_finish(&tally);
        tally_finish(&columns);
    }
}

/* A real run: the sum over all 175 bins is that of ANSWERS.txt. */
static void a_real_run_adds_up_over_its_energies(void **state)
{
    (void)state;
    double sum = 0;
    for (long energy = 1; energy <= 175; energy++) {
        struct tally tally;
        struct error err = { 0 };
        if (!read_mesh("pyne_r2s_meshtal.txt", &(struct tally_choice){ 4, energy }, &tally, &err))
            fail_msg("%s", err.text);
        sum += sum_of(tally.values, &tally);
        assert_close(tally.histories, 1e7, 0);
        if (energy == 1) {
            assert_near(at(&tally, 0, 1, 0), 2.00451e-5, 1e-5);
            assert_near(at(&tally, 1, 0, 0), 1.97437e-5, 1e-5);
        }
        tally_finish(&tally);
    }
    assert_near(sum, .012051018, 1e-6);
    struct tally tally;
    struct error err = { 0 };
    assert_true(read_mesh("pyne_r2s_meshtal.txt", &(struct tally_choice){ 4, TALLY_ENERGY_TOTAL }, &tally, &err));
    assert_near(sum_of(tally.values, &tally), sum, 1e-5); /* MCNP's own total */
    tally_finish(&tally);
}

static void cylinders_are_refused_by_name(void **state)
{
    (void)state;
    struct tally tally;
    struct error err = { 0 };
    assert_false(read_mesh("fmesh_124.msht", &unsaid, &tally, &err));
    assert_int_equal(err.code, ERROR_UNSUPPORTED);
    assert_string_equal(err.text, "fmesh_124.msht: mesh tally 124 is cylindrical; rectangular ones are read");
}

#define MESH_HEAD \
    " Mesh Tally Number 4\n Tally bin boundaries:\n X direction: 0 1 2\n Y direction: 0 1\n Z direction: 0 1\n" \
    " Energy bin boundaries: 0 1\n X Y Z Result Rel Error\n"

static void refuse_mesh(const char *text, enum error_code code, const char *word)
{
    struct tally tally;
    struct error err = { 0 };
    size_t n = strlen(text);
    uint8_t *copy = malloc(n + 1);
    assert_non_null(copy);
    memcpy(copy, text, n);
    assert_false(meshtal_read(copy, n, "it", &unsaid, &tally, &err));
    free(copy);
    if (err.code != code || !strstr(err.text, word))
        fail_msg("'%s', expected '%s'", err.text, word);
}

static void a_mesh_tally_that_is_cut_or_changed_is_refused_with_the_line(void **state)
{
    (void)state;
    refuse_mesh("", ERROR_FORMAT, "no line says Mesh Tally Number");
    refuse_mesh(MESH_HEAD "0.5 0.5 0.5 1 .1\n", ERROR_FORMAT, "1 of its 2 boxes");
    refuse_mesh(MESH_HEAD "0.5 0.5 0.5 1 .1\n0.5 0.5 0.5 1 .1\n", ERROR_FORMAT, "line 9: this box was there before");
    refuse_mesh(MESH_HEAD "0.5 0.5 0.5 1 .1\n2.5 0.5 0.5 1 .1\n", ERROR_FORMAT, "line 9: x is 2.5 cm");
    refuse_mesh(MESH_HEAD "0.5 0.5 0.5 1 .1\n1.0 0.5 0.5 1 .1\n", ERROR_FORMAT, "line 9: x is 1 cm");
    refuse_mesh(MESH_HEAD "0.5 0.5 0.5 1 -.1\n", ERROR_FORMAT, "line 8: a value within");
    refuse_mesh(MESH_HEAD "0.5 0.5 0.5 one .1\n", ERROR_FORMAT, "line 8: a column holds no number");
    refuse_mesh(MESH_HEAD "0.5 0.5 0.5 1\n", ERROR_FORMAT, "line 8: a column is missing");
    refuse_mesh("Mesh Tally Number 4\nX direction: 0 1 3\n", ERROR_UNSUPPORTED, "bound 2 along x is 1 cm");
    refuse_mesh("Mesh Tally Number 4\nX direction: 1 0\n", ERROR_RANGE, "do not grow");
    refuse_mesh("Mesh Tally Number 4\nEnergy bin boundaries: 0 1\n", ERROR_FORMAT, "no bounds along x");
    refuse_mesh("Mesh Tally Number 4\nMesh Tally Number 14\n", ERROR_RANGE, "2 mesh tallies");
}

/* The errors behind another bin's line would lie in boxes of another axis, or of another energy. */
static void errors_that_do_not_follow_their_matrix_are_refused(void **state)
{
    (void)state;
#define MATRIX_HEAD \
    " Mesh Tally Number 4\n X direction: 0 1 2\n Y direction: 0 1 2\n Z direction: 0 1 2\n Energy bin boundaries: 0 1\n" \
    " Z bin: 0 - 1\n Tally Results:  X (across) by Y (down)\n 0.5 1.5\n 0.5 1 2\n 1.5 3 4\n"
    static const char *const between[] = { "X bin: 0 - 1",          "Y bin: 1 - 2",     "Z bin: 1 - 2",
                                           "Energy Bin: 0 - 1 MeV", "Total Energy Bin", "Time Bin: 0 - 1",
                                           "Total Time Bin" };
    for (size_t i = 0; i < sizeof between / sizeof *between; i++) {
        char text[512];
        snprintf(text, sizeof text, "%s %s\n Relative Errors\n 0.5 1.5\n 0.5 .1 .1\n 1.5 .1 .1\n", MATRIX_HEAD,
                 between[i]);
        refuse_mesh(text, ERROR_FORMAT, "line 12: errors before their values");
    }
}

/* ---- PHITS -------------------------------------------------------------------------------------------------------- */

static bool read_phits(const char *name, struct tally *tally, struct error *err)
{
    size_t size;
    char path[128];
    snprintf(path, sizeof path, "formats/phits/%s", name);
    uint8_t *bytes = real(path, &size);
    if (!bytes)
        skip();
    assert_true(phits_tally_is(bytes, size) && !meshtal_is(bytes, size));
    bool is_read = phits_tally_read(bytes, size, name, &unsaid, tally, err);
    free(bytes);
    return is_read;
}

static void deposits_along_an_axis_have_the_sums_of_the_answers(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        uint32_t size[3];
        double sum, first, low, high, most_error;
    } files[] = {
        { "deposit-x-water-15-3.out", { 1, 1, 80 }, 2.671659e-11, 3.2923e-13, 3.2669e-13, 3.3836e-13, .0039 },
        { "deposit-y-water.out", { 1, 150, 1 }, 2.2764889e-11, 1.3438e-13, 4.7991e-14, 3.2574e-13, .0252 },
        { "I075-deposit-z-water-50.out", { 1, 1, 80 }, 7.105768e-12, 3.1258e-16, 2.8828e-16, 1.1953e-12, .1513 }
    };
    for (int f = 0; f < 3; f++) {
        struct tally tally;
        struct error err = { 0 };
        double low = 1, high = 0, error = 0;
        if (!read_phits(files[f].name, &tally, &err))
            fail_msg("%s", err.text);
        assert_memory_equal(tally.size, files[f].size, sizeof tally.size);
        for (size_t i = 0; i < (size_t)tally.size[0] * tally.size[1] * tally.size[2]; i++) {
            low = fmin(low, (double)tally.values[i]);
            high = fmax(high, (double)tally.values[i]);
            error = fmax(error, (double)tally.errors[i] / (double)tally.values[i]);
        }
        assert_near(sum_of(tally.values, &tally), files[f].sum, 1e-6);
        assert_near(tally.values[0], files[f].first, 1e-6);
        assert_near(low, files[f].low, 1e-6);
        assert_near(high, files[f].high, 1e-6);
        assert_near(error, files[f].most_error, 1e-4);
        assert_non_null(strstr(tally.words, "[T-Deposit] of PHITS, in Gy/source"));
        tally_finish(&tally);
    }
}

/* The first row of the plane is x = +1.975, and z grows along it. */
static void a_plane_of_a_track_lies_as_its_order_says(void **state)
{
    (void)state;
    struct tally tally;
    struct error err = { 0 };
    if (!read_phits("track-xz-water-ic-3.out", &tally, &err))
        fail_msg("%s", err.text);
    assert_true(tally.size[0] == 80 && tally.size[1] == 1 && tally.size[2] == 80);
    assert_near(sum_of(tally.values, &tally), 432.84065, 1e-6);
    assert_near(at(&tally, 79, 0, 0), 2.987e-3, 1e-6);
    assert_near(at(&tally, 79, 0, 1), 3.153e-3, 1e-6);
    assert_near(at(&tally, 79, 0, 10), 3.717e-3, 1e-6);
    assert_near(at(&tally, 0, 0, 79), 2.973e-3, 1e-6); /* the last number of the file's plane */
    assert_close(tally.step_cm[0], .05, 1e-9);
    assert_close(tally.low_cm[1], 1.4, 1e-9);
    assert_null(tally.errors);
    /* A file of the same form with relative errors. */
    size_t size;
    uint8_t *bytes = real("formats/phits/track-xz-water-ic-3.out", &size);
    assert_non_null(bytes);
    assert_true(phits_tally_read_errors(bytes, size, "err", &unsaid, &tally, &err));
    assert_near(tally.errors[79], 2.987e-3 * 2.987e-3, 1e-5);
    free(bytes);
    tally_finish(&tally);
}

#define PHITS_HEAD \
    "[ T - Deposit ]\n mesh = xyz\n x-type = 2\n xmin = 0\n xmax = 2\n nx = 2\n ymin = 0\n ymax = 1\n ny = 1\n zmin = 0\n" \
    " zmax = 1\n nz = 1\n unit = 0 # unit is [Gy/source]\n"
#define PHITS_PAGE "#newpage:\n#   no. =  1   iy  =  1   iz  =  1\n#  x-lower  x-upper  all  r.err\n"

static void refuse_phits(const char *text, enum error_code code, const char *word)
{
    struct tally tally;
    struct error err = { 0 };
    size_t n = strlen(text);
    uint8_t *copy = malloc(n + 1);
    assert_non_null(copy);
    memcpy(copy, text, n);
    assert_false(phits_tally_read(copy, n, "it", &unsaid, &tally, &err));
    free(copy);
    if (err.code != code || !strstr(err.text, word))
        fail_msg("'%s', expected '%s'", err.text, word);
}

static void a_tally_of_phits_that_is_cut_or_changed_is_refused_with_the_line(void **state)
{
    (void)state;
    const char *whole = PHITS_HEAD " axis = x\n" PHITS_PAGE "0 1 5 .1\n1 2 6 .1\n";
    struct tally tally;
    struct error err = { 0 };
    if (!phits_tally_read((const uint8_t *)whole, strlen(whole), "it", &unsaid, &tally, &err))
        fail_msg("%s", err.text);
    assert_close(tally.values[1], 6, 0);
    assert_close(tally.errors[1], .6, 1e-6);
    tally_finish(&tally);
    refuse_phits("[ T - Cross ]\n", ERROR_UNSUPPORTED, "neither [T-Deposit]");
    refuse_phits("[ T - Deposit ]\n mesh = r-z\n", ERROR_UNSUPPORTED, "meshes xyz are read");
    refuse_phits("[ T - Deposit ]\n x-type = 1\n", ERROR_UNSUPPORTED, "type 2");
    refuse_phits(PHITS_HEAD " axis = eng\n" PHITS_PAGE, ERROR_UNSUPPORTED, "its axis is 'eng'");
    refuse_phits(PHITS_HEAD " axis = x\n" PHITS_PAGE "0 1 5 .1\n", ERROR_FORMAT, "ends within a page");
    refuse_phits(PHITS_HEAD " axis = x\n" PHITS_PAGE "1 2 6 .1\n0 1 5 .1\n", ERROR_FORMAT, "line 18: the row's bounds");
    refuse_phits(PHITS_HEAD " axis = x\n" PHITS_PAGE "0 1 5 .1\n1 2 6\n", ERROR_FORMAT, "line 19: lower and upper");
    refuse_phits(PHITS_HEAD " axis = x\n#newpage:\n#  x-lower  x-upper  neutron  r.err  photon  r.err\n"
                            "0 1 5 .1 50 .1\n1 2 6 .1 60 .1\n",
                 ERROR_UNSUPPORTED, "line 17: values of several particles");
    const char *parts = PHITS_HEAD " axis = x\n#newpage:\n#  x-lower  x-upper  all  r.err  photon  r.err\n"
                                   "0 1 5 .1 3 .1\n1 2 6 .1 4 .1\n";
    assert_true(phits_tally_read((const uint8_t *)parts, strlen(parts), "it", &unsaid, &tally, &err));
    assert_close(tally.values[1], 6, 0);
    tally_finish(&tally);
    refuse_phits(PHITS_HEAD " axis = x\n#newpage:\n# no. = 1 iz = 2\n", ERROR_FORMAT, "line 16: the page's place");
    refuse_phits(PHITS_HEAD " axis = x\n#newpage:\n", ERROR_FORMAT, "0 of the mesh's 2 boxes");
    refuse_phits(PHITS_HEAD " axis = xy\n#newpage:\nhc: y = 1\n1 2\n", ERROR_UNSUPPORTED, "the order of its numbers");
    refuse_phits(PHITS_HEAD " axis = xy\n#newpage:\n# ( ( data(z,x), z = 1, nz ), x = nx, 1, -1 )\n", ERROR_FORMAT,
                 "not that of its axes");
}

/* ---- in the patient ----------------------------------------------------------------------------------------------- */

static void a_box_lies_where_axes_and_origin_say(void **state)
{
    (void)state;
    struct tally tally;
    struct error err = { 0 };
    struct tally_placing placing = { "RAS", { 100, 200, 300 }, 10 };
    assert_true(read_mesh("fmesh_104.msht", &unsaid, &tally, &err));
    struct volume *volume = tally_volume(&tally, &placing, false, "it", &err);
    assert_non_null(volume);
    /* Box 1, 0, 2 of the code: its centre at 5.625, 1.5, 12.5 cm; x grows to the right, -x of LPS. */
    struct vec3 centre = affine_point(&volume->grid.lps_mm_from_ijk, vec3(1, 0, 2));
    assert_point(centre, 100 - 56.25, 200 - 15, 300 + 125, 1e-9);
    assert_close(volume_value(volume, 1, 0, 2), 90, 1e-3);
    volume_unref(volume);
    volume = tally_volume(&tally, &placing, true, "it", &err);
    assert_non_null(volume);
    assert_near(volume_value(volume, 1, 0, 2), 90 * .092, 1e-4);
    volume_unref(volume);
    struct tally_placing lying = { "ASL", { 0, 0, 0 }, 1 };
    volume = tally_volume(&tally, &lying, false, "it", &err);
    assert_point(affine_point(&volume->grid.lps_mm_from_ijk, vec3(0, 0, 0)), 25, -18.75, 15, 1e-9);
    volume_unref(volume);
    static const char bad[][4] = { "LPP", "LRS", "XYZ", "" };
    for (int i = 0; i < 4; i++) {
        memcpy(lying.axes, bad[i], 4);
        assert_null(tally_volume(&tally, &lying, false, "it", &err));
        assert_int_equal(err.code, ERROR_RANGE);
    }
    struct tally_placing huge = { "LPS", { 0, 0, 0 }, 1e38 };
    assert_null(tally_volume(&tally, &huge, false, "it", &err));
    assert_non_null(strstr(err.text, "is no number that a dose can have"));
    tally_finish(&tally);
}

#define TALLY \
    "{\"format\":\"beamroom-tally\",\"version\":1,\"file\":\"meshtal\",\"factor\":2,\"axes\":\"LPS\",\"origin_mm\":[0,0,0]"

static void refuse_file(const char *text, const char *word)
{
    struct tally_file file;
    struct error err = { 0 };
    assert_false(tally_file_parse((const uint8_t *)text, strlen(text), "t.tally.json", &file, NULL, &err));
    if (!strstr(err.text, word))
        fail_msg("'%s', expected '%s'", err.text, word);
}

static void a_tally_file_guesses_nothing(void **state)
{
    (void)state;
    struct tally_file file;
    struct error err = { 0 };
    const char *whole = TALLY ",\"energy\":\"total\",\"tally\":14,\"normalisation\":\"per MW-min\"}";
    assert_true(tally_file_parse((const uint8_t *)whole, strlen(whole), "t", &file, NULL, &err));
    assert_true(file.choice.number == 14 && file.choice.energy == TALLY_ENERGY_TOTAL && file.placing.factor == 2);
    refuse_file("{\"format\":\"beamroom-tally\",\"version\":1,\"file\":\"m\"}", "factor: expected a number");
    refuse_file("{\"format\":\"beamroom-tally\",\"version\":1,\"file\":\"m\",\"factor\":1}",
                "axes: expected the patient's sides");
    refuse_file("{\"format\":\"beamroom-tally\",\"version\":1,\"file\":\"m\",\"factor\":1,\"axes\":\"LPS\"}",
                "origin_mm");
    refuse_file("{\"format\":\"beamroom-tally\",\"version\":1}", "file");
    refuse_file("{\"format\":\"beamroom-tally\",\"version\":2}", "version 1");
    refuse_file("{\"format\":\"beamroom-beam\",\"version\":1}", "beamroom-tally");
    refuse_file(TALLY ",\"energy\":0}", "energy: expected a whole number from 1");
    refuse_file(TALLY ",\"energy\":1.5}", "energy");
}

static void a_plan_shows_a_tally_with_its_error_and_says_how_it_was_taken(void **state)
{
    (void)state;
    char folder[256];
    struct error err = { 0 };
    folder_make(folder);
    folder_put_text(
        folder, "plan.json",
        "{\"format\":\"beamroom-plan\",\"version\":1,\"doses\":[{\"id\":\"mc\",\"unit\":\"Gy\",\"per\":\"minute\","
        "\"components\":[{\"quantity\":\"boron\",\"path\":\"mc/boron.tally.json\"}]}]}");
    folder_put_text(folder, "mc/boron.tally.json", TALLY ",\"normalisation\":\"two neutrons a minute\"}");
    folder_put_text(folder, "mc/meshtal", MESH_HEAD "0.5 0.5 0.5 3 .1\n1.5 0.5 0.5 4 .25\n");
    struct plan *plan = plan_of_folder(folder, &err);
    if (!plan)
        fail_msg("%s", err.text);
    assert_int_equal(plan->n_doses, 1);
    const struct dose_component *component = &plan->doses[0].components[0];
    assert_int_equal(component->quantity, DOSE_BORON);
    assert_close(volume_value(component->values, 0, 0, 0), 6, 1e-6);
    assert_non_null(component->error);
    assert_close(volume_value(component->error, 1, 0, 0), 2, 1e-6);
    static const char *const said[] = {
        "mesh tally 4 of MCNP, all energies from 0 to 1 MeV: x, y, z were taken as cm towards L, P, S, with 0 at 0, 0, 0 "
        "mm, and each value multiplied by 2 (two neutrons a minute).",
        "Largest value 8 at 15.0, 5.0, 5.0 mm; times volume the values add up to 14 (in the unit times cm3), in boxes of 10 x 10 x 10 mm; with errors.",
    };
    size_t n = 0;
    for (size_t i = 0; i < plan->report.n_lines; i++)
        if (strcmp(plan->report.lines[i].code, "dose.tally") == 0) {
            assert_true(n < 2);
            assert_string_equal(plan->report.lines[i].where, "mc/boron.tally.json");
            assert_string_equal(plan->report.lines[i].sentence, said[n++]);
        }
    assert_int_equal(n, 2);
    plan_destroy(plan);
    folder_remove(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(five_arrangements_of_a_mesh_tally_are_one_field),
        cmocka_unit_test(energies_have_to_be_chosen_and_several_times_count_by_their_total),
        cmocka_unit_test(a_real_run_adds_up_over_its_energies),
        cmocka_unit_test(cylinders_are_refused_by_name),
        cmocka_unit_test(a_mesh_tally_that_is_cut_or_changed_is_refused_with_the_line),
        cmocka_unit_test(errors_that_do_not_follow_their_matrix_are_refused),
        cmocka_unit_test(deposits_along_an_axis_have_the_sums_of_the_answers),
        cmocka_unit_test(a_plane_of_a_track_lies_as_its_order_says),
        cmocka_unit_test(a_tally_of_phits_that_is_cut_or_changed_is_refused_with_the_line),
        cmocka_unit_test(a_box_lies_where_axes_and_origin_say),
        cmocka_unit_test(a_tally_file_guesses_nothing),
        cmocka_unit_test(a_plan_shows_a_tally_with_its_error_and_says_how_it_was_taken),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
