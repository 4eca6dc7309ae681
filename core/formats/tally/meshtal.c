/* Reads a mesh tally of MCNP. */
#include "core/formats/tally/meshtal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/formats/tally/tally_text.h"
#include "core/formats/text.h"

enum column { ENERGY, TIME, X, Y, Z, RESULT, ERROR, OTHER };
enum { MOST_COLUMNS = 9 };

struct reading {
    struct tally_text text;
    struct tally_line line;
    const char *name;
    const struct tally_choice *choice;
    struct tally *tally;
    struct error *err;
    size_t bytes;

    long number;                             /* of the tally that is read */
    double energies[TALLY_MAX_ENERGIES + 1]; /* MeV */
    size_t n_energies, n_times;              /* bins; 0: bounds not seen */
    bool has_edges[3];
    bool *is_filled;
    size_t n_filled;
};

static bool fail(const struct reading *reading, enum error_code code, const char *what)
{
    return error_set(reading->err, code, "%s: line %zu: %s", reading->name, reading->line.number, what);
}

/* ---- which tally -------------------------------------------------------------------------------------------------- */

#define TALLY_MARK "Mesh Tally Number"

static bool take_number(struct tally_line *line, long *number)
{
    double value;
    if (!tally_skip(line, TALLY_MARK) || !tally_number(line, &value) || !(value >= 0 && value < 1e9))
        return false;
    *number = (long)value;
    return true;
}

/* Goes to the line of the chosen tally. */
static bool find_tally(struct reading *reading)
{
    struct tally_text start = reading->text;
    size_t n = 0;
    long number, first = 0;
    while (tally_next_line(&reading->text, &reading->line)) {
        struct tally_line line = reading->line;
        if (tally_skip(&line, "Number of histories used for normalizing tallies =") &&
            !tally_number(&line, &reading->tally->histories))
            return fail(reading, ERROR_FORMAT, "the number of histories is no number");
        if (!take_number(&reading->line, &number))
            continue;
        first = n++ == 0 ? number : first;
        if (reading->choice->number == number) {
            reading->number = number;
            return true;
        }
    }
    if (reading->choice->number == 0 && n == 1) {
        reading->text = start;
        reading->number = first;
        while (tally_next_line(&reading->text, &reading->line))
            if (take_number(&reading->line, &number))
                return true;
    }
    if (n == 0)
        return error_set(reading->err, ERROR_FORMAT, "%s: no line says " TALLY_MARK, reading->name);
    return reading->choice->number == 0
               ? error_set(reading->err, ERROR_RANGE,
                           "%s: %zu mesh tallies, of which \"tally\" has to name one, as %ld", reading->name, n, first)
               : error_set(reading->err, ERROR_NOT_FOUND, "%s: no mesh tally %ld; there are %zu, the first is %ld",
                           reading->name, reading->choice->number, n, first);
}

/* ---- bins --------------------------------------------------------------------------------------------------------- */

static bool take_edges(struct reading *reading, struct tally_line line, int axis)
{
    double *edges = mem_array(VOLUME_MAX_SIDE + 2, sizeof *edges, UINT64_MAX, reading->err);
    size_t n = 0;
    if (!edges)
        return false;
    while (n < VOLUME_MAX_SIDE + 2 && tally_number(&line, &edges[n]))
        n++;
    bool is_taken = tally_take_edges(reading->tally, axis, edges, n, reading->name, reading->err);
    free(edges);
    reading->has_edges[axis] = is_taken;
    return is_taken;
}

static bool take_energies(struct reading *reading, struct tally_line line)
{
    size_t n = 0;
    while (n <= TALLY_MAX_ENERGIES && tally_number(&line, &reading->energies[n]))
        n++;
    if (n < 2 || n > TALLY_MAX_ENERGIES)
        return fail(reading, ERROR_FORMAT, "2 to 4096 energies expected");
    reading->n_energies = n - 1;
    long wanted = reading->choice->energy;
    if (reading->n_energies > 1 && wanted == TALLY_ENERGY_UNSAID)
        return error_set(reading->err, ERROR_RANGE,
                         "%s: mesh tally %ld has %zu energy bins; \"energy\" has to say which, from 1, or \"total\"",
                         reading->name, reading->number, reading->n_energies);
    return wanted <= (long)reading->n_energies ||
           error_set(reading->err, ERROR_NOT_FOUND, "%s: mesh tally %ld has no energy bin %ld, but %zu", reading->name,
                     reading->number, wanted, reading->n_energies);
}

static size_t count_numbers(struct tally_line line)
{
    double value;
    size_t n = 0;
    while (tally_number(&line, &value))
        n++;
    return n;
}

/* A line of the head; *is_head becomes false behind the head. */
static bool take_head_line(struct reading *reading, bool *is_head)
{
    static const char *const words[] = { "X direction:", "Y direction:", "Z direction:" };
    struct tally_line line = reading->line;
    if (tally_find(&line, "Theta direction") || tally_find(&line, "R direction:"))
        return error_set(reading->err, ERROR_UNSUPPORTED,
                         "%s: mesh tally %ld is cylindrical; rectangular ones are read", reading->name,
                         reading->number);
    for (int axis = 0; axis < 3; axis++)
        if (tally_skip(&line, words[axis]))
            return take_edges(reading, line, axis);
    if (tally_skip(&line, "Time bin boundaries:")) {
        size_t n = count_numbers(line);
        reading->n_times = n > 1 ? n - 1 : 1;
    } else if (tally_skip(&line, "Energy bin boundaries:")) {
        *is_head = false;
        return take_energies(reading, line);
    }
    return true;
}

static bool read_head(struct reading *reading)
{
    for (bool is_head = true; is_head;) {
        struct tally_line line;
        if (!tally_next_line(&reading->text, &reading->line))
            return fail(reading, ERROR_FORMAT, "the file ends before the energy bin boundaries");
        line = reading->line;
        if (tally_find(&line, TALLY_MARK))
            return fail(reading, ERROR_FORMAT, "another tally begins before the energy bin boundaries");
        if (!take_head_line(reading, &is_head))
            return false;
    }
    for (int axis = 0; axis < 3; axis++)
        if (!reading->has_edges[axis])
            return error_set(reading->err, ERROR_FORMAT, "%s: mesh tally %ld gives no bounds along %c", reading->name,
                             reading->number, "xyz"[axis]);
    if (!tally_make_room(reading->tally, reading->bytes / 4, true, reading->name, reading->err))
        return false;
    size_t n = (size_t)reading->tally->size[0] * reading->tally->size[1] * reading->tally->size[2];
    reading->is_filled = mem_array(n, sizeof *reading->is_filled, UINT64_MAX, reading->err);
    return reading->is_filled != NULL;
}

/* ---- boxes -------------------------------------------------------------------------------------------------------- */

/* The box that a centre along an axis is of; false: of none. */
static bool index_of(const struct tally *tally, int axis, double centre_cm, uint32_t *index)
{
    double at = (centre_cm - tally->low_cm[axis]) / tally->step_cm[axis] - .5, whole = floor(at + .5);
    if (!(fabs(at - whole) <= .3 && whole >= 0 && whole < tally->size[axis]))
        return false;
    *index = (uint32_t)whole;
    return true;
}

static size_t box_at(const struct tally *tally, const uint32_t ijk[3])
{
    return ((size_t)ijk[2] * tally->size[1] + ijk[1]) * tally->size[0] + ijk[0];
}

/* True if the word of a row's or matrix's energy is of the wanted bin; upper_mev: not-a-number for the total. */
static bool is_wanted(const struct reading *reading, double upper_mev)
{
    long wanted = reading->choice->energy;
    if (reading->n_energies == 1)
        return true;
    if (wanted == TALLY_ENERGY_TOTAL || isnan(upper_mev))
        return wanted == TALLY_ENERGY_TOTAL && isnan(upper_mev);
    size_t nearest = 1;
    for (size_t i = 1; i <= reading->n_energies; i++)
        if (fabs(upper_mev - reading->energies[i]) < fabs(upper_mev - reading->energies[nearest]))
            nearest = i;
    return (size_t)wanted == nearest;
}

static bool put(struct reading *reading, const uint32_t ijk[3], double value, double relative)
{
    size_t box = box_at(reading->tally, ijk);
    if (reading->is_filled[box])
        return fail(reading, ERROR_FORMAT, "this box was there before");
    if (!(fabs(value) <= 1e30 && relative >= 0 && relative <= 1e6))
        return fail(reading, ERROR_FORMAT, "a value within 1e30 and an error from 0 on expected");
    reading->is_filled[box] = true;
    reading->n_filled++;
    reading->tally->values[box] = (float)value;
    reading->tally->errors[box] = (float)(fabs(value) * relative);
    return true;
}

/* ---- columns ------------------------------------------------------------------------------------------------------ */

struct columns {
    enum column of[MOST_COLUMNS];
    size_t n;
};

/* True for the line above columns. */
static bool take_columns(struct tally_line line, struct columns *columns)
{
    char word[TALLY_WORD_SIZE];
    unsigned seen = 0;
    columns->n = 0;
    while (tally_word(&line, word)) {
        enum column column = strcmp(word, "Energy") == 0   ? ENERGY
                             : strcmp(word, "Time") == 0   ? TIME
                             : strcmp(word, "X") == 0      ? X
                             : strcmp(word, "Y") == 0      ? Y
                             : strcmp(word, "Z") == 0      ? Z
                             : strcmp(word, "Result") == 0 ? RESULT
                                                           : OTHER;
        if (strcmp(word, "Rel") == 0 && tally_word(&line, word) && strcmp(word, "Error") == 0)
            column = ERROR;
        if (strcmp(word, "Rslt") == 0) { /* "Rslt * Vol" */
            (void)tally_word(&line, word);
            (void)tally_word(&line, word);
        }
        if (columns->n == MOST_COLUMNS)
            return false;
        columns->of[columns->n++] = column;
        seen |= 1U << column;
    }
    const unsigned needed = 1U << X | 1U << Y | 1U << Z | 1U << RESULT | 1U << ERROR;
    return (seen & needed) == needed;
}

static bool take_row(struct reading *reading, const struct columns *columns)
{
    struct tally_line line = reading->line;
    double values[OTHER + 1] = { 0 };
    uint32_t ijk[3];
    for (size_t c = 0; c < columns->n; c++) {
        char word[TALLY_WORD_SIZE];
        enum column column = columns->of[c];
        if (!tally_word(&line, word))
            return fail(reading, ERROR_FORMAT, "a column is missing");
        bool may_be_total = column == ENERGY || column == TIME;
        if (may_be_total && strcmp(word, "Total") == 0)
            values[column] = NAN;
        else if (!text_number(word, &values[column]))
            return fail(reading, ERROR_FORMAT, "a column holds no number");
    }
    if (!is_wanted(reading, values[ENERGY]) || (reading->n_times > 1 && !isnan(values[TIME])))
        return true;
    for (int axis = 0; axis < 3; axis++)
        if (!index_of(reading->tally, axis, values[X + axis], &ijk[axis]))
            return error_set(reading->err, ERROR_FORMAT, "%s: line %zu: %c is %g cm, which is the centre of no box",
                             reading->name, reading->line.number, "xyz"[axis], values[X + axis]);
    return put(reading, ijk, values[RESULT], values[ERROR]);
}

/* ---- matrices ----------------------------------------------------------------------------------------------------- */

struct matrix {
    int across, down, fixed; /* axes */
    uint32_t at;             /* index along the fixed one */
    double upper_mev;        /* of its energy; not-a-number: the total */
    bool is_total_time;
    double *values; /* of the results, until their errors come; [down][across] */
};

static int axis_of_letter(char letter)
{
    return letter == 'X' ? 0 : letter == 'Y' ? 1 : letter == 'Z' ? 2 : -1;
}

/* A line of numbers: an across header, or a row. out: most numbers. False: not as many. */
static bool numbers_of(struct tally_line line, double *out, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (!tally_number(&line, &out[i]))
            return false;
    char word[TALLY_WORD_SIZE];
    return !tally_word(&line, word);
}

/* The centres above a matrix and its rows. is_errors: puts what was read before with these errors. */
static bool take_matrix(struct reading *reading, struct matrix *matrix, bool is_errors)
{
    const struct tally *tally = reading->tally;
    uint32_t n_across = tally->size[matrix->across], n_down = tally->size[matrix->down], ijk[3];
    double *row = mem_array(2 * (size_t)n_across + 1, sizeof *row, UINT64_MAX, reading->err), *centres = row;
    if (!row)
        return false;
    row += n_across;
    bool is_good = (tally_next_line(&reading->text, &reading->line) && numbers_of(reading->line, centres, n_across)) ||
                   fail(reading, ERROR_FORMAT, "the centres of a matrix's columns expected");
    for (uint32_t down = 0; is_good && down < n_down; down++) {
        is_good = (tally_next_line(&reading->text, &reading->line) && numbers_of(reading->line, row, n_across + 1)) ||
                  fail(reading, ERROR_FORMAT, "a row of a matrix expected: its centre, and a number for each column");
        is_good = is_good && (index_of(tally, matrix->down, row[0], &ijk[matrix->down]) ||
                              fail(reading, ERROR_FORMAT, "the row's centre is that of no box"));
        ijk[matrix->fixed] = matrix->at;
        for (uint32_t i = 0; is_good && i < n_across; i++) {
            if (!index_of(tally, matrix->across, centres[i], &ijk[matrix->across])) {
                is_good = fail(reading, ERROR_FORMAT, "a column's centre is that of no box");
                break;
            }
            double *value = &matrix->values[(size_t)ijk[matrix->down] * n_across + ijk[matrix->across]];
            if (is_errors)
                is_good = put(reading, ijk, *value, row[1 + i]);
            else
                *value = row[1 + i];
        }
    }
    free(centres);
    return is_good;
}

/* "Tally Results:  X (across) by Y (down)" */
static bool take_sides(struct reading *reading, struct matrix *matrix, struct tally_line line)
{
    char across[TALLY_WORD_SIZE] = "", down[TALLY_WORD_SIZE] = "", word[TALLY_WORD_SIZE];
    bool is_whole =
        tally_word(&line, across) && tally_word(&line, word) && tally_word(&line, word) && tally_word(&line, down);
    matrix->across = axis_of_letter(across[0]);
    matrix->down = axis_of_letter(down[0]);
    return (is_whole && matrix->across >= 0 && matrix->down >= 0 && matrix->fixed >= 0 &&
            (1U << matrix->across | 1U << matrix->down | 1U << matrix->fixed) == 7) ||
           fail(reading, ERROR_FORMAT, "a matrix's sides, and the bin of the third axis before it, expected");
}

/* "Z bin:  0.00 - 5.00" */
static bool take_bin(struct reading *reading, struct matrix *matrix, int axis, struct tally_line line)
{
    double low, high;
    char dash[TALLY_WORD_SIZE];
    bool is_whole = tally_number(&line, &low) && tally_word(&line, dash) && tally_number(&line, &high);
    matrix->fixed = axis;
    return (is_whole && index_of(reading->tally, axis, .5 * (low + high), &matrix->at)) ||
           fail(reading, ERROR_FORMAT, "the bin is none of the mesh");
}

static bool take_energy_bin(struct reading *reading, struct matrix *matrix, struct tally_line line)
{
    double low, high;
    char dash[TALLY_WORD_SIZE];
    if (!tally_number(&line, &low) || !tally_word(&line, dash) || !tally_number(&line, &high))
        return fail(reading, ERROR_FORMAT, "an energy bin with its bounds expected");
    matrix->upper_mev = high;
    return true;
}

/* Results before this line have no errors behind it: those would be of other boxes. */
static void end_matrix(struct matrix *matrix)
{
    matrix->across = -1;
}

static bool take_matrix_line(struct reading *reading, struct matrix *matrix)
{
    static const char *const bins[] = { "X bin:", "Y bin:", "Z bin:" };
    struct tally_line line = reading->line;
    bool is_total = tally_find(&line, "Total Energy Bin"), is_total_time = tally_find(&line, "Total Time Bin");
    for (int axis = 0; axis < 3; axis++)
        if (tally_skip(&line, bins[axis])) {
            end_matrix(matrix);
            return take_bin(reading, matrix, axis, line);
        }
    if (is_total || tally_skip(&line, "Energy Bin:")) {
        end_matrix(matrix);
        matrix->upper_mev = NAN;
        return is_total || take_energy_bin(reading, matrix, line);
    }
    if (is_total_time || tally_find(&line, "Time Bin:")) {
        end_matrix(matrix);
        matrix->is_total_time = is_total_time;
        return true;
    }
    bool is_used = is_wanted(reading, matrix->upper_mev) && (reading->n_times <= 1 || matrix->is_total_time);
    if (tally_skip(&line, "Tally Results:"))
        return take_sides(reading, matrix, line) && (!is_used || take_matrix(reading, matrix, false));
    if (tally_find(&line, "Relative Errors") && is_used)
        return matrix->across >= 0 ? take_matrix(reading, matrix, true)
                                   : fail(reading, ERROR_FORMAT, "errors before their values");
    return true;
}

/* ---- the whole ---------------------------------------------------------------------------------------------------- */

static bool read_lines(struct reading *reading, struct matrix *matrix)
{
    struct columns columns = { 0 };
    bool is_rows = false;
    while (tally_next_line(&reading->text, &reading->line)) {
        struct tally_line line = reading->line;
        char word[TALLY_WORD_SIZE];
        if (tally_find(&line, TALLY_MARK))
            return true;
        if (!tally_word(&line, word))
            continue;
        if (!is_rows && take_columns(reading->line, &columns))
            is_rows = true;
        else if (!(is_rows ? take_row(reading, &columns) : take_matrix_line(reading, matrix)))
            return false;
    }
    return true;
}

static bool read_boxes(struct reading *reading)
{
    const struct tally *tally = reading->tally;
    uint32_t side = tally->size[0] > tally->size[1] ? tally->size[0] : tally->size[1];
    size_t most = (size_t)side * (tally->size[2] > side ? tally->size[2] : side);
    struct matrix matrix = { -1, -1, -1, 0, NAN, false, NULL };
    if (!(matrix.values = mem_array(most, sizeof *matrix.values, VOLUME_MAX_BYTES, reading->err)))
        return false;
    bool is_read = read_lines(reading, &matrix);
    free(matrix.values);
    size_t n = (size_t)tally->size[0] * tally->size[1] * tally->size[2];
    return is_read &&
           (reading->n_filled == n ||
            error_set(reading->err, ERROR_FORMAT, "%s: mesh tally %ld: %zu of its %zu boxes are there, of this energy",
                      reading->name, reading->number, reading->n_filled, n));
}

static void say(struct reading *reading)
{
    struct tally *tally = reading->tally;
    long wanted = reading->choice->energy;
    bool is_bin = wanted >= 1;
    snprintf(tally->words, sizeof tally->words, "mesh tally %ld of MCNP, %s energies from %g to %g MeV",
             reading->number, is_bin ? "of" : "all", reading->energies[is_bin ? wanted - 1 : 0],
             reading->energies[is_bin ? (size_t)wanted : reading->n_energies]);
}

bool meshtal_is(const uint8_t *data, size_t size)
{
    struct tally_line line = { (const char *)data, (const char *)data + (size < 65536 ? size : 65536), 0 };
    return tally_find(&line, TALLY_MARK) != NULL;
}

bool meshtal_read(const uint8_t *data, size_t size, const char *name, const struct tally_choice *choice,
                  struct tally *tally, struct error *err)
{
    struct tally_choice wanted = *choice;
    *tally = (struct tally){ 0 };
    if (size > TALLY_MAX_BYTES)
        return error_set(err, ERROR_LIMIT, "%s: %zu bytes, at most %llu expected", name, size,
                         (unsigned long long)TALLY_MAX_BYTES);
    struct reading *reading = mem_array(1, sizeof *reading, UINT64_MAX, err);
    if (!reading)
        return false;
    reading->name = name;
    reading->choice = &wanted;
    reading->tally = tally;
    reading->err = err;
    reading->bytes = size;
    tally_text_start(&reading->text, data, size);
    bool is_read = find_tally(reading) && read_head(reading) && read_boxes(reading);
    if (is_read)
        say(reading);
    else
        tally_finish(tally);
    free(reading->is_filled);
    free(reading);
    return is_read;
}
