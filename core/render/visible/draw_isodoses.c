/* Isodose surfaces and the surface of a region's coverage as draws. */
#include "core/render/visible/draw_isodoses.h"

#include "core/base/log.h"
#include "core/derive/coverage_shape.h"
#include "core/render/visible/draw_clip.h"
#include "core/render/visible/draw_dose.h"
#include "core/render/visible/draw_order.h"
#include "core/render/visible/shading.h"
#include "core/scene/dose_coverage_choice.h"
#include "core/scene/isodoses.h"

/* A surface and how it is drawn. */
struct painted {
    struct subject subject;
    struct shape *shape; /* borrowed */
    uint32_t reduction;
    int n_passes; /* of shading_normals */
    uint32_t color_rgb;
    double opacity;
    bool is_clipped;
};

/* A draw of the surface; false without an error: it cannot be seen. */
static bool make_draw(const struct draw_scope *scope, const struct painted *painted, struct draw *draw,
                      struct error *err)
{
    const struct snapshot *snapshot = scope->snapshot;
    const struct box3 *box = &painted->shape->bounds_lps_mm;
    struct clip_set clip = draw_clip_set(snapshot, painted->is_clipped);
    if (painted->shape->mesh->n_triangles == 0 || visible_is_out_of_sight(&scope->camera->clip_from_lps_mm, box) ||
        !draw_clip_box(&clip, box))
        return false;
    const struct drawable *drawable = draw_cache_computed_shape(scope->cache, snapshot->plan, painted->shape,
                                                                painted->n_passes, painted->reduction, err);
    if (!drawable)
        return false;
    bool is_opaque = painted->opacity >= 1;
    *draw = (struct draw){
        .pass = is_opaque ? DRAW_OPAQUE : DRAW_TRANSLUCENT,
        .kind = DRAW_SHAPE,
        .depth = is_opaque ? DRAW_DEPTH_TESTED : DRAW_DEPTH_LAYER,
        .subject = painted->subject,
        .clip = clip,
        .color_rgb = painted->color_rgb,
        .opacity = painted->opacity,
        .shape = { .drawable = drawable,
                   /* two-sided: it may end where the dose's grid does */
                   .look = { .is_flat = snapshot->scene.surface.normals == SCENE_NORMALS_FACE,
                             .is_two_sided = true,
                             .is_rim = !is_opaque && snapshot->scene.surface.translucency == SCENE_TRANSLUCENCY_RIM },
                   .cue = visible_depth_cue(scope->camera, &drawable->bounds_lps_mm) },
    };
    return true;
}

static bool add_painted(struct draw_list *list, const struct draw_scope *scope, const struct painted *painted,
                        struct error *err)
{
    struct draw draw;
    struct error why = { 0 };
    if (make_draw(scope, painted, &draw, &why))
        return painted->opacity < 1 ? draw_insert_translucent(list, scope, &draw, err)
                                    : draw_list_add(list, &draw, err);
    if (why.code && err)
        *err = why;
    return !why.code;
}

static int passes_of(const struct isodose_choice *choice, uint32_t reduction)
{
    const struct shape_key key = { .representation = REPRESENTATION_SURFACE, .algorithm = choice->algorithm };
    return choice->algorithm == SURFACE_EIGHT_CELL ? visible_shading_passes(&key, reduction) : 0;
}

/* A surface that cannot be made is left out, unless memory is short. */
static bool is_fatal(const struct error *why, const char *what, struct error *err)
{
    if (why->code == ERROR_MEMORY && err)
        *err = *why;
    if (why->code)
        log_info("%s is not drawn: %s", what, why->text);
    return why->code == ERROR_MEMORY;
}

static bool add_isodose(struct draw_list *list, const struct draw_scope *scope, const struct isodose *isodose,
                        struct error *err)
{
    struct error why = { 0 };
    struct isodose_shape *made = isodose_shape_get(scope->snapshot->derived, &isodose->choice, scope->detail, &why);
    if (!made)
        return !is_fatal(&why, "an isodose", err);
    struct painted painted = { isodose->subject,
                               made->shape,
                               made->facts.reduction,
                               passes_of(&isodose->choice, made->facts.reduction),
                               isodose->color_rgb,
                               isodose->opacity,
                               scope->snapshot->scene.dose.surfaces.clipped };
    bool is_good = add_painted(list, scope, &painted, err);
    derive_result_unref(&made->base);
    return is_good;
}

static bool add_isodoses(struct draw_list *list, const struct draw_scope *scope, bool is_opaque, struct error *err)
{
    struct isodose isodoses[ISODOSES_MAX];
    if (!isodoses_are_shown(scope->snapshot))
        return true;
    const struct dose_scale *scale = draw_dose_scale(list, scope->snapshot);
    size_t n = scale ? isodoses_shown(scope->snapshot, scale, isodoses) : 0;
    for (size_t i = 0; i < n; i++)
        if ((isodoses[i].opacity >= 1) == is_opaque && !add_isodose(list, scope, &isodoses[i], err))
            return false;
    return true;
}

/* ---- the coverage ------------------------------------------------------------------------------------------------ */

static bool shows_coverage(const struct snapshot *snapshot)
{
    return snapshot->scene.dose.coverage.visible && snapshot->has_dose_choice && !snapshot_is_pane(snapshot);
}

/* The surface, and the region whose coverage it is. NULL without an error: the region is not shown. */
static struct coverage_shape *coverage_of(const struct snapshot *snapshot, const struct dose_scale *scale,
                                          size_t *region, struct error *why)
{
    struct dose_coverage_choice choice;
    if (!dose_coverage_choice_of(snapshot, scale, &choice, why) || !visible_is_drawn(snapshot, choice.region))
        return NULL;
    *region = choice.region;
    return coverage_shape_get(snapshot->derived, &choice, visible_surface_key(snapshot).algorithm, why);
}

static bool add_coverage(struct draw_list *list, const struct draw_scope *scope, struct error *err)
{
    const struct snapshot *snapshot = scope->snapshot;
    struct error why = { 0 };
    size_t region;
    const struct dose_scale *scale = shows_coverage(snapshot) ? draw_dose_scale(list, snapshot) : NULL;
    struct coverage_shape *made = scale ? coverage_of(snapshot, scale, &region, &why) : NULL;
    if (!made)
        return !is_fatal(&why, "the coverage", err);
    struct shape_key key = visible_surface_key(snapshot);
    struct painted painted = { { SUBJECT_DOSE, (size_t)snapshot->dose, 0 },
                               made->shape,
                               1,
                               visible_shading_passes(&key, 1),
                               snapshot->scene.dose.coverage.color_rgb,
                               1,
                               snapshot->styles[region].clipped };
    bool is_good = add_painted(list, scope, &painted, err);
    derive_result_unref(&made->base);
    return is_good;
}

bool draw_opaque_isodoses(struct draw_list *list, const struct draw_scope *scope, struct error *err)
{
    return add_isodoses(list, scope, true, err) && add_coverage(list, scope, err);
}

bool draw_translucent_isodoses(struct draw_list *list, const struct draw_scope *scope, struct error *err)
{
    return add_isodoses(list, scope, false, err);
}

/* ---- before the picture ------------------------------------------------------------------------------------------ */

bool draw_isodoses_are_wanted(const struct snapshot *snapshot)
{
    return isodoses_are_shown(snapshot) || shows_coverage(snapshot);
}

void draw_isodoses_build(const struct snapshot *snapshot, enum surface_detail detail, bool (*go_on)(void *context),
                         void *context)
{
    struct isodose isodoses[ISODOSES_MAX];
    struct dose_scale scale;
    if (!draw_isodoses_are_wanted(snapshot) || !go_on(context) || !dose_scale_of(snapshot, &scale))
        return;
    size_t n = isodoses_shown(snapshot, &scale, isodoses);
    struct error why = { 0 };
    for (size_t i = 0; i < n && go_on(context); i++) {
        struct isodose_shape *made = isodose_shape_get(snapshot->derived, &isodoses[i].choice, detail, &why);
        if (made)
            derive_result_unref(&made->base);
    }
    size_t region;
    struct coverage_shape *coverage =
        shows_coverage(snapshot) && go_on(context) ? coverage_of(snapshot, &scale, &region, &why) : NULL;
    if (coverage)
        derive_result_unref(&coverage->base);
    dose_scale_finish(&scale);
}
