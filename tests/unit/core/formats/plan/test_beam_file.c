/* The reader of beam files: lengths, keys, and what is refused, with its place. */
#include "core/formats/plan/beam_file.h"

#include "tests/check.h"

static struct beam_file file;
static struct error err;

static bool parse(const char *text, struct report *report)
{
    err = (struct error){ 0 };
    return beam_file_parse((const uint8_t *)text, strlen(text), "beam.json", &file, report, &err);
}

static void lengths_are_read_in_mm_and_points_in_patient_coordinates(void **state)
{
    (void)state;
    struct report report = { 0 };
    if (!parse(
            "{\"format\": \"beamroom-beam\", \"version\": 1, \"name\": \"made\", \"per\": \"minute\", \"colour\": 1,"
            " \"spectrum\": {\"radius_mm\": 70, \"distance_mm\": 120, \"cosines\": [0.9, 0.5],"
            " \"neutrons\": {\"energy_ev\": [2e6, 1e4, 1], \"share\": [1, 2], \"per_cm2\": 1e9, \"by_lethargy\": true},"
            " \"photons\": {\"energy_ev\": [2e6, 1e4], \"share\": [3], \"per_cm2\": 1e7}},"
            " \"delimiter\": {\"length_mm\": 100, \"exit_radius_mm\": 60, \"entrance_radius_mm\": 90},"
            " \"entry_mm\": [1, 2, 3], \"target_mm\": [4, 5, 6], \"materials\": {"
            " \"bone\": {\"g_cm3\": 1.6, \"weights\": {\"H\": 0.1, \"Ca\": 0.9}, \"ppm\": 3}, \"air\": {\"icru46\": \"air\"}}}",
            &report))
        fail_msg("%s", err.text);
    const struct beam_source *source = &file.source;
    assert_string_equal(file.name, "made");
    assert_string_equal(file.per, "minute");
    assert_near(source->radius_cm, 7, 1e-12);
    assert_near(source->to_aperture_cm, 12, 1e-12);
    assert_near(source->delimiter.length_cm, 10, 1e-12);
    assert_near(source->delimiter.exit_radius_cm, 6, 1e-12);
    assert_near(source->delimiter.entrance_radius_cm, 9, 1e-12);
    assert_near(source->delimiter.natural_lithium_from_cm, 200, 1e-12); /* absent: enriched all over */
    assert_int_equal(source->n_cuts, 2);
    assert_int_equal(source->neutrons.n_groups, 2);
    assert_near(source->neutrons.cuts[1][1], .5, 1e-12);
    assert_near(source->neutrons.share[1], 2, 1e-12);
    assert_true(source->neutrons.is_by_lethargy && !source->photons.is_by_lethargy);
    assert_near(source->photons.per_cm2, 1e7, 1e-12);
    assert_true(file.has_pose && file.entry_lps_mm.y > 1.99 && file.entry_lps_mm.y < 2.01);
    assert_near(file.target_lps_mm.z, 6, 1e-12);
    assert_int_equal(file.n_materials, 2);
    assert_string_equal(file.materials[0].elements[1].symbol, "Ca");
    assert_near(file.materials[0].boron_ppm, 3, 1e-12);
    assert_string_equal(file.materials[1].word, "air");
    assert_int_equal(report.n_lines, 1); /* the colour */
    report_finish(&report);
}

static void what_is_beyond_its_bounds_is_refused_with_its_place(void **state)
{
    (void)state;
#define BEAM "{\"format\": \"beamroom-beam\", \"version\": 1"
#define NEUTRONS "\"neutrons\": {\"energy_ev\": [2, 1], \"share\": [1], \"per_cm2\": 1}"
    static const struct {
        const char *text, *sentence;
    } rows[] = {
        { "{\"format\": \"beamroom-plan\", \"version\": 1}", "expected \"beamroom-beam\"" },
        { BEAM "}", "expected one of \"source\", \"spectrum\" and" },
        { BEAM ", \"source\": \"a\", \"spectrum\": {\"radius_mm\": 5, " NEUTRONS "}}", "expected one of" },
        { BEAM ", \"source\": \"../a\"}", "source" },
        { BEAM ", \"spectrum\": {\"radius_mm\": 5000, " NEUTRONS "}}", "expected a number from 0.01 to 2000" },
        { BEAM ", \"spectrum\": {\"radius_mm\": 5, \"cosines\": [], " NEUTRONS "}}",
          "spectrum.cosines: expected a list of 1 to 32 numbers from 0 to 1" },
        { BEAM ", \"spectrum\": {\"radius_mm\": 5, \"cosines\": [0.5, 0.5], " NEUTRONS "}}", "the numbers must fall" },
        { BEAM
          ", \"spectrum\": {\"radius_mm\": 5, \"neutrons\": {\"energy_ev\": [2, 1], \"share\": [0], \"per_cm2\": 1}}}",
          "the groups' shares are all 0" },
        { BEAM
          ", \"spectrum\": {\"radius_mm\": 5, \"neutrons\": {\"energy_ev\": [2, 1], \"share\": [1, 1], \"per_cm2\": 1}}}",
          "share: expected a list of 1 numbers" },
        { BEAM ", \"spectrum\": {\"radius_mm\": 5, " NEUTRONS
               "}, \"delimiter\": {\"length_mm\": 50, \"exit_radius_mm\": 60}}",
          "spectrum.distance_mm: is needed with a delimiter" },
        { BEAM ", \"spectrum\": {\"radius_mm\": 5, " NEUTRONS "}, \"entry_mm\": [1, 2, 3], \"target_mm\": [1, 2, 3]}",
          "is the same point as entry_mm" },
        { BEAM ", \"spectrum\": {\"radius_mm\": 5, " NEUTRONS
               "}, \"materials\": {\"bone\": {\"g_cm3\": 1, \"weights\": {\"H\": 2}}}}",
          "materials.bone.weights" },
        { BEAM ", \"spectrum\": {\"radius_mm\": 5, " NEUTRONS
               "}, \"materials\": {\"bone\": {\"icru46\": \"brain\", \"ppm\": -1}}}",
          "materials.bone.ppm" },
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        if (parse(rows[i].text, NULL))
            fail_msg("read: %s", rows[i].text);
        if (!strstr(err.text, rows[i].sentence) || strncmp(err.text, "beam.json: ", 11) != 0)
            fail_msg("'%s', expected '%s' for %s", err.text, rows[i].sentence, rows[i].text);
    }
    static uint8_t large[BEAM_FILE_MAX_BYTES + 1];
    assert_false(beam_file_parse(large, sizeof large, "beam.json", &file, NULL, &err));
    assert_int_equal(err.code, ERROR_LIMIT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lengths_are_read_in_mm_and_points_in_patient_coordinates),
        cmocka_unit_test(what_is_beyond_its_bounds_is_refused_with_its_place),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
