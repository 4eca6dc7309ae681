/* Reads particle tracks from a table of comma-separated values. */
#include "core/formats/track_csv.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/formats/text.h"

enum { X0, Y0, Z0, X1, Y1, Z1, CLASS, ENERGY, N_KNOWN, N_NEEDED = ENERGY };
static const char *const known_columns[N_KNOWN] = { "x0_mm", "y0_mm", "z0_mm", "x1_mm",
                                                    "y1_mm", "z1_mm", "class", "energy_mev" };

struct header {
    int known_of[TRACK_CSV_MAX_COLUMNS]; /* by column of the file; -1 none of ours */
    size_t n_columns;
};

/* Counts of what the report names once, at the end. */
struct counts {
    size_t n_lines, n_bad, n_zero_length, n_far, first_bad_line;
    char first_why[120];
};

/* Ends the cell in place and returns its text without blanks and quotes. *rest becomes the next cell, NULL after the
 * last one. */
static char *next_cell(char **rest)
{
    char *cell = *rest, *comma = strchr(cell, ',');
    if (comma)
        *comma = 0;
    *rest = comma ? comma + 1 : NULL;
    cell += strspn(cell, " \t");
    size_t n = strlen(cell);
    while (n > 0 && strchr(" \t", cell[n - 1]))
        n--;
    if (n >= 2 && cell[0] == '"' && cell[n - 1] == '"') {
        cell++;
        n -= 2;
    }
    cell[n] = 0;
    return cell;
}

/* Skips the byte order mark that spreadsheets write. */
static void start(struct text *text, const uint8_t *data, size_t size)
{
    static const uint8_t mark[3] = { 0xef, 0xbb, 0xbf };
    size_t n_mark = size >= sizeof mark && memcmp(data, mark, sizeof mark) == 0 ? sizeof mark : 0;
    text_start(text, data ? data + n_mark : data, size - n_mark);
    text->most_lines = SIZE_MAX;
}

/* Reads the next line that is not empty. */
static bool next_line(struct text *text, char line[TEXT_LINE_SIZE])
{
    while (text_line(text, line))
        if (line[0])
            return true;
    return false;
}

static bool read_header(char *line, const char *name, struct header *header, struct error *err)
{
    bool is_given[N_KNOWN] = { false };
    *header = (struct header){ 0 };
    for (char *rest = line; rest;) {
        const char *cell = next_cell(&rest);
        if (header->n_columns == TRACK_CSV_MAX_COLUMNS)
            return error_set(err, ERROR_LIMIT, "%s: more than %d columns", name, TRACK_CSV_MAX_COLUMNS);
        int known = N_KNOWN;
        while (--known >= 0 && !text_equal(cell, known_columns[known])) {
        }
        if (known >= 0 && is_given[known])
            return error_set(err, ERROR_FORMAT, "%s: the header names the column %s twice", name, known_columns[known]);
        if (known >= 0)
            is_given[known] = true;
        header->known_of[header->n_columns++] = known;
    }
    for (int column = 0; column < N_NEEDED; column++)
        if (!is_given[column])
            return error_set(err, ERROR_FORMAT,
                             "%s: the header does not name the column %s; a table of tracks has x0_mm, y0_mm, z0_mm, "
                             "x1_mm, y1_mm, z1_mm, class, and perhaps energy_mev",
                             name, known_columns[column]);
    return true;
}

bool track_csv_looks_like(const uint8_t *data, size_t size)
{
    struct text text;
    struct header header;
    char line[TEXT_LINE_SIZE];
    start(&text, data, size);
    return next_line(&text, line) && strchr(line, ',') && read_header(line, "", &header, NULL);
}

/* Writes why a line is not a segment; false. */
static bool refuse(char why[120], const char *format, const char *column, const char *cell)
{
    char clean[48];
    text_clean(cell, clean, sizeof clean);
    snprintf(why, 120, format, column, clean);
    return false;
}

static bool read_segment(char *line, const struct header *header, struct track_segment *segment, char why[120])
{
    size_t n_cells = 0;
    *segment = (struct track_segment){ .energy_mev = NAN };
    for (char *rest = line; rest; n_cells++) {
        const char *cell = next_cell(&rest);
        int known = n_cells < header->n_columns ? header->known_of[n_cells] : -1;
        double value = NAN;
        if (known < 0 || (known == ENERGY && !cell[0]))
            continue;
        if (known == CLASS) {
            enum track_class class = track_class_of_word(cell);
            if (class == TRACK_N_CLASSES)
                return refuse(why, "%s is none of the classes: '%s'", known_columns[known], cell);
            segment->class = (uint8_t) class;
            continue;
        }
        if (!text_number(cell, &value))
            return refuse(why, "%s is not a number: '%s'", known_columns[known], cell);
        if (known == ENERGY) {
            if (value < 0 || value > TRACK_CSV_MAX_MEV)
                return refuse(why, "%s is below 0 or above 1e9: '%s'", known_columns[known], cell);
            segment->energy_mev = (float)value;
            continue;
        }
        (known < X1 ? segment->from_lps_mm : segment->to_lps_mm)[known % 3] = (float)fmax(-1e30, fmin(1e30, value));
    }
    if (n_cells != header->n_columns) {
        snprintf(why, 120, "%zu cells instead of %zu", n_cells, header->n_columns);
        return false;
    }
    return true;
}

static bool is_far(const float point[3])
{
    return fabs((double)point[0]) > TRACK_CSV_MAX_PLACE_MM || fabs((double)point[1]) > TRACK_CSV_MAX_PLACE_MM ||
           fabs((double)point[2]) > TRACK_CSV_MAX_PLACE_MM;
}

static void report_counts(const struct counts *counts, const char *name, struct report *report)
{
    if (counts->n_bad > 0)
        report_add(report, REPORT_WARNING, "tracks.bad-lines", name,
                   "%zu lines are not segments, the first is line %zu: %s.", counts->n_bad, counts->first_bad_line,
                   counts->first_why);
    if (counts->n_zero_length > 0)
        report_add(report, REPORT_NOTE, "tracks.zero-length", name, "%zu segments of no length were left out.",
                   counts->n_zero_length);
    if (counts->n_far > 0)
        report_add(report, REPORT_WARNING, "tracks.far", name,
                   "%zu of %zu segments end more than %g m away and were left out.", counts->n_far,
                   counts->n_lines - counts->n_bad, TRACK_CSV_MAX_PLACE_MM / 1000);
}

bool track_csv_parse(const uint8_t *data, size_t size, const char *name, struct track_set *set, struct report *report,
                     struct error *err)
{
    struct text text;
    struct header header;
    struct counts counts = { 0 };
    char line[TEXT_LINE_SIZE], why[120];
    size_t capacity = set->n_segments;
    start(&text, data, size);
    if (!next_line(&text, line))
        return error_set(err, ERROR_FORMAT, "%s: the file is empty", name);
    if (!read_header(line, name, &header, err))
        return false;
    while (next_line(&text, line)) {
        struct track_segment segment;
        bool is_cut = strlen(line) == TEXT_LINE_SIZE - 1;
        counts.n_lines++;
        if (is_cut)
            snprintf(why, sizeof why, "it is longer than %d bytes", TEXT_LINE_SIZE - 2);
        if (is_cut || !read_segment(line, &header, &segment, why)) {
            if (counts.n_bad++ == 0) {
                counts.first_bad_line = text.line;
                memcpy(counts.first_why, why, sizeof why);
            }
            continue;
        }
        if (is_far(segment.from_lps_mm) || is_far(segment.to_lps_mm)) {
            counts.n_far++;
            continue;
        }
        if (track_segment_is_point(&segment)) {
            counts.n_zero_length++;
            continue;
        }
        if (!track_set_make_room(set, &capacity, name, err))
            return false;
        set->segments[set->n_segments++] = segment;
        set->n_of_class[segment.class]++;
    }
    if (counts.n_bad == counts.n_lines)
        return error_set(err, ERROR_FORMAT, "%s: not one of %zu lines below the header is a segment%s%s", name,
                         counts.n_lines, counts.n_bad > 0 ? ": " : "", counts.first_why);
    report_counts(&counts, name, report);
    return true;
}
