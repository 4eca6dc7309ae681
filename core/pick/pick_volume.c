/* Follows a ray through a volume. */
#include "core/pick/pick_volume.h"

/* Limit of opacity, as in the picture's table: an opacity of 1 would absorb without end. */
static const double most_opacity = 0.999;
/* Steps along the axis whose voxels a ray passes fastest, in voxels. */
static const double step_voxels = 0.25;
/* A ray of which less passes ends. */
static const double least_left = 1.0 / 512;

struct volume_ray {
    const struct volume *volume;
    const struct scene_image_style *style;
    struct vec3 origin_lps_mm, direction;
    double first_mm, end_mm, step_mm;
    bool is_cut_face; /* enters through a clip plane that is capped */
};

/* False: what is there is not drawn. */
static bool value_at(const struct volume_ray *ray, double t_mm, double *value)
{
    struct vec3 p = vec3_add(ray->origin_lps_mm, vec3_scale(ray->direction, t_mm));
    uint32_t ijk[3];
    if (ray->style->volume.interpolation != SCENE_INTERPOLATION_NEAREST) {
        if (!volume_sample(ray->volume, p, value))
            return false;
    } else {
        if (!volume_voxel_at(ray->volume, p, ijk))
            return false;
        *value = volume_value(ray->volume, ijk[0], ijk[1], ijk[2]);
    }
    return isfinite(*value) && *value >= ray->style->volume.cull_below;
}

/* Absorption of the method ray per mm, natural: light exp(-a d) passes d mm. */
static double absorption(const struct scene_volume_style *style, double value)
{
    const struct scene_transfer_point *points = style->points;
    size_t next = 0; /* the first point above the value */
    if (style->n_points == 0)
        return 0;
    while (next < style->n_points && points[next].value <= value)
        next++;
    const struct scene_transfer_point *a = &points[next > 0 ? next - 1 : 0],
                                      *b = &points[next < style->n_points ? next : style->n_points - 1];
    double part = a->value < b->value ? (value - a->value) / (b->value - a->value) : 0;
    double low = fmin(a->opacity, most_opacity), high = fmin(b->opacity, most_opacity);
    return -log1p(-(low + part * (high - low)));
}

static double grey_of(const struct snapshot *snapshot, double value)
{
    const struct scene_window *window = &snapshot->scene.image.window;
    double grey = fmin(fmax((value - window->center) / window->width + 0.5, 0), 1);
    return snapshot_is_low_white(snapshot) ? 1 - grey : grey;
}

static double component(struct vec3 v, int axis)
{
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

/* Shortens the ray to the grid's outer faces; sets its step. */
static void clip_to_grid(struct volume_ray *ray)
{
    const struct grid *grid = &ray->volume->grid;
    struct vec3 origin = affine_point(&grid->ijk_from_lps_mm, ray->origin_lps_mm),
                per_mm = affine_vector(&grid->ijk_from_lps_mm, ray->direction);
    double fastest = 0;
    for (int axis = 0; axis < 3; axis++) {
        double at = component(origin, axis), speed = component(per_mm, axis), last = grid->size[axis] - 0.5;
        fastest = fmax(fastest, fabs(speed));
        if (fabs(speed) < 1e-12) {
            if (at < -0.5 || at > last)
                ray->end_mm = -INFINITY;
            continue;
        }
        double a = (-0.5 - at) / speed, b = (last - at) / speed;
        ray->first_mm = fmax(ray->first_mm, fmin(a, b));
        ray->end_mm = fmin(ray->end_mm, fmax(a, b));
    }
    ray->step_mm = step_voxels / fastest;
}

static void clip_to_planes(struct volume_ray *ray, const struct snapshot *snapshot)
{
    for (size_t i = 0; i < snapshot->n_clips; i++) {
        const struct plane *plane = &snapshot->clips[i].plane;
        double height_mm = plane_height_mm(plane, ray->origin_lps_mm) - CLIP_SLACK_MM,
               rise = vec3_dot(plane->normal, ray->direction);
        if (fabs(rise) < 1e-12) {
            if (height_mm > 0)
                ray->end_mm = -INFINITY;
        } else if (rise > 0) {
            ray->end_mm = fmin(ray->end_mm, -height_mm / rise);
        } else if (-height_mm / rise > ray->first_mm) {
            ray->first_mm = -height_mm / rise;
            ray->is_cut_face = snapshot->clips[i].is_capped;
        }
    }
}

static bool follow_light(const struct volume_ray *ray, struct pick_volume_hit *hit)
{
    const struct scene_volume_style *style = &ray->style->volume;
    double absorbed = 0, value;
    *hit = (struct pick_volume_hit){ INFINITY, 0, false };
    if (ray->is_cut_face && value_at(ray, ray->first_mm, &value) && absorption(style, value) > 0) {
        *hit = (struct pick_volume_hit){ ray->first_mm, 1, true };
        return true;
    }
    for (double t = ray->first_mm; t < ray->end_mm && exp(-absorbed) > least_left; t += ray->step_mm) {
        double length_mm = fmin(ray->step_mm, ray->end_mm - t);
        double per_mm = value_at(ray, t + length_mm / 2, &value) ? absorption(style, value) : 0;
        if (absorbed < M_LN2 && absorbed + per_mm * length_mm >= M_LN2)
            hit->t_mm = t + (M_LN2 - absorbed) / per_mm;
        absorbed += per_mm * length_mm;
    }
    hit->alpha = 1 - exp(-absorbed);
    return isfinite(hit->t_mm);
}

static bool find_first(const struct volume_ray *ray, struct pick_volume_hit *hit)
{
    double value, before_mm = ray->first_mm;
    for (double t = ray->first_mm; t < ray->end_mm; before_mm = t, t += ray->step_mm) {
        if (!value_at(ray, t, &value))
            continue;
        for (int i = 0; i < 10; i++) { /* halves the step in which it begins */
            double middle = (before_mm + t) / 2;
            if (value_at(ray, middle, &value))
                t = middle;
            else
                before_mm = middle;
        }
        *hit = (struct pick_volume_hit){ t, 1, false };
        return true;
    }
    return false;
}

static bool find_largest(const struct volume_ray *ray, const struct snapshot *snapshot, struct pick_volume_hit *hit)
{
    double largest = -INFINITY, sum = 0, value;
    size_t n = 0;
    hit->is_on_cap = false;
    for (double t = ray->first_mm + ray->step_mm / 2; t < ray->end_mm; t += ray->step_mm) {
        if (!value_at(ray, t, &value))
            continue;
        if (value > largest)
            hit->t_mm = t;
        largest = fmax(largest, value);
        sum += value;
        n++;
    }
    if (n == 0)
        return false;
    bool is_mip = ray->style->volume.method == SCENE_VOLUME_METHOD_MIP;
    hit->alpha = grey_of(snapshot, is_mip ? largest : sum / (double)n);
    return true;
}

bool pick_volume(const struct snapshot *snapshot, struct vec3 origin_lps_mm, struct vec3 direction,
                 struct pick_volume_hit *hit)
{
    const struct scene_volume_style *style = &snapshot->scene.image.volume;
    if (snapshot_is_pane(snapshot) || snapshot->image < 0 || !style->visible)
        return false;
    struct volume_ray ray = { .volume = snapshot->plan->images[snapshot->image].volume,
                              .style = &snapshot->scene.image,
                              .origin_lps_mm = origin_lps_mm,
                              .direction = direction,
                              .first_mm = 0,
                              .end_mm = INFINITY };
    clip_to_grid(&ray);
    if (style->clipped)
        clip_to_planes(&ray, snapshot);
    if (!(ray.first_mm < ray.end_mm))
        return false;
    switch (style->method) {
    case SCENE_VOLUME_METHOD_RAY: return follow_light(&ray, hit);
    case SCENE_VOLUME_METHOD_SLICES: return find_first(&ray, hit);
    case SCENE_VOLUME_METHOD_MIP:
    case SCENE_VOLUME_METHOD_AVERAGE: break;
    }
    return find_largest(&ray, snapshot, hit);
}
