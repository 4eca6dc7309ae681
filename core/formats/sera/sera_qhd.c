/* Reads SERA's medical images, .qhd with .qim. */
#include "core/formats/sera/sera_qhd.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/formats/sera/sera_axes.h"
#include "core/formats/text.h"
#include "core/formats/zlib_stream.h"

static const double uneven_share = 0.01;  /* unevenness as a fraction of the spacing; less is rounding */
static const double refused_share = 0.25; /* more unevenness cannot be shown on an even grid */

void qhd_finish(struct qhd *qhd)
{
    free(qhd->locations);
    qhd->locations = NULL;
    qhd->n_locations = 0;
}

struct parser {
    struct text text;
    const char *name;
    struct qhd *qhd;
    uint8_t *has_location; /* [QHD_MAX_LOCATIONS] */
    bool has_columns, has_rows, has_slices, has_x, has_y;
    size_t n_unknown;
    char unknown[64];
    struct error *err;
};

static bool fail(const struct parser *p, const char *key, const char *found, const char *expected)
{
    return error_set(p->err, ERROR_FORMAT, "%s: line %zu: %s is \"%.40s\", expected %s", p->name, p->text.line, key,
                     found, expected);
}

static bool get_number(const struct parser *p, const char *key, const char *value, double *out)
{
    return text_number(value, out) || fail(p, key, value, "a number");
}

static bool get_size(const struct parser *p, const char *key, const char *value, uint32_t *out)
{
    double number;
    if (!text_number(value, &number) || number != floor(number) || number < 1 || number > VOLUME_MAX_SIDE)
        return fail(p, key, value, "a whole number from 1 to 4096");
    *out = (uint32_t)number;
    return true;
}

static bool get_step(const struct parser *p, const char *key, const char *value, double *out)
{
    if (!get_number(p, key, value, out))
        return false;
    return *out > 0 || fail(p, key, value, "a size above 0");
}

/* The number in the brackets of "Image Location[12]"; -1 for another key. */
static long bracket_index(const char *key, const char *stem)
{
    size_t n = strlen(stem);
    char start[64], *end;
    snprintf(start, sizeof start, "%.*s", (int)(n < 60 ? n : 60), key);
    if (!text_equal(start, stem) || key[n] != '[')
        return -1;
    long index = strtol(key + n + 1, &end, 10);
    return end != key + n + 1 && *end == ']' && index >= 0 ? index : -1;
}

static bool set_location(struct parser *p, const char *key, const char *value, long index)
{
    if (index >= QHD_MAX_LOCATIONS)
        return error_set(p->err, ERROR_LIMIT, "%s: line %zu: more than %d slice positions", p->name, p->text.line,
                         QHD_MAX_LOCATIONS);
    if (!get_number(p, key, value, &p->qhd->locations[index]))
        return false;
    p->has_location[index] = 1;
    return true;
}

static bool set_word(struct parser *p, const char *key, const char *value, bool *is_known)
{
    struct qhd *qhd = p->qhd;
    *is_known = true;
    if (text_equal(key, "Modality")) {
        text_clean(value, qhd->modality, sizeof qhd->modality);
    } else if (text_equal(key, "Dimensionality")) {
        qhd->mm = text_equal(value, "mm") ? 1 : text_equal(value, "cm") ? 10 : text_equal(value, "in") ? 25.4 : 0;
        return qhd->mm > 0 || fail(p, key, value, "mm, cm or in");
    } else if (text_equal(key, "Slice Orientation")) {
        static const char *const axial[] = { "Axial", "Transverse", "Transaxial" };
        for (int i = 0; i < 3; i++)
            if (text_equal(value, axial[i]))
                qhd->orientation = 'A';
        if (text_equal(value, "Coronal"))
            qhd->orientation = 'C';
        if (text_equal(value, "Sagittal"))
            qhd->orientation = 'S';
        if (text_equal(value, "Oblique"))
            return error_set(p->err, ERROR_UNSUPPORTED, "%s: line %zu: oblique slices are not read", p->name,
                             p->text.line);
        return qhd->orientation || fail(p, key, value, "Axial, Coronal or Sagittal");
    } else if (text_equal(key, "Byte Order")) {
        qhd->is_big = text_equal(value, "big endian");
        return qhd->is_big || text_equal(value, "little endian") || fail(p, key, value, "big endian or little endian");
    } else {
        *is_known = text_equal(key, "Patient Name"); /* a known key whose value is never kept */
    }
    return true;
}

static bool set_value(struct parser *p, const char *key, const char *value)
{
    struct qhd *qhd = p->qhd;
    bool is_known;
    if (!set_word(p, key, value, &is_known))
        return false;
    if (is_known)
        return true;
    long index = bracket_index(key, "Image Location");
    if (index >= 0)
        return set_location(p, key, value, index);
    index = bracket_index(key, "Size of Dimension");
    if (index == 0)
        return p->has_slices = true, get_size(p, key, value, &qhd->slices);
    if (index == 1)
        return p->has_rows = true, get_size(p, key, value, &qhd->rows);
    if (index == 2)
        return p->has_columns = true, get_size(p, key, value, &qhd->columns);
    if (text_equal(key, "Bytes Per Pixel")) {
        qhd->pixel_bytes = text_equal(value, "1") ? 1 : text_equal(value, "2") ? 2 : 0;
        return qhd->pixel_bytes > 0 || fail(p, key, value, "1 or 2");
    }
    if (text_equal(key, "Number of Dimensions"))
        return text_equal(value, "3") || fail(p, key, value, "3");
    if (text_equal(key, "Reference Location"))
        return qhd->has_reference = true, get_number(p, key, value, &qhd->reference);
    if (text_equal(key, "Uniform Spacing"))
        return qhd->has_spacing = true, get_step(p, key, value, &qhd->spacing);
    if (text_equal(key, "X Pixel Size"))
        return p->has_x = true, get_step(p, key, value, &qhd->step_columns);
    if (text_equal(key, "Y Pixel Size"))
        return p->has_y = true, get_step(p, key, value, &qhd->step_rows);
    if (p->n_unknown++ == 0)
        text_clean(key, p->unknown, sizeof p->unknown);
    return true;
}

static bool check_whole(struct parser *p)
{
    const struct {
        bool is_there;
        const char *key;
    } needed[] = { { p->has_slices, "Size of Dimension[0]" },
                   { p->has_rows, "Size of Dimension[1]" },
                   { p->has_columns, "Size of Dimension[2]" },
                   { p->qhd->pixel_bytes > 0, "Bytes Per Pixel" },
                   { p->has_x, "X Pixel Size" },
                   { p->has_y, "Y Pixel Size" },
                   { p->qhd->mm > 0, "Dimensionality" },
                   { p->qhd->orientation != 0, "Slice Orientation" } };
    for (size_t i = 0; i < sizeof needed / sizeof needed[0]; i++)
        if (!needed[i].is_there)
            return error_set(p->err, ERROR_FORMAT, "%s: the key %s is missing", p->name, needed[i].key);
    while (p->qhd->n_locations < QHD_MAX_LOCATIONS && p->has_location[p->qhd->n_locations])
        p->qhd->n_locations++;
    if (p->qhd->n_locations < 2 && !(p->qhd->has_reference && p->qhd->has_spacing))
        return error_set(p->err, ERROR_FORMAT, "%s: neither slice positions nor a reference location with a spacing",
                         p->name);
    return true;
}

bool qhd_parse(const uint8_t *data, size_t size, const char *name, struct qhd *qhd, struct report *report,
               struct error *err)
{
    *qhd = (struct qhd){ .locations = mem_new(QHD_MAX_LOCATIONS * sizeof *qhd->locations) };
    struct parser p = { .name = name, .qhd = qhd, .err = err, .has_location = mem_new(QHD_MAX_LOCATIONS) };
    char line[TEXT_LINE_SIZE], *key, *value;
    bool is_read = true;
    text_start(&p.text, data, size);
    while (is_read && text_line(&p.text, line))
        if (line[0] && text_split(line, ":=", &key, &value))
            is_read = set_value(&p, key, value);
    is_read = is_read && check_whole(&p);
    free(p.has_location);
    if (!is_read) {
        qhd_finish(qhd);
        return false;
    }
    if (p.n_unknown > 0)
        report_add(report, REPORT_NOTE, "header.unknown-key", name,
                   "%zu unknown keys were ignored, the first is \"%s\".", p.n_unknown, p.unknown);
    return true;
}

/* Finds the first slice and the step: from the positions, else from reference location and spacing. step is negative
 * when positions fall. */
static bool place_slices(const struct qhd *qhd, uint32_t n_slices, const char *name, double *first, double *step,
                         struct report *report, struct error *err)
{
    size_t n = qhd->n_locations < n_slices ? qhd->n_locations : n_slices;
    if (n < 2) {
        *first = n == 1 ? qhd->locations[0] : qhd->reference;
        *step = qhd->has_spacing ? qhd->spacing : 1;
        return true;
    }
    *first = qhd->locations[0];
    *step = (qhd->locations[n - 1] - *first) / (double)(n - 1);
    double worst = 0;
    for (size_t i = 0; i < n; i++)
        worst = fmax(worst, fabs(qhd->locations[i] - (*first + *step * (double)i)));
    if (!(fabs(*step) > 0) || worst > refused_share * fabs(*step))
        return error_set(err, ERROR_UNSUPPORTED,
                         "%s: the slice positions are not evenly spaced: one is %.3g off a mean spacing of %.3g", name,
                         worst, *step);
    if (worst > uneven_share * fabs(*step))
        report_add(report, REPORT_WARNING, "image.locations-uneven", name,
                   "One slice position is %.3g off an even spacing of %.3g; the even spacing was used.", worst, *step);
    bool is_other_start = qhd->has_reference && fabs(qhd->reference - *first) > uneven_share * fabs(*step);
    bool is_other_step = qhd->has_spacing && fabs(qhd->spacing - fabs(*step)) > uneven_share * fabs(*step);
    if (is_other_start || is_other_step)
        report_add(
            report, REPORT_WARNING, "image.locations-differ", name,
            "The slice positions (from %.4g, every %.4g) disagree with reference location %.4g and spacing %.4g; the positions "
            "were used.",
            *first, *step, qhd->reference, qhd->spacing);
    return true;
}

/* Makes the grid. The header does not give the position of the image within its plane; SERA centres it on the axes. */
static bool make_grid(const struct qhd *qhd, uint32_t n_slices, const char *name, struct grid *grid,
                      struct report *report, struct error *err)
{
    struct sera_grid sera = { .size = { qhd->columns, qhd->rows, n_slices }, .mm = qhd->mm, .given_mm = qhd->given_mm };
    double first, step;
    if (!place_slices(qhd, n_slices, name, &first, &step, report, err))
        return false;
    const struct sera_direction axial[3] = { { SERA_RL, 1 }, { SERA_PA, -1 }, { SERA_IS, 1 } };
    const struct sera_direction coronal[3] = { { SERA_RL, 1 }, { SERA_IS, -1 }, { SERA_PA, 1 } };
    const struct sera_direction sagittal[3] = { { SERA_PA, -1 }, { SERA_IS, -1 }, { SERA_RL, 1 } };
    memcpy(sera.along,
           qhd->orientation == 'C'   ? coronal
           : qhd->orientation == 'S' ? sagittal
                                     : axial,
           sizeof sera.along);
    sera.step[0] = qhd->step_columns;
    sera.step[1] = qhd->step_rows;
    sera.step[2] = fabs(step);
    if (step < 0)
        sera.along[2].sign = -sera.along[2].sign;
    for (int a = 0; a < 2; a++) {
        double half = sera.size[a] * sera.step[a] / 2;
        sera.low[sera.along[a].axis] = -half;
        sera.high[sera.along[a].axis] = half;
    }
    double last = first + step * (n_slices - 1.0);
    sera.low[sera.along[2].axis] = fmin(first, last) - fabs(step) / 2;
    sera.high[sera.along[2].axis] = fmax(first, last) + fabs(step) / 2;
    report_add(
        report, REPORT_NOTE, "geometry.centred", name,
        "The header does not say where the picture lies across its plane; it was centred on the axes, as SERA does.");
    return sera_grid_resolve(&sera, name, grid, report, err);
}

static void copy_pixels(const struct qhd *qhd, const uint8_t *in, struct volume *volume)
{
    size_t n = grid_n_voxels(&volume->grid);
    if (qhd->pixel_bytes == 1) {
        memcpy(volume->voxels, in, n);
        return;
    }
    uint16_t *out = volume->voxels;
    int high = qhd->is_big ? 0 : 1;
    for (size_t i = 0; i < n; i++)
        out[i] = (uint16_t)(in[2 * i + (size_t)high] << 8 | in[2 * i + 1 - (size_t)high]);
}

struct volume *qhd_read_pixels(const struct qhd *qhd, const struct bytes *pixels, const char *header_name,
                               const char *name, bool *is_doubtful, struct report *report, struct error *err)
{
    struct bytes all = { 0 };
    uint64_t slice_bytes = (uint64_t)qhd->columns * qhd->rows * qhd->pixel_bytes;
    struct volume *volume = NULL;
    struct grid grid;
    uint64_t most = slice_bytes * VOLUME_MAX_SIDE < VOLUME_MAX_BYTES ? slice_bytes * VOLUME_MAX_SIDE : VOLUME_MAX_BYTES;
    bool is_packed;
    if (!sera_unpack(pixels, name, most, &is_packed, &all, err))
        return NULL;
    const struct bytes *from = is_packed ? &all : pixels;
    uint64_t n_slices = from->size / slice_bytes;
    *is_doubtful = n_slices != qhd->slices;
    if (n_slices == 0 || from->size % slice_bytes != 0 || n_slices > VOLUME_MAX_SIDE) {
        error_set(err, ERROR_FORMAT,
                  "%s: %zu bytes are not whole slices of %u x %u pixels of %u bytes; the header says %u slices", name,
                  from->size, qhd->columns, qhd->rows, qhd->pixel_bytes, qhd->slices);
        goto done;
    }
    if (*is_doubtful)
        report_add(report, REPORT_WARNING, "image.slices-differ", header_name,
                   "The header says %u slices, %s holds %llu; the pixels were believed.", qhd->slices, name,
                   (unsigned long long)n_slices);
    if (!make_grid(qhd, (uint32_t)n_slices, header_name, &grid, report, err))
        goto done;
    volume = volume_create(&grid, qhd->pixel_bytes == 1 ? VOXEL_U8 : VOXEL_U16, err);
    if (volume) {
        copy_pixels(qhd, from->data, volume);
        volume_measure(volume);
    }
done:
    bytes_free(&all);
    return volume;
}
