/* The wash of a snapshot: which values have which colours. */
#include "core/render/visible/draw_wash.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/render/visible/draw_compare.h"
#include "core/render/visible/draw_dose.h"

static int compare_levels(const void *left, const void *right)
{
    const struct draw_wash_level *a = left, *b = right;
    return a->value < b->value ? -1 : a->value > b->value;
}

static float channel(uint32_t rgb, int c)
{
    return (float)(rgb >> (16 - 8 * c) & 255) / 255.0f;
}

void draw_wash_colors(struct draw_wash *wash, struct draw_wash_level *levels, size_t n, bool is_smooth, double below,
                      double opacity)
{
    qsort(levels, n, sizeof *levels, compare_levels);
    wash->n_knots = 0;
    for (size_t i = 0; i < n; i++) {
        const struct draw_wash_level *level = &levels[i], *next = i + 1 < n ? level + 1 : NULL;
        if (next && (next->value <= below || (float)next->value <= (float)level->value))
            continue;
        double start = fmax(level->value, below);
        int knot = wash->n_knots++;
        wash->knots[knot] = (float)start;
        for (int c = 0; c < 3; c++) {
            double rise = is_smooth && next ? (double)(channel(next->color_rgb, c) - channel(level->color_rgb, c)) /
                                                  (next->value - level->value)
                                            : 0;
            wash->rises[knot][c] = (float)rise;
            wash->colors[knot][c] = (float)(channel(level->color_rgb, c) + rise * (start - level->value));
        }
        wash->colors[knot][3] = (float)opacity;
        wash->rises[knot][3] = 0;
    }
}

static bool fill_from_dose(struct draw_wash *wash, const struct snapshot *snapshot, const struct dose_scale *scale)
{
    const struct scene_dose_style *style = &snapshot->scene.dose;
    struct draw_wash_level levels[DRAW_WASH_MAX_KNOTS];
    size_t n = 0;
    for (size_t i = 0; i < style->n_levels && n < DRAW_WASH_MAX_KNOTS; i++) {
        const struct scene_dose_level *level = &style->levels[i].value;
        double value = dose_level_value(scale, level->unit, level->value);
        if (level->visible && level->wash && isfinite(value))
            levels[n++] = (struct draw_wash_level){ value, level->color_rgb };
    }
    if (n == 0)
        return false;
    double below = dose_level_value(scale, SCENE_DOSE_UNIT_PERCENT, style->wash.below_percent);
    draw_wash_colors(wash, levels, n, style->wash.style == SCENE_WASH_STYLE_SMOOTH, isfinite(below) ? below : -INFINITY,
                     style->wash.opacity);
    for (; wash->n_rows < scale->field->n_rows; wash->n_rows++)
        wash->rows[wash->n_rows] = scale->field->rows[wash->n_rows];
    wash->field = scale->field;
    wash->tissue = scale->field->tissue ? scale->field->tissue->rows : NULL;
    wash->is_per_slice = style->interpolation == SCENE_DOSE_INTERPOLATION_SLICE;
    return true;
}

const struct draw_wash *draw_wash_shown(struct draw_list *list, const struct snapshot *snapshot)
{
    const struct scene_dose_wash *style = &snapshot->scene.dose.wash;
    bool is_compared = draw_compare_is_asked(&snapshot->scene.dose);
    if (!list->wash && (style->visible || is_compared) && style->opacity > 0) {
        const struct dose_scale *scale = list->reads_dose_in_parts && !is_compared
                                             ? draw_dose_scale_begun(list, snapshot)
                                             : draw_dose_scale(list, snapshot);
        struct draw_wash *wash = scale ? mem_new(sizeof *wash) : NULL;
        struct error err = { 0 };
        bool is_filled = wash && (is_compared                  ? draw_compare_fill(wash, snapshot, scale, &err)
                                  : snapshot->scene.dose.error ? draw_error_fill(wash, snapshot, &err)
                                                               : fill_from_dose(wash, snapshot, scale));
        if (err.code == ERROR_MEMORY)
            list->dose->why = err; /* fails the picture: see dose_scale_is_whole */
        if (is_filled)
            list->wash = wash;
        else
            free(wash);
    }
    return list->wash;
}

const struct draw_wash *draw_wash_of_region(struct draw_list *list, const struct snapshot *snapshot, size_t region)
{
    const struct draw_wash *wash = draw_wash_shown(list, snapshot);
    if (!wash || !wash->tissue)
        return wash;
    const uint8_t row = snapshot->dose_choice.row_of_region[region];
    if (row >= wash->n_rows)
        return NULL;
    if (!list->row_washes)
        list->row_washes = mem_new(wash->n_rows * sizeof *list->row_washes);
    struct draw_wash *own = &list->row_washes[row];
    *own = *wash;
    own->rows[0] = wash->rows[row];
    own->n_rows = 1;
    own->tissue = NULL;
    own->source = NULL;
    return own;
}

void draw_wash_release(struct draw_list *list)
{
    free(list->row_washes);
    list->row_washes = NULL;
    if (list->wash && list->wash->source)
        derive_result_unref(list->wash->source);
    free(list->wash);
    list->wash = NULL;
}

bool draw_wash_on_pane(struct draw_list *list, const struct draw_scope *scope, struct error *err)
{
    const struct draw_wash *wash = draw_wash_shown(list, scope->snapshot);
    return !wash || draw_list_add(list,
                                  &(struct draw){
                                      .pass = DRAW_PLANES,
                                      .kind = DRAW_WASH,
                                      .depth = DRAW_DEPTH_NONE,
                                      .subject = { SUBJECT_DOSE, (size_t)scope->snapshot->dose, 0 },
                                      .plane = scope->snapshot->pane,
                                      .opacity = 1,
                                      .wash = wash,
                                  },
                                  err);
}

/* The middle of the nearest slice: the point with the third index rounded. */
static struct vec3 into_slice(const struct grid *grid, struct vec3 point_lps_mm)
{
    struct vec3 at = affine_point(&grid->ijk_from_lps_mm, point_lps_mm);
    at.z = floor(at.z + 0.5);
    return affine_point(&grid->lps_mm_from_ijk, at);
}

bool draw_wash_at(const struct draw_wash *wash, struct vec3 point_lps_mm, float color[4])
{
    uint32_t row = 0, at[3];
    double value;
    if (wash->tissue) {
        if (!volume_voxel_at(wash->tissue, point_lps_mm, at))
            return false;
        row = volume_label(wash->tissue, at[0], at[1], at[2]);
    }
    if (row >= wash->n_rows || !volume_voxel_at(wash->rows[row], point_lps_mm, at))
        return false;
    if (wash->is_per_slice)
        point_lps_mm = into_slice(&wash->rows[row]->grid, point_lps_mm);
    if (wash->field)
        dose_field_need_box(wash->field, &(struct box3){ point_lps_mm, point_lps_mm });
    if (!volume_sample(wash->rows[row], point_lps_mm, &value))
        return false;
    int knot = -1;
    while (knot + 1 < wash->n_knots && (float)value >= wash->knots[knot + 1])
        knot++;
    for (int c = 0; knot >= 0 && c < 4; c++)
        color[c] = wash->colors[knot][c] + ((float)value - wash->knots[knot]) * wash->rises[knot][c];
    return knot >= 0;
}
