/* Reads the words of figures, and the figures from histograms. */
#include "core/dose/dvh_metrics.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WORD_SIZE = 32 };

/* Without blanks, in small letters; false for what is too long. */
static bool condense(const char *word, char out[WORD_SIZE])
{
    size_t n = 0;
    for (; *word; word++) {
        if (isspace((unsigned char)*word))
            continue;
        if (n + 1 == WORD_SIZE)
            return false;
        out[n++] = (char)tolower((unsigned char)*word);
    }
    out[n] = 0;
    return true;
}

/* Digits with at most one point: what strtod takes besides is no number here. */
static const char *read_amount(const char *at, double *amount)
{
    size_t n = strspn(at, "0123456789."), n_digits = 0;
    const char *point = strchr(at, '.');
    for (size_t i = 0; i < n; i++)
        n_digits += at[i] != '.';
    if (n_digits == 0 || (point && point < at + n && memchr(point + 1, '.', (size_t)(at + n - point - 1))))
        return NULL;
    *amount = strtod(at, NULL);
    return at + n;
}

static bool is_cc(const char *unit)
{
    return strcmp(unit, "cc") == 0 || strcmp(unit, "cm3") == 0;
}

bool dvh_metric_parse(const char *word, struct dvh_metric *metric, struct error *err)
{
    static const char *const plain[] = {
        [DVH_MEAN] = "mean", [DVH_MIN] = "min", [DVH_MAX] = "max", [DVH_HOMOGENEITY] = "hi"
    };
    char text[WORD_SIZE];
    *metric = (struct dvh_metric){ 0 };
    if (condense(word, text)) {
        for (size_t i = 0; i < sizeof plain / sizeof *plain; i++)
            if (plain[i] && strcmp(text, plain[i]) == 0) {
                metric->kind = (enum dvh_metric_kind)i;
                return true;
            }
        const char *unit = text[0] == 'd' || text[0] == 'v' ? read_amount(text + 1, &metric->amount) : NULL;
        bool is_dose = text[0] == 'd', is_known = unit && (is_cc(unit) || strcmp(unit, is_dose ? "%" : "") == 0);
        if (is_known) {
            metric->kind = is_dose       ? is_cc(unit) ? DVH_DOSE_CC : DVH_DOSE_PERCENT
                           : is_cc(unit) ? DVH_VOLUME_CC
                                         : DVH_VOLUME_PERCENT;
            if (metric->kind == DVH_DOSE_PERCENT && metric->amount > 100)
                return error_set(err, ERROR_RANGE, "%s: more than 100 %% of the volume", word);
            return true;
        }
    }
    return error_set(err, ERROR_FORMAT, "\"%.24s\" is none of mean, min, max, HI, D95%%, D2cc, V20, V20cc", word);
}

double dvh_metric_value(const struct dvh *dvh, const struct dvh_metric *metric)
{
    if (!(dvh->n > 0))
        return NAN;
    switch (metric->kind) {
    case DVH_MEAN: return dvh->sum / dvh->n;
    case DVH_MIN: return dvh->low;
    case DVH_MAX: return dvh->high;
    case DVH_DOSE_PERCENT: return dvh_value_of_hottest(dvh, metric->amount / 100 * dvh->n);
    case DVH_DOSE_CC: {
        double n = metric->amount / dvh->univel_cm3;
        return n <= dvh->n ? dvh_value_of_hottest(dvh, n) : NAN;
    }
    case DVH_VOLUME_PERCENT: return 100 * dvh_univels_from(dvh, metric->amount) / dvh->n;
    case DVH_VOLUME_CC: return dvh_univels_from(dvh, metric->amount) * dvh->univel_cm3;
    case DVH_HOMOGENEITY: {
        double half = dvh_value_of_hottest(dvh, 0.5 * dvh->n);
        return half > 0 ? (dvh_value_of_hottest(dvh, 0.02 * dvh->n) - dvh_value_of_hottest(dvh, 0.98 * dvh->n)) / half
                        : NAN;
    }
    }
    return NAN;
}

/* The largest value that at least n univels of the whole reach, when those without a value have 0 (is_hot false) or the
 * greatest of all. */
static double ranked(const struct dvh *dvh, double n, bool is_hot)
{
    if (is_hot)
        return n <= dvh->n_missing ? INFINITY : dvh_value_of_hottest(dvh, n - dvh->n_missing);
    return n > dvh->n ? fmin(dvh->low, 0) : dvh_value_of_hottest(dvh, n);
}

void dvh_metric_bounds(const struct dvh *dvh, const struct dvh_metric *metric, double *least, double *most)
{
    double all = dvh->n + dvh->n_missing, value = dvh_metric_value(dvh, metric);
    *least = *most = value;
    if (!(dvh->n_missing > 0))
        return;
    *least = 0;
    *most = INFINITY;
    if (!(dvh->n > 0))
        return;
    switch (metric->kind) {
    case DVH_MEAN: *least = dvh->sum / all; break;
    case DVH_MIN:
        *least = fmin(value, 0);
        *most = value;
        break;
    case DVH_MAX: *least = value; break;
    case DVH_DOSE_PERCENT:
    case DVH_DOSE_CC: {
        double n = metric->kind == DVH_DOSE_CC ? metric->amount / dvh->univel_cm3 : metric->amount / 100 * all;
        if (n > all) {
            *least = *most = NAN;
            break;
        }
        *least = ranked(dvh, n, false);
        *most = ranked(dvh, n, true);
        break;
    }
    case DVH_VOLUME_PERCENT:
    case DVH_VOLUME_CC: {
        double n = dvh_univels_from(dvh, metric->amount),
               scale = metric->kind == DVH_VOLUME_CC ? dvh->univel_cm3 : 100 / all;
        *least = n * scale;
        *most = (n + dvh->n_missing) * scale;
        break;
    }
    case DVH_HOMOGENEITY: break;
    }
}

/* A part without a value that no figure depends on, as a share of the region. */
static const double negligible_share = 1e-3;

bool dvh_is_partial(const struct dvh *dvh)
{
    return dvh->n_missing > 0 && dvh->n_missing >= negligible_share * (dvh->n + dvh->n_missing);
}

void dvh_metric_range(const struct dvh *dvh, const struct dvh_metric *metric, double *least, double *most)
{
    if (dvh_is_partial(dvh))
        dvh_metric_bounds(dvh, metric, least, most);
    else
        *least = *most = dvh_metric_value(dvh, metric);
}

struct dvh_conformity dvh_conformity(double target_cm3, double isodose_cm3, double covered_cm3)
{
    struct dvh_conformity out = { target_cm3, isodose_cm3, covered_cm3, NAN, NAN };
    if (target_cm3 > 0) {
        out.rtog = isodose_cm3 / target_cm3;
        if (isodose_cm3 > 0)
            out.paddick = covered_cm3 * covered_cm3 / (target_cm3 * isodose_cm3);
    }
    return out;
}
