#pragma once
/* Doses of a treatment plan that are given beam by beam. Any thread. */
#include "core/plan/plan.h"

/* The doses that make the plan's dose when added: of each of its beams exactly one, of one unit, quantities and frame,
 * by the beams' order. Returns their number; 0: a beam has none or several, or they do not fit each other. */
size_t plan_beam_doses(const struct plan *plan, int treatment_plan, size_t doses[PLAN_MAX_DOSES]);
