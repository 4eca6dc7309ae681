/* Files of particles against an independent reader, and what is refused of them and where. */
#include "core/formats/iaea_phase_space.h"
#include "core/formats/mcpl.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/oracle.h"

#define ORACLE "tests/oracle/beam_particles.py"

static bool read_any(const char *path, struct beam_particles *particles, struct error *err)
{
    size_t size;
    uint8_t *bytes = file_bytes(path, &size);
    assert_true(mcpl_is(bytes, size));
    bool is_read = mcpl_read(bytes, size, "it", particles, err);
    free(bytes);
    return is_read;
}

static void read_pair(const char *folder, const char *stem, struct beam_particles *particles)
{
    char path[512];
    struct iaea_header header;
    struct error err = { 0 };
    size_t size;
    snprintf(path, sizeof path, "%s/%s.IAEAheader", folder, stem);
    uint8_t *bytes = file_bytes(path, &size);
    if (!iaea_header_parse(bytes, size, stem, &header, &err))
        fail_msg("%s", err.text);
    free(bytes);
    snprintf(path, sizeof path, "%s/%s.IAEAphsp", folder, stem);
    bytes = file_bytes(path, &size);
    if (!iaea_phase_space_read(&header, bytes, size, stem, particles, &err))
        fail_msg("%s", err.text);
    free(bytes);
}

static void add_up(const struct beam_particle *from, size_t n, double sums[8])
{
    for (size_t i = 0; i < n; i++) {
        sums[0] += (double)from[i].energy_mev;
        sums[1] += (double)from[i].weight;
        for (int axis = 0; axis < 3; axis++) {
            sums[2 + axis] += (double)from[i].position_cm[axis];
            sums[5 + axis] += (double)from[i].direction[axis];
        }
    }
}

static void compare(const struct beam_particles *particles, const char *line)
{
    unsigned long n[3];
    double expected[8], sums[8] = { 0 };
    assert_int_equal(sscanf(line, "%lu %lu %lu %lf %lf %lf %lf %lf %lf %lf %lf", &n[0], &n[1], &n[2], &expected[0],
                            &expected[1], &expected[2], &expected[3], &expected[4], &expected[5], &expected[6],
                            &expected[7]),
                     11);
    assert_int_equal(particles->n_neutrons, n[0]);
    assert_int_equal(particles->n_photons, n[1]);
    assert_int_equal(particles->n_others, n[2]);
    add_up(particles->neutrons, particles->n_neutrons, sums);
    add_up(particles->photons, particles->n_photons, sums);
    for (int i = 0; i < 8; i++)
        assert_close(sums[i], expected[i], 2e-6 * (fabs(expected[i]) + (double)(n[0] + n[1])));
}

/* The oracle's answers to files, a line each; NULL: no Python. */
static char *ask(char *const *arguments)
{
    enum { MOST = 1 << 16 };
    char *out = malloc(MOST);
    assert_non_null(out);
    int status = oracle_run(arguments, out, MOST);
    if (status == ORACLE_MISSING) {
        free(out);
        return NULL;
    }
    assert_int_equal(status, 0);
    return out;
}

static void compare_file(const char *path)
{
    struct beam_particles particles;
    struct error err = { 0 };
    char *out = ask((char *[]){ oracle_python(), ORACLE, "sums", (char *)(uintptr_t)path, NULL });
    if (!out)
        skip();
    if (!read_any(path, &particles, &err))
        fail_msg("%s: %s", path, err.text);
    compare(&particles, out);
    beam_particles_finish(&particles);
    free(out);
}

static void real_files_hold_what_another_reader_finds(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        size_t n; /* of ANSWERS.txt */
    } files[] = { { "example.mcpl", 1006 },
                  { "gammas_uw.mcpl.gz", 15 },
                  { "openmc_surface_source.mcpl", 1000 },
                  { "ref_statsum.mcpl.gz", 100 } };
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        char name[128], path[512];
        struct beam_particles particles;
        struct error err = { 0 };
        snprintf(name, sizeof name, "formats/mcpl/%s", files[i].name);
        if (!data_path(name, path, sizeof path))
            skip();
        compare_file(path);
        assert_true(read_any(path, &particles, &err));
        assert_int_equal(particles.n_neutrons + particles.n_photons + particles.n_others, files[i].n);
        assert_true(particles.is_count_given && particles.title[0]);
        beam_particles_finish(&particles);
    }
}

static void a_real_file_that_was_cut_is_refused_with_its_count(void **state)
{
    (void)state;
    char path[512];
    struct beam_particles particles;
    struct error err = { 0 };
    if (!data_path("formats/mcpl/reffile_truncated.mcpl", path, sizeof path))
        skip();
    assert_false(read_any(path, &particles, &err));
    assert_int_equal(err.code, ERROR_FORMAT);
    assert_non_null(strstr(err.text, "15 particles of 32 bytes"));
}

static char *make_folder(char folder[256])
{
    folder_make(folder);
    char *out = ask((char *[]){ oracle_python(), ORACLE, "make", folder, NULL });
    if (!out)
        folder_remove(folder);
    return out;
}

/* Known particles, worked out by hand: 3 neutrons, 2 photons and an electron. */
static void check_known(const struct beam_particles *particles, double weight, double z_cm)
{
    const double s = sqrt(.6);
    assert_int_equal(particles->n_neutrons, 3);
    assert_int_equal(particles->n_photons, 2);
    assert_int_equal(particles->n_others, 1);
    const struct beam_particle *n = particles->neutrons, *p = particles->photons;
    assert_close(n[0].energy_mev, 1e-6, 1e-12);
    assert_close(n[1].energy_mev, 2.5, 1e-6);
    assert_close(n[1].position_cm[0], -1, 0);
    assert_close(n[1].position_cm[1], .5, 0);
    assert_close(n[1].position_cm[2], isnan(z_cm) ? -3 : z_cm, 0);
    assert_close(n[1].direction[0], -.6, 1e-6);
    assert_close(n[1].direction[1], -.2, 1e-6);
    assert_close(n[1].direction[2], -s, 1e-6);
    assert_close(n[1].weight, isnan(weight) ? .25 : weight, 0);
    assert_close(n[2].direction[0], 1, 1e-6);
    assert_close(p[0].direction[0], -s, 1e-6);
    assert_close(p[0].direction[2], -.6, 1e-6);
    assert_close(p[1].direction[1], -s, 1e-6);
    assert_close(p[1].energy_mev, 2.2246, 1e-6);
}

static void all_arrangements_of_mcpl_give_the_same_particles(void **state)
{
    (void)state;
    char folder[256], path[512];
    char *out = make_folder(folder);
    if (!out)
        skip();
    for (int i = 0; i < 16; i++) {
        struct beam_particles particles;
        struct error err = { 0 };
        snprintf(path, sizeof path, "%s/%c%d%d%d.mcpl", folder, i & 8 ? 'B' : 'L', i >> 2 & 1, i >> 1 & 1, i & 1);
        if (!read_any(path, &particles, &err))
            fail_msg("%s: %s", path, err.text);
        check_known(&particles, NAN, NAN);
        assert_string_equal(particles.title, "made");
        beam_particles_finish(&particles);
    }
    struct beam_particles particles;
    struct error err = { 0 };
    snprintf(path, sizeof path, "%s/universal.mcpl.gz", folder);
    assert_true(read_any(path, &particles, &err));
    assert_int_equal(particles.n_neutrons, 6); /* one code for all */
    assert_close(particles.neutrons[5].weight, .125, 0);
    beam_particles_finish(&particles);
    snprintf(path, sizeof path, "%s/cut.mcpl", folder);
    assert_true(read_any(path, &particles, &err));
    check_known(&particles, NAN, NAN);
    assert_false(particles.is_count_given);
    beam_particles_finish(&particles);
    folder_remove(folder);
    free(out);
}

static void a_phase_space_gives_kinds_signs_constants_and_histories(void **state)
{
    (void)state;
    char folder[256];
    char *out = make_folder(folder);
    if (!out)
        skip();
    static const char *const stems[] = { "all", "big", "plane" };
    for (int i = 0; i < 3; i++) {
        struct beam_particles particles;
        read_pair(folder, stems[i], &particles);
        check_known(&particles, i == 2 ? 1 : NAN, i == 2 ? 26.5 : NAN);
        assert_close(particles.histories, 200, 0);
        assert_string_equal(particles.title, "made of known particles");
        beam_particles_finish(&particles);
    }
    folder_remove(folder);
    free(out);
}

/* ---- what is refused ---------------------------------------------------------------------------------------------- */

static void put(uint8_t *at, uint64_t value, int n)
{
    for (int i = 0; i < n; i++)
        at[i] = (uint8_t)(value >> (8 * i));
}

static void put_float(uint8_t *at, float value)
{
    memcpy(at, &value, 4);
}

enum { MCPL_SIZE = 48 + 4 + 4 * 36 };

/* Four neutrons of single precision. */
static void make_mcpl(uint8_t file[MCPL_SIZE])
{
    memset(file, 0, MCPL_SIZE);
    memcpy(file, "MCPL003L", 8);
    put(file + 8, 4, 8);
    put(file + 32, 1, 4);
    put(file + 40, 36, 4);
    for (int i = 0; i < 4; i++) {
        uint8_t *at = file + 52 + 36 * i;
        put_float(at + 20, 1e-6F);
        put_float(at + 28, 1);
        put(at + 32, 2112, 4);
    }
}

static void refuse_mcpl(const uint8_t *file, size_t size, enum error_code code, const char *word)
{
    struct beam_particles particles;
    struct error err = { 0 };
    uint8_t *copy = malloc(size ? size : 1); /* of its size, for the address sanitizer */
    assert_non_null(copy);
    memcpy(copy, file, size);
    assert_false(mcpl_read(copy, size, "it", &particles, &err));
    assert_null(particles.neutrons);
    free(copy);
    if (err.code != code || !strstr(err.text, word))
        fail_msg("'%s', expected '%s'", err.text, word);
}

static void mcpl_that_is_cut_or_changed_is_refused_with_the_place(void **state)
{
    (void)state;
    uint8_t file[MCPL_SIZE];
    struct beam_particles particles;
    struct error err = { 0 };
    make_mcpl(file);
    assert_true(mcpl_read(file, sizeof file, "it", &particles, &err));
    assert_int_equal(particles.n_neutrons, 4);
    beam_particles_finish(&particles);
    for (size_t size = 0; size < sizeof file; size++)
        refuse_mcpl(file, size, ERROR_FORMAT, size < 48 ? "header" : size < 52 ? "cut" : "counts 4");
    static const struct {
        int at, n;
        uint64_t value;
        enum error_code code;
        const char *word;
    } changes[] = {
        { 4, 3, 0x323030, ERROR_UNSUPPORTED, "version '002'" },
        { 7, 1, 'X', ERROR_FORMAT, "neither L nor B" },
        { 8, 8, UINT64_MAX, ERROR_FORMAT, "counts" },
        { 16, 4, UINT32_MAX, ERROR_LIMIT, "comments" },
        { 20, 4, 1, ERROR_FORMAT, "counts" },
        { 24, 4, 2, ERROR_FORMAT, "userflags" },
        { 28, 4, 1, ERROR_FORMAT, "36 bytes" },
        { 40, 4, 0, ERROR_FORMAT, "0 bytes" },
        { 48, 4, UINT32_MAX, ERROR_FORMAT, "byte 48" },
        { 52 + 36, 4, 0x7fc00000, ERROR_FORMAT, "particle 2, at byte 88: its place" },
        { 52 + 36 + 12, 4, 0x7fc00000, ERROR_FORMAT, "particle 2, at byte 88: its direction" },
        { 52 + 20, 4, 0x7f800000, ERROR_FORMAT, "particle 1, at byte 52: its energy" },
        { 52 + 28, 4, 0xbf800000, ERROR_FORMAT, "its weight" },
    };
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
        make_mcpl(file);
        put(file + changes[i].at, changes[i].value, changes[i].n);
        refuse_mcpl(file, sizeof file, changes[i].code, changes[i].word);
    }
}

#define HEADER \
    "$FILE_TYPE:\n0\n$CHECKSUM:\n58\n$RECORD_CONTENTS:\n1 // X\n1\n1\n1\n1\n1\n1\n0\n0\n$RECORD_LENGTH:\n29\n" \
    "$BYTE_ORDER:\n1234\n$PARTICLES:\n2\n"

static void refuse_header(const char *from, const char *to, enum error_code code, const char *word)
{
    char text[512] = HEADER;
    struct iaea_header header;
    struct error err = { 0 };
    char *at = strstr(text, from), rest[512];
    assert_non_null(at);
    snprintf(rest, sizeof rest, "%s", at + strlen(from));
    snprintf(at, sizeof text - (size_t)(at - text), "%s%s", to, rest);
    assert_false(iaea_header_parse((const uint8_t *)text, strlen(text), "it", &header, &err));
    if (err.code != code || !strstr(err.text, word))
        fail_msg("'%s', expected '%s'", err.text, word);
}

static void a_phase_space_that_is_cut_or_changed_is_refused_with_the_place(void **state)
{
    (void)state;
    struct iaea_header header;
    struct beam_particles particles;
    struct error err = { 0 };
    assert_true(iaea_header_parse((const uint8_t *)HEADER, strlen(HEADER), "it", &header, &err));
    refuse_header("$FILE_TYPE:\n0", "$FILE_TYPE:\n1", ERROR_UNSUPPORTED, "event generator");
    refuse_header("58", "57", ERROR_FORMAT, "$CHECKSUM is 57");
    refuse_header("29", "28", ERROR_FORMAT, "$RECORD_LENGTH is 28");
    refuse_header("1234", "3412", ERROR_FORMAT, "$BYTE_ORDER");
    refuse_header("1 // X", "2 // X", ERROR_FORMAT, "X is 2");
    refuse_header("1 // X", "0 // X", ERROR_FORMAT, "X is not stored");
    refuse_header("$PARTICLES:\n2", "", ERROR_FORMAT, "$PARTICLES");
    refuse_header("$PARTICLES:\n2", "$PARTICLES:\nmany", ERROR_FORMAT, "'many'");
    refuse_header("0\n0\n$RECORD_LENGTH", "$RECORD_LENGTH", ERROR_FORMAT, "7 lines");
    uint8_t records[58] = { 4, [29] = 6 };
    assert_false(iaea_phase_space_read(&header, records, sizeof records, "it", &particles, &err));
    assert_non_null(strstr(err.text, "particle 2 is of kind 6"));
    records[29] = 4;
    put_float(records + 29 + 17, 1.5F);
    assert_false(iaea_phase_space_read(&header, records, sizeof records, "it", &particles, &err));
    assert_non_null(strstr(err.text, "particle 2, at byte 29: its direction"));
    assert_null(particles.neutrons);
    assert_false(iaea_phase_space_read(&header, records, 57, "it", &particles, &err));
    assert_non_null(strstr(err.text, "57 bytes, and its header counts 2 particles of 29 bytes"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(real_files_hold_what_another_reader_finds),
        cmocka_unit_test(a_real_file_that_was_cut_is_refused_with_its_count),
        cmocka_unit_test(all_arrangements_of_mcpl_give_the_same_particles),
        cmocka_unit_test(a_phase_space_gives_kinds_signs_constants_and_histories),
        cmocka_unit_test(mcpl_that_is_cut_or_changed_is_refused_with_the_place),
        cmocka_unit_test(a_phase_space_that_is_cut_or_changed_is_refused_with_the_place),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
