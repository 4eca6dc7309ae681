/* Reads seraMC's restart file with the dose on its mesh, .rst. */
#include "core/formats/sera/sera_rst.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/formats/sera/sera_axes.h"
#include "core/formats/text.h"

enum { NUMBER_WIDTH = 15, NUMBERS_A_LINE = 6, LINES_BEFORE_ORIGIN = 8, LINES_A_SET = 9, LINES_A_SET_READ = 2 };

/* Columns of the array, from 0, and their number in newer and older files. */
enum { GAMMA_PRODUCTION = 4, COLUMNS_NOW = 14, COLUMNS_BEFORE = 12 };
static const struct {
    enum dose_quantity quantity;
    size_t column;
} kept[RST_N_DOSES] = { { DOSE_BORON, 3 },
                        { DOSE_NITROGEN, 5 },
                        { DOSE_FAST, 1 },
                        { DOSE_GAMMA, 0 },
                        { DOSE_OTHER, 11 },
                        { DOSE_FAST_FLUENCE, 6 },
                        { DOSE_EPITHERMAL_FLUENCE, 7 },
                        { DOSE_THERMAL_FLUENCE, 8 } };

struct lines {
    const char *at, *start, *end;
    size_t line;
    const char *name;
    struct error *err;
};

struct line {
    const char *at;
    size_t n;
};

static bool next_line(struct lines *lines, struct line *line)
{
    *line = (struct line){ lines->at, 0 };
    if (lines->at >= lines->end)
        return false;
    const char *end = memchr(lines->at, '\n', (size_t)(lines->end - lines->at));
    line->n = (size_t)((end ? end : lines->end) - lines->at);
    while (line->n > 0 && (line->at[line->n - 1] == '\r' || line->at[line->n - 1] == ' '))
        line->n--;
    lines->at = end ? end + 1 : lines->end;
    lines->line++;
    return true;
}

static bool need_line(struct lines *lines, struct line *line, const char *what)
{
    return next_line(lines, line) ||
           error_set(lines->err, ERROR_FORMAT, "%s: the file ends after line %zu, expected %s", lines->name,
                     lines->line, what);
}

/* Copies a fixed field without its blanks; "" when the line ends before it. */
static void field(const struct line *line, size_t from, size_t width, char *out)
{
    size_t to = from + width < line->n ? from + width : line->n;
    while (from < to && line->at[from] == ' ')
        from++;
    while (from < to && line->at[to - 1] == ' ')
        to--;
    size_t n = from < to ? to - from : 0;
    memcpy(out, line->at + (n ? from : 0), n);
    out[n] = 0;
}

static bool refuse(const struct lines *lines, size_t column, const char *found, const char *expected)
{
    char clean[40];
    text_clean(found, clean, sizeof clean);
    return error_set(lines->err, ERROR_FORMAT, "%s: line %zu, column %zu: found \"%s\", expected %s", lines->name,
                     lines->line, column + 1, clean, expected);
}

static bool get_number(const struct lines *lines, const struct line *line, size_t from, size_t width, double low,
                       double high, const char *expected, double *out)
{
    char word[NUMBER_WIDTH + 1];
    field(line, from, width, word);
    if (!text_number(word, out) || !(*out >= low && *out <= high))
        return refuse(lines, from, word, expected);
    return true;
}

static bool get_whole(const struct lines *lines, const struct line *line, size_t from, size_t width, uint32_t low,
                      uint32_t high, const char *expected, uint32_t *out)
{
    double number;
    if (!get_number(lines, line, from, width, low, high, expected, &number))
        return false;
    *out = (uint32_t)number;
    return number == (double)*out || refuse(lines, from, "a fraction", expected);
}

/* Finds the four numbers of a line of histories: columns 3I8,E15.6, where large counts touch; a line edited by hand has
 * other columns, and its blanks separate the numbers. */
static void place_histories(const struct line *line, size_t from[4], size_t width[4])
{
    size_t n = 0, at = 0;
    while (at < line->n) {
        size_t start = at;
        while (at < line->n && line->at[at] != ' ')
            at++;
        if (at > start && (n == 4 || at - start > NUMBER_WIDTH))
            break;
        if (at > start) {
            from[n] = start;
            width[n++] = at - start;
        }
        at++;
    }
    if (n == 4 && at >= line->n)
        return;
    for (size_t i = 0; i < 4; i++) {
        from[i] = 8 * i;
        width[i] = i < 3 ? 8 : NUMBER_WIDTH;
    }
}

/* Reads two of the nine lines of a set and skips the others. */
static bool get_set(struct lines *lines, struct rst_set *set)
{
    struct line line;
    if (!need_line(lines, &line, "a set of histories"))
        return false;
    set->directive = line.n > 0 && line.at[0] > ' ' && line.at[0] < 127 ? line.at[0] : '?';
    if (!get_number(lines, &line, 51, NUMBER_WIDTH, 1e-30, 1e30, "the strength of the source", &set->strength) ||
        !need_line(lines, &line, "numbers of histories"))
        return false;
    size_t from[4] = { 0 }, width[4] = { 0 };
    place_histories(&line, from, width);
    for (size_t i = 0; i < 3; i++)
        if (!get_whole(lines, &line, from[i], width[i], 0, 999999999, "a number of histories", &set->n_histories[i]))
            return false;
    if (!get_number(lines, &line, from[3], width[3], 0, 1, "the source's fraction of gammas, 0 to 1",
                    &set->gamma_fraction))
        return false;
    for (int i = LINES_A_SET_READ; i < LINES_A_SET; i++)
        if (!need_line(lines, &line, "the rest of a set"))
            return false;
    return true;
}

static bool get_grid(struct lines *lines, struct rst_header *header, uint32_t *n_groups)
{
    struct line line;
    double origin[3];
    if (!need_line(lines, &line, "the origin of the mesh"))
        return false;
    for (size_t i = 0; i < 3; i++)
        if (!get_number(lines, &line, i * NUMBER_WIDTH, NUMBER_WIDTH, -1e4, 1e4, "the origin of the mesh, cm",
                        &origin[i]))
            return false;
    if (!get_number(lines, &line, 45, NUMBER_WIDTH, 1e-3, 100, "the width of a cell, cm", &header->cell_cm) ||
        !get_whole(lines, &line, 60, 8, 1, RST_MAX_CELLS, "cells along an edge, 1 to 128", &header->n_cells) ||
        !get_whole(lines, &line, 68, 8, 1, RST_MAX_GROUPS, "a number of groups, 1 to 1000", n_groups))
        return false;
    const double mm = 10, cell = header->cell_cm * mm, half = cell / 2;
    const uint32_t size[3] = { header->n_cells, header->n_cells, header->n_cells };
    const struct affine map = {
        { sera_lps_from_rpi(cell, 0, 0), sera_lps_from_rpi(0, cell, 0), sera_lps_from_rpi(0, 0, cell) },
        sera_lps_from_rpi(origin[1] * mm + half, origin[0] * mm + half, origin[2] * mm + half)
    };
    if (!grid_init(&header->grid, size, &map, lines->err)) {
        error_prefix(lines->err, "%s: line %zu", lines->name, lines->line);
        return false;
    }
    return true;
}

bool rst_parse_header(const uint8_t *text, size_t size, const char *name, struct rst_header *header, struct error *err)
{
    struct lines lines = { .at = (const char *)text,
                           .start = (const char *)text,
                           .end = (const char *)text + size,
                           .name = name,
                           .err = err };
    struct line line;
    uint32_t n_sets, n_groups;
    *header = (struct rst_header){ 0 };
    if (!need_line(&lines, &line, "the number of sets and the program's version"))
        return false;
    field(&line, 4, 12, header->version);
    if (!header->version[0])
        return refuse(&lines, 4, "", "the version of seraMC");
    if (!get_whole(&lines, &line, 0, 4, 1, RST_MAX_SETS, "a number of sets, 1 to 99", &n_sets))
        return false;
    for (int i = 2; i <= LINES_BEFORE_ORIGIN; i++) {
        if (!need_line(&lines, &line, "names of the plan's files"))
            return false;
        if (i == 3) {
            char title[81];
            field(&line, 0, 80, title);
            text_clean(title, header->title, sizeof header->title);
        }
    }
    if (!get_grid(&lines, header, &n_groups))
        return false;
    for (uint32_t group = 0; group < n_groups; group += 10)
        if (!need_line(&lines, &line, "limits of the groups"))
            return false;
    for (header->n_sets = 0; header->n_sets < n_sets; header->n_sets++)
        if (!get_set(&lines, &header->sets[header->n_sets]))
            return false;
    header->data_at = (size_t)(lines.at - lines.start);
    header->data_line = lines.line;
    return true;
}

/* ---- the array -------------------------------------------------------------------------------------------------- */

static struct lines array_lines(const struct bytes *text, const struct rst_header *header, const char *name,
                                struct error *err)
{
    const char *start = (const char *)text->data;
    return (struct lines){ start + header->data_at, start, start + text->size, header->data_line, name, err };
}

static size_t fields_of(const struct line *line)
{
    return (line->n + NUMBER_WIDTH - 1) / NUMBER_WIDTH;
}

/* Finds the number of values per cell, which only the count of all values gives. */
static bool count_columns(const struct bytes *text, const struct rst_header *header, const char *name,
                          size_t *n_columns, struct error *err)
{
    struct lines lines = array_lines(text, header, name, err);
    struct line line;
    size_t n_cells = grid_n_voxels(&header->grid), n_values = 0;
    while (next_line(&lines, &line)) {
        size_t n = fields_of(&line);
        if (n > NUMBERS_A_LINE)
            return error_set(err, ERROR_FORMAT, "%s: line %zu: %zu characters, expected at most %d numbers of %d", name,
                             lines.line, line.n, NUMBERS_A_LINE, NUMBER_WIDTH);
        n_values += n;
    }
    *n_columns = n_values == n_cells * COLUMNS_NOW ? COLUMNS_NOW : COLUMNS_BEFORE;
    return n_values == n_cells * *n_columns ||
           error_set(err, ERROR_FORMAT,
                     "%s: %zu values after line %zu; %u^3 cells need %zu, or %zu of an older version", name, n_values,
                     header->data_line, header->n_cells, n_cells * COLUMNS_NOW, n_cells * COLUMNS_BEFORE);
}

struct array {
    const struct rst_header *header;
    float *of_column[COLUMNS_BEFORE]; /* NULL: not kept */
    double sum_gamma_production;
    size_t n_unprinted, n_unread, first_line; /* first_line: with either; 0: none */
};

/* Reads a value; a word that is no number becomes not-a-number and is counted. */
static double read_value(struct array *array, const char *word, size_t line)
{
    double value;
    if (text_number(word, &value) && fabs(value) <= 1e30)
        return value;
    bool is_unprinted = word[0] == '*' && strspn(word, "*") == strlen(word);
    array->n_unprinted += is_unprinted;
    array->n_unread += !is_unprinted;
    if (array->first_line == 0)
        array->first_line = line;
    return NAN;
}

static void store(struct array *array, size_t index, size_t n_columns, const char *word, size_t line)
{
    size_t column = index % n_columns, cell = index / n_columns, n = array->header->n_cells;
    if (column >= COLUMNS_BEFORE || (!array->of_column[column] && column != GAMMA_PRODUCTION))
        return;
    double value = read_value(array, word, line);
    if (column == GAMMA_PRODUCTION) {
        array->sum_gamma_production += isfinite(value) ? value : 0;
        return;
    }
    /* the file: z fastest, then y (RL), then x (PA); ours: RL fastest, then PA, then IS */
    size_t z = cell % n, y = cell / n % n, x = cell / n / n;
    array->of_column[column][(z * n + x) * n + y] = (float)value;
}

static void read_array(const struct bytes *text, const char *name, size_t n_columns, struct array *array)
{
    struct lines lines = array_lines(text, array->header, name, NULL);
    struct line line;
    size_t index = 0;
    while (next_line(&lines, &line))
        for (size_t i = 0, n = fields_of(&line); i < n; i++) {
            char word[NUMBER_WIDTH + 1];
            field(&line, i * NUMBER_WIDTH, NUMBER_WIDTH, word);
            store(array, index++, n_columns, word, lines.line);
        }
}

/* Scales to cGy: neutron columns are per source particle and cell; the gamma dose is scaled by the gammas that neutrons
 * make and those of the source. */
static void scale(const struct array *array, struct sera_doses *doses)
{
    const struct rst_header *header = array->header;
    const struct rst_set *set = &header->sets[0];
    double volume_cm3 = header->cell_cm * header->cell_cm * header->cell_cm;
    double neutron = set->strength * (1 - set->gamma_fraction) / volume_cm3;
    double gammas = set->strength * ((1 - set->gamma_fraction) * array->sum_gamma_production + set->gamma_fraction);
    double photon = gammas / 3600 / volume_cm3;
    size_t n = grid_n_voxels(&header->grid);
    for (size_t d = 0; d < doses->n_components; d++) {
        struct volume *volume = doses->components[d].values;
        double factor = doses->components[d].quantity == DOSE_GAMMA ? photon : neutron;
        float *values = volume->voxels;
        for (size_t i = 0; i < n; i++) {
            double value = (double)values[i] * factor;
            values[i] = fabs(value) <= 1e30 ? (float)value : NAN;
        }
        volume_measure(volume);
    }
}

static void note_array(const struct array *array, const char *name, struct report *report)
{
    const struct rst_header *header = array->header;
    if (array->n_unprinted + array->n_unread > 0)
        report_add(
            report, REPORT_WARNING, "dose.bad-values", name,
            "%zu values too large or small for their columns (***) and %zu that are no numbers, first in line %zu; they are shown "
            "as nothing.",
            array->n_unprinted, array->n_unread, array->first_line);
    for (size_t i = 1; i < header->n_sets; i++)
        if (header->sets[i].strength != header->sets[0].strength ||
            header->sets[i].gamma_fraction != header->sets[0].gamma_fraction) {
            report_add(
                report, REPORT_WARNING, "dose.sets-differ", name,
                "Set %zu has a source of %g with %g of gammas, set 1 one of %g with %g; the first was used for all.",
                i + 1, header->sets[i].strength, header->sets[i].gamma_fraction, header->sets[0].strength,
                header->sets[0].gamma_fraction);
            return;
        }
}

bool rst_read(const struct bytes *text, const char *name, struct sera_doses *doses, struct report *report,
              struct error *err)
{
    struct rst_header header;
    size_t n_columns = 0;
    *doses = (struct sera_doses){ 0 };
    if (!rst_parse_header(text->data, text->size, name, &header, err) ||
        !count_columns(text, &header, name, &n_columns, err))
        return false;
    struct array array = { .header = &header };
    for (size_t d = 0; d < RST_N_DOSES; d++) {
        float *values = sera_doses_add(doses, kept[d].quantity, kept[d].quantity == DOSE_BORON, &header.grid, err);
        if (!values) {
            sera_doses_finish(doses);
            error_prefix(err, "%s", name);
            return false;
        }
        array.of_column[kept[d].column] = values;
    }
    read_array(text, name, n_columns, &array);
    scale(&array, doses);
    note_array(&array, name, report);
    return true;
}
