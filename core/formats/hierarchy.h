#pragma once
/* Reads SERA's hierarchy of regions, body_containment.info: lines "outer > inner". */
#include "core/formats/plan_file.h"
#include "core/report/report.h"

/* Fills up to most pairs and returns how many. Other lines are reported and left out. */
size_t hierarchy_parse(const uint8_t *data, size_t size, const char *name, struct plan_file_pair *pairs, size_t most,
                       struct report *report);
