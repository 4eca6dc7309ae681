#pragma once
/* How long to irradiate: from doses per output of a source to the output at which a figure of a region reaches its
 * limit. Weighted and physical doses grow in proportion to the output as long as the concentration of boron and the
 * shares of the fields are those stated. Any thread. */
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
