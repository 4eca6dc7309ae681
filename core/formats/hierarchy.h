#pragma once
/* SERA's body_containment.info: lines "outer > inner". */
#include "core/formats/plan_file.h"
#include "core/report/report.h"

/* Lines that are something else are reported and left out. Returns how many pairs; more than most are left out. */
size_t hierarchy_parse(const uint8_t *data, size_t size, const char *name, struct plan_file_pair *pairs, size_t most,
                       struct report *report);
