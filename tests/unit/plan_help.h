#pragma once
/* Plans for tests: opened, and asked for their parts; and what a report says. */
#include "core/plan/plan.h"

bool report_has(const struct report *report, const char *code);
/* The sentence of the first line with the code; "" without one. */
const char *report_said(const struct report *report, const char *code);
struct plan *plan_of_folder(const char *folder, struct error *err);
/* A plan of the real data; NULL when they are not there. */
struct plan *plan_of_data(const char *name);
/* Fails where there is no such region. */
const struct region *region_of(const struct plan *plan, const char *id);
const char *parent_of(const struct plan *plan, const char *id); /* "" for a root */
