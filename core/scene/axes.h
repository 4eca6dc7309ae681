#pragma once
/* The patient axes in a 3-D view: lines through the middle of the plan's box, with letters at their ends. The page
 * draws the letters itself (web/js/pane/orientation.js). */
#include "core/plan/plan.h"

/* Half the length of an axis, in sizes of the box along it: the ends stand out of the box. */
#define AXES_REACH 0.6

enum { AXES_N_ENDS = 6 };
struct axis_end {
    char letter; /* L R P A S I */
    struct vec3 at_lps_mm;
};
/* The middle of the plan's bounds, and the ends in the order of the letters: middle +- AXES_REACH times the box's size
 * along L, P and S. Returns false, and fills nothing, if the bounds are empty. */
bool axes_of_plan(const struct plan *plan, struct vec3 *middle_lps_mm, struct axis_end ends[AXES_N_ENDS]);
