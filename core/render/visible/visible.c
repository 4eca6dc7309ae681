/* Chooses for each region of a scene if it is shown, as which shape and with which look. */
#include "core/render/visible/visible.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/render/visible/shading.h"

const uint8_t visible_background[3] = { 0x08, 0x09, 0x0b };

void visible_ground(const struct snapshot *snapshot, uint8_t rgb[3])
{
    const uint32_t color = snapshot->scene.space.background_rgb;
    for (int c = 0; c < 3; c++)
        rgb[c] = snapshot->view.kind == SCENE_KIND_3D ? (uint8_t)(color >> (16 - 8 * c) & 255) : visible_background[c];
}

bool visible_ground_is_light(const struct snapshot *snapshot)
{
    static const double parts[3] = { 0.2126, 0.7152, 0.0722 }, even = 0.179; /* contrast with white and black alike */
    uint8_t rgb[3];
    double luminance = 0;
    visible_ground(snapshot, rgb);
    for (int c = 0; c < 3; c++) {
        const double part = rgb[c] / 255.0;
        luminance += parts[c] * (part <= 0.04045 ? part / 12.92 : pow((part + 0.055) / 1.055, 2.4));
    }
    return luminance > even;
}

/* ---- shapes ----------------------------------------------------------------------------------------------------- */

struct shape_key visible_surface_key(const struct snapshot *snapshot)
{
    static const enum surface_algorithm algorithms[] = {
        [SCENE_ALGORITHM_MARCHING_CUBES] = SURFACE_MARCHING_CUBES,
        [SCENE_ALGORITHM_EIGHT_CELL] = SURFACE_EIGHT_CELL,
        [SCENE_ALGORITHM_SMOOTH] = SURFACE_SMOOTH,
    };
    struct shape_key key = { .representation = REPRESENTATION_SURFACE,
                             .algorithm = algorithms[snapshot->scene.surface.algorithm] };
    shape_key_normalise(&key);
    return key;
}

enum outline_method visible_outline_method(const struct snapshot *snapshot)
{
    return snapshot->scene.outline.method == SCENE_OUTLINE_METHOD_MARCHING_SQUARES ? OUTLINE_MARCHING_SQUARES
                                                                                   : OUTLINE_TRACED;
}

struct shape_key visible_shape_key(const struct snapshot *snapshot, size_t region)
{
    static const enum region_representation representations[] = {
        [SCENE_REPRESENTATION_SURFACE] = REPRESENTATION_SURFACE,
        [SCENE_REPRESENTATION_OUTLINE] = REPRESENTATION_OUTLINE,
        [SCENE_REPRESENTATION_POINTS] = REPRESENTATION_POINTS,
        [SCENE_REPRESENTATION_UNIVELS] = REPRESENTATION_UNIVELS,
        [SCENE_REPRESENTATION_SOLID] = REPRESENTATION_SOLID,
        [SCENE_REPRESENTATION_NURBS] = REPRESENTATION_NURBS,
        [SCENE_REPRESENTATION_FAN] = REPRESENTATION_FAN,
    };
    const struct scene *scene = &snapshot->scene;
    struct shape_key key = {
        .representation = representations[snapshot->styles[region].representation],
        .algorithm = visible_surface_key(snapshot).algorithm,
        .outline = visible_outline_method(snapshot),
        .has_inner_boundary = scene->points.inner_boundary,
        .nurbs_order = (int)scene->nurbs.order,
        .nurbs_sampling = scene->nurbs.sampling == SCENE_NURBS_SAMPLING_TRACES ? NURBS_TRACES : NURBS_DEGREE_BINS,
        .nurbs_bins = (int)scene->nurbs.bins,
    };
    shape_key_normalise(&key);
    return key;
}

struct visible_look visible_look(const struct snapshot *snapshot, size_t region, const struct shape_key *key)
{
    const struct scene *scene = &snapshot->scene;
    enum region_representation kind = key->representation;
    bool is_line = kind == REPRESENTATION_OUTLINE,
         is_point = kind == REPRESENTATION_POINTS || kind == REPRESENTATION_SOLID;
    return (struct visible_look){
        .is_flat = scene->surface.normals == SCENE_NORMALS_FACE,
        .rounding =
            kind == REPRESENTATION_UNIVELS && scene->surface.normals == SCENE_NORMALS_VERTEX ? VISIBLE_ROUNDING : 0,
        .is_two_sided = kind == REPRESENTATION_FAN || kind == REPRESENTATION_NURBS,
        .is_rim = !is_line && !is_point && snapshot->styles[region].opacity < 1 &&
                  scene->surface.translucency == SCENE_TRANSLUCENCY_RIM,
        .is_baked = kind == REPRESENTATION_SOLID && scene->points.solid == SCENE_SOLID_LIGHTING_BAKED,
        .is_covering = kind == REPRESENTATION_SOLID,
        .size_px = is_line ? scene->outline.width_px : scene->points.size_px,
    };
}

/* Only surfaces with terraces of voxels need smoothed normals. */
int visible_shading_passes(const struct shape_key *key, uint32_t reduction)
{
    bool has_terraces = key->representation == REPRESENTATION_UNIVELS ||
                        (key->representation == REPRESENTATION_SURFACE && key->algorithm != SURFACE_SMOOTH);
    return has_terraces ? shading_passes(reduction) : 0;
}

struct visible_cue visible_depth_cue(const struct camera *camera, const struct box3 *box)
{
    struct vec3 f = camera->forward, size = vec3_sub(box->high, box->low);
    double length = fabs(f.x) * size.x + fabs(f.y) * size.y + fabs(f.z) * size.z; /* along the line of sight */
    double slope = -(1 - VISIBLE_DARKEST) / fmax(length, 1e-6);
    struct vec3 nearest = vec3(f.x > 0 ? box->low.x : box->high.x, f.y > 0 ? box->low.y : box->high.y,
                               f.z > 0 ? box->low.z : box->high.z);
    return (struct visible_cue){ slope * f.x, slope * f.y, slope * f.z, 1 - slope * vec3_dot(f, nearest) };
}

bool visible_is_out_of_sight(const struct mat4 *clip_from_lps_mm, const struct box3 *box)
{
    const double *m = clip_from_lps_mm->m;
    int n_beyond[6] = { 0 };
    for (int corner = 0; corner < 8; corner++) {
        double x = corner & 1 ? box->high.x : box->low.x, y = corner & 2 ? box->high.y : box->low.y,
               z = corner & 4 ? box->high.z : box->low.z;
        double clip[4];
        for (int row = 0; row < 4; row++)
            clip[row] = m[row] * x + m[4 + row] * y + m[8 + row] * z + m[12 + row];
        for (int axis = 0; axis < 3; axis++) {
            n_beyond[2 * axis] += clip[axis] < -clip[3];
            n_beyond[2 * axis + 1] += clip[axis] > clip[3];
        }
    }
    for (int side = 0; side < 6; side++)
        if (n_beyond[side] == 8)
            return true;
    return false;
}

bool visible_is_shown(const struct snapshot *snapshot, size_t region)
{
    return snapshot->styles[region].visible && snapshot->styles[region].opacity > 0;
}

bool visible_is_drawn(const struct snapshot *snapshot, size_t region)
{
    return visible_is_shown(snapshot, region) && snapshot->plan->regions.regions[region].n_voxels > 0;
}

struct visible_rank visible_rank(const struct snapshot *snapshot, size_t region)
{
    const struct region_set *set = &snapshot->plan->regions;
    return (struct visible_rank){ region, (int)snapshot->styles[region].order, region_depth(set, region),
                                  set->regions[region].n_voxels };
}

int visible_rank_compare(const void *left, const void *right)
{
    const struct visible_rank *a = left, *b = right;
    if (a->order != b->order)
        return a->order < b->order ? -1 : 1;
    if (a->depth != b->depth)
        return a->depth < b->depth ? -1 : 1;
    if (a->n_voxels != b->n_voxels)
        return a->n_voxels > b->n_voxels ? -1 : 1;
    return a->region < b->region ? -1 : a->region > b->region;
}

size_t visible_n_translucent(const struct snapshot *snapshot)
{
    size_t n = 0;
    for (size_t i = 0; i < snapshot->plan->regions.n_regions; i++)
        n += visible_is_drawn(snapshot, i) && snapshot->styles[i].opacity < 1;
    return n;
}

/* True if the outer region's shape is a closed surface that encloses the inner region's shape whenever its voxels
 * enclose those of the inner region. */
static bool can_enclose(const struct snapshot *snapshot, size_t outer, size_t inner)
{
    enum scene_representation a = snapshot->styles[outer].representation, b = snapshot->styles[inner].representation;
    return (a == SCENE_REPRESENTATION_SURFACE || a == SCENE_REPRESENTATION_UNIVELS) &&
           (a == b || (a == SCENE_REPRESENTATION_UNIVELS && b == SCENE_REPRESENTATION_SURFACE));
}

bool visible_hides(const struct snapshot *snapshot, size_t outer, size_t region)
{
    const struct region *regions = snapshot->plan->regions.regions;
    return visible_is_drawn(snapshot, outer) && snapshot->styles[outer].opacity >= 1 &&
           regions[outer].layer == regions[region].layer && can_enclose(snapshot, outer, region);
}

/* False if some region hides it, as far as that can be told without shapes and camera. */
static bool may_be_seen(const struct snapshot *snapshot, size_t region)
{
    const struct region *regions = snapshot->plan->regions.regions;
    for (int outer = regions[region].parent; outer >= 0; outer = regions[outer].parent) {
        bool may_be_cut = snapshot->n_clips > 0 && snapshot->styles[outer].clipped;
        if (!may_be_cut && visible_hides(snapshot, (size_t)outer, region))
            return false;
    }
    return true;
}

struct shape_key visible_checked_key(const struct snapshot *snapshot, size_t region)
{
    struct shape_key key = visible_shape_key(snapshot, region);
    bool has_triangles = key.representation != REPRESENTATION_OUTLINE && key.representation != REPRESENTATION_POINTS &&
                         key.representation != REPRESENTATION_SOLID;
    return has_triangles ? key : visible_surface_key(snapshot);
}

bool visible_is_checked(const struct snapshot *snapshot, size_t region)
{
    const struct scene_check_style *check = &snapshot->scene.check;
    return check->visible && visible_is_drawn(snapshot, region) &&
           (check->region[0] == 0 || strcmp(check->region, snapshot->plan->regions.regions[region].id) == 0);
}

struct shape_key visible_outlined_key(const struct snapshot *snapshot, size_t region)
{
    struct shape_key key = visible_checked_key(snapshot, region);
    return key.representation == REPRESENTATION_FAN ? visible_surface_key(snapshot) : key;
}

bool visible_has_outlined_surface(const struct snapshot *snapshot, size_t region)
{
    const struct scene_outline_style *style = &snapshot->scene.outline;
    return style->on_slices && style->method == SCENE_OUTLINE_METHOD_SURFACE && visible_is_drawn(snapshot, region);
}

/* The shape that a picture needs of a region; false: none. */
static bool find_want(const struct snapshot *snapshot, size_t region, enum surface_detail detail,
                      struct shape_want *want)
{
    *want = (struct shape_want){ .subject = subject_region(region), .detail = SURFACE_FULL };
    if (!snapshot_is_pane(snapshot)) {
        want->key = visible_shape_key(snapshot, region);
        if (want->key.representation == REPRESENTATION_SURFACE)
            want->detail = detail;
        return visible_is_drawn(snapshot, region);
    }
    bool is_checked = visible_is_checked(snapshot, region);
    want->key = is_checked ? visible_checked_key(snapshot, region) : visible_outlined_key(snapshot, region);
    return is_checked || visible_has_outlined_surface(snapshot, region);
}

bool visible_body(const struct snapshot *snapshot, size_t region, enum surface_detail detail, struct shape_want *want)
{
    *want = (struct shape_want){ subject_region(region), visible_shape_key(snapshot, region), detail };
    switch (want->key.representation) {
    case REPRESENTATION_SURFACE: return true;
    case REPRESENTATION_UNIVELS:
    case REPRESENTATION_NURBS: want->detail = SURFACE_FULL; return true;
    case REPRESENTATION_SOLID: want->key = visible_surface_key(snapshot); return true;
    case REPRESENTATION_OUTLINE:
    case REPRESENTATION_POINTS:
    case REPRESENTATION_FAN:
    case REPRESENTATION_N: break;
    }
    return false;
}

/* True if caps close cuts through the region. */
static bool may_be_capped(const struct snapshot *snapshot, size_t region)
{
    bool is_capped = false;
    for (size_t i = 0; i < snapshot->n_clips; i++)
        is_capped |= snapshot->clips[i].is_capped;
    return is_capped && snapshot->styles[region].clipped && visible_is_drawn(snapshot, region);
}

size_t visible_wants(const struct snapshot *snapshot, enum surface_detail detail, bool is_still,
                     struct shape_want *wants)
{
    bool is_in_space = !snapshot_is_pane(snapshot);
    size_t n = 0;
    for (size_t i = 0; i < snapshot->plan->regions.n_regions; i++) {
        bool may_wait = is_in_space ? may_be_seen(snapshot, i) : is_still || visible_is_checked(snapshot, i);
        bool is_wanted = may_wait && find_want(snapshot, i, detail, &wants[n]);
        n += is_wanted;
        /* a cap needs the body also of a region that is hidden itself, or drawn as another shape */
        if (may_be_capped(snapshot, i) && visible_body(snapshot, i, detail, &wants[n]))
            n += !(is_wanted && shape_key_equal(&wants[n - 1].key, &wants[n].key));
    }
    return n;
}

size_t visible_missing(const struct snapshot *snapshot, enum surface_detail detail,
                       struct visible_missing missing[VISIBLE_MAX_MISSING])
{
    size_t n = 0;
    for (size_t i = 0; i < snapshot->plan->regions.n_regions; i++) {
        struct shape_want want;
        struct error why = { 0 };
        bool has_other = snapshot_is_pane(snapshot) && !visible_is_checked(snapshot, i); /* outlines of univels */
        if (has_other || !find_want(snapshot, i, detail, &want) ||
            !derive_shape_is_refused(snapshot->derived, &want, &why))
            continue;
        if (n < VISIBLE_MAX_MISSING)
            missing[n] = (struct visible_missing){ want.subject, why };
        n++;
    }
    return n;
}

int visible_samples(const struct snapshot *snapshot, const struct camera *camera, int width_px, bool is_still)
{
    enum { STILL_SAMPLES = 2 };
    if (!is_still)
        return 1;
    if (!snapshot_is_pane(snapshot) || snapshot->image < 0)
        return STILL_SAMPLES;
    struct vec3 spacing_mm = grid_spacing_mm(&snapshot->plan->images[snapshot->image].volume->grid);
    double pixels_per_mm = camera->pixels_per_mm * width_px / snapshot->view.size_px[0];
    return fmin(fmin(spacing_mm.x, spacing_mm.y), spacing_mm.z) * pixels_per_mm < 1 ? STILL_SAMPLES : 1;
}
