#pragma once
/* The wash that compares two doses: their difference in diverging colours, or their gamma index. */
#include "core/render/visible/draw_wash.h"
#include "core/scene/dose_scale.h"

/* True if the scene asks for such a wash, which then takes the place of the dose's own. */
bool draw_compare_is_asked(const struct scene_dose_style *style);

/* Fills a zeroed wash, which gets a reference to the comparison (wash->source). Difference: blue where the second dose
 * is lower, orange where it is higher, nearly clear where they are equal; strongest from span_percent of the reference
 * on. Gamma: blue up to 1, from there orange to 2. The colours are in proto/dose_presets.json. Opacity: at most that of
 * the wash. Returns false if there is nothing to compare: err.code ERROR_MEMORY, or why. */
bool draw_compare_fill(struct draw_wash *wash, const struct snapshot *snapshot, const struct dose_scale *scale,
                       struct error *err);

/* Like draw_compare_fill, for a wash of the statistical error in place of the dose's own: from pale yellow at 0 to dark
 * red from 20 % on. */
bool draw_error_fill(struct draw_wash *wash, const struct snapshot *snapshot, struct error *err);
