#pragma once
/* Reports patients, treatment plans and structure sets. Patients are named masked: the report is shown to everybody. */
#include "core/load/loading.h"

/* Adds the lines. Call it once all parts are in the plan. */
void plan_note_origins(struct loading *loading);
