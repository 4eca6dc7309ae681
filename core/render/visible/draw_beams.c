/* Beams as draws: in space as shapes, on slice panes as lines of the overlay. */
#include "core/render/visible/draw_beams.h"

#include <math.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/render/visible/beam_shape.h"
#include "core/render/visible/draw_order.h"

/* ---- in space ---------------------------------------------------------------------------------------------------- */

static bool add_shape(struct draw_list *list, const struct draw_scope *scope, const struct beam_drawn *beam,
                      struct shape *shape, struct draw *draw, struct error *err)
{
    const struct snapshot *snapshot = scope->snapshot;
    if (visible_is_out_of_sight(&scope->camera->clip_from_lps_mm, &shape->bounds_lps_mm))
        return true;
    draw->kind = DRAW_SHAPE;
    draw->subject = beam->subject;
    draw->color_rgb = beam->color_rgb;
    draw->shape.cue.w = 1;
    draw->shape.drawable = draw_cache_computed_shape(scope->cache, snapshot->plan, shape, 0, 1, err);
    if (!draw->shape.drawable)
        return false;
    return draw->depth == DRAW_DEPTH_LAYER ? draw_insert_translucent(list, scope, draw, err)
                                           : draw_list_add(list, draw, err);
}

static bool add_lines(struct draw_list *list, const struct draw_scope *scope, const struct beam_drawn *beam,
                      const struct beam_parts *parts, struct error *err)
{
    struct cut_lines lines = { 0 };
    struct shape *shape = NULL;
    struct draw draw = {
        .pass = DRAW_OPAQUE, .depth = DRAW_DEPTH_TESTED, .opacity = 1, .shape.look.size_px = DRAW_BEAM_WIDTH_PX
    };
    bool is_good = beam_add_lines(beam, parts, &lines, err);
    if (is_good && lines.n > 0) {
        shape = beam_lines_shape(&lines, err);
        is_good = shape && add_shape(list, scope, beam, shape, &draw, err);
    }
    shape_unref(shape);
    cut_lines_finish(&lines);
    return is_good;
}

static bool add_wall(struct draw_list *list, const struct draw_scope *scope, const struct beam_drawn *beam,
                     const struct beam_opening *opening, struct error *err)
{
    const struct scene *scene = &scope->snapshot->scene;
    bool is_opaque = scene->beam.opacity >= 1;
    struct draw draw = {
        .pass = is_opaque ? DRAW_OPAQUE : DRAW_TRANSLUCENT,
        .depth = is_opaque ? DRAW_DEPTH_TESTED : DRAW_DEPTH_LAYER,
        .opacity = scene->beam.opacity,
        .shape.look = { .is_two_sided = true,
                        .is_rim = !is_opaque && scene->surface.translucency == SCENE_TRANSLUCENCY_RIM },
    };
    struct shape *shape = beam_wall_shape(beam, opening, err);
    bool is_good = shape && add_shape(list, scope, beam, shape, &draw, err);
    shape_unref(shape);
    return is_good;
}

static bool add_in_space(struct draw_list *list, const struct draw_scope *scope, bool is_opaque, struct error *err)
{
    const struct snapshot *snapshot = scope->snapshot;
    const struct scene_beam_style *style = &snapshot->scene.beam;
    struct beam_drawn drawn[BEAMS_DRAWN_MAX];
    struct beam_opening opening;
    size_t n = snapshot_is_pane(snapshot) ? 0 : beams_drawn(snapshot->plan, &snapshot->scene, &snapshot->fits, drawn);
    for (size_t i = 0; i < n; i++) {
        const struct beam_drawn *beam = &drawn[i];
        bool has_opening =
            beam_opening_is_drawn(beam, &snapshot->view) && beam_opening_of(snapshot->plan, &beam->shown, &opening);
        const struct beam_parts parts = { beam_line_is_drawn(beam, &snapshot->view), has_opening ? &opening : NULL };
        if (is_opaque && !add_lines(list, scope, beam, &parts, err))
            return false;
        if (has_opening && style->opacity > 0 && (style->opacity >= 1) == is_opaque &&
            !add_wall(list, scope, beam, &opening, err))
            return false;
    }
    return true;
}

bool draw_opaque_beams(struct draw_list *list, const struct draw_scope *scope, struct error *err)
{
    return add_in_space(list, scope, true, err);
}

bool draw_translucent_beams(struct draw_list *list, const struct draw_scope *scope, struct error *err)
{
    return add_in_space(list, scope, false, err);
}

/* ---- on slice panes ---------------------------------------------------------------------------------------------- */

/* Consumes lines, also on failure. */
static bool add_strokes(struct draw_list *list, const struct draw_scope *scope, const struct beam_drawn *beam,
                        struct cut_lines *lines, double opacity, struct error *err)
{
    struct draw draw = { .pass = DRAW_OVERLAY,
                         .kind = DRAW_STROKES,
                         .depth = DRAW_DEPTH_NONE,
                         .subject = beam->subject,
                         .plane = scope->snapshot->pane,
                         .color_rgb = beam->color_rgb,
                         .opacity = opacity,
                         .strokes = { mem_new(sizeof *lines), DRAW_BEAM_WIDTH_PX } };
    *draw.strokes.lines = *lines;
    *lines = (struct cut_lines){ 0 };
    if (draw.strokes.lines->n > 0 && draw_list_add(list, &draw, err))
        return true;
    bool is_empty = draw.strokes.lines->n == 0;
    cut_lines_finish(draw.strokes.lines);
    free(draw.strokes.lines);
    return is_empty;
}

/* Half of an image's slice, or of a univel's without an image, along the normal of the pane. */
static double half_slice_mm(const struct snapshot *snapshot)
{
    const struct plan *plan = snapshot->plan;
    const struct volume *volume = snapshot->image >= 0         ? plan->images[snapshot->image].volume
                                  : plan->regions.n_layers > 0 ? plan->regions.layers[0]
                                                               : NULL;
    double most_mm = 1;
    for (int axis = 0; volume && axis < 3; axis++)
        most_mm =
            fmax(axis ? most_mm : 0, fabs(vec3_dot(volume->grid.lps_mm_from_ijk.columns[axis], snapshot->pane.normal)));
    return most_mm / 2;
}

static bool add_on_pane(struct draw_list *list, const struct draw_scope *scope, const struct beam_drawn *beam,
                        struct error *err)
{
    const struct snapshot *snapshot = scope->snapshot;
    const struct plane *pane = &snapshot->pane;
    const struct beam_parts parts = { true, NULL };
    struct cut_lines lines = { 0 }, near = { 0 }, far = { 0 };
    struct beam_opening opening;
    bool has_opening = beam->has_opening && beam_opening_of(snapshot->plan, &beam->shown, &opening);
    bool is_good = beam_add_lines(beam, &parts, &lines, err) &&
                   beam_project(&lines, pane, half_slice_mm(snapshot), &near, &far, err) &&
                   beam_add_crossing(beam, pane, DRAW_BEAM_CROSSING_PX / scope->camera->pixels_per_mm, &near, err) &&
                   (!has_opening || beam_add_section(beam, &opening, pane, &near, err)) &&
                   add_strokes(list, scope, beam, &far, DRAW_BEAM_FAINT, err) &&
                   add_strokes(list, scope, beam, &near, 1, err);
    cut_lines_finish(&lines);
    cut_lines_finish(&near);
    cut_lines_finish(&far);
    return is_good;
}

bool draw_beams_on_pane(struct draw_list *list, const struct draw_scope *scope, struct error *err)
{
    const struct snapshot *snapshot = scope->snapshot;
    struct beam_drawn drawn[BEAMS_DRAWN_MAX];
    size_t n = snapshot_is_pane(snapshot) ? beams_drawn(snapshot->plan, &snapshot->scene, &snapshot->fits, drawn) : 0;
    for (size_t i = 0; i < n; i++)
        if (!add_on_pane(list, scope, &drawn[i], err))
            return false;
    return true;
}

void draw_beams_release(struct draw_list *list)
{
    for (size_t i = 0; i < list->n; i++)
        if (list->draws[i].kind == DRAW_STROKES) {
            cut_lines_finish(list->draws[i].strokes.lines);
            free(list->draws[i].strokes.lines);
        }
}
