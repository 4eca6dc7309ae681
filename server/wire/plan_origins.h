#pragma once
/* Where the parts of a plan come from, in its document: patients masked, treatment plans, and for each part of which of
 * them it is. Patients in full are given by plan_identity alone. Thread: any. */
#include "core/plan/plan.h"
#include "server/wire/json.h"

/* Adds to a plan document (plan_document.h), and to the entries of its images, regions, doses and beams, the fields
 * that plan_document.h lists under "origins". */
void plan_origins_add(cJSON *document, const struct plan *plan);

/* {patients: [ {id, issuer, name, birth_date, sex, has_conflict, masked} ]} in the order of the plan document; a birth
 * date is YYYY-MM-DD where the file's can be read so. A new object, for cJSON_Delete. */
cJSON *plan_identity(const struct plan *plan);
