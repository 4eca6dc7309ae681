/* Finds what lies under a pixel: along a ray through the label layers and the slices, or at a point of a slice pane. */
#include "core/pick/pick.h"

#include <stdlib.h>
#include <string.h>

#include "core/pick/pick_beams.h"
#include "core/pick/pick_isodoses.h"
#include "core/pick/pick_volume.h"
#include "core/scene/camera.h"

/* p(t) = origin + t direction, direction of unit length, t in millimetres >= 0 */
struct ray {
    struct vec3 origin_lps_mm, direction;
};

static struct ray pixel_ray(const struct camera *camera, const struct view *view, double px, double py)
{
    double x = 2 * px / view->size_px[0] - 1, y = 1 - 2 * py / view->size_px[1];
    struct vec3 near = mat4_project(&camera->lps_mm_from_clip, vec3(x, y, -1));
    struct vec3 far = mat4_project(&camera->lps_mm_from_clip, vec3(x, y, 1));
    return (struct ray){ near, vec3_normalize(vec3_sub(far, near)) };
}

static struct vec3 ray_point(const struct ray *ray, double t)
{
    return vec3_add(ray->origin_lps_mm, vec3_scale(ray->direction, t));
}

static bool is_shown(const struct snapshot *snapshot, size_t region)
{
    return snapshot->styles[region].visible && snapshot->styles[region].opacity > 0;
}

/* The part of its opacity that a surface has as alpha where it faces the viewer; proto/scene.json, translucency. */
#define RIM_PLAIN_PART 0.3
/* The part of a pixel that lines and points cover, roughly. */
#define SPARSE_COVER 0.1

static double surface_alpha(const struct snapshot *snapshot, double opacity)
{
    bool is_rim = opacity < 1 && snapshot->scene.surface.translucency == SCENE_TRANSLUCENCY_RIM;
    return is_rim ? opacity * RIM_PLAIN_PART : opacity;
}

static double region_alpha(const struct snapshot *snapshot, size_t region)
{
    const struct scene_region_style *style = &snapshot->styles[region];
    if (style->representation == SCENE_REPRESENTATION_OUTLINE || style->representation == SCENE_REPRESENTATION_POINTS)
        return style->opacity * SPARSE_COVER;
    return style->representation == SCENE_REPRESENTATION_SOLID ? style->opacity
                                                               : surface_alpha(snapshot, style->opacity);
}

/* Inserts by distance, after hits of equal distance. Drops the farthest beyond PICK_MAX_HITS. Returns the new count. */
static size_t add_hit(struct pick_hit hits[PICK_MAX_HITS], size_t n, struct pick_hit hit)
{
    size_t at = n;
    while (at > 0 && hits[at - 1].distance_mm > hit.distance_mm)
        at--;
    if (at >= PICK_MAX_HITS)
        return n;
    size_t n_after = n < PICK_MAX_HITS ? n - at : PICK_MAX_HITS - 1 - at;
    memmove(&hits[at + 1], &hits[at], n_after * sizeof hits[0]);
    hits[at] = hit;
    return n < PICK_MAX_HITS ? n + 1 : n;
}

/* Where a part of a ray enters and leaves the regions; distances along the ray, infinity: never. */
struct crossings {
    bool starts_inside[REGION_MAX], ends_inside[REGION_MAX];
    double entered_mm[REGION_MAX]; /* the first time */
    double left_mm[REGION_MAX];    /* a region that the part starts inside, the first time */
};

/* A part of a ray through one label layer. */
struct layer_walk {
    const struct snapshot *snapshot;
    const struct volume *layer;
    size_t layer_index;
    double from_mm, to_mm;
    struct crossings *crossings;
};

static int region_of_label(const struct layer_walk *walk, uint16_t label)
{
    const struct region_set *set = &walk->snapshot->plan->regions;
    for (size_t i = 0; label && i < set->n_regions; i++)
        if (set->regions[i].layer == walk->layer_index && set->regions[i].label == label)
            return (int)i;
    return -1;
}

/* True if the part starts inside the region and has not left it yet. */
static bool is_still_inside(const struct crossings *crossings, int region)
{
    return crossings->starts_inside[region] && !isfinite(crossings->left_mm[region]);
}

/* A region's surface also encloses its descendants, so a voxel counts for its region and all ancestors on the layer. */
static void enter_voxel(const struct layer_walk *walk, uint16_t label, double t)
{
    const struct region *regions = walk->snapshot->plan->regions.regions;
    for (int r = region_of_label(walk, label); r >= 0; r = regions[r].parent)
        if (regions[r].layer == walk->layer_index && !is_still_inside(walk->crossings, r) &&
            t < walk->crossings->entered_mm[r])
            walk->crossings->entered_mm[r] = t;
}

/* A region that the ray started inside can be entered once the ray has left it: after a voxel that is not its own. */
static void leave_voxel(const struct layer_walk *walk, uint16_t label, double t)
{
    const struct region_set *set = &walk->snapshot->plan->regions;
    int self = region_of_label(walk, label);
    for (size_t i = 0; i < set->n_regions; i++) {
        if (set->regions[i].layer != walk->layer_index || !is_still_inside(walk->crossings, (int)i))
            continue;
        int r = self;
        while (r >= 0 && r != (int)i)
            r = set->regions[r].parent;
        if (r < 0)
            walk->crossings->left_mm[i] = t;
    }
}

/* Sets the flag of the label's region and all its ancestors on the layer. */
static void mark_inside(const struct layer_walk *walk, uint16_t label, bool is_inside[REGION_MAX])
{
    const struct region *regions = walk->snapshot->plan->regions.regions;
    for (int r = region_of_label(walk, label); r >= 0; r = regions[r].parent)
        if (regions[r].layer == walk->layer_index)
            is_inside[r] = true;
}

/* The part of the ray inside the grid's outer faces, t0 to t1 in mm; false if there is none. */
static bool clip_to_grid(const struct vec3 *origin_ijk, const struct vec3 *step_ijk, const uint32_t size[3], double *t0,
                         double *t1)
{
    const double o[3] = { origin_ijk->x, origin_ijk->y, origin_ijk->z },
                 d[3] = { step_ijk->x, step_ijk->y, step_ijk->z };
    *t0 = 0;
    *t1 = INFINITY;
    for (int a = 0; a < 3; a++) {
        double low = -0.5, high = size[a] - 0.5;
        if (fabs(d[a]) < 1e-12) {
            if (o[a] < low || o[a] > high)
                return false;
            continue;
        }
        double ta = (low - o[a]) / d[a], tb = (high - o[a]) / d[a];
        *t0 = fmax(*t0, fmin(ta, tb));
        *t1 = fmin(*t1, fmax(ta, tb));
    }
    return *t0 < *t1 && isfinite(*t1);
}

/* A plane along the faces of voxels lies in those that the ray goes on into. */
#define NUDGE_MM 1e-7

/* Source: J. Amanatides, A. Woo, A Fast Voxel Traversal Algorithm for Ray Tracing, Eurographics 1987. Works in index
 * space, so it is exact for any orientation and spacing of the grid. */
static void walk_layer(const struct layer_walk *walk, const struct ray *ray)
{
    const struct grid *grid = &walk->layer->grid;
    struct vec3 origin = affine_point(&grid->ijk_from_lps_mm, ray->origin_lps_mm);
    struct vec3 step = affine_vector(&grid->ijk_from_lps_mm, ray->direction);
    double t0, t1;
    if (!clip_to_grid(&origin, &step, grid->size, &t0, &t1) || walk->to_mm <= t0 || walk->from_mm >= t1)
        return;
    bool starts_inside = t0 <= walk->from_mm, ends_inside = walk->to_mm < t1;
    if (starts_inside)
        t0 = walk->from_mm > 0 ? fmin(walk->from_mm + NUDGE_MM, t1) : 0;
    if (ends_inside)
        t1 = walk->to_mm - NUDGE_MM;

    const double o[3] = { origin.x, origin.y, origin.z }, d[3] = { step.x, step.y, step.z };
    int64_t at[3], way[3];
    double next[3];
    for (int a = 0; a < 3; a++) {
        double start = o[a] + t0 * d[a];
        at[a] = (int64_t)floor(start + 0.5);
        at[a] = at[a] < 0 ? 0 : at[a] >= grid->size[a] ? grid->size[a] - 1 : at[a];
        way[a] = d[a] > 0 ? 1 : -1;
        next[a] = fabs(d[a]) < 1e-12 ? INFINITY : ((double)at[a] + 0.5 * (double)way[a] - o[a]) / d[a];
    }
    uint16_t label = volume_label(walk->layer, (uint32_t)at[0], (uint32_t)at[1], (uint32_t)at[2]);
    if (starts_inside)
        mark_inside(walk, label, walk->crossings->starts_inside);
    else
        enter_voxel(walk, label, t0);
    for (;;) {
        int a = next[0] < next[1] ? (next[0] < next[2] ? 0 : 2) : (next[1] < next[2] ? 1 : 2);
        double t = next[a];
        if (t >= t1)
            break;
        at[a] += way[a];
        if (at[a] < 0 || at[a] >= grid->size[a]) {
            ends_inside = false;
            break;
        }
        next[a] = ((double)at[a] + 0.5 * (double)way[a] - o[a]) / d[a];
        uint16_t here = volume_label(walk->layer, (uint32_t)at[0], (uint32_t)at[1], (uint32_t)at[2]);
        if (here == label)
            continue;
        label = here;
        leave_voxel(walk, label, t);
        enter_voxel(walk, label, t);
    }
    if (ends_inside)
        mark_inside(walk, label, walk->crossings->ends_inside);
    else
        leave_voxel(walk, 0, t1);
}

/* True if the region is shown and clip planes cut it, as is_cut says. */
static bool is_walked(const struct snapshot *snapshot, size_t region, bool is_cut)
{
    return is_shown(snapshot, region) && (snapshot->n_clips > 0 && snapshot->styles[region].clipped) == is_cut;
}

static bool layer_is_walked(const struct snapshot *snapshot, size_t layer, bool is_cut)
{
    const struct region_set *set = &snapshot->plan->regions;
    for (size_t i = 0; i < set->n_regions; i++)
        if (set->regions[i].layer == layer && is_walked(snapshot, i, is_cut))
            return true;
    return false;
}

static void cross_regions(const struct snapshot *snapshot, const struct ray *ray, const struct clip_range *range,
                          bool is_cut, struct crossings *crossings)
{
    const struct region_set *set = &snapshot->plan->regions;
    for (size_t i = 0; i < set->n_regions; i++) {
        crossings->starts_inside[i] = crossings->ends_inside[i] = false;
        crossings->entered_mm[i] = crossings->left_mm[i] = INFINITY;
    }
    for (size_t layer = 0; layer < set->n_layers; layer++)
        if (range->from_mm < range->to_mm && layer_is_walked(snapshot, layer, is_cut))
            walk_layer(&(struct layer_walk){ snapshot, set->layers[layer], layer, range->from_mm, range->to_mm,
                                             crossings },
                       ray);
}

/* True if caps close the region where a plane cuts it. */
static bool has_caps(const struct snapshot *snapshot, size_t region)
{
    switch (snapshot->styles[region].representation) {
    case SCENE_REPRESENTATION_SURFACE:
    case SCENE_REPRESENTATION_UNIVELS:
    case SCENE_REPRESENTATION_SOLID:
    case SCENE_REPRESENTATION_NURBS: return true;
    case SCENE_REPRESENTATION_OUTLINE:
    case SCENE_REPRESENTATION_POINTS:
    case SCENE_REPRESENTATION_FAN: break;
    }
    return false;
}

static bool is_capped(const struct snapshot *snapshot, int clip, size_t region)
{
    return clip >= 0 && snapshot->clips[clip].is_capped && has_caps(snapshot, region);
}

/* The hits of one region: the cap that the ray comes to first, or else the region's wall; the cap that it leaves by. */
static size_t add_region(const struct snapshot *snapshot, const struct ray *ray, const struct clip_range *range,
                         const struct crossings *crossings, size_t region, bool is_caps,
                         struct pick_hit hits[PICK_MAX_HITS], size_t n)
{
    bool is_opened = range->from >= 0 && crossings->starts_inside[region],
         is_first_cap = is_opened && is_capped(snapshot, range->from, region),
         is_last_cap = crossings->ends_inside[region] && is_capped(snapshot, range->to, region);
    double cap_mm = is_first_cap  ? range->from_mm
                    : is_last_cap ? range->to_mm
                                  : INFINITY,
           wall_mm = is_first_cap ? INFINITY
                     : is_opened  ? crossings->left_mm[region]
                                  : crossings->entered_mm[region],
           t = is_caps ? cap_mm : wall_mm;
    if (!isfinite(t))
        return n;
    return add_hit(hits, n,
                   (struct pick_hit){ ray_point(ray, t), subject_region(region), t,
                                      is_caps ? 1 : region_alpha(snapshot, region), is_caps });
}

/* Adds the hits of the regions that clip planes cut, or of those that they do not cut. add_hit keeps the order of equal
 * distances: outer regions first, on caps inner ones. */
static size_t pick_regions(const struct snapshot *snapshot, const struct ray *ray, bool is_cut,
                           struct pick_hit hits[PICK_MAX_HITS], size_t n)
{
    const struct region_set *set = &snapshot->plan->regions;
    struct clip_range range =
        clip_ray(snapshot->clips, is_cut ? snapshot->n_clips : 0, ray->origin_lps_mm, ray->direction);
    struct crossings crossings;
    cross_regions(snapshot, ray, &range, is_cut, &crossings);
    int deepest = 0;
    for (size_t i = 0; i < set->n_regions; i++)
        deepest = region_depth(set, i) > deepest ? region_depth(set, i) : deepest;
    for (int is_caps = 0; is_caps <= is_cut; is_caps++)
        for (int step = 0; step <= deepest; step++)
            for (size_t i = 0; i < set->n_regions; i++)
                if (is_walked(snapshot, i, is_cut) && region_depth(set, i) == (is_caps ? deepest - step : step))
                    n = add_region(snapshot, ray, &range, &crossings, i, is_caps, hits, n);
    return n;
}

/* True if a slice in space is drawn at the point: its value, interpolated as in the picture, reaches cull_below. */
static bool slice_is_drawn_at(const struct snapshot *snapshot, const struct volume *volume, struct vec3 point_lps_mm)
{
    const struct scene_image_style *style = &snapshot->scene.image;
    uint32_t ijk[3];
    double value;
    if (style->interpolation == SCENE_INTERPOLATION_NEAREST) {
        if (!volume_voxel_at(volume, point_lps_mm, ijk))
            return false;
        value = volume_value(volume, ijk[0], ijk[1], ijk[2]);
    } else if (!volume_sample(volume, point_lps_mm, &value))
        return false;
    return value >= style->cull_below;
}

/* The image shown, which the snapshot has. */
static struct subject image_subject(const struct snapshot *snapshot)
{
    return (struct subject){ SUBJECT_IMAGE, (size_t)snapshot->image, 0 };
}

/* Adds the hits of image slices in space. */
static size_t pick_slices(const struct snapshot *snapshot, const struct ray *ray, struct pick_hit hits[PICK_MAX_HITS],
                          size_t n)
{
    if (snapshot->image < 0)
        return n;
    const struct volume *volume = snapshot->plan->images[snapshot->image].volume;
    for (size_t i = 0; i < snapshot->n_slices; i++) {
        const struct plane *plane = &snapshot->slices[i];
        double across = vec3_dot(ray->direction, plane->normal);
        if (fabs(across) < 1e-12)
            continue;
        double t = (plane_position_mm(plane) - vec3_dot(ray->origin_lps_mm, plane->normal)) / across;
        struct vec3 point = ray_point(ray, t);
        bool is_cut = snapshot->scene.image.clipped && clip_cuts(snapshot->clips, snapshot->n_clips, point);
        if (t >= 0 && !is_cut && slice_is_drawn_at(snapshot, volume, point))
            n = add_hit(hits, n, (struct pick_hit){ point, image_subject(snapshot), t, 1, false });
    }
    return n;
}

/* Sets holds for the regions whose label the point carries, and for all their ancestors. */
static void mark_regions_at(const struct snapshot *snapshot, struct vec3 point, bool holds[REGION_MAX])
{
    const struct region_set *set = &snapshot->plan->regions;
    for (size_t i = 0; i < set->n_regions; i++) {
        const struct volume *layer = set->layers[set->regions[i].layer];
        uint32_t ijk[3];
        if (!volume_voxel_at(layer, point, ijk) || volume_label(layer, ijk[0], ijk[1], ijk[2]) != set->regions[i].label)
            continue;
        for (int r = (int)i; r >= 0 && !holds[r]; r = set->regions[r].parent)
            holds[r] = true;
    }
}

static size_t pick_pane(const struct snapshot *snapshot, const struct camera *camera, double px, double py,
                        struct pick_hit hits[PICK_MAX_HITS])
{
    const struct region_set *set = &snapshot->plan->regions;
    const struct view *view = &snapshot->view;
    double right = (px - view->size_px[0] / 2.0) / camera->pixels_per_mm,
           up = (view->size_px[1] / 2.0 - py) / camera->pixels_per_mm;
    struct vec3 point =
        vec3_add(camera->target_lps_mm, vec3_add(vec3_scale(camera->right, right), vec3_scale(camera->up, up)));
    bool holds[REGION_MAX] = { false };
    mark_regions_at(snapshot, point, holds);

    int deepest = 0;
    for (size_t i = 0; i < set->n_regions; i++)
        if (holds[i] && region_depth(set, i) > deepest)
            deepest = region_depth(set, i);
    size_t n = 0;
    struct pick_beam_hit beams[BEAMS_DRAWN_MAX];
    size_t n_beams = pick_beams(snapshot, camera, px, py, beams);
    for (size_t i = 0; i < n_beams && n < PICK_MAX_HITS; i++)
        hits[n++] = (struct pick_hit){ point, beams[i].subject, 0, 1, false };
    for (int depth = deepest; depth >= 0; depth--)
        for (size_t i = 0; i < set->n_regions && n < PICK_MAX_HITS; i++)
            if (holds[i] && is_shown(snapshot, i) && region_depth(set, i) == depth)
                hits[n++] = (struct pick_hit){ point, subject_region(i), 0, 1, false };
    uint32_t ijk[3];
    if (n < PICK_MAX_HITS && snapshot->image >= 0 &&
        volume_voxel_at(snapshot->plan->images[snapshot->image].volume, point, ijk))
        hits[n++] = (struct pick_hit){ point, image_subject(snapshot), 0, 1, false };
    return n;
}

size_t snapshot_pick(const struct snapshot *snapshot, double px, double py, struct pick_hit hits[PICK_MAX_HITS])
{
    struct camera camera;
    camera_resolve(snapshot, &camera);
    if (snapshot_is_pane(snapshot))
        return pick_pane(snapshot, &camera, px, py, hits);
    struct ray ray = pixel_ray(&camera, &snapshot->view, px, py);
    size_t n = pick_regions(snapshot, &ray, false, hits, 0);
    if (snapshot->n_clips > 0)
        n = pick_regions(snapshot, &ray, true, hits, n);
    n = pick_slices(snapshot, &ray, hits, n);
    struct pick_isodose_hit isodoses[ISODOSES_MAX];
    size_t n_isodoses = pick_isodoses(snapshot, ray.origin_lps_mm, ray.direction, isodoses);
    for (size_t i = 0; i < n_isodoses; i++)
        n = add_hit(hits, n,
                    (struct pick_hit){ ray_point(&ray, isodoses[i].t_mm), isodoses[i].subject, isodoses[i].t_mm,
                                       surface_alpha(snapshot, isodoses[i].opacity), false });
    struct pick_beam_hit beams[BEAMS_DRAWN_MAX];
    size_t n_beams = pick_beams(snapshot, &camera, px, py, beams);
    for (size_t i = 0; i < n_beams; i++)
        n = add_hit(hits, n,
                    (struct pick_hit){ beams[i].point_lps_mm, beams[i].subject,
                                       vec3_dot(vec3_sub(beams[i].point_lps_mm, ray.origin_lps_mm), ray.direction), 1,
                                       false });
    struct pick_volume_hit volume;
    if (pick_volume(snapshot, ray.origin_lps_mm, ray.direction, &volume))
        n = add_hit(hits, n,
                    (struct pick_hit){ ray_point(&ray, volume.t_mm), image_subject(snapshot), volume.t_mm, volume.alpha,
                                       volume.is_on_cap });
    /* the ray starts on the near plane; distances count from the eye */
    for (size_t i = 0; i < n; i++)
        hits[i].distance_mm = vec3_length(vec3_sub(hits[i].point_lps_mm, camera.eye_lps_mm));
    return n;
}

size_t pick_seen(const struct pick_hit *hits, size_t n, int preferred)
{
    double left = 1, most = 0; /* the part of the light that has passed, the largest part that one hit covers */
    size_t largest = 0;
    for (size_t i = 0; i < n; i++) {
        if (preferred >= 0 && hits[i].subject.kind == SUBJECT_REGION && hits[i].subject.index == (size_t)preferred)
            return i;
        if (left * hits[i].alpha > most) {
            most = left * hits[i].alpha;
            largest = i;
        }
        left *= 1 - hits[i].alpha;
        if (left < 0.5)
            return i;
    }
    return largest;
}
