#include "core/render/visible/draw_compare.h"

#include <math.h>
#include <string.h>

#include "core/derive/dose_error.h"
#include "core/scene/dose_compare.h"
#include "dose_presets.h"

bool draw_compare_is_asked(const struct scene_dose_style *style)
{
    return style->compare.id[0] && (style->compare.mode == SCENE_DOSE_COMPARISON_DIFFERENCE ||
                                    style->compare.mode == SCENE_DOSE_COMPARISON_GAMMA);
}

/* Adds the colour from a value on, up to that of the next stop a width further on; width 0: it holds. */
static void add_knot(struct draw_wash *wash, double value, double width, const struct color_stop *stop,
                     const struct color_stop *next, double opacity)
{
    int knot = wash->n_knots++;
    wash->knots[knot] = (float)value;
    for (int c = 0; c < 4; c++) {
        double here = c == 3 ? stop->opacity * opacity : (stop->color_rgb >> (16 - 8 * c) & 255) / 255.0,
               there = c == 3 ? next->opacity * opacity : (next->color_rgb >> (16 - 8 * c) & 255) / 255.0;
        wash->colors[knot][c] = (float)here;
        wash->rises[knot][c] = width > 0 ? (float)((there - here) / width) : 0;
    }
}

/* Mixed between two stops at different values; a jump where they are equal. The first stop's colour holds below it, the
 * last one's above. unit: the value that 1 of the scale stands for. */
static void fill_scale(struct draw_wash *wash, const struct color_scale *scale, double unit, double opacity)
{
    add_knot(wash, -1e30, 0, &scale->stops[0], &scale->stops[0], opacity);
    for (size_t i = 0; i < scale->n_stops; i++) {
        const struct color_stop *stop = &scale->stops[i], *next = i + 1 < scale->n_stops ? stop + 1 : stop;
        if (next == stop || next->at > stop->at)
            add_knot(wash, stop->at * unit, (next->at - stop->at) * unit, stop, next, opacity);
    }
}

bool draw_compare_fill(struct draw_wash *wash, const struct snapshot *snapshot, const struct dose_scale *scale,
                       struct error *err)
{
    const struct scene_dose_style *style = &snapshot->scene.dose;
    struct dose_comparison_choice choice;
    double span = scale->reference * style->compare.span_percent / 100;
    bool is_gamma = style->compare.mode == SCENE_DOSE_COMPARISON_GAMMA;
    if (!is_gamma && !isfinite(span))
        return error_set(err, ERROR_RANGE, "the reference is unknown");
    if (!dose_compare_of(snapshot, scale, is_gamma, &choice, err))
        return false;
    struct dose_comparison *comparison = dose_comparison_get(snapshot->derived, &choice, err);
    if (!comparison)
        return false;
    fill_scale(wash, is_gamma ? &gamma_scale : &difference_scale, is_gamma ? 1 : span, style->wash.opacity);
    wash->rows[0] = comparison->values;
    wash->n_rows = 1;
    wash->is_per_slice = style->interpolation == SCENE_DOSE_INTERPOLATION_SLICE;
    wash->source = &comparison->base;
    return true;
}

bool draw_error_fill(struct draw_wash *wash, const struct snapshot *snapshot, struct error *err)
{
    const struct scene_dose_style *style = &snapshot->scene.dose;
    struct dose_error *error = dose_error_get(snapshot->derived, &snapshot->dose_choice, err);
    if (!error)
        return false;
    fill_scale(wash, &error_scale, 1, style->wash.opacity);
    wash->rows[0] = error->percent;
    wash->n_rows = 1;
    wash->is_per_slice = style->interpolation == SCENE_DOSE_INTERPOLATION_SLICE;
    wash->source = &error->base;
    return true;
}
