/* SERA's beam sources: a made one, published ones, broken ones. */
#include "core/formats/sera/sera_source.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"

static const char made[] = " made beam\n@@ poison @@\n# note\n 0.0 0.0 5.000 0 1\n 1 2 1 1 2\n 1 1.0E+10 2.0E+08 7.5\n"
                           " 1.0E+06 1.0E+00\n 1.0E-03 2.0E+06 1.0E+05\n 9.0E-01 1.0E-01\n 1.0\n .9 .0 .8 .5\n .7 .0\n";

static bool parse(const char *text, struct beam_source *source, struct error *err)
{
    *err = (struct error){ 0 };
    return sera_source_parse((const uint8_t *)text, strlen(text), "made.source", source, err);
}

static void a_source_is_read_group_by_group(void **state)
{
    (void)state;
    static struct beam_source source;
    struct error err;
    assert_true(parse(made, &source, &err));
    assert_string_equal(source.name, "made beam");
    assert_close(source.to_aperture_cm, 5, 0);
    assert_close(source.radius_cm, 7.5, 0);
    assert_int_equal(source.neutrons.n_groups, 2);
    assert_int_equal(source.photons.n_groups, 1);
    assert_close(source.neutrons.per_cm2, 1e10, 0);
    assert_close(source.neutrons.bounds_ev[2], 1e-3, 0);
    assert_close(source.neutrons.share[1], .1, 0);
    assert_close(source.neutrons.cuts[1][0], .8, 0);
    assert_close(source.neutrons.cuts[1][1], .5, 0);
    assert_close(source.photons.bounds_ev[0], 2e6, 0);
    assert_close(source.photons.cuts[0][0], .7, 0);
}

/* Figures of the files themselves; group shares of FIR_SHRT_12: thermal 5.2, epithermal 91.6, fast 3.2 %. */
static void published_sources_are_read(void **state)
{
    (void)state;
    static struct beam_source source;
    struct error err = { 0 };
    char path[512];
    if (!data_path("sera-st/beam/FIR_SHRT_12.source", path, sizeof path))
        skip();
    size_t size;
    uint8_t *bytes = file_bytes(path, &size);
    assert_true(sera_source_parse(bytes, size, "FIR_SHRT_12.source", &source, &err));
    free(bytes);
    assert_close(source.neutrons.per_cm2, 1.9342e11, 1);
    assert_close(source.photons.per_cm2, 1.147e9, 1);
    assert_int_equal(source.neutrons.n_groups, 47);
    assert_int_equal(source.photons.n_groups, 20);
    assert_int_equal(source.n_cuts, 10);
    double sum = 0, thermal = 0, fast = 0;
    for (size_t i = 0; i < 47; i++) {
        sum += source.neutrons.share[i];
        thermal += source.neutrons.bounds_ev[i] <= .5 ? source.neutrons.share[i] : 0;
        double high = source.neutrons.bounds_ev[i], low = source.neutrons.bounds_ev[i + 1];
        if (high > 9120) /* by lethargy where the group is cut */
            fast += source.neutrons.share[i] * log(high / fmax(low, 9120)) / log(high / low);
    }
    assert_close(thermal / sum, .052, .001);
    assert_close(fast / sum, .032, .001);
    static const char *const others[] = { "BPTB_C_8cmBS", "BPTB_F_12cmCG", "DOG_Apr98_8cmBS", "HFR_12_XG6",
                                          "hfr_93adj_8cm" };
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        char name[64];
        snprintf(name, sizeof name, "sera-st/beam/%s.source", others[i]);
        assert_true(data_path(name, path, sizeof path));
        bytes = file_bytes(path, &size);
        if (!sera_source_parse(bytes, size, others[i], &source, &err))
            fail_msg("%s", err.text);
        free(bytes);
    }
}

static void a_broken_source_is_refused_with_its_line(void **state)
{
    (void)state;
    static struct beam_source source;
    struct error err;
    assert_false(parse("", &source, &err));
    assert_non_null(strstr(err.text, "made.source: the file ends after line 0"));
    assert_false(parse("title\n 0 0 5 0 1\n 1 2 1 1\n 2000\n", &source, &err));
    assert_string_equal(err.text, "made.source: line 4: a number of cosines of 2000, 1 to 32 expected");
    assert_false(parse("title\n 0 0 5 0 1\n 1 129 1 1 1\n", &source, &err));
    assert_string_equal(err.text, "made.source: line 3: a number of neutron groups of 129, 1 to 128 expected");
    char text[sizeof made];
    memcpy(text, made, sizeof made);
    memcpy(strstr(text, "1.0E+00"), "1.0E+07", 7);
    assert_false(parse(text, &source, &err));
    assert_string_equal(err.text, "made.source: line 7: energy 1e+07 eV does not fall below 1e+06");
    memcpy(text, made, sizeof made);
    memcpy(strstr(text, "7.5"), "x.5", 3);
    assert_false(parse(text, &source, &err));
    assert_non_null(strstr(err.text, "'x.5' is no number, the disk's radius in cm expected"));
    for (size_t n = 0; n + 4 < sizeof made; n += 7) { /* cut anywhere: refused, and never more than what is there */
        memcpy(text, made, sizeof made);
        text[n] = '\0';
        assert_false(parse(text, &source, &err));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_source_is_read_group_by_group),
        cmocka_unit_test(published_sources_are_read),
        cmocka_unit_test(a_broken_source_is_refused_with_its_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
