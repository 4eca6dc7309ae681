/* The output of a source at which a figure reaches its limit. */
#include "core/dose/irradiation.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- the source's output ---------------------------------------------------------------------------------------- */

/* Spellings without blanks, hyphens, dots and stars, in units of the kind. */
static const struct {
    const char *spelling;
    enum source_output_kind kind;
    double amount;
} spellings[] = {
    { "mwmin", SOURCE_ENERGY, 1 },
    { "mwminute", SOURCE_ENERGY, 1 },
    { "mwminutes", SOURCE_ENERGY, 1 },
    { "kwmin", SOURCE_ENERGY, 1e-3 },
    { "kwminute", SOURCE_ENERGY, 1e-3 },
    { "kwminutes", SOURCE_ENERGY, 1e-3 },
    { "mwh", SOURCE_ENERGY, 60 },
    { "kwh", SOURCE_ENERGY, 0.06 },
    { "mws", SOURCE_ENERGY, 1.0 / 60 },
    { "kws", SOURCE_ENERGY, 1e-3 / 60 },
    { "mamin", SOURCE_CHARGE, 1 },
    { "maminute", SOURCE_CHARGE, 1 },
    { "maminutes", SOURCE_CHARGE, 1 },
    { "mah", SOURCE_CHARGE, 60 },
    { "mas", SOURCE_CHARGE, 1.0 / 60 },
    { "mc", SOURCE_CHARGE, 1.0 / 60 },
    { "c", SOURCE_CHARGE, 1000.0 / 60 },
    { "coulomb", SOURCE_CHARGE, 1000.0 / 60 },
    { "min", SOURCE_TIME, 1 },
    { "minute", SOURCE_TIME, 1 },
    { "minutes", SOURCE_TIME, 1 },
    { "s", SOURCE_TIME, 1.0 / 60 },
    { "second", SOURCE_TIME, 1.0 / 60 },
    { "seconds", SOURCE_TIME, 1.0 / 60 },
    { "h", SOURCE_TIME, 60 },
    { "hour", SOURCE_TIME, 60 },
    { "hours", SOURCE_TIME, 60 },
};
static const char *const kind_words[] = { "MW-min", "mA-min", "min" };

/* Copies without what stands between the parts of a unit. */
static void squeeze(const char *text, char *bare, size_t size)
{
    static const char dot[] = "\xc2\xb7"; /* a middle dot in UTF-8 */
    size_t n = 0;
    while (*text && n + 1 < size) {
        if (strncmp(text, dot, 2) == 0)
            text += 2;
        else if (strchr(" -*.", *text))
            text++;
        else
            bare[n++] = *text++;
    }
    bare[n] = 0;
}

bool source_output_parse(const char *per, struct source_output *output)
{
    char *end, unit[SOURCE_WORDS_SIZE], bare[SOURCE_WORDS_SIZE];
    double amount = strtod(per, &end);
    bool has_amount = end > per && strchr("0123456789.", per[0]) != NULL;
    if (!has_amount) {
        amount = 1;
        end = (char *)per;
    }
    end += strspn(end, " ");
    const char *at = strstr(end, " at "), *condition = at ? at : ""; /* "minute at 1e10 n/cm2/s" */
    snprintf(unit, sizeof unit, "%.*s", (int)(at ? at - end : (ptrdiff_t)strlen(end)), end);
    squeeze(unit, bare, sizeof bare);
    *output = (struct source_output){ .kind = SOURCE_COUNT, .amount = amount };
    if (!bare[0] || !(amount > 0) || !isfinite(amount))
        return false;
    snprintf(output->words, sizeof output->words, "%s", end);
    for (size_t i = 0; i < sizeof spellings / sizeof *spellings; i++)
        if (strcmp(bare, spellings[i].spelling) == 0) {
            output->kind = spellings[i].kind;
            output->amount = amount * spellings[i].amount;
            snprintf(output->words, sizeof output->words, "%s%s", kind_words[output->kind], condition);
        }
    return true;
}

bool source_outputs_add(const struct source_output *a, const struct source_output *b)
{
    return a->kind == b->kind && strcmp(a->words, b->words) == 0;
}

double source_minutes(const struct source_output *output, double rate, enum source_rate_unit unit)
{
    if (output->kind == SOURCE_TIME)
        return 1;
    if (!(rate > 0))
        return NAN;
    if (output->kind == SOURCE_ENERGY && unit != SOURCE_MILLIAMPERE)
        return 1 / (unit == SOURCE_KILOWATT ? rate / 1000 : rate);
    return output->kind == SOURCE_CHARGE && unit == SOURCE_MILLIAMPERE ? 1 / rate : NAN;
}

/* ---- the output at a limit -------------------------------------------------------------------------------------- */

/* The dose whose growth to `dose` the limit waits for: of a limit on a volume, that of the hottest part of that size.
 */
static bool as_dose(const struct dvh_metric *metric, double limit, struct dvh_metric *of, double *dose)
{
    *of = *metric;
    *dose = limit;
    if (metric->kind == DVH_VOLUME_PERCENT || metric->kind == DVH_VOLUME_CC) {
        of->kind = metric->kind == DVH_VOLUME_CC ? DVH_DOSE_CC : DVH_DOSE_PERCENT;
        of->amount = limit;
        *dose = metric->amount;
        return true;
    }
    return false;
}

static double quotient(double dose, double per_unit)
{
    if (isinf(per_unit))
        return 0;
    return per_unit > 0 ? dose / per_unit : INFINITY;
}

/* The wait of a limit. */
struct awaited {
    struct dvh_metric metric; /* of a dose */
    double dose, least, most; /* the dose, and the bounds of the metric now */
    bool is_settled;          /* met at any output, or at none */
};

static bool await(const struct dvh *dvh, const struct dvh_metric *metric, bool is_at_most, double limit,
                  struct awaited *awaited, struct error *err)
{
    const double all = (dvh->n + dvh->n_missing) * dvh->univel_cm3;
    *awaited = (struct awaited){ .is_settled = false };
    if (!(dvh->n > 0))
        return error_set(err, ERROR_NOT_FOUND, "the dose has no value in the region");
    if (as_dose(metric, limit, &awaited->metric, &awaited->dose)) {
        const double size = metric->kind == DVH_VOLUME_CC ? all : 100;
        awaited->is_settled = is_at_most ? limit >= size : limit > size;
        if (awaited->is_settled)
            return true;
    }
    dvh_metric_range(dvh, &awaited->metric, &awaited->least, &awaited->most);
    if (isnan(awaited->least) || isnan(awaited->most))
        return error_set(err, ERROR_RANGE, "the region is smaller than that");
    return true;
}

bool irradiation_reach_of(const struct dvh *dvh, const struct dvh_metric *metric, bool is_at_most, double limit,
                          struct irradiation_reach *reach, struct error *err)
{
    struct awaited awaited;
    *reach = (struct irradiation_reach){ INFINITY, INFINITY };
    if (metric->kind == DVH_HOMOGENEITY)
        return error_set(err, ERROR_STATE, "the figure does not change with the time");
    if (!await(dvh, metric, is_at_most, limit, &awaited, err))
        return false;
    if (!awaited.is_settled)
        *reach =
            (struct irradiation_reach){ quotient(awaited.dose, awaited.most), quotient(awaited.dose, awaited.least) };
    return true;
}

void irradiation_figure(const struct dvh *dvh, const struct dvh_metric *metric, double output, double *least,
                        double *most)
{
    struct dvh_metric of = *metric;
    bool is_volume = metric->kind == DVH_VOLUME_PERCENT || metric->kind == DVH_VOLUME_CC;
    if (is_volume) /* the univels with d at the output are those with d / output per unit */
        of.amount = output > 0 ? metric->amount / output : INFINITY;
    if (is_volume && metric->amount == 0)
        of.amount = 0;
    dvh_metric_range(dvh, &of, least, most);
    if (is_volume || metric->kind == DVH_HOMOGENEITY)
        return;
    *least *= output;
    *most = isinf(*most) ? *most : *most * output;
}

/* ---- a dose that is not proportional ----------------------------------------------------------------------------- */

enum { FALSE_POSITION_STEPS = 30, MAX_STEPS = 60 }; /* then halves: 30 of them are 1e-9 */
static const double output_tolerance = 1e-4, dose_tolerance = 1e-6, most_output = 1e9;

struct growth {
    irradiation_histogram *histogram;
    void *context;
    const struct awaited *awaited;
    bool is_most; /* of the bounds */
};
struct side {
    double output, off; /* off: the figure less the dose that is awaited */
};

static bool look_at(const struct growth *growth, double output, struct side *side, struct error *err)
{
    struct dvh dvh = { 0 };
    double least, most;
    if (!growth->histogram(growth->context, output, &dvh, err))
        return false;
    dvh_metric_range(&dvh, &growth->awaited->metric, &least, &most);
    dvh_finish(&dvh);
    *side = (struct side){ output, (growth->is_most ? most : least) - growth->awaited->dose };
    return !isnan(side->off) || error_set(err, ERROR_NOT_FOUND, "the dose has no value in the region");
}

/* Grows the bracket until high is beyond the dose. high->output becomes INFINITY: never. */
static bool bracket(const struct growth *growth, struct side *low, struct side *high, struct error *err)
{
    const double dose = growth->awaited->dose;
    while (high->off < 0) {
        const double figure = high->off + dose;
        if (!(figure > 0) || high->output >= most_output) {
            high->output = INFINITY;
            return true;
        }
        *low = *high;
        if (!look_at(growth, low->output * fmin(fmax(1.1 * dose / figure, 1.5), 100), high, err))
            return false;
    }
    return true;
}

static bool is_wide(const struct side *low, const struct side *high)
{
    return isfinite(high->output) && high->output - low->output > output_tolerance * high->output;
}

/* Finds where a bound of the figure is the dose. figure: that bound at 1 unit. */
static bool find_output(const struct growth *growth, double figure, double *output, struct error *err)
{
    const double dose = growth->awaited->dose;
    struct side low = { 0, -dose }, high = { 1, figure - dose }, at;
    int last = 0; /* the end that moved last: -1 low, 1 high */
    *output = 0;
    if (!(dose > 0) || isinf(figure))
        return true;
    if (!bracket(growth, &low, &high, err))
        return false;
    for (int step = 0; step < MAX_STEPS && is_wide(&low, &high); step++) {
        const double width = high.output - low.output, margin = output_tolerance / 4 * high.output,
                     share = step < FALSE_POSITION_STEPS ? low.off / (low.off - high.off) : 0.5,
                     guess = low.output + share * width;
        if (!look_at(growth, fmin(fmax(guess, low.output + margin), high.output - margin), &at, err))
            return false;
        if (fabs(at.off) <= dose_tolerance * dose) {
            low = high = at;
        } else if (at.off < 0) {
            low = at;
            high.off /= last < 0 ? 2 : 1;
            last = -1;
        } else {
            high = at;
            low.off /= last > 0 ? 2 : 1;
            last = 1;
        }
    }
    *output = isinf(high.output) ? INFINITY : (low.output + high.output) / 2;
    return true;
}

bool irradiation_reach_growing(irradiation_histogram *histogram, void *context, const struct dvh_metric *metric,
                               bool is_at_most, double limit, struct irradiation_reach *reach, struct error *err)
{
    struct awaited awaited;
    struct dvh dvh = { 0 };
    struct growth growth = { histogram, context, &awaited, true };
    *reach = (struct irradiation_reach){ INFINITY, INFINITY };
    if (metric->kind == DVH_HOMOGENEITY)
        return error_set(err, ERROR_STATE, "the figure does not always grow with the time");
    if (!histogram(context, 1, &dvh, err))
        return false;
    const bool is_awaited = await(&dvh, metric, is_at_most, limit, &awaited, err);
    dvh_finish(&dvh);
    if (!is_awaited || awaited.is_settled)
        return is_awaited;
    if (!find_output(&growth, awaited.most, &reach->least, err))
        return false;
    reach->most = reach->least;
    growth.is_most = false;
    return awaited.least == awaited.most || find_output(&growth, awaited.least, &reach->most, err);
}
