#pragma once
/* Statements for records of decisions and signatures. Internal to server/store. */
#include <sqlite3.h>

#include "core/base/error.h"
#include "server/store/store_rows.h"

/* SQL over the columns item and body of a record for what lists say of it: {decision, plan_name, patient,
 * label, approval}, null where it is not known. Step 13 of the schema has it, so it stays as it is. */
#define RECORD_PLACE_IN_PLAN(name) \
    "max(0, CASE json_type(body, '$.kept.plan." name "') WHEN 'integer' THEN json_extract(body, '$.kept.plan." name \
    "') ELSE 0 END)"
#define RECORD_FACTS \
    "json_object('decision', coalesce(json_extract(item, '$.body.decision'), json_extract(item, '$.decision'))," \
    " 'plan_name', coalesce(json_extract(body, '$.kept.plan.name'), json_extract(body, '$.record.plan_name'))," \
    " 'patient', json_extract(body, '$.kept.plan.patients[' || " RECORD_PLACE_IN_PLAN( \
        "shown_patient") " || '].masked')," \
                         " 'label', json_extract(body, '$.kept.plan.treatment_plans[' || " RECORD_PLACE_IN_PLAN( \
                             "shown_plan") " || '].label')," \
                                           " 'approval', json_extract(body, '$.kept.plan.treatment_plans[' " \
                                           "|| " RECORD_PLACE_IN_PLAN("shown_plan") " || '].approval'))"

/* Adds the records of this write. Errors: those of sql_fail. */
NODISCARD bool records_write(sqlite3 *db, const struct store_room *room, struct error *err);
/* Like store_read_records. n records, the caller's; NULL: ERROR_NOT_FOUND (of one), ERROR_MEMORY, those of sql_fail. */
NODISCARD struct store_record *records_read(sqlite3 *db, const char *id, const char *before, size_t *n,
                                            struct error *err);
