#pragma once
/* Applies an entry of plan.json's "doses" to a dose of the plan: unit, frame of reference, components. */
#include "core/formats/plan_file.h"
#include "core/formats/sera/sera_doses.h"
#include "core/report/report.h"

/* Sets the unit of the dose, and its "per", from the entry. is_sera: the file is in cGy and per unit of its source,
 * whatever unit the entry has. */
void plan_dose_units(struct dose *dose, const struct plan_file_dose *entry, bool is_sera, struct report *report);
/* Sets the frame of reference from the entry, unless the dose's file says a worse one. where: the file, for the report.
 */
void plan_dose_frame(struct dose *dose, const struct plan_file_dose *entry, const char *where, struct report *report);
/* Adds values as the entry's component. Consumes values. */
void plan_add_component(struct dose *dose, const struct plan_file_dose *entry, size_t component, struct volume *values,
                        struct report *report);
/* Moves out of a SERA file's doses the quantity that the entry's component names; "total" names every quantity that no
 * other component of the entry does. Reports a quantity the file does not hold. */
void plan_add_sera(struct dose *dose, const struct plan_file_dose *entry, size_t component, struct sera_doses *doses,
                   struct report *report);
