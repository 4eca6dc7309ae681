#pragma once
/* The scale of a dose that is shown: its reference, its levels, and what stands in the way of drawing it. */
#include "core/scene/snapshot.h"

struct dose_scale {
    struct dose_field *field; /* NULL: there is nothing to show, see `why` */
    double reference;         /* 100 %, in the field's unit; NAN: unknown, see `why_no_reference` */
    char words[96];           /* "maximum in the body", "mean of PTV" */
    struct error why, why_no_reference;
};

/* Finds field and reference of the snapshot's dose. The reference `body` is the largest value at the centres of the
 * univels of any region, in a plan without regions that of the whole grid. May build the field and read all univels.
 * Returns false if there is nothing to show: no dose, or not its quantity, weights or acceptance. thread any */
bool dose_scale_of(const struct snapshot *snapshot, struct dose_scale *scale);
/* False with err: memory ran out on the way, and a part of the scale is not there though it could be. errors
 * ERROR_MEMORY
 */
NODISCARD bool dose_scale_is_whole(const struct dose_scale *scale, struct error *err);
/* Like dose_scale_of, with a field that is combined where it is read (dose_field_begin); all of it for a reference that
 * is measured in regions. */
bool dose_scale_begin(const struct snapshot *snapshot, struct dose_scale *scale);
void dose_scale_finish(struct dose_scale *scale);

/* A level's value in the field's unit; NAN if it is in percent of an unknown reference. */
double dose_level_value(const struct dose_scale *scale, enum scene_dose_unit unit, double value);
