/* The regions of a scene as draws: which can be seen, and their order. */
#include "core/render/visible/draw_regions.h"

#include <math.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/render/visible/draw_clip.h"
#include "core/render/visible/draw_planes.h"
#include "core/render/visible/draw_wash.h"

/* A region whose shape can be seen, and what its place in the order depends on. */
struct ranked {
    size_t region;
    struct shape_key key;
    const struct drawable *drawable;
    struct clip_set clip;
    double distance_mm; /* from the eye to the nearest point of its box */
    int order;          /* the style's */
    int depth;          /* in the hierarchy */
    uint64_t n_voxels;
};

static struct shape *region_shape(struct derive *derived, const struct shape_want *want, uint32_t *reduction,
                                  struct error *err)
{
    struct shape_facts facts = { 0 };
    struct shape *shape = derive_shape(derived, want, &facts, err);
    *reduction = facts.reduction;
    return shape;
}

static const struct drawable *drawable_of(const struct draw_scope *scope, size_t region, struct error *err)
{
    const struct shape_want want = { subject_region(region), visible_shape_key(scope->snapshot, region),
                                     scope->detail };
    return draw_cache_shape(scope->cache, scope->snapshot->derived, &want, region_shape, err);
}

/* The corner of a box that is nearest along the line of sight. */
static struct vec3 nearest_corner(const struct camera *camera, const struct box3 *box)
{
    struct vec3 f = camera->forward;
    return vec3(f.x > 0 ? box->low.x : box->high.x, f.y > 0 ? box->low.y : box->high.y,
                f.z > 0 ? box->low.z : box->high.z);
}

double draw_nearest_mm(const struct camera *camera, const struct box3 *box)
{
    struct vec3 e = camera->eye_lps_mm;
    if (camera->is_parallel)
        return vec3_dot(vec3_sub(nearest_corner(camera, box), e), camera->forward);
    struct vec3 p = vec3(fmin(fmax(e.x, box->low.x), box->high.x), fmin(fmax(e.y, box->low.y), box->high.y),
                         fmin(fmax(e.z, box->low.z), box->high.z));
    return vec3_length(vec3_sub(p, e));
}

/* True if the near plane cuts nothing of a box away. */
static bool is_wholly_ahead(const struct camera *camera, const struct box3 *box)
{
    return vec3_dot(vec3_sub(nearest_corner(camera, box), camera->eye_lps_mm), camera->forward) > camera->near_mm;
}

/* The clip planes that cut a region's box. False: they cut all of it off. */
static bool clip_of(const struct draw_scope *scope, size_t region, const struct box3 *box, struct clip_set *clip)
{
    *clip = draw_clip_set(scope->snapshot, scope->snapshot->styles[region].clipped);
    return draw_clip_box(clip, box);
}

/* True if a box can be seen from outside only, and is not cut open. */
static bool is_closed_box(const struct draw_scope *scope, size_t region, const struct box3 *box)
{
    struct clip_set clip;
    return !box3_is_empty(box) && is_wholly_ahead(scope->camera, box) && clip_of(scope, region, box, &clip) &&
           !draw_clip_cuts(&clip);
}

/* A region that an opaque one hides cannot be seen, unless the eye is within the outer one's box, or the near plane or
 * a clip plane cuts it open. False on failure. */
static bool find_hidden(const struct draw_scope *scope, size_t region, bool *is_hidden, struct error *err)
{
    const struct region *regions = scope->snapshot->plan->regions.regions;
    *is_hidden = false;
    for (int outer = regions[region].parent; outer >= 0 && !*is_hidden; outer = regions[outer].parent) {
        if (!visible_hides(scope->snapshot, (size_t)outer, region))
            continue;
        const struct drawable *drawable = drawable_of(scope, (size_t)outer, err);
        if (!drawable)
            return false;
        *is_hidden = is_closed_box(scope, (size_t)outer, &drawable->bounds_lps_mm);
    }
    return true;
}

/* Back to front. A region that encloses another is never farther away, so at equal distances the inner one comes
 * first. */
static int compare_back_to_front(const void *left, const void *right)
{
    const struct ranked *a = left, *b = right;
    if (a->order != b->order)
        return a->order < b->order ? -1 : 1;
    if (a->distance_mm != b->distance_mm)
        return a->distance_mm > b->distance_mm ? -1 : 1;
    if (a->depth != b->depth)
        return a->depth > b->depth ? -1 : 1;
    if (a->n_voxels != b->n_voxels)
        return a->n_voxels < b->n_voxels ? -1 : 1;
    return a->region < b->region ? -1 : a->region > b->region;
}

static bool rank_regions(const struct draw_scope *scope, bool is_opaque, struct ranked *ranks, size_t *n,
                         struct error *err)
{
    const struct snapshot *snapshot = scope->snapshot;
    const struct region_set *set = &snapshot->plan->regions;
    for (size_t i = 0; i < set->n_regions; i++) {
        bool is_hidden;
        if (!visible_is_drawn(snapshot, i) || (snapshot->styles[i].opacity >= 1) != is_opaque)
            continue;
        if (!find_hidden(scope, i, &is_hidden, err))
            return false;
        if (is_hidden)
            continue;
        const struct drawable *drawable = drawable_of(scope, i, err);
        if (!drawable)
            return false;
        const struct box3 *box = &drawable->bounds_lps_mm;
        struct clip_set clip;
        if (!box3_is_empty(box) && !visible_is_out_of_sight(&scope->camera->clip_from_lps_mm, box) &&
            clip_of(scope, i, box, &clip))
            ranks[(*n)++] = (struct ranked){ i,
                                             visible_shape_key(snapshot, i),
                                             drawable,
                                             clip,
                                             draw_nearest_mm(scope->camera, box),
                                             (int)snapshot->styles[i].order,
                                             region_depth(set, i),
                                             set->regions[i].n_voxels };
    }
    qsort(ranks, *n, sizeof *ranks, compare_back_to_front);
    return true;
}

/* The texture of a region's triangles. */
static struct draw_texture texture_of(struct draw_list *list, const struct snapshot *snapshot,
                                      const struct ranked *rank)
{
    enum region_representation kind = rank->key.representation;
    struct draw_texture texture = { .kind = snapshot->styles[rank->region].texture };
    bool has_triangles = kind == REPRESENTATION_SURFACE || kind == REPRESENTATION_UNIVELS ||
                         kind == REPRESENTATION_NURBS || kind == REPRESENTATION_FAN;
    if (texture.kind == SCENE_TEXTURE_IMAGE && snapshot->image >= 0) {
        texture.image_index = (size_t)snapshot->image;
        texture.image = draw_image_shown(list, snapshot, false);
    } else if (texture.kind == SCENE_TEXTURE_DOSE)
        texture.wash = draw_wash_of_region(list, snapshot, rank->region);
    if (!has_triangles || (texture.kind == SCENE_TEXTURE_IMAGE && snapshot->image < 0) ||
        (texture.kind == SCENE_TEXTURE_DOSE && !texture.wash))
        texture.kind = SCENE_TEXTURE_NONE;
    return texture;
}

static struct draw draw_of(struct draw_list *list, const struct draw_scope *scope, const struct ranked *rank,
                           bool is_opaque)
{
    const struct scene_region_style *style = &scope->snapshot->styles[rank->region];
    struct visible_look look = visible_look(scope->snapshot, rank->region, &rank->key);
    look.is_two_sided |= draw_clip_opens(&rank->clip);
    return (struct draw){
        .pass = is_opaque ? DRAW_OPAQUE : DRAW_TRANSLUCENT,
        .kind = DRAW_SHAPE,
        .depth = is_opaque ? DRAW_DEPTH_TESTED : DRAW_DEPTH_LAYER,
        .subject = subject_region(rank->region),
        .clip = rank->clip,
        .color_rgb = style->color_rgb,
        .opacity = style->opacity,
        .shape = { .drawable = rank->drawable,
                   .look = look,
                   .cue = visible_depth_cue(scope->camera, &rank->drawable->bounds_lps_mm),
                   .texture = texture_of(list, scope->snapshot, rank) },
    };
}

bool draw_regions(struct draw_list *list, const struct draw_scope *scope, bool is_opaque, struct error *err)
{
    size_t n = 0;
    struct ranked *ranks = mem_array(scope->snapshot->plan->regions.n_regions, sizeof *ranks, UINT64_MAX, err);
    bool is_good = ranks && rank_regions(scope, is_opaque, ranks, &n, err);
    for (size_t i = 0; is_good && i < n; i++) {
        struct draw draw = draw_of(list, scope, &ranks[is_opaque ? n - 1 - i : i], is_opaque);
        is_good = draw_list_add(list, &draw, err);
    }
    free(ranks);
    return is_good;
}
