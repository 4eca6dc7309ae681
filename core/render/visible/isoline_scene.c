/* Finds the doses, values and lattices of a snapshot's isodose lines. */
#include "core/render/visible/isoline_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- doses and values ------------------------------------------------------------------------------------------- */

static void find_second(struct isoline_scene *lines, const struct snapshot *snapshot)
{
    const struct scene_dose_compare *compare = &snapshot->scene.dose.compare;
    struct isoline_dose *second = &lines->doses[1];
    int dose = compare->id[0] ? dose_index_of(snapshot->plan, compare->id) : -1;
    if (dose < 0 || !dose_choice_compared(snapshot, (size_t)dose, snapshot->scene.dose.quantity,
                                          snapshot->scene.dose.tissue, &second->choice, NULL))
        return;
    struct error err = { 0 };
    second->field = dose_field_get(snapshot->derived, &second->choice, &err);
    if (err.code == ERROR_MEMORY)
        lines->failure = err;
    if (second->field && strcmp(second->field->unit, lines->doses[0].field->unit) != 0) {
        derive_result_unref(&second->field->base);
        second->field = NULL;
    }
}

static int compare_levels(const void *left, const void *right)
{
    const struct isoline_level *a = left, *b = right;
    if (a->value != b->value)
        return a->value < b->value ? -1 : 1;
    return a->index < b->index ? -1 : a->index > b->index;
}

bool isoline_scene_init(struct isoline_scene *lines, const struct snapshot *snapshot)
{
    const struct scene_dose_style *style = &snapshot->scene.dose;
    struct dose_scale scale;
    memset(lines, 0, sizeof *lines);
    enum scene_dose_comparison mode = style->compare.id[0] ? style->compare.mode : SCENE_DOSE_COMPARISON_NONE;
    bool is_compared = mode == SCENE_DOSE_COMPARISON_LINES || mode == SCENE_DOSE_COMPARISON_DIFFERENCE;
    if (!(style->lines.visible || is_compared) || style->n_levels == 0 || !snapshot->has_dose_choice)
        return false;
    bool has_scale = dose_scale_of(snapshot, &scale), is_whole = dose_scale_is_whole(&scale, &lines->failure);
    if (!has_scale || !is_whole) {
        dose_scale_finish(&scale);
        return false;
    }
    for (size_t i = 0; i < style->n_levels && lines->n_levels < ISOLINE_MAX_LEVELS; i++) {
        const struct scene_dose_level *level = &style->levels[i].value;
        double value = dose_level_value(&scale, level->unit, level->value);
        if (level->visible && level->line && isfinite(value))
            lines->levels[lines->n_levels++] = (struct isoline_level){ i, value, level->color_rgb };
    }
    qsort(lines->levels, lines->n_levels, sizeof *lines->levels, compare_levels);
    lines->reference = scale.reference;
    lines->doses[0] = (struct isoline_dose){ scale.field, snapshot->dose_choice };
    if (lines->n_levels > 0 && is_compared)
        find_second(lines, snapshot);
    lines->is_drawn[0] = lines->n_levels > 0 && (style->lines.visible || mode == SCENE_DOSE_COMPARISON_LINES);
    lines->is_drawn[1] = lines->doses[1].field != NULL;
    if (lines->is_drawn[0] || lines->is_drawn[1])
        return true;
    isoline_scene_finish(lines);
    return false;
}

void isoline_scene_finish(struct isoline_scene *lines)
{
    struct error failure = lines->failure;
    for (int i = 0; i < 2; i++)
        if (lines->doses[i].field)
            derive_result_unref(&lines->doses[i].field->base);
    memset(lines, 0, sizeof *lines);
    lines->failure = failure;
}

/* ---- lattices --------------------------------------------------------------------------------------------------- */

/* Limit for all lines together, 4 bytes each. */
#define MAX_SAMPLES 4e6

struct isoline_window isoline_window_of_pane(const struct plane *plane, const struct camera *camera)
{
    struct isoline_window window = { { INFINITY, INFINITY }, { -INFINITY, -INFINITY } };
    for (int corner = 0; corner < 4; corner++) {
        struct vec3 p = mat4_project(&camera->lps_mm_from_clip, vec3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, 0)),
                    from = vec3_sub(p, plane->origin_lps_mm);
        const double at[2] = { vec3_dot(from, plane->right), vec3_dot(from, plane->up) };
        for (int i = 0; i < 2; i++) {
            window.low_mm[i] = fmin(window.low_mm[i], at[i]);
            window.high_mm[i] = fmax(window.high_mm[i], at[i]);
        }
    }
    return window;
}

struct isoline_window isoline_window_of_plane(void)
{
    return (struct isoline_window){ { -GRID_FARTHEST_MM, -GRID_FARTHEST_MM }, { GRID_FARTHEST_MM, GRID_FARTHEST_MM } };
}

/* The two index axes that lie in the plane; false: it is not parallel to slices of the grid. */
static bool find_axes(const struct grid *grid, const struct plane *plane, int axes[3])
{
    int n = 0;
    axes[2] = -1;
    for (int i = 0; i < 3; i++) {
        struct vec3 column = grid->lps_mm_from_ijk.columns[i];
        bool is_in_plane = fabs(vec3_dot(column, plane->normal)) < 1e-9 * vec3_length(column);
        if (is_in_plane && n < 2)
            axes[n++] = i;
        else
            axes[2] = i;
    }
    return n == 2 && axes[2] >= 0;
}

/* An interval along an axis, in lattice coordinates. */
struct extent {
    double low, high;
};

/* The grid's part of the window in lattice coordinates, in whose map column i is a step of length 1. */
static bool find_extents(const struct grid *grid, const struct plane *plane, const struct isoline_window *window,
                         const struct affine *map, struct extent extents[2])
{
    struct box3 box = grid_bounds_lps_mm(grid);
    struct plane_reach reach = plane_reach(plane, &box);
    struct affine inverse, full = *map;
    full.columns[2] = plane->normal;
    if (!plane_meets(&reach) || !affine_invert(&full, &inverse))
        return false;
    double low[2] = { fmax(window->low_mm[0], reach.low_right_mm), fmax(window->low_mm[1], reach.low_up_mm) },
           high[2] = { fmin(window->high_mm[0], reach.high_right_mm), fmin(window->high_mm[1], reach.high_up_mm) };
    if (!(low[0] < high[0] && low[1] < high[1]))
        return false;
    for (int i = 0; i < 2; i++)
        extents[i] = (struct extent){ INFINITY, -INFINITY };
    for (int corner = 0; corner < 4; corner++) {
        struct vec3 p =
            affine_point(&inverse, plane_point(plane, corner & 1 ? high[0] : low[0], corner & 2 ? high[1] : low[1]));
        const double at[2] = { p.x, p.y };
        for (int i = 0; i < 2; i++) {
            extents[i].low = fmin(extents[i].low, at[i]);
            extents[i].high = fmax(extents[i].high, at[i]);
        }
    }
    return true;
}

bool isoline_lattice_of(const struct grid *grid, const struct plane *plane, const struct isoline_window *window,
                        double mm_per_px, struct isoline_lattice *lattice)
{
    const struct affine *lps = &grid->lps_mm_from_ijk;
    int axes[3];
    bool is_slice = find_axes(grid, plane, axes);
    double spacing_mm[2];
    struct affine map;
    struct extent extents[2];
    if (is_slice) {
        struct vec3 across = lps->columns[axes[2]];
        double index = -plane_height_mm(plane, lps->origin) / vec3_dot(across, plane->normal);
        map = (struct affine){ { lps->columns[axes[0]], lps->columns[axes[1]] },
                               vec3_add(lps->origin, vec3_scale(across, index)) };
        for (int i = 0; i < 2; i++)
            spacing_mm[i] = vec3_length(map.columns[i]);
    } else {
        struct vec3 spacing = grid_spacing_mm(grid);
        struct plane upright = plane_upright(plane);
        spacing_mm[0] = spacing_mm[1] = fmin(fmin(spacing.x, spacing.y), spacing.z);
        map = (struct affine){ { vec3_scale(upright.right, spacing_mm[0]), vec3_scale(upright.up, spacing_mm[1]) },
                               plane_nearest(plane, vec3(0, 0, 0)) };
    }
    if (!find_extents(grid, plane, window, &map, extents))
        return false;
    for (int i = 0; is_slice && i < 2; i++) {
        extents[i].low = fmax(extents[i].low, -0.5);
        extents[i].high = fmin(extents[i].high, grid->size[axes[i]] - 0.5);
    }
    int halvings[2], coarser = 0;
    double n[2];
    for (int i = 0; i < 2; i++)
        halvings[i] = (int)fmin(fmax(ceil(log2(spacing_mm[i] / (ISOLINE_STEP_PX * mm_per_px))), -8), 8);
    do {
        for (int i = 0; i < 2; i++) {
            double scale = ldexp(1, halvings[i] - coarser);
            n[i] = floor(extents[i].high * scale) - ceil(extents[i].low * scale) + 1;
        }
    } while ((n[0] * n[1] > MAX_SAMPLES || fmax(n[0], n[1]) > ISOLINES_MAX_SIDE) && coarser++ < 16);
    if (!(n[0] >= 2 && n[1] >= 2))
        return false;
    for (int i = 0; i < 2; i++) {
        double scale = ldexp(1, halvings[i] - coarser);
        map.columns[i] = vec3_scale(map.columns[i], 1 / scale);
        lattice->first[i] = (int32_t)ceil(extents[i].low * scale);
        lattice->last[i] = (int32_t)floor(extents[i].high * scale);
    }
    lattice->lps_mm_from_uv = map;
    lattice->is_by_slice = false;
    return true;
}

bool isoline_lattice_holds(const struct isoline_lattice *a, const struct isoline_lattice *b)
{
    return memcmp(&a->lps_mm_from_uv, &b->lps_mm_from_uv, sizeof a->lps_mm_from_uv) == 0 &&
           a->is_by_slice == b->is_by_slice && a->first[0] <= b->first[0] && a->first[1] <= b->first[1] &&
           a->last[0] >= b->last[0] && a->last[1] >= b->last[1];
}

struct dose_lattice isoline_lattice_samples(const struct isoline_lattice *lattice)
{
    const struct affine *map = &lattice->lps_mm_from_uv;
    struct dose_lattice samples = { .lps_mm_from_uv = *map, .is_by_slice = lattice->is_by_slice };
    samples.lps_mm_from_uv.origin = affine_point(map, vec3(lattice->first[0], lattice->first[1], 0));
    for (int i = 0; i < 2; i++)
        samples.size[i] = (uint32_t)(lattice->last[i] - lattice->first[i] + 1);
    return samples;
}
