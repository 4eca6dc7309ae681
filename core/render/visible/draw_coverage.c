/* The coverage of a region by the dose as draws. */
#include "core/render/visible/draw_coverage.h"

#include "core/render/visible/draw_dose.h"
#include "core/scene/dose_coverage_choice.h"

static const double stripe_px = 8, edge_px = 1.5;

static bool add_marks(struct draw_list *list, const struct snapshot *snapshot, const struct plane *plane,
                      const struct clip_set *clip, struct error *err)
{
    return draw_list_add(list,
                         &(struct draw){
                             .pass = DRAW_PLANES,
                             .kind = DRAW_MARKS,
                             .depth = snapshot_is_pane(snapshot) ? DRAW_DEPTH_NONE : DRAW_DEPTH_TESTED,
                             .subject = { SUBJECT_DOSE, (size_t)snapshot->dose, 0 },
                             .clip = *clip,
                             .plane = *plane,
                             .color_rgb = snapshot->scene.dose.coverage.color_rgb,
                             .opacity = 1,
                             .marks = { list->coverage->labels, stripe_px, edge_px },
                         },
                         err);
}

/* Leaves list->coverage NULL if there is none. */
static bool find_coverage(struct draw_list *list, const struct snapshot *snapshot, struct error *err)
{
    struct dose_coverage_choice choice;
    struct error why = { 0 };
    const struct dose_scale *scale = draw_dose_scale(list, snapshot);
    if (scale && dose_coverage_choice_of(snapshot, scale, &choice, &why))
        list->coverage = dose_coverage_get(snapshot->derived, &choice, &why);
    if (why.code == ERROR_MEMORY && err)
        *err = why;
    return why.code != ERROR_MEMORY;
}

bool draw_coverage(struct draw_list *list, const struct draw_scope *scope, struct error *err)
{
    const struct snapshot *snapshot = scope->snapshot;
    if (!snapshot->scene.dose.coverage.visible)
        return true;
    if (!find_coverage(list, snapshot, err))
        return false;
    if (!list->coverage || list->coverage->n == 0)
        return true;
    if (snapshot_is_pane(snapshot))
        return add_marks(list, snapshot, &snapshot->pane, &(struct clip_set){ 0 }, err);
    bool is_good = true;
    for (size_t i = 0, n = list->n; is_good && i < n; i++) {
        const struct draw draw = list->draws[i]; /* a copy: adding moves the draws */
        if (draw.kind == DRAW_IMAGE || draw.kind == DRAW_CAP)
            is_good = add_marks(list, snapshot, &draw.plane, &draw.clip, err);
    }
    return is_good;
}

void draw_coverage_release(struct draw_list *list)
{
    if (list->coverage)
        derive_result_unref(&list->coverage->base);
    list->coverage = NULL;
}
