/* Reads a mesh of PHITS. */
#include "core/formats/tally/phits_tally.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/formats/tally/tally_text.h"
#include "core/formats/text.h"

enum { AXIS_X, AXIS_Y, AXIS_Z, AXIS_E, N_AXES };
enum { VALUE_SIZE = 64 };

struct reading {
    struct tally_text text;
    struct tally_line line;
    const char *name;
    const struct tally_choice *choice;
    struct tally *tally;
    struct error *err;
    size_t bytes;

    double low[N_AXES], high[N_AXES];
    size_t n[N_AXES]; /* 0: not given */
    char axes[8];     /* of a page: "y", "xz" */
    char unit[VALUE_SIZE], title[32];
    uint32_t at[3]; /* of the page, along the axes that it does not show */
    long energy;    /* of the page, from 1 */
    bool is_page;   /* a page has begun, and its boxes have not come yet */
    bool is_of_all; /* the first column of the page's values is of all particles */
    bool *is_filled;
    size_t n_filled;
};

static bool fail(const struct reading *reading, enum error_code code, const char *what)
{
    return error_set(reading->err, code, "%s: line %zu: %s", reading->name, reading->line.number, what);
}

static int axis_of(char letter)
{
    return letter == 'x' ? AXIS_X : letter == 'y' ? AXIS_Y : letter == 'z' ? AXIS_Z : letter == 'e' ? AXIS_E : -1;
}

/* ---- head --------------------------------------------------------------------------------------------------------- */

/* "key = value # comment": key without blanks, value without the comment and outer blanks. */
static bool split(struct tally_line line, char key[VALUE_SIZE], char value[VALUE_SIZE])
{
    struct tally_line left = line, right = line;
    const char *equals = tally_find(&line, "="), *comment;
    char word[TALLY_WORD_SIZE];
    if (!equals)
        return false;
    left.end = equals;
    right.at = equals + 1;
    if ((comment = tally_find(&right, "#")))
        right.end = comment;
    if (!tally_word(&left, word) || word[0] == '#')
        return false;
    snprintf(key, VALUE_SIZE, "%s", word);
    tally_copy(&right, value, VALUE_SIZE);
    return true;
}

static bool take_bound(struct reading *reading, const char *key, const char *value)
{
    int axis = axis_of(key[0]);
    double number;
    if (axis < 0)
        return true;
    if (strcmp(key + 1, "-type") == 0)
        return (text_number(value, &number) && (number == 2 || (axis == AXIS_E && number >= 1 && number <= 5))) ||
               fail(reading, ERROR_UNSUPPORTED, "a mesh of another type; type 2, linear steps, is read");
    double *to = strcmp(key + 1, "min") == 0   ? &reading->low[axis]
                 : strcmp(key + 1, "max") == 0 ? &reading->high[axis]
                                               : NULL;
    if (to)
        return (text_number(value, to) && fabs(*to) <= 1e9) ||
               fail(reading, ERROR_FORMAT, "a bound of the mesh expected");
    return true;
}

/* "nx", also in files that begin "n" with other words. */
static bool take_count(struct reading *reading, const char *key, const char *value)
{
    int axis = key[0] == 'n' && key[1] && !key[2] ? axis_of(key[1]) : -1;
    double number;
    if (axis < 0)
        return true;
    if (!text_number(value, &number) || !(number >= 1 && number <= VOLUME_MAX_SIDE && number == floor(number)))
        return fail(reading, ERROR_FORMAT, "a number of boxes from 1 to 4096 expected");
    reading->n[axis] = (size_t)number;
    return true;
}

static bool take_head_line(struct reading *reading)
{
    char key[VALUE_SIZE], value[VALUE_SIZE];
    if (!split(reading->line, key, value))
        return true;
    if (strcmp(key, "mesh") == 0 && strcmp(value, "xyz") != 0)
        return fail(reading, ERROR_UNSUPPORTED, "the mesh is not xyz; meshes xyz are read");
    if (strcmp(key, "axis") == 0)
        snprintf(reading->axes, sizeof reading->axes, "%.7s", value);
    if (strcmp(key, "unit") == 0) {
        struct tally_line line = reading->line;
        if (tally_skip(&line, "unit is ["))
            line.end = tally_find(&line, "]") ? tally_find(&line, "]") : line.end;
        tally_copy(&line, reading->unit, sizeof reading->unit);
    }
    return take_bound(reading, key, value) && take_count(reading, key, value);
}

static bool is_new_page(const struct tally_line *line)
{
    return tally_find(line, "newpage:") != NULL;
}

static bool check_axes(struct reading *reading)
{
    size_t n = strlen(reading->axes);
    bool is_good = n == 1 || n == 2;
    for (size_t i = 0; i < n && is_good; i++)
        is_good = axis_of(reading->axes[i]) >= AXIS_X && axis_of(reading->axes[i]) <= AXIS_Z;
    if (!is_good || reading->axes[0] == reading->axes[1])
        return error_set(reading->err, ERROR_UNSUPPORTED, "%s: its axis is '%s'; x, y, z, xy, yz and xz are read",
                         reading->name, reading->axes);
    for (int axis = 0; axis < 3; axis++)
        if (reading->n[axis] == 0 || !(reading->high[axis] > reading->low[axis]))
            return error_set(reading->err, ERROR_FORMAT,
                             "%s: the mesh along %c is not whole: %cmin, %cmax and n%c expected", reading->name,
                             "xyz"[axis], "xyz"[axis], "xyz"[axis], "xyz"[axis]);
    long wanted = reading->choice->energy;
    size_t n_energies = reading->n[AXIS_E] ? reading->n[AXIS_E] : 1;
    if (n_energies > 1 && wanted == TALLY_ENERGY_UNSAID)
        return error_set(reading->err, ERROR_RANGE, "%s: %zu energy bins; \"energy\" has to say which, from 1",
                         reading->name, n_energies);
    if (n_energies > 1 && wanted == TALLY_ENERGY_TOTAL)
        return error_set(reading->err, ERROR_UNSUPPORTED,
                         "%s: %zu energy bins and no total; \"energy\" has to say which", reading->name, n_energies);
    return wanted <= (long)n_energies || error_set(reading->err, ERROR_NOT_FOUND, "%s: no energy bin %ld, but %zu",
                                                   reading->name, wanted, n_energies);
}

/* Up to the first page, whose line is the current one then. */
static bool read_head(struct reading *reading)
{
    bool is_first = true;
    while (tally_next_line(&reading->text, &reading->line)) {
        struct tally_line line = reading->line;
        if (is_first) {
            tally_copy(&line, reading->title, sizeof reading->title);
            if (!tally_find(&line, "D e p o s i t") && !tally_find(&line, "Deposit") &&
                !tally_find(&line, "T r a c k") && !tally_find(&line, "Track"))
                return fail(reading, ERROR_UNSUPPORTED, "neither [T-Deposit] nor [T-Track] of PHITS");
            is_first = false;
        }
        if (is_new_page(&line))
            return check_axes(reading);
        if (!take_head_line(reading))
            return false;
    }
    return fail(reading, ERROR_FORMAT, "the file ends before its first page");
}

static bool make_room(struct reading *reading, bool has_errors)
{
    struct tally *tally = reading->tally;
    for (int axis = 0; axis < 3; axis++) {
        tally->size[axis] = (uint32_t)reading->n[axis];
        tally->low_cm[axis] = reading->low[axis];
        tally->step_cm[axis] = (reading->high[axis] - reading->low[axis]) / (double)reading->n[axis];
    }
    if (!tally_make_room(tally, reading->bytes / 4, has_errors, reading->name, reading->err))
        return false;
    size_t n = reading->n[0] * reading->n[1] * reading->n[2];
    reading->is_filled = mem_array(n, sizeof *reading->is_filled, UINT64_MAX, reading->err);
    return reading->is_filled != NULL;
}

/* ---- pages -------------------------------------------------------------------------------------------------------- */

/* "#   no. =  1   iy  =  1   iz  =  1"; words that are none of these are passed over. */
static bool take_page_place(struct reading *reading, struct tally_line line)
{
    char word[TALLY_WORD_SIZE], equals[TALLY_WORD_SIZE];
    while (tally_word(&line, word)) {
        if (word[0] != 'i' || !word[1] || word[2] || axis_of(word[1]) < 0)
            continue;
        double number;
        int axis = axis_of(word[1]);
        size_t most = axis == AXIS_E && reading->n[AXIS_E] == 0 ? 1 : reading->n[axis];
        if (!tally_word(&line, equals) || !tally_number(&line, &number) || !(number >= 1 && number <= (double)most))
            return fail(reading, ERROR_FORMAT, "the page's place in the mesh expected");
        if (axis == AXIS_E)
            reading->energy = (long)number;
        else
            reading->at[axis] = (uint32_t)number - 1;
    }
    return true;
}

static bool is_wanted(const struct reading *reading)
{
    return reading->choice->energy < 1 || reading->energy == reading->choice->energy;
}

static bool put(struct reading *reading, const uint32_t ijk[3], double value, double relative)
{
    struct tally *tally = reading->tally;
    size_t box = ((size_t)ijk[2] * tally->size[1] + ijk[1]) * tally->size[0] + ijk[0];
    if (reading->is_filled[box])
        return fail(reading, ERROR_FORMAT, "this box was there before");
    if (!(fabs(value) <= 1e30 && relative >= 0 && relative <= 1e6))
        return fail(reading, ERROR_FORMAT, "a value within 1e30 and an error from 0 on expected");
    reading->is_filled[box] = true;
    reading->n_filled++;
    tally->values[box] = (float)value;
    if (tally->errors)
        tally->errors[box] = (float)(fabs(value) * relative);
    return true;
}

/* "#  x-lower  x-upper  all  r.err": a file of several particles has two columns for each. */
static bool starts_with_all(struct tally_line line)
{
    char word[TALLY_WORD_SIZE];
    bool is_found = tally_skip(&line, "-upper") && tally_word(&line, word);
    return is_found && strcmp(word, "all") == 0;
}

/* Rows "lower upper value error" along the page's axis, up to an empty line. */
static bool take_rows(struct reading *reading)
{
    int axis = axis_of(reading->axes[0]);
    const struct tally *tally = reading->tally;
    uint32_t ijk[3] = { reading->at[0], reading->at[1], reading->at[2] };
    for (uint32_t i = 0; i < tally->size[axis]; i++) {
        struct tally_line line;
        double numbers[4], more;
        if (!tally_next_line(&reading->text, &reading->line))
            return fail(reading, ERROR_FORMAT, "the file ends within a page");
        line = reading->line;
        for (int k = 0; k < 4; k++)
            if (!tally_number(&line, &numbers[k]))
                return fail(reading, ERROR_FORMAT, "lower and upper bound, value and error expected");
        if (!reading->is_of_all && tally_number(&line, &more))
            return fail(reading, ERROR_UNSUPPORTED,
                        "values of several particles; a file of one, or of their sum, is read");
        double at = (.5 * (numbers[0] + numbers[1]) - tally->low_cm[axis]) / tally->step_cm[axis] - .5;
        if (!(fabs(at - i) <= .3))
            return fail(reading, ERROR_FORMAT, "the row's bounds are not those of the next box");
        ijk[axis] = i;
        if (is_wanted(reading) && !put(reading, ijk, numbers[2], numbers[3]))
            return false;
    }
    return true;
}

/* "( ( data(z,x), z = 1, nz ), x = nx, 1, -1 )": the fast axis, the slow one, and which of them fall. */
struct order {
    int fast, slow;
    bool is_fast_down, is_slow_down;
};

static bool take_order(struct reading *reading, struct order *order)
{
    struct tally_line line = reading->line, fast, slow;
    if (!tally_skip(&line, "data(") || line.end - line.at < 4 || line.at[1] != ',')
        return fail(reading, ERROR_FORMAT, "the order of a plane's numbers expected");
    order->fast = axis_of(line.at[0]);
    order->slow = axis_of(line.at[2]);
    bool is_whole = tally_skip(&line, "),");
    fast = line;
    slow = line;
    is_whole = is_whole && tally_skip(&slow, "),");
    fast.end = is_whole ? slow.at : fast.end;
    const char *fast_down = tally_find(&fast, "-1"), *slow_down = tally_find(&slow, "-1");
    order->is_fast_down = fast_down != NULL;
    order->is_slow_down = slow_down != NULL;
    bool is_of_page = order->fast >= 0 && order->slow >= 0 && order->fast != order->slow && order->fast < 3 &&
                      order->slow < 3 && strchr(reading->axes, "xyz"[order->fast]) &&
                      strchr(reading->axes, "xyz"[order->slow]);
    return (is_whole && is_of_page) ||
           fail(reading, ERROR_FORMAT, "the order of a plane's numbers is not that of its axes");
}

/* The next number of a plane, over the ends of lines. */
static bool next_number(struct reading *reading, double *value)
{
    char word[TALLY_WORD_SIZE];
    while (!tally_word(&reading->line, word))
        if (!tally_next_line(&reading->text, &reading->line))
            return fail(reading, ERROR_FORMAT, "the file ends within a plane");
    return text_number(word, value) || fail(reading, ERROR_FORMAT, "a number of a plane expected");
}

/* Numbers behind "hc: y = ... ; x = ... ;". */
static bool take_plane(struct reading *reading, const struct order *order)
{
    uint32_t n_fast = (uint32_t)reading->n[order->fast], n_slow = (uint32_t)reading->n[order->slow];
    uint32_t ijk[3] = { reading->at[0], reading->at[1], reading->at[2] };
    reading->line.at = reading->line.end;
    for (uint32_t s = 0; s < n_slow; s++)
        for (uint32_t f = 0; f < n_fast; f++) {
            double value;
            ijk[order->fast] = order->is_fast_down ? n_fast - 1 - f : f;
            ijk[order->slow] = order->is_slow_down ? n_slow - 1 - s : s;
            if (!next_number(reading, &value) || (is_wanted(reading) && !put(reading, ijk, value, 0)))
                return false;
        }
    return true;
}

static bool starts_plane(struct tally_line line)
{
    char word[TALLY_WORD_SIZE];
    return tally_word(&line, word) &&
           (strcmp(word, "hc:") == 0 || strcmp(word, "h2:") == 0 || strcmp(word, "hd:") == 0);
}

static bool take_page_line(struct reading *reading, struct order *order)
{
    bool is_plane = reading->axes[1] != '\0';
    struct tally_line line = reading->line;
    if (tally_find(&line, "no. =") && tally_find(&line, "#"))
        return take_page_place(reading, line);
    if (is_plane && tally_find(&line, "data("))
        return take_order(reading, order);
    if (is_plane && starts_plane(line)) {
        reading->is_page = false;
        return order->fast >= 0
                   ? take_plane(reading, order)
                   : fail(reading, ERROR_UNSUPPORTED, "a plane without the order of its numbers before it");
    }
    if (!is_plane && tally_find(&line, "-lower") && tally_find(&line, "r.err")) {
        reading->is_page = false;
        reading->is_of_all = starts_with_all(line);
        return take_rows(reading);
    }
    return true;
}

static bool read_pages(struct reading *reading)
{
    struct order order = { -1, -1, false, false };
    size_t n = reading->n[0] * reading->n[1] * reading->n[2];
    reading->is_page = true;
    reading->energy = 1;
    while (tally_next_line(&reading->text, &reading->line)) {
        if (is_new_page(&reading->line)) {
            reading->is_page = true;
            reading->energy = 1;
            order.fast = -1;
        } else if (reading->is_page && !take_page_line(reading, &order))
            return false;
    }
    return reading->n_filled == n ||
           error_set(reading->err, ERROR_FORMAT, "%s: %zu of the mesh's %zu boxes are there, of this energy",
                     reading->name, reading->n_filled, n);
}

static void say(const struct reading *reading)
{
    char title[32];
    size_t n = 0;
    for (const char *at = reading->title; *at; at++) /* "[ T - T r a c k ]" */
        if (*at != ' ')
            title[n++] = *at;
    title[n] = '\0';
    snprintf(reading->tally->words, sizeof reading->tally->words, "%s of PHITS, in %s%s", title,
             reading->unit[0] ? reading->unit : "a unit that it does not name", reading->axes[1] ? ", planes" : "");
}

bool phits_tally_is(const uint8_t *data, size_t size)
{
    struct tally_line line = { (const char *)data, (const char *)data + (size < 64 ? size : 64), 0 };
    return (tally_find(&line, "[ T - ") || tally_find(&line, "[T-")) &&
           (tally_find(&line, "Deposit") || tally_find(&line, "T r a c k") || tally_find(&line, "Track") ||
            tally_find(&line, "D e p o s i t"));
}

bool phits_tally_has_errors(const uint8_t *data, size_t size)
{
    struct tally_text text;
    struct tally_line line;
    char key[VALUE_SIZE], value[VALUE_SIZE];
    tally_text_start(&text, data, size);
    while (tally_next_line(&text, &line) && !is_new_page(&line))
        if (split(line, key, value) && strcmp(key, "axis") == 0)
            return strlen(value) == 1;
    return false;
}

static bool read_any(const uint8_t *data, size_t size, const char *name, const struct tally_choice *choice,
                     struct tally *tally, struct error *err)
{
    *tally = (struct tally){ 0 };
    if (size > TALLY_MAX_BYTES)
        return error_set(err, ERROR_LIMIT, "%s: %zu bytes, at most %llu expected", name, size,
                         (unsigned long long)TALLY_MAX_BYTES);
    struct reading reading = { .name = name, .choice = choice, .tally = tally, .err = err, .bytes = size };
    tally_text_start(&reading.text, data, size);
    bool is_read = read_head(&reading) && make_room(&reading, !reading.axes[1]) && read_pages(&reading);
    if (is_read)
        say(&reading);
    else
        tally_finish(tally);
    free(reading.is_filled);
    return is_read;
}

bool phits_tally_read(const uint8_t *data, size_t size, const char *name, const struct tally_choice *choice,
                      struct tally *tally, struct error *err)
{
    return read_any(data, size, name, choice, tally, err);
}

bool phits_tally_read_errors(const uint8_t *data, size_t size, const char *name, const struct tally_choice *choice,
                             struct tally *tally, struct error *err)
{
    struct tally errors;
    if (!read_any(data, size, name, choice, &errors, err))
        return false;
    size_t n = (size_t)tally->size[0] * tally->size[1] * tally->size[2];
    bool is_same = memcmp(errors.size, tally->size, sizeof tally->size) == 0;
    for (int axis = 0; axis < 3; axis++)
        is_same = is_same && fabs(errors.low_cm[axis] - tally->low_cm[axis]) < 1e-3 * tally->step_cm[axis] &&
                  fabs(errors.step_cm[axis] - tally->step_cm[axis]) < 1e-3 * tally->step_cm[axis];
    if (!is_same)
        error_set(err, ERROR_RANGE, "%s: its mesh is not that of the file whose errors it should hold", name);
    for (size_t i = 0; is_same && i < n; i++)
        if (!(errors.values[i] >= 0 && errors.values[i] <= 1e6F))
            is_same = error_set(err, ERROR_RANGE, "%s: box %zu: %g is no relative error", name, i + 1,
                                (double)errors.values[i]);
    for (size_t i = 0; is_same && i < n; i++)
        errors.values[i] *= fabsf(tally->values[i]);
    if (is_same) {
        free(tally->errors);
        tally->errors = errors.values;
        errors.values = NULL;
    }
    tally_finish(&errors);
    return is_same;
}
