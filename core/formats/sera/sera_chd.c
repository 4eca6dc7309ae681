/* Reads the header of SERA's dose contours, .chd. */
#include "core/formats/sera/sera_chd.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/formats/text.h"

/* Half the width of a patient with the couch is never more, in cm. */
static const double widest_half_cm = 60;
static const double narrowest_half_mm = 20;

enum key { KEY_FOV, KEY_XMIN, KEY_XMAX, KEY_YMIN, KEY_YMAX, KEY_COLS, KEY_ROWS, KEY_PLANES, N_KEYS };
static const char *const key_words[N_KEYS] = { "FOV",  "xmin",     "xmax",     "ymin",
                                               "ymax", "num_cols", "num_rows", "num_planes" };

struct parser {
    struct text text;
    const char *name;
    struct chd *chd;
    double values[N_KEYS];
    uint32_t seen; /* one bit for each key */
    double *z;     /* [CHD_MAX_SIDE] */
    bool *has_z;
    bool has_weight[CHD_N_COLUMNS];
    size_t n_unknown;
    char unknown[64];
    struct report *report;
    struct error *err;
};

void chd_finish(struct chd *chd)
{
    free(chd->planes);
    chd->planes = NULL;
    chd->n_planes = 0;
}

static bool fail(const struct parser *p, const char *key, const char *found, const char *expected)
{
    char clean[48];
    text_clean(found, clean, sizeof clean);
    return error_set(p->err, ERROR_FORMAT, "%s: line %zu: %s is \"%.40s\", expected %s", p->name, p->text.line, key,
                     clean, expected);
}

static bool get_number(const struct parser *p, const char *key, const char *value, double *out)
{
    return (text_number(value, out) && fabs(*out) <= 1e30) || fail(p, key, value, "a number");
}

/* The number at the end of a key "z_value_3" or the like; -1 for another key. */
static long key_index(const char *key, const char *stem)
{
    size_t n = strlen(stem);
    char start[32], *end;
    snprintf(start, sizeof start, "%.*s", (int)n, key);
    if (strlen(key) <= n || !text_equal(start, stem) || key[n] < '0' || key[n] > '9')
        return -1;
    long index = strtol(key + n, &end, 10);
    return *end == 0 && index >= 0 && index < 100000 ? index : -1;
}

/* Finds the quantity by seraMC's or seraPlan's name; the hydrogen dose is that of fast neutrons. */
static bool quantity_of(const char *word, enum dose_quantity *quantity)
{
    static const struct {
        const char *word;
        enum dose_quantity quantity;
    } names[] = { { "total", DOSE_TOTAL },
                  { "boron", DOSE_BORON },
                  { "gamma", DOSE_GAMMA },
                  { "nitrogen", DOSE_NITROGEN },
                  { "fast", DOSE_FAST },
                  { "hydrogen", DOSE_FAST },
                  { "other", DOSE_OTHER },
                  { "fast fluence", DOSE_FAST_FLUENCE },
                  { "epithermal fluence", DOSE_EPITHERMAL_FLUENCE },
                  { "thermal fluence", DOSE_THERMAL_FLUENCE } };
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        if (text_equal(word, names[i].word)) {
            *quantity = names[i].quantity;
            return true;
        }
    return false;
}

static void set_column(struct parser *p, long column, const char *value)
{
    struct chd *chd = p->chd;
    enum dose_quantity quantity;
    if (!quantity_of(value, &quantity)) {
        char clean[64];
        text_clean(value, clean, sizeof clean);
        report_add(p->report, REPORT_WARNING, "dose.unknown-column", p->name,
                   "Column %ld of the doses is called \"%.40s\"; it was left out.", column, clean);
        return;
    }
    for (long i = 0; i < CHD_N_COLUMNS; i++)
        if (i != column && chd->has_column[i] && chd->quantities[i] == quantity) {
            report_add(p->report, REPORT_WARNING, "dose.unknown-column", p->name,
                       "Columns %ld and %ld of the doses are both called \"%s\"; the latter was left out.", i, column,
                       value);
            return;
        }
    chd->has_column[column] = true;
    chd->quantities[column] = quantity;
}

static bool set_indexed(struct parser *p, const char *key, const char *value, bool *is_known)
{
    struct chd *chd = p->chd;
    long index = key_index(key, "z_value_");
    *is_known = true;
    if (index >= 0) {
        if (index >= CHD_MAX_SIDE)
            return error_set(p->err, ERROR_LIMIT, "%s: line %zu: more than %d planes", p->name, p->text.line,
                             CHD_MAX_SIDE);
        p->has_z[index] = true;
        return get_number(p, key, value, &p->z[index]);
    }
    static const char *const stems[] = { "dose_comp_", "conc_", "rbe_val_", "ref_dose_" };
    for (int s = 0; s < 4; s++) {
        index = key_index(key, stems[s]);
        if (index < 0)
            continue;
        if (index >= CHD_N_COLUMNS)
            return fail(p, key, value, "at most nine columns, 0 to 8");
        if (s == 0) {
            set_column(p, index, value);
            return true;
        }
        double number = 0;
        if (!text_number(value, &number) || fabs(number) > 1e30) { /* a reference too wide for its column is "***" */
            report_add(p->report, REPORT_WARNING, "header.bad-number", p->name,
                       "Line %zu: %.20s is not a number; it is not known then.", p->text.line, key);
            return true;
        }
        (s == 1 ? chd->concentration : s == 2 ? chd->weight : chd->reference)[index] = number;
        p->chd->has_concentration[index] |= s == 1;
        p->has_weight[index] |= s == 2;
        return true;
    }
    *is_known = key_index(key, "phi_val_") >= 0 || key_index(key, "theta_val_") >= 0;
    return true;
}

static bool set_value(struct parser *p, const char *key, const char *value)
{
    static const char *const fields[] = { "x_in_field", "y_in_field", "z_in_field" }, *const numbers[] = { "1", "2",
                                                                                                           "3" };
    static const char *const quiet[] = { "run_title", "number_beams" };
    bool is_known;
    if (!set_indexed(p, key, value, &is_known))
        return false;
    if (is_known)
        return true;
    if (text_equal(key, "Version_stamp")) {
        text_clean(value, p->chd->version, sizeof p->chd->version);
        return true;
    }
    for (int k = 0; k < N_KEYS; k++)
        if (text_equal(key, key_words[k])) {
            p->seen |= 1u << k;
            return get_number(p, key, value, &p->values[k]);
        }
    for (int f = 0; f < 3; f++)
        if (text_equal(key, fields[f]))
            return text_equal(value, numbers[f]) || fail(p, key, value, numbers[f]);
    for (size_t q = 0; q < sizeof quiet / sizeof quiet[0]; q++)
        if (text_equal(key, quiet[q]))
            return true;
    if (p->n_unknown++ == 0)
        text_clean(key, p->unknown, sizeof p->unknown);
    return true;
}

static bool check_side(const struct parser *p, enum key key, uint32_t low, uint32_t *out)
{
    double value = p->values[key];
    if (!(value == floor(value) && value >= low && value <= CHD_MAX_SIDE))
        return error_set(p->err, ERROR_FORMAT, "%s: %s is %g, expected a whole number from %u to %d", p->name,
                         key_words[key], value, low, CHD_MAX_SIDE);
    *out = (uint32_t)value;
    return true;
}

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static bool sort_planes(struct parser *p)
{
    struct chd *chd = p->chd;
    for (uint32_t i = 0; i < chd->n_planes; i++)
        if (!p->has_z[i])
            return error_set(p->err, ERROR_FORMAT, "%s: num_planes is %u, but z_value_%02u is missing", p->name,
                             chd->n_planes, i);
    chd->planes = mem_new(chd->n_planes * sizeof *chd->planes);
    memcpy(chd->planes, p->z, chd->n_planes * sizeof *chd->planes);
    qsort(chd->planes, chd->n_planes, sizeof *chd->planes, compare);
    for (uint32_t i = 1; i < chd->n_planes; i++)
        if (!(chd->planes[i] - chd->planes[i - 1] > 1e-4 * chd->half_width))
            return error_set(p->err, ERROR_FORMAT, "%s: two planes lie at z %g", p->name, chd->planes[i]);
    double reach = fmax(fabs(chd->planes[0]), fabs(chd->planes[chd->n_planes - 1]));
    return reach <= 1e4 ||
           error_set(p->err, ERROR_FORMAT, "%s: a plane lies at z %g, farther than any patient", p->name, reach);
}

static void check_unit(const struct parser *p)
{
    struct chd *chd = p->chd;
    chd->mm = 10;
    if (chd->half_width > widest_half_cm) {
        chd->mm = 1;
        report_add(
            p->report, REPORT_WARNING, "geometry.unit-assumed", p->name,
            "The contours would be %.2f m wide in centimetres, as SERA counts; the numbers were taken as millimetres (seraPlan writes "
            "these for a header in mm).",
            chd->half_width * 2 / 100);
    } else if (chd->half_width * chd->mm < narrowest_half_mm) {
        report_add(p->report, REPORT_WARNING, "geometry.unit-doubtful", p->name, "The contours are only %.3g mm wide.",
                   chd->half_width * chd->mm * 2);
    }
}

static bool check_geometry(struct parser *p)
{
    struct chd *chd = p->chd;
    for (int k = 0; k < N_KEYS; k++)
        if (!(p->seen & 1u << k))
            return error_set(p->err, ERROR_FORMAT, "%s: the key %s is missing", p->name, key_words[k]);
    chd->half_width = p->values[KEY_FOV];
    if (!(chd->half_width > 1e-3 && chd->half_width <= 1e4))
        return error_set(p->err, ERROR_FORMAT, "%s: FOV is %g, expected half the width of the contours, above 0",
                         p->name, chd->half_width);
    for (int a = 0; a < 2; a++) {
        chd->low[a] = p->values[KEY_XMIN + 2 * a];
        chd->high[a] = p->values[KEY_XMAX + 2 * a];
        if (!(chd->high[a] - chd->low[a] > 1e-3 && fabs(chd->low[a]) <= 10 && fabs(chd->high[a]) <= 10))
            return error_set(p->err, ERROR_FORMAT, "%s: %s to %s is %g to %g, expected parts of FOV, as -1 to 1",
                             p->name, key_words[KEY_XMIN + 2 * a], key_words[KEY_XMAX + 2 * a], chd->low[a],
                             chd->high[a]);
    }
    if (!check_side(p, KEY_COLS, 2, &chd->n_columns) || !check_side(p, KEY_ROWS, 2, &chd->n_rows) ||
        !check_side(p, KEY_PLANES, 1, &chd->n_planes))
        return false;
    if ((uint64_t)chd->n_columns * chd->n_rows * chd->n_planes > CHD_MAX_POINTS)
        return error_set(p->err, ERROR_LIMIT, "%s: %u x %u x %u points, at most %d are read", p->name, chd->n_columns,
                         chd->n_rows, chd->n_planes, CHD_MAX_POINTS);
    check_unit(p);
    return sort_planes(p);
}

static bool check_columns(struct parser *p)
{
    struct chd *chd = p->chd;
    size_t n = 0, n_missing = 0;
    for (int i = 0; i < CHD_N_COLUMNS; i++) {
        n += chd->has_column[i];
        if (!chd->has_column[i])
            continue;
        bool is_boron = chd->quantities[i] == DOSE_BORON;
        n_missing += !p->has_weight[i] || (is_boron && !chd->has_concentration[i]);
        if (!p->has_weight[i])
            chd->weight[i] = 1;
        if (!chd->has_concentration[i])
            chd->concentration[i] = 1;
    }
    if (n == 0)
        return error_set(p->err, ERROR_FORMAT,
                         "%s: no column has a name that is known (dose_comp_0: total and its like)", p->name);
    if (n_missing > 0)
        report_add(p->report, REPORT_WARNING, "dose.weights-missing", p->name,
                   "%zu columns have no rbe_val or no conc; 1 was taken for it.", n_missing);
    return true;
}

/* Reports columns in another order than seraMC's: programs that rely on that order show such a file wrongly. */
static void note_order(const struct parser *p)
{
    static const enum dose_quantity usual[CHD_N_COLUMNS] = { DOSE_TOTAL,
                                                             DOSE_BORON,
                                                             DOSE_GAMMA,
                                                             DOSE_NITROGEN,
                                                             DOSE_FAST,
                                                             DOSE_FAST_FLUENCE,
                                                             DOSE_EPITHERMAL_FLUENCE,
                                                             DOSE_THERMAL_FLUENCE,
                                                             DOSE_OTHER };
    for (int i = 0; i < CHD_N_COLUMNS; i++)
        if (p->chd->has_column[i] && p->chd->quantities[i] != usual[i]) {
            report_add(
                p->report, REPORT_NOTE, "dose.column-order", p->name,
                "Column %d holds %s, as seraPlan writes it and seraMC does not; all columns were taken by their names.",
                i, dose_quantity_word(p->chd->quantities[i]));
            return;
        }
}

static void note_header(const struct parser *p)
{
    note_order(p);
    const char *version = p->chd->version;
    if (strncmp(version, "seraMC_", 7) != 0 && strncmp(version, "seraPlan_", 9) != 0)
        report_add(p->report, REPORT_NOTE, "dose.unknown-version", p->name,
                   "The version is \"%s\"; the file has all keys that are needed and was read.", version);
    if (p->n_unknown > 0)
        report_add(p->report, REPORT_NOTE, "header.unknown-key", p->name,
                   "%zu unknown keys were ignored, the first is \"%s\".", p->n_unknown, p->unknown);
}

bool chd_parse(const uint8_t *data, size_t size, const char *name, struct chd *chd, struct report *report,
               struct error *err)
{
    *chd = (struct chd){ 0 };
    struct parser p = { .name = name, .chd = chd, .report = report, .err = err };
    p.z = mem_new(CHD_MAX_SIDE * sizeof *p.z);
    p.has_z = mem_new(CHD_MAX_SIDE * sizeof *p.has_z);
    char line[TEXT_LINE_SIZE], *key, *value;
    bool is_read = true;
    text_start(&p.text, data, size);
    while (is_read && text_line(&p.text, line))
        if (line[0] && text_split(line, ":", &key, &value))
            is_read = set_value(&p, key, value);
    is_read = is_read && check_geometry(&p) && check_columns(&p);
    free(p.z);
    free(p.has_z);
    if (is_read)
        note_header(&p);
    else
        chd_finish(chd);
    return is_read;
}

uint64_t chd_table_bytes(const struct chd *chd)
{
    return ((uint64_t)chd->n_columns * chd->n_rows * chd->n_planes + 16) * CHD_LINE_MAX_BYTES;
}

uint64_t chd_mask_bytes(const struct chd *chd)
{
    return (uint64_t)chd->n_planes * CHD_MASK_MAX_SIDE * CHD_MASK_MAX_SIDE;
}
