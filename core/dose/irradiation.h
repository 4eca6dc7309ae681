#pragma once
/* How long to irradiate: from doses per output of a source to the output at which a figure of a region reaches its
 * limit. Weighted and physical doses grow in proportion to the output as long as the concentration of boron and the
 * shares of the fields are those stated; a photon-isoeffective dose grows with it, too, but not in proportion. Any
 * thread. */
#include "core/dose/dvh_metrics.h"

/* ---- the source's output ---------------------------------------------------------------------------------------- */

enum source_output_kind {
    SOURCE_ENERGY, /* of a reactor: MW-min */
    SOURCE_CHARGE, /* on an accelerator's target: mA-min */
    SOURCE_TIME,   /* min */
    SOURCE_COUNT   /* of what the dose is per: fractions, plans, source particles */
};
enum { SOURCE_WORDS_SIZE = 96 };
struct source_output {
    enum source_output_kind kind;
    double amount;                 /* how many of the kind's unit the dose is per: 0.25 of "250 kW-min" */
    char words[SOURCE_WORDS_SIZE]; /* the kind's unit, with the source's strength where it is said: "MW-min", "mA-min",
                                      "min at 1e10 n/cm2/s", "fraction" */
};
/* Reads what a dose is per.
 *   per      as fit_per gives it, in small letters: "250 kw-min", "mw min", "ma-min", "minute", "fraction"
 *   returns  false: the dose does not say it, or has zero of it */
bool source_output_parse(const char *per, struct source_output *output);
/* True if outputs add up: of one kind, and counts of the same thing. */
bool source_outputs_add(const struct source_output *a, const struct source_output *b);

enum source_rate_unit { SOURCE_KILOWATT, SOURCE_MEGAWATT, SOURCE_MILLIAMPERE };
/* Minutes that the source takes for one unit of its output. rate: of the source; <= 0: not known. NAN: it cannot be
 * said; of a time 1. */
double source_minutes(const struct source_output *output, double rate, enum source_rate_unit unit);

/* ---- the output at a limit -------------------------------------------------------------------------------------- */

/* The output at which a figure reaches its limit; with a limit at most, up to it the limit is met; at least, from it
 * on. INFINITY: never. Bounds where a part of the region has no value. */
struct irradiation_reach {
    double least, most;
};
/* dvh    of a dose per one unit of output
 * metric, is_at_most, limit   in the dose's unit, or % and cm3 of volumes
 * errors ERROR_NOT_FOUND no univel has a value; ERROR_RANGE the region is smaller than the figure's volume; ERROR_STATE
 *        the figure does not change with the output
 * A volume V_d of at most v is met up to the output at which D_v, the dose of the hottest v, is d. */
NODISCARD bool irradiation_reach_of(const struct dvh *dvh, const struct dvh_metric *metric, bool is_at_most,
                                    double limit, struct irradiation_reach *reach, struct error *err);
/* The bounds of a figure at an output, from those per one unit of it; volumes are counted at the output. */
void irradiation_figure(const struct dvh *dvh, const struct dvh_metric *metric, double output, double *least,
                        double *most);

/* ---- a dose that is not proportional ----------------------------------------------------------------------------- */

/* The histogram of a dose at an output. dvh: zeroed, for dvh_finish; unchanged on failure. */
typedef bool irradiation_histogram(void *context, double output, struct dvh *dvh, struct error *err);

/* Like irradiation_reach_of, of a dose that is 0 without output and grows with it at every univel. The output is found
 * in a bracket by false position, the end that stays counting half (Illinois), then by halving, to 1e-4 of itself;
 * beyond 1e9 units it counts as never reached.
 *
 *   errors   also ERROR_STATE for a figure that need not grow; those of histogram
 *   source   M. Dowell and P. Jarratt, A modified regula falsi method, BIT 11 (1971) 168. A photon-isoeffective dose
 *            (isoeffective.h) grows: at constant dose rates each term of its effect is in proportion to the time T or
 *            to T^2 G(T), which is in proportion to y - 1 + e^-y, y = T / repair time, and the dose is the positive
 *            root of alpha D + beta Gr D^2 = effect (S. J. Gonzalez and G. A. Santa Cruz, Radiat. Res. 178 (2012) 609;
 *            D. E. Lea and D. G. Catcheside, J. Genet. 44 (1942) 216) */
NODISCARD bool irradiation_reach_growing(irradiation_histogram *histogram, void *context,
                                         const struct dvh_metric *metric, bool is_at_most, double limit,
                                         struct irradiation_reach *reach, struct error *err);
