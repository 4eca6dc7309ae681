/* Reads SERA's table of doses over depth and radius, .dose. */
#include "core/formats/sera/sera_table.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/formats/sera/sera_axes.h"
#include "core/formats/sera/sera_row.h"
#include "core/formats/text.h"

enum { N_VALUES = 8 };
static const enum dose_quantity columns[N_VALUES] = {
    DOSE_TOTAL,          DOSE_BORON, DOSE_GAMMA, DOSE_NITROGEN, DOSE_FAST, DOSE_FAST_FLUENCE, DOSE_EPITHERMAL_FLUENCE,
    DOSE_THERMAL_FLUENCE
};

struct parser {
    struct text text;
    const char *name;
    struct dose_curve *curve;
    size_t n_side, n_unprinted, n_unread, first_bad_line, n_nothing;
    struct error *err;
};

static bool fail(const struct parser *p, const char *found, const char *expected)
{
    char clean[40];
    text_clean(found, clean, sizeof clean);
    return error_set(p->err, ERROR_FORMAT, "%s: line %zu: found \"%s\", expected %s", p->name, p->text.line, clean,
                     expected);
}

/* Reads the numbers that follow these words at the start of a line; returns how many. */
static size_t numbers_behind(const char *line, const char *words, double *out, size_t most)
{
    char copy[TEXT_LINE_SIZE], *rest = NULL;
    size_t n = 0;
    if (strncmp(line, words, strlen(words)) != 0)
        return 0;
    snprintf(copy, sizeof copy, "%s", line + strlen(words));
    for (char *word = strtok_r(copy, " \t", &rest); word && n < most; word = strtok_r(NULL, " \t", &rest))
        if (!text_number(word, &out[n++]))
            return n - 1;
    return n;
}

/* Reads "Center Point x y z" and "no. d,r points used n ..."; skips lines of words up to the first point. */
static bool read_heading(struct parser *p)
{
    char line[TEXT_LINE_SIZE];
    double center[3], n_points;
    if (!text_line(&p->text, line) || numbers_behind(line, "Center Point", center, 3) != 3)
        return fail(p, line, "\"Center Point\" and three numbers");
    if (!text_line(&p->text, line) || numbers_behind(line, "no. d,r points used", &n_points, 1) != 1)
        return fail(p, line, "\"no. d,r points used\" and a number");
    if (!(n_points == floor(n_points) && n_points >= 2 && n_points <= CURVE_MAX_POINTS))
        return error_set(p->err, ERROR_FORMAT, "%s: line 2: %g points, expected a whole number from 2 to %d", p->name,
                         n_points, CURVE_MAX_POINTS);
    for (int i = 0; i < 3; i++)
        if (!(fabs(center[i]) <= 1e4))
            return error_set(p->err, ERROR_FORMAT, "%s: line 1: a centre %g cm away", p->name, center[i]);
    p->n_side = (size_t)n_points;
    p->curve->center_lps_mm = sera_lps_from_rpi(center[1] * 10, center[0] * 10, center[2] * 10);
    return true;
}

static bool create(struct parser *p)
{
    struct dose_curve *curve = p->curve;
    size_t n = p->n_side;
    snprintf(curve->unit, sizeof curve->unit, "cGy");
    curve->n_depths = curve->n_radii = n;
    curve->depths_mm = mem_new(n * sizeof *curve->depths_mm);
    curve->radii_mm = mem_new(n * sizeof *curve->radii_mm);
    for (; curve->n_columns < N_VALUES; curve->n_columns++) {
        size_t c = curve->n_columns;
        curve->quantities[c] = columns[c];
        curve->is_per_ppm[c] = columns[c] == DOSE_BORON;
        curve->values[c] = malloc(n * n * sizeof(float));
        if (!curve->values[c])
            return error_set(p->err, ERROR_MEMORY, "%s: no memory for %zu x %zu points", p->name, n, n);
    }
    return true;
}

static bool put(struct parser *p, size_t point, const struct sera_row *row)
{
    struct dose_curve *curve = p->curve;
    size_t d = point / p->n_side, r = point % p->n_side;
    double depth = row->at[0] * 10, radius = row->at[1] * 10;
    if (!(fabs(depth) <= 1e5 && fabs(radius) <= 1e5))
        return fail(p, "no coordinates", "a depth and a radius in cm");
    if (r == 0)
        curve->depths_mm[d] = depth;
    if (d == 0)
        curve->radii_mm[r] = radius;
    if (fabs(curve->depths_mm[d] - depth) > 1e-3 || fabs(curve->radii_mm[r] - radius) > 1e-3)
        return error_set(p->err, ERROR_FORMAT, "%s: line %zu: depth %g and radius %g cm, expected %g and %g", p->name,
                         p->text.line, depth / 10, radius / 10, curve->depths_mm[d] / 10, curve->radii_mm[r] / 10);
    if ((r == 0 && d > 0 && depth <= curve->depths_mm[d - 1]) || (d == 0 && r > 0 && radius <= curve->radii_mm[r - 1]))
        return error_set(p->err, ERROR_FORMAT, "%s: line %zu: depths and radii do not rise: %g and %g cm", p->name,
                         p->text.line, depth / 10, radius / 10);
    bool is_nothing = true;
    for (size_t c = 0; c < N_VALUES; c++)
        is_nothing = is_nothing && !(row->values[c] > 0) && !isnan(row->values[c]);
    for (size_t c = 0; c < N_VALUES; c++)
        curve->values[c][point] = is_nothing ? NAN : (float)row->values[c];
    p->n_nothing += is_nothing;
    if (row->n_unprinted + row->n_unread > 0 && p->first_bad_line == 0)
        p->first_bad_line = p->text.line;
    p->n_unprinted += row->n_unprinted;
    p->n_unread += row->n_unread;
    return true;
}

/* Length of the line as it is in the file: text_line removes leading blanks, which fixed columns need. */
static size_t raw_line(const struct text *text, const char *from)
{
    const char *to = text->at;
    while (to > from && (to[-1] == '\n' || to[-1] == '\r' || to[-1] == ' '))
        to--;
    return (size_t)(to - from);
}

static bool read_points(struct parser *p)
{
    char line[TEXT_LINE_SIZE];
    size_t n = 0, n_points = p->n_side * p->n_side;
    bool is_fixed = false;
    while (n < n_points) {
        const char *from = p->text.at;
        struct sera_row row;
        if (!text_line(&p->text, line))
            return error_set(p->err, ERROR_FORMAT, "%s: the file ends after %zu of %zu x %zu points", p->name, n,
                             p->n_side, p->n_side);
        if (line[0] == 0 || (n == 0 && ((line[0] >= 'a' && line[0] <= 'z') || line[0] == '(')))
            continue; /* headings of the columns */
        size_t length = raw_line(&p->text, from);
        if (n == 0)
            is_fixed = sera_row_is_fixed(from, length, N_VALUES);
        if (!sera_row_parse(from, length, is_fixed, N_VALUES, &row))
            return fail(p, line, "12 numbers: depth, radius, distance, region and eight values");
        if (!put(p, n++, &row))
            return false;
    }
    return true;
}

bool sera_table_parse(const uint8_t *data, size_t size, const char *name, struct dose_curve *curve,
                      struct report *report, struct error *err)
{
    *curve = (struct dose_curve){ 0 };
    struct parser p = { .name = name, .curve = curve, .err = err };
    text_start(&p.text, data, size);
    p.text.most_lines = (size_t)CURVE_MAX_POINTS * CURVE_MAX_POINTS + 1000;
    if (!read_heading(&p) || (uint64_t)p.n_side * p.n_side * 20 > size) {
        if (p.n_side > 0)
            error_set(err, ERROR_FORMAT, "%s: %zu bytes are too few for %zu x %zu points", name, size, p.n_side,
                      p.n_side);
        return false;
    }
    if (!create(&p) || !read_points(&p)) {
        dose_curve_finish(curve);
        return false;
    }
    if (p.n_unprinted + p.n_unread > 0)
        report_add(
            report, REPORT_WARNING, "dose.bad-values", name,
            "%zu values too large or small for their columns (***) and %zu that are no numbers, first in line %zu; they are shown "
            "as nothing.",
            p.n_unprinted, p.n_unread, p.first_bad_line);
    if (p.n_nothing > 0)
        report_add(report, REPORT_NOTE, "dose.outside-mesh", name,
                   "%zu of %zu points hold zeros alone: they lie outside the mesh of the run and are not valid.",
                   p.n_nothing, p.n_side * p.n_side);
    return true;
}
