#pragma once
/* Gives regions their parents from pairs of names, outer and inner, of which some may name no region of the plan. */
#include "core/formats/plan_file.h"
#include "core/region/region.h"
#include "core/report/report.h"

/* An outer name that is no region is passed through to the next one outside. is_strict: the pairs are our own
 * plan.json's, so ids come before names and a name that is no region is reported. Sets hierarchy to HIERARCHY_FILE when
 * any region gets a parent. where: the file, for the report. */
void region_set_apply_pairs(struct region_set *set, const struct plan_file_pair *pairs, size_t n_pairs, bool is_strict,
                            const char *where, struct report *report);
