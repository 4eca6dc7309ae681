/* The particle tracks of a scene as a draw. */
#include "core/render/visible/draw_tracks.h"

#include "core/render/visible/draw_clip.h"

/* Over the plan's box, not that of the tracks: a single particle that is lost far away would leave all others alike. */
static struct visible_cue cue_of(const struct draw_scope *scope)
{
    const struct box3 *box = &scope->snapshot->plan->bounds_lps_mm;
    if (!scope->snapshot->scene.tracks.depth_cue || box3_is_empty(box))
        return (struct visible_cue){ .w = 1 };
    return visible_depth_cue(scope->camera, box);
}

/* A beam's-eye view begins at the eye, also where it is parallel. */
static double nearest_mm(const struct draw_scope *scope)
{
    if (!scope->camera->is_parallel)
        return 0.1 * scope->camera->near_mm;
    return scope->snapshot->view.kind == SCENE_KIND_BEAM ? fmin(scope->camera->near_mm, 0) : -INFINITY;
}

bool draw_tracks(struct draw_list *list, const struct draw_scope *scope, struct error *err)
{
    const struct snapshot *snapshot = scope->snapshot;
    const struct scene_track_style *style = &snapshot->scene.tracks;
    const struct track_set *set = &snapshot->plan->tracks;
    if (snapshot_is_pane(snapshot) || !style->visible || !fit_is_used(&snapshot->fits.tracks))
        return true;
    struct draw draw = {
        .pass = DRAW_PLANES,
        .kind = DRAW_TRACKS,
        .depth = DRAW_DEPTH_TESTED,
        .subject = { SUBJECT_TRACKS, 0, 0 },
        .clip = draw_clip_set(snapshot, style->clipped),
        .opacity = 1,
        .tracks = { .set = set,
                    .shown = tracks_shown_of(set, style),
                    .width_px = style->width_px,
                    .is_still = scope->is_still,
                    .cue = cue_of(scope),
                    .nearest_mm = nearest_mm(scope) },
    };
    const struct tracks_shown *shown = &draw.tracks.shown;
    return shown->first == shown->end || shown->classes == 0 || draw_list_add(list, &draw, err);
}
