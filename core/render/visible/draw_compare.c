#include "core/render/visible/draw_compare.h"

#include <math.h>
#include <string.h>

#include "core/derive/dose_error.h"
#include "core/scene/dose_compare.h"

/* A colour at a value; opacity as a part of the wash's. */
struct stop {
    double value;
    uint32_t rgb;
    double opacity;
};

bool draw_compare_is_asked(const struct scene_dose_style *style)
{
    return style->compare.id[0] && (style->compare.mode == SCENE_DOSE_COMPARISON_DIFFERENCE ||
                                    style->compare.mode == SCENE_DOSE_COMPARISON_GAMMA);
}

/* Mixed between two stops with different values; a jump where they are equal. The last stop's colour holds above it. */
static void fill_stops(struct draw_wash *wash, const struct stop *stops, size_t n, double opacity)
{
    for (size_t i = 0; i < n; i++) {
        const struct stop *stop = &stops[i], *next = i + 1 < n ? stop + 1 : stop;
        if (i + 1 < n && next->value <= stop->value)
            continue;
        int knot = wash->n_knots++;
        double width = next->value - stop->value;
        wash->knots[knot] = (float)stop->value;
        for (int c = 0; c < 4; c++) {
            double here = c == 3 ? stop->opacity * opacity : (stop->rgb >> (16 - 8 * c) & 255) / 255.0,
                   there = c == 3 ? next->opacity * opacity : (next->rgb >> (16 - 8 * c) & 255) / 255.0;
            wash->colors[knot][c] = (float)here;
            wash->rises[knot][c] = width > 0 ? (float)((there - here) / width) : 0;
        }
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
    /* blue and red of ColorBrewer's RdBu, told apart with any colour vision; the first stop is below all values */
    const struct stop differences[] = {
        { -1e30, 0x2166ac, 1 }, { -span, 0x2166ac, 1 }, { 0, 0xf7f7f7, 0.1 }, { span, 0xb2182b, 1 }
    };
    const struct stop indices[] = { { 0, 0x2166ac, 0.35 }, { 1, 0x92c5de, 1 }, { 1, 0xfdae61, 1 }, { 2, 0xb2182b, 1 } };
    if (is_gamma)
        fill_stops(wash, indices, sizeof indices / sizeof *indices, style->wash.opacity);
    else
        fill_stops(wash, differences, sizeof differences / sizeof *differences, style->wash.opacity);
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
    const struct stop stops[] = { { 0, 0xffffcc, 1 }, { 5, 0xfecc5c, 1 }, { 10, 0xf03b20, 1 }, { 20, 0x800026, 1 } };
    fill_stops(wash, stops, sizeof stops / sizeof *stops, style->wash.opacity);
    wash->rows[0] = error->percent;
    wash->n_rows = 1;
    wash->is_per_slice = style->interpolation == SCENE_DOSE_INTERPOLATION_SLICE;
    wash->source = &error->base;
    return true;
}
