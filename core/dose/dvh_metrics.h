#pragma once
/* Figures of a dose-volume histogram, and the words they are written by. The value of a
 * figure is that of the univels with a value; its bounds are those of the whole region. */
#include "core/dose/dvh.h"

enum dvh_metric_kind {
    DVH_MEAN,           /* "mean" */
    DVH_MIN,            /* "min": lowest value at a univel */
    DVH_MAX,            /* "max" */
    DVH_DOSE_PERCENT,   /* "D95%": the greatest dose that 95 % of the volume have at least (ICRU Report 83, 3.6) */
    DVH_DOSE_CC,        /* "D2cc": the same of 2 cm3; NAN for a region that is smaller */
    DVH_VOLUME_PERCENT, /* "V20": the part of the volume with at least 20 of the quantity's unit, % */
    DVH_VOLUME_CC,      /* "V20cc": that volume, cm3 */
    DVH_HOMOGENEITY     /* "HI": (D2% - D98%) / D50%, 0 for an even dose (ICRU Report 83, 3.7.1) */
};
struct dvh_metric {
    enum dvh_metric_kind kind;
    double amount; /* 95 of D95%, 20 of V20; else 0 */
};
/* In any case, with blanks between, and "cm3" for "cc". errors ERROR_FORMAT: no such word; ERROR_RANGE: more than
 * 100 % */
NODISCARD bool dvh_metric_parse(const char *word, struct dvh_metric *metric, struct error *err);
/* In the quantity's unit, %, cm3 or without a unit, as its kind says. NAN without a univel that has a value. */
double dvh_metric_value(const struct dvh *dvh, const struct dvh_metric *metric);

/* The two bounds of a figure of the whole region, when univels without a value may have any value from 0 on; most is
 * INFINITY where there is none. NAN: the region is too small for the figure. */
void dvh_metric_bounds(const struct dvh *dvh, const struct dvh_metric *metric, double *least, double *most);
/* True if figures are given as bounds: 0.1 % of the univels or more have no value. */
bool dvh_is_partial(const struct dvh *dvh);
/* The bounds that are said of a figure: those of dvh_metric_bounds, of a region that is not partial both its value. */
void dvh_metric_range(const struct dvh *dvh, const struct dvh_metric *metric, double *least, double *most);

/* How an isodose volume and a target agree.
 *
 *   target_cm3    the target
 *   isodose_cm3   all of the body with at least the level
 *   covered_cm3   their intersection
 *   paddick       covered^2 / (target * isodose): 1 for agreement, 0 for none (I. Paddick, J. Neurosurg. 93 suppl. 3
 *                 (2000) 219)
 *   rtog          isodose / target: 1 if as large, wherever it lies (E. Shaw et al., Int. J. Radiat. Oncol. Biol. Phys.
 *                 27 (1993) 1231)
 * Both are NAN without a target; paddick also without an isodose volume. */
struct dvh_conformity {
    double target_cm3, isodose_cm3, covered_cm3, paddick, rtog;
};
struct dvh_conformity dvh_conformity(double target_cm3, double isodose_cm3, double covered_cm3);
