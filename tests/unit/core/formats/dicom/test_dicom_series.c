/* Series of slices as volumes: made-up slices with every trap of real ones. */
#include <stdatomic.h>
#include <unistd.h>

#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/made_series.h"

/* Slices at z_mm[] with base value 100 z; names and instance numbers run against the positions. */
static void put_row(const char *folder, const struct made_slice *like, const double *z_mm, int n)
{
    for (int i = 0; i < n; i++) {
        struct made_slice slice = *like;
        char name[32];
        slice.position[2] += z_mm[i];
        slice.base = (int)(100 * z_mm[i]);
        slice.number = 100 - i;
        snprintf(name, sizeof name, "IM%04d", (i * 7) % 101);
        made_slice_put(folder, name, &slice);
    }
}

static void check_point(const struct volume *volume, double i, double j, double k, double x, double y, double z)
{
    assert_point(affine_point(&volume->grid.lps_mm_from_ijk, vec3(i, j, k)), x, y, z, 1e-9);
}

static void slices_are_sorted_by_position_and_not_by_name_or_number(void **state)
{
    (void)state;
    struct scanned s = { 0 };
    folder_make(s.path);
    put_row(s.path, &made_slice_defaults, (double[]){ 6, -2, 0, 4, 2 }, 5);
    scanned_open(&s);
    assert_int_equal(s.index->n_stacks, 1);
    struct volume *volume = scanned_read(&s, 0);
    assert_int_equal(volume->grid.size[0], 3);
    assert_int_equal(volume->grid.size[1], 2);
    assert_int_equal(volume->grid.size[2], 5);
    assert_int_equal(volume->type, VOXEL_I16);
    for (uint32_t k = 0; k < 5; k++)
        for (uint32_t j = 0; j < 2; j++)
            for (uint32_t i = 0; i < 3; i++)
                assert_close(volume_value(volume, i, j, k), -200 + 200.0 * k + 10 * j + i, 0);
    check_point(volume, 0, 0, 0, 0, 0, -2);
    check_point(volume, 2, 1, 4, 2, 1, 6);
    assert_close(volume->low, -200, 0);
    assert_close(volume->high, 612, 0);
    assert_int_equal(s.report.n_lines, 0);
    volume_unref(volume);
    scanned_finish(&s);
}

static void pixels_need_not_be_square_and_slices_may_lie_obliquely(void **state)
{
    (void)state;
    struct scanned s = { 0 };
    folder_make(s.path);
    /* rows run to 0.6 L + 0.8 S, columns to P; the normal is row x column = (-0.8, 0, 0.6) */
    struct made_slice slice = made_slice_defaults;
    slice.spacing[0] = 1.5;
    slice.spacing[1] = 0.5;
    memcpy(slice.cosines, (double[]){ 0.6, 0, 0.8, 0, 1, 0 }, sizeof slice.cosines);
    for (int k = 0; k < 3; k++) {
        char name[16];
        memcpy(slice.position, (double[]){ 10 - 0.8 * 2 * k, 20, 30 + 0.6 * 2 * k }, sizeof slice.position);
        slice.base = 100 * k;
        slice.number = k;
        snprintf(name, sizeof name, "%d", 9 - k);
        made_slice_put(s.path, name, &slice);
    }
    scanned_open(&s);
    struct volume *volume = scanned_read(&s, 0);
    check_point(volume, 0, 0, 0, 10, 20, 30);
    check_point(volume, 2, 0, 0, 10 + 0.6, 20, 30 + 0.8); /* two pixels of 0.5 mm along the row */
    check_point(volume, 0, 1, 0, 10, 21.5, 30);           /* one of 1.5 mm down the column */
    check_point(volume, 0, 0, 2, 10 - 3.2, 20, 30 + 2.4);
    assert_close(volume_value(volume, 2, 1, 2), 212, 0);
    assert_int_equal(s.report.n_lines, 0);
    volume_unref(volume);
    scanned_finish(&s);
}

static void a_tilted_gantry_stays_a_shear(void **state)
{
    (void)state;
    struct scanned s = { 0 };
    folder_make(s.path);
    struct made_slice slice =
        made_slice_defaults; /* each slice is shifted 1 mm posterior per 2 mm up: atan(1 / 2) = 26.57 degrees */
    for (int k = 0; k < 4; k++) {
        char name[16];
        memcpy(slice.position, (double[]){ 5, 1.0 * k, 2.0 * k }, sizeof slice.position);
        slice.base = 100 * k;
        snprintf(name, sizeof name, "%d", k);
        made_slice_put(s.path, name, &slice);
    }
    scanned_open(&s);
    struct volume *volume = scanned_read(&s, 0);
    check_point(volume, 0, 0, 0, 5, 0, 0);
    check_point(volume, 0, 0, 3, 5, 3, 6);
    check_point(volume, 1, 1, 2, 6, 3, 4);
    const struct report_line *line = scanned_said(&s, "image.gantry-tilt");
    assert_non_null(line);
    assert_non_null(strstr(line->sentence, "26.57 degrees"));
    volume_unref(volume);
    scanned_finish(&s);
}

static void missing_slices_are_interpolated_and_named(void **state)
{
    (void)state;
    struct scanned s = { 0 };
    folder_make(s.path);
    put_row(s.path, &made_slice_defaults, (double[]){ 0, 2, 4, 8, 10, 12, 18 }, 7); /* 6, 14 and 16 are missing */
    scanned_open(&s);
    struct volume *volume = scanned_read(&s, 0);
    assert_int_equal(volume->grid.size[2], 10);
    for (uint32_t k = 0; k < 10; k++) /* the values grow linearly, so interpolated ones are known */
        assert_close(volume_value(volume, 1, 1, k), 200.0 * k + 11, 0);
    check_point(volume, 0, 0, 9, 0, 0, 18);
    const struct report_line *line = scanned_said(&s, "image.slices-missing");
    assert_non_null(line);
    assert_int_equal(line->severity, REPORT_WARNING);
    assert_non_null(strstr(line->sentence, "3 between them are missing, at 6.00, 14.00, 16.00 mm"));
    assert_null(scanned_said(&s, "image.slices-resampled"));
    volume_unref(volume);
    scanned_finish(&s);
}

static void uneven_slices_are_brought_to_the_smallest_usual_distance(void **state)
{
    (void)state;
    struct scanned s = { 0 };
    folder_make(s.path);
    put_row(s.path, &made_slice_defaults, (double[]){ 0, 1, 2, 3, 5.5, 8 },
            6); /* thin slices below, thick ones above */
    scanned_open(&s);
    struct volume *volume = scanned_read(&s, 0);
    assert_int_equal(volume->grid.size[2], 9);
    for (uint32_t k = 0; k < 9; k++) {
        /* values are rounded to whole numbers: tolerance 0.5 */
        assert_close(volume_value(volume, 0, 0, k), 100.0 * k, 0.5);
        check_point(volume, 0, 0, k, 0, 0, k);
    }
    const struct report_line *line = scanned_said(&s, "image.slices-resampled");
    assert_non_null(line);
    assert_non_null(
        strstr(line->sentence,
               "6 slices between 1 and 2.5 mm apart were interpolated to 9, 1 mm apart; 5 kept their values"));
    volume_unref(volume);
    scanned_finish(&s);
}

static void slices_a_little_off_their_places_are_taken_as_even_and_said_so(void **state)
{
    (void)state;
    struct scanned s = { 0 };
    folder_make(s.path);
    put_row(s.path, &made_slice_defaults, (double[]){ 0, 1.02, 2, 2.99, 4 }, 5); /* up to 2 % of the pitch */
    scanned_open(&s);
    struct volume *volume = scanned_read(&s, 0);
    assert_int_equal(volume->grid.size[2], 5);
    assert_close(volume_value(volume, 0, 0, 1), 102, 0); /* its own value, not an interpolated one */
    const struct report_line *line = scanned_said(&s, "image.locations-uneven");
    assert_non_null(line);
    assert_non_null(strstr(line->sentence, "up to 0.02 mm"));
    volume_unref(volume);
    scanned_finish(&s);
}

static void a_slice_a_tenth_off_its_place_is_not_taken_as_even(void **state)
{
    (void)state;
    struct scanned s = { 0 };
    folder_make(s.path);
    put_row(s.path, &made_slice_defaults, (double[]){ 0, 1.1, 2, 3, 4 }, 5);
    scanned_open(&s);
    struct volume *volume = scanned_read(&s, 0);
    assert_int_equal(volume->grid.size[2], 5);
    assert_close(volume_value(volume, 0, 0, 1), 100, 0.5); /* interpolated between those at 0 and 1.1 mm */
    assert_close(volume_value(volume, 0, 0, 2), 200, 0);
    assert_non_null(scanned_said(&s, "image.slices-resampled"));
    volume_unref(volume);
    scanned_finish(&s);
}

static void slices_that_lie_on_no_line_are_refused(void **state)
{
    (void)state;
    struct scanned s = { 0 };
    folder_make(s.path);
    struct made_slice slice = made_slice_defaults;
    for (int k = 0; k < 4; k++) {
        char name[16];
        memcpy(slice.position, (double[]){ k == 2 ? 30 : 0, 0, 2.0 * k }, sizeof slice.position);
        snprintf(name, sizeof name, "%d", k);
        made_slice_put(s.path, name, &slice);
    }
    scanned_open(&s);
    struct error err = { 0 };
    assert_null(dicom_series_read(&s.folder, s.index, 0, NULL, NULL, &s.report, &err));
    assert_int_equal(err.code, ERROR_UNSUPPORTED);
    assert_non_null(strstr(err.text, "do not lie on a straight line: one is 30 mm beside it"));
    scanned_finish(&s);
}

static void values_are_rescaled_whatever_their_bits_and_sign(void **state)
{
    (void)state;
    static const struct {
        int bits, stored, is_signed, base;
        enum voxel_type type;
    } cases[] = {
        { 16, 16, 1, -1000, VOXEL_I16 }, { 16, 12, 1, -1000, VOXEL_I16 }, { 16, 16, 0, 60000, VOXEL_U16 },
        { 16, 12, 0, 4000, VOXEL_U16 },  { 8, 8, 0, 200, VOXEL_U8 },      { 8, 8, 1, -100, VOXEL_I16 },
        { 32, 32, 1, -1000, VOXEL_F32 },
    };
    static const char *const encodings[] = { MADE_EXPLICIT, MADE_IMPLICIT, MADE_BIG_ENDIAN };
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++)
        for (size_t e = 0; e < 3; e++) {
            if (cases[c].bits != 16 && e == 2)
                continue;
            struct scanned s = { 0 };
            folder_make(s.path);
            struct made_slice slice = made_slice_defaults;
            slice.transfer_syntax = encodings[e];
            slice.bits = cases[c].bits;
            slice.stored = cases[c].stored;
            slice.is_signed = cases[c].is_signed;
            slice.base = cases[c].base;
            slice.has_rescale = true;
            slice.slope = 0.5;
            slice.offset = -7;
            slice.thickness = 3;
            made_slice_put(s.path, "one", &slice);
            scanned_open(&s);
            struct volume *volume = scanned_read(&s, 0);
            assert_int_equal(volume->type, cases[c].type);
            for (uint32_t j = 0; j < 2; j++)
                for (uint32_t i = 0; i < 3; i++)
                    assert_close(volume_value(volume, i, j, 0), 0.5 * (cases[c].base + 10.0 * j + i) - 7, 0);
            assert_close(volume->low, 0.5 * cases[c].base - 7, 0);
            assert_close(volume->high, 0.5 * (cases[c].base + 12) - 7, 0);
            assert_non_null(scanned_said(&s, "image.single-slice"));
            check_point(volume, 0, 0, 1, 0, 0, 3); /* slice thickness of the file */
            volume_unref(volume);
            scanned_finish(&s);
        }
}

/* Stored values are base + 10 y + x: 0, 1, 2 and 10, 11, 12 more. */
static void pixels_with_the_padding_value_have_no_value(void **state)
{
    (void)state;
    static const struct {
        int is_signed, bits, base, n_padding, padding[2];
        double low_slope_of_second; /* of the second slice; 1: all alike */
        double low, high;
        size_t n_padded; /* pixels of a slice */
    } cases[] = {
        { 1, 16, -2000, 1, { -2000, 0 }, 1, -1999, -1988, 1 }, /* written as US: 63536 */
        { 1, 16, -2000, 2, { -2000, -1990 }, 1, -1989, -1988, 4 },
        { 1, 16, -2000, 2, { -1990, -2000 }, 1, -1989, -1988, 4 }, /* the limit may be the lower one */
        { 0, 16, 60000, 1, { 60012, 0 }, 1, 60000, 60011, 1 },
        { 0, 8, 200, 1, { 211, 0 }, 1, 200, 212, 1 },
        { 1, 16, -1000, 1, { -1000, 0 }, 2, -1998, -988, 1 }, /* slices with a scale of their own */
        { 1, 16, -1000, 1, { -3000, 0 }, 1, -1000, -988, 0 },
    };
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        struct scanned s = { 0 };
        folder_make(s.path);
        for (int k = 0; k < 2; k++) {
            struct made_slice slice = made_slice_defaults;
            slice.bits = slice.stored = cases[c].bits;
            slice.is_signed = cases[c].is_signed;
            slice.base = cases[c].base;
            slice.n_padding = cases[c].n_padding;
            memcpy(slice.padding, cases[c].padding, sizeof slice.padding);
            slice.has_rescale = true;
            slice.slope = k == 1 ? cases[c].low_slope_of_second : 1;
            slice.position[2] = 2 * k;
            slice.number = k + 1;
            made_slice_put(s.path, k ? "b" : "a", &slice);
        }
        scanned_open(&s);
        struct volume *volume = scanned_read(&s, 0);
        size_t n = 0;
        for (uint32_t k = 0; k < 2; k++)
            for (uint32_t j = 0; j < 2; j++)
                for (uint32_t i = 0; i < 3; i++) {
                    double value = volume_value(volume, i, j, k);
                    n += isnan(value) ? 1 : 0;
                    if (!isnan(value))
                        assert_close(value, (cases[c].base + 10.0 * j + i) * (k ? cases[c].low_slope_of_second : 1), 0);
                }
        assert_int_equal(n, 2 * cases[c].n_padded);
        assert_close(volume->low, cases[c].low, 0);
        assert_close(volume->high, cases[c].high, 0);
        assert_int_equal(scanned_said(&s, "image.padding") != NULL, n > 0);
        volume_unref(volume);
        scanned_finish(&s);
    }
}

static void an_image_of_padding_alone_keeps_its_values(void **state)
{
    (void)state;
    struct scanned s = { 0 };
    folder_make(s.path);
    struct made_slice slice = made_slice_defaults;
    slice.base = -50;
    slice.n_padding = 2;
    slice.padding[0] = -100;
    slice.padding[1] = 100;
    made_slice_put(s.path, "one", &slice);
    scanned_open(&s);
    struct volume *volume = scanned_read(&s, 0);
    assert_close(volume_value(volume, 1, 1, 0), -39, 0);
    assert_int_equal(scanned_said(&s, "image.padding")->severity, REPORT_WARNING);
    volume_unref(volume);
    scanned_finish(&s);
}

static void pixel_data_with_more_than_the_declared_frames_are_said(void **state)
{
    (void)state;
    struct scanned s = { 0 };
    folder_make(s.path);
    struct made_slice slice = made_slice_defaults;
    for (int k = 0; k < 2; k++) { /* the second one has the pixels of 3 frames: 3 x 2 of 16 bits each */
        struct made_dicom made;
        slice.position[2] = 2 * k;
        slice.number = k + 1;
        made_slice_bytes(&made, &slice);
        if (k == 1) {
            made.data[made.size - 12 - 4] = 36;
            made_raw(&made, (uint8_t[24]){ 0 }, 24);
        }
        folder_put(s.path, k ? "b" : "a", made.data, made.size);
        made_finish(&made);
    }
    scanned_open(&s);
    struct volume *volume = scanned_read(&s, 0);
    assert_int_equal(volume->grid.size[2], 2);
    const struct report_line *line = scanned_said(&s, "dicom.surplus-pixels");
    assert_non_null(line);
    assert_string_equal(line->where, "b");
    assert_non_null(strstr(line->sentence, "1 of 2 files"));
    assert_non_null(strstr(line->sentence, "24 bytes more than 1 frames"));
    volume_unref(volume);
    scanned_finish(&s);
}

static void slices_with_a_scale_of_their_own_are_brought_to_one_unit(void **state)
{
    (void)state;
    struct scanned s = { 0 };
    folder_make(s.path);
    for (int k = 0; k < 3; k++) {
        struct made_slice slice = made_slice_defaults;
        char name[16];
        slice.modality = "PT";
        slice.position[2] = 4 * k;
        slice.base = 1000;
        slice.has_rescale = true;
        slice.slope = 1 + k;
        snprintf(name, sizeof name, "%d", k);
        made_slice_put(s.path, name, &slice);
    }
    scanned_open(&s);
    struct volume *volume = scanned_read(&s, 0);
    assert_int_equal(volume->type, VOXEL_F32);
    for (uint32_t k = 0; k < 3; k++)
        assert_close(volume_value(volume, 2, 1, k), 1012.0 * (k + 1), 0);
    assert_close(volume->high, 3036, 0);
    assert_non_null(scanned_said(&s, "image.slopes-differ"));
    volume_unref(volume);
    scanned_finish(&s);
}

static void a_slope_of_nothing_is_not_believed(void **state)
{
    (void)state;
    struct scanned s = { 0 };
    folder_make(s.path);
    struct made_slice slice = made_slice_defaults;
    slice.has_rescale = true;
    slice.slope = 0;
    slice.offset = 5;
    put_row(s.path, &slice, (double[]){ 0, 1 }, 2);
    scanned_open(&s);
    struct volume *volume = scanned_read(&s, 0);
    assert_close(volume_value(volume, 2, 1, 1), 112, 0);
    assert_non_null(scanned_said(&s, "image.rescale"));
    volume_unref(volume);
    scanned_finish(&s);
}

/* MONOCHROME1 concerns display: the values are the file's. In a mixture the majority decides, with a warning. */
static void inverted_pictures_keep_their_values_and_it_is_said(void **state)
{
    (void)state;
    static const struct {
        int n_inverted;
        enum report_severity severity;
    } rows[] = { { 0, REPORT_ERROR }, { 1, REPORT_WARNING }, { 2, REPORT_WARNING }, { 3, REPORT_NOTE } };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        struct scanned s = { 0 };
        struct dicom_series_facts facts = { 0 };
        struct error err = { 0 };
        folder_make(s.path);
        for (int k = 0; k < 3; k++) {
            struct made_slice slice = made_slice_defaults;
            char name[8];
            slice.color = k < rows[i].n_inverted ? "MONOCHROME1" : "MONOCHROME2";
            slice.position[2] = k;
            slice.base = 100 * k;
            snprintf(name, sizeof name, "%d", k);
            made_slice_put(s.path, name, &slice);
        }
        scanned_open(&s);
        struct volume *volume = dicom_series_read(&s.folder, s.index, 0, NULL, &facts, &s.report, &err);
        assert_string_equal(err.text, "");
        assert_close(volume_value(volume, 2, 1, 1), 112, 0);
        assert_close(volume->low, 0, 0);
        assert_int_equal(facts.is_inverted, rows[i].n_inverted >= 2);
        const struct report_line *line = scanned_said(&s, "image.inverted");
        assert_int_equal(line != NULL, rows[i].n_inverted > 0);
        if (line)
            assert_int_equal(line->severity, rows[i].severity);
        volume_unref(volume);
        scanned_finish(&s);
    }
}

static void directions_off_by_rounding_are_taken_and_worse_ones_are_said(void **state)
{
    (void)state;
    static const struct {
        double off;
        bool is_said;
    } cases[] = { { 2e-10, false }, { 0.01, true } };
    for (int c = 0; c < 2; c++) {
        struct scanned s = { 0 };
        folder_make(s.path);
        struct made_slice slice = made_slice_defaults;
        slice.cosines[1] = cases[c].off;
        put_row(s.path, &slice, (double[]){ 0, 1 }, 2);
        scanned_open(&s);
        struct volume *volume = scanned_read(&s, 0);
        assert_int_equal(scanned_said(&s, "geometry.cosines") != NULL, cases[c].is_said);
        const struct vec3 *columns = volume->grid.lps_mm_from_ijk.columns;
        assert_close(vec3_dot(columns[0], columns[1]), 0, 1e-12);
        assert_close(vec3_length(columns[0]), 1, 1e-12);
        volume_unref(volume);
        scanned_finish(&s);
    }
}

static void thickness_is_not_taken_for_distance(void **state)
{
    (void)state;
    struct scanned s = { 0 };
    folder_make(s.path);
    struct made_slice slice = made_slice_defaults;
    slice.thickness = 1.5;
    put_row(s.path, &slice, (double[]){ 0, 3, 6 }, 3);
    scanned_open(&s);
    struct volume *volume = scanned_read(&s, 0);
    check_point(volume, 0, 0, 2, 0, 0, 6);
    const struct report_line *line = scanned_said(&s, "image.thickness-differs");
    assert_non_null(line);
    assert_non_null(strstr(line->sentence, "3 mm apart and 1.5 mm thick"));
    volume_unref(volume);
    scanned_finish(&s);
}

static void count_steps(void *context, size_t n_done, size_t n_all)
{
    size_t *steps = context;
    assert_int_equal(n_done, ++*steps);
    assert_int_equal(n_all, 5);
}

static void reading_tells_each_slice_and_stops_when_told(void **state)
{
    (void)state;
    struct scanned s = { 0 };
    folder_make(s.path);
    put_row(s.path, &made_slice_defaults, (double[]){ 0, 1, 2, 3, 4 }, 5);
    scanned_open(&s);
    size_t n_steps = 0;
    atomic_bool cancel;
    atomic_init(&cancel, false);
    struct dicom_progress progress = { .step = count_steps, .context = &n_steps, .cancel = &cancel, .n_threads = 2 };
    struct error err = { 0 };
    struct volume *volume = dicom_series_read(&s.folder, s.index, 0, &progress, NULL, NULL, &err);
    assert_non_null(volume);
    assert_int_equal(n_steps, 5);
    volume_unref(volume);
    atomic_store(&cancel, true);
    assert_null(dicom_series_read(&s.folder, s.index, 0, &progress, NULL, NULL, &err));
    assert_int_equal(err.code, ERROR_CANCELLED);
    assert_null(dicom_index_scan(&s.folder, NULL, 0, &progress, NULL, &err));
    assert_int_equal(err.code, ERROR_CANCELLED);
    scanned_finish(&s);
}

static void a_file_that_changes_after_the_scan_is_noticed(void **state)
{
    (void)state;
    struct scanned s = { 0 };
    folder_make(s.path);
    put_row(s.path, &made_slice_defaults, (double[]){ 0, 1 }, 2);
    scanned_open(&s);
    char path[2048];
    snprintf(path, sizeof path, "%s/%s", s.path, s.index->objects[1].path);
    assert_int_equal(truncate(path, 600), 0);
    struct error err = { 0 };
    assert_null(dicom_series_read(&s.folder, s.index, 0, NULL, NULL, NULL, &err));
    assert_int_equal(err.code, ERROR_IO);
    assert_non_null(strstr(err.text, "the file changed"));
    assert_int_equal(unlink(path), 0);
    assert_null(dicom_series_read(&s.folder, s.index, 0, NULL, NULL, NULL, &err));
    assert_int_equal(err.code, ERROR_NOT_FOUND);
    scanned_finish(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slices_are_sorted_by_position_and_not_by_name_or_number),
        cmocka_unit_test(pixels_need_not_be_square_and_slices_may_lie_obliquely),
        cmocka_unit_test(a_tilted_gantry_stays_a_shear),
        cmocka_unit_test(missing_slices_are_interpolated_and_named),
        cmocka_unit_test(uneven_slices_are_brought_to_the_smallest_usual_distance),
        cmocka_unit_test(slices_a_little_off_their_places_are_taken_as_even_and_said_so),
        cmocka_unit_test(a_slice_a_tenth_off_its_place_is_not_taken_as_even),
        cmocka_unit_test(slices_that_lie_on_no_line_are_refused),
        cmocka_unit_test(values_are_rescaled_whatever_their_bits_and_sign),
        cmocka_unit_test(pixels_with_the_padding_value_have_no_value),
        cmocka_unit_test(an_image_of_padding_alone_keeps_its_values),
        cmocka_unit_test(pixel_data_with_more_than_the_declared_frames_are_said),
        cmocka_unit_test(slices_with_a_scale_of_their_own_are_brought_to_one_unit),
        cmocka_unit_test(a_slope_of_nothing_is_not_believed),
        cmocka_unit_test(inverted_pictures_keep_their_values_and_it_is_said),
        cmocka_unit_test(directions_off_by_rounding_are_taken_and_worse_ones_are_said),
        cmocka_unit_test(thickness_is_not_taken_for_distance),
        cmocka_unit_test(reading_tells_each_slice_and_stops_when_told),
        cmocka_unit_test(a_file_that_changes_after_the_scan_is_noticed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
