#pragma once
/* The masked form of a patient, the only one that is shown without asking: initials and the end of the ID. Any thread.
 */
#include "core/plan/plan.h"

enum { IDENTITY_MASK_SIZE = 48 };

/* "A. V. …417": the initials of the given, the middle and the family name, in this order (of an ideographic or phonetic
 * name family first), then the last three characters of the ID, of an ID of fewer than 6 characters the last one. A
 * name without '^' gives the initials of its first and last word. Control characters, also those of writing direction,
 * are never part of it. "…" if there is neither name nor ID.
 *
 *   source  DICOM PS3.5 6.2.1 (person names) */
void identity_mask(const struct plan_patient *patient, char out[IDENTITY_MASK_SIZE]);

/* "ZWEIFEL, Quirin, id 77-30419, born 1961-04-12": whom the files name, in full, for who has asked. */
enum { IDENTITY_WORDS_SIZE = 240 };
void identity_words(const struct plan_patient *patient, char out[IDENTITY_WORDS_SIZE]);

/* The treatment plan that is shown first: approved before without statement, before unapproved, before rejected; then
 * the newest by date and time, then the first. -1: the plan has none. */
int plan_shown_treatment_plan(const struct plan *plan);
int identity_first_treatment_plan(const struct treatment_plan *plans, size_t n); /* the same, of a list */
/* The patient of that treatment plan; without one, of the image with most slices. -1: the files name nobody. */
int plan_shown_patient(const struct plan *plan);
