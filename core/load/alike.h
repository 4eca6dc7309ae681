#pragma once
/* Tells doses and beams of several treatment plans apart by name and id, and puts the dose first that is shown first.
 * For plans without a plan.json, which would say both itself. */
#include "core/plan/plan.h"

/* Gives doses, or beams, with one name the label of their treatment plan in front; those still alike its date, then the
 * name of their file. Their ids are made anew. */
void plan_name_alike_doses(struct plan *plan);
void plan_name_alike_beams(struct plan *plan);

/* Sorts doses: those of the patient that is shown first; then by treatment plan: the one that is shown first, none
 * stated, others, one that is not here; then summed over the plan, its
 * beams where each has a dose (by the beams' order), a fraction, a beam. Equal ones keep their order. */
void plan_order_doses(struct plan *plan);
