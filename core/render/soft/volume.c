/* Prepares a volume for the rays of a picture. */
#include "core/render/soft/volume.h"

#include <math.h>
#include <stdlib.h>

#include "core/derive/volume_bricks.h"

static const enum soft_voxel types[] = {
    [VOXEL_U8] = SOFT_U8, [VOXEL_I16] = SOFT_I16, [VOXEL_U16] = SOFT_U16, [VOXEL_F32] = SOFT_F32
};

/* ---- rays --------------------------------------------------------------------------------------------------------- */

/* The linear quantity with these values at the picture's corners left above, right above and left below. */
static struct soft_linear linear(double corner, double right, double below, int width, int height)
{
    double per_column = (right - corner) / width, per_row = (below - corner) / height;
    /* at the middle of the sample in the corner */
    return (struct soft_linear){ corner + 0.5 * (per_column + per_row), per_column, per_row };
}

static double component(struct vec3 v, int axis)
{
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

struct corner_ray {
    struct vec3 origin_lps_mm, per_depth;
};

static struct corner_ray ray_of_corner(const struct camera *camera, double x, double y)
{
    struct vec3 at = mat4_project(&camera->lps_mm_from_clip, vec3(x, y, 0));
    struct vec3 from_eye = vec3_sub(at, camera->eye_lps_mm);
    double depth_mm = vec3_dot(from_eye, camera->forward);
    if (camera->is_parallel)
        return (struct corner_ray){ vec3_sub(at, vec3_scale(camera->forward, depth_mm)), camera->forward };
    return (struct corner_ray){ camera->eye_lps_mm, vec3_scale(from_eye, 1 / depth_mm) };
}

static void set_rays(struct soft_volume *volume, const struct camera *camera, const struct grid *grid, int width,
                     int height)
{
    const struct affine *to_index = &grid->ijk_from_lps_mm;
    struct corner_ray corners[3] = { ray_of_corner(camera, -1, 1), ray_of_corner(camera, 1, 1),
                                     ray_of_corner(camera, -1, -1) };
    double right[3], up[3];
    struct vec3 origin[3], per_depth[3];
    for (int i = 0; i < 3; i++) {
        origin[i] = affine_point(to_index, corners[i].origin_lps_mm);
        per_depth[i] = affine_vector(to_index, corners[i].per_depth);
        right[i] = vec3_dot(corners[i].per_depth, camera->right);
        up[i] = vec3_dot(corners[i].per_depth, camera->up);
    }
    for (int axis = 0; axis < 3; axis++) {
        volume->origin[axis] =
            linear(component(origin[0], axis), component(origin[1], axis), component(origin[2], axis), width, height);
        volume->per_depth[axis] = linear(component(per_depth[0], axis), component(per_depth[1], axis),
                                         component(per_depth[2], axis), width, height);
    }
    volume->right = linear(right[0], right[1], right[2], width, height);
    volume->up = linear(up[0], up[1], up[2], width, height);
    volume->near_mm = camera->near_mm;
    volume->is_parallel = camera->is_parallel;
    /* clip z and w are linear in depth, w is 1 or the depth */
    const double *m = camera->clip_from_lps_mm.m;
    double per_mm = m[2] * camera->forward.x + m[6] * camera->forward.y + m[10] * camera->forward.z;
    double at_eye = m[2] * camera->eye_lps_mm.x + m[6] * camera->eye_lps_mm.y + m[10] * camera->eye_lps_mm.z + m[14];
    volume->depth_scale = camera->is_parallel ? 1 / per_mm : at_eye;
    volume->depth_offset = camera->is_parallel ? at_eye : per_mm;
}

static void set_planes(struct soft_volume *volume, const struct camera *camera, const struct clip_set *clip, int width,
                       int height)
{
    struct corner_ray corners[3] = { ray_of_corner(camera, -1, 1), ray_of_corner(camera, 1, 1),
                                     ray_of_corner(camera, -1, -1) };
    for (size_t i = 0; i < clip->n_planes && volume->n_planes < SOFT_RAY_PLANES; i++) {
        const struct plane *plane = &clip->planes[i].plane;
        double height_mm[3], per_depth[3];
        if (clip->left_out >> i & 1)
            continue;
        for (int c = 0; c < 3; c++) {
            height_mm[c] = plane_height_mm(plane, corners[c].origin_lps_mm) - CLIP_SLACK_MM;
            per_depth[c] = vec3_dot(corners[c].per_depth, plane->normal);
        }
        volume->planes[volume->n_planes++] =
            (struct soft_ray_plane){ linear(height_mm[0], height_mm[1], height_mm[2], width, height),
                                     linear(per_depth[0], per_depth[1], per_depth[2], width, height),
                                     clip->planes[i].is_capped };
    }
}

/* The planes of the method slices divide the extent of the grid along the line of sight. */
static void set_slices(struct soft_volume *volume, const struct camera *camera, const struct grid *grid, int n)
{
    double low = INFINITY, high = -INFINITY;
    for (int corner = 0; corner < 8; corner++) {
        struct vec3 at = affine_point(&grid->lps_mm_from_ijk, vec3(corner & 1 ? grid->size[0] - 0.5 : -0.5,
                                                                   corner & 2 ? grid->size[1] - 0.5 : -0.5,
                                                                   corner & 4 ? grid->size[2] - 0.5 : -0.5));
        double depth_mm = vec3_dot(vec3_sub(at, camera->eye_lps_mm), camera->forward);
        low = fmin(low, depth_mm);
        high = fmax(high, depth_mm);
    }
    volume->n_slices = n;
    volume->part_depth = (high - low) / n;
    volume->first_depth = low + 0.5 * volume->part_depth;
}

/* Converts a linear form over samples to one over pixels. */
static void scale_places(struct soft_linear *linear, int samples)
{
    linear->right *= samples;
    linear->down *= samples;
}

void soft_volume_per_pixel(const struct soft_volume *volume, struct soft_volume *per_pixel)
{
    *per_pixel = *volume;
    per_pixel->samples = 1;
    for (int axis = 0; axis < 3; axis++) {
        scale_places(&per_pixel->origin[axis], volume->samples);
        scale_places(&per_pixel->per_depth[axis], volume->samples);
    }
    scale_places(&per_pixel->right, volume->samples);
    scale_places(&per_pixel->up, volume->samples);
    for (int i = 0; i < volume->n_planes; i++) {
        scale_places(&per_pixel->planes[i].origin_mm, volume->samples);
        scale_places(&per_pixel->planes[i].per_depth, volume->samples);
    }
}

/* ---- values ------------------------------------------------------------------------------------------------------- */

static void set_colors(struct soft_volume *volume, const struct draw_image *image)
{
    const int top = image->tones ? DRAW_TONES - 1 : 255;
    volume->top = (float)top;
    volume->flip = image->is_low_white ? (uint32_t)top : 0;
    volume->colors = image->tones ? image->tones : image->colors;
}

/* t of a value, by how raw values become values. */
static void set_values(struct soft_volume *volume, const struct volume *image, const struct draw_volume *draw)
{
    double per_value = 1 / draw->image.width, low = draw->image.low;
    if (draw->method == SCENE_VOLUME_METHOD_RAY) {
        per_value = (DRAW_VOLUME_TABLE - 1) / draw->width;
        low = draw->low;
    }
    volume->scale = (float)(image->slope * per_value);
    volume->offset = (float)((image->offset - low) * per_value);
    volume->value_scale = (float)per_value;
    volume->value_offset = (float)(-low * per_value);
    volume->cull = (float)((draw->cull - low) * per_value);
    volume->grey_scale = (float)(1 / (per_value * draw->image.width));
    volume->grey_offset = (float)((low - draw->image.low) / draw->image.width);
    set_colors(volume, &draw->image);
    for (int c = 0; c < 3; c++)
        volume->darkest[c] = visible_background[c];
    if (draw->method != SCENE_VOLUME_METHOD_RAY)
        return;
    volume->gradient = (float)(draw->gradient * per_value);
    for (int i = 0; i < DRAW_VOLUME_TABLE; i++) {
        volume->absorption[i] = draw->table[i][3];
        for (int c = 0; c < 3; c++)
            volume->color[i] |= (uint32_t)lrintf(draw->table[i][c] * 255.0f) << 8 * c;
    }
}

void soft_volume_init_image(struct soft_volume *volume, const struct volume *image, const struct draw_image *look)
{
    *volume = (struct soft_volume){ .voxels = image->voxels,
                                    .type = types[image->type],
                                    .is_linear = look->is_linear,
                                    .scale = (float)(image->slope / look->width),
                                    .offset = (float)((image->offset - look->low) / look->width),
                                    .grey_scale = 1 };
    set_colors(volume, look);
    for (int axis = 0; axis < 3; axis++)
        volume->size[axis] = image->grid.size[axis];
}

static void set_shading(struct soft_volume *volume, const struct camera *camera, const struct grid *grid)
{
    const struct affine *to_index = &grid->ijk_from_lps_mm;
    /* the gradient in patient space is the transpose of this map applied to the one in index space */
    const struct vec3 axes[3] = { camera->right, camera->up, vec3_scale(camera->forward, -1) };
    for (int eye_axis = 0; eye_axis < 3; eye_axis++) {
        struct vec3 index = affine_vector(to_index, axes[eye_axis]);
        for (int axis = 0; axis < 3; axis++)
            volume->to_eye[eye_axis][axis] = (float)component(index, axis);
    }
}

/* ---- what is seen --------------------------------------------------------------------------------------------------- */

/* The values between table entries that absorb, a little widened, as interpolated values are rounded. */
static size_t seen_ranges(const struct draw_volume *draw, struct volume_range ranges[VOLUME_MAX_RANGES])
{
    const struct draw_image *image = &draw->image;
    if (draw->method != SCENE_VOLUME_METHOD_RAY) {
        double low = draw->cull - 1e-5 * (fabs(draw->cull) + image->width);
        /* below the window the largest value adds no light, if that end of the window is black */
        bool is_black = !image->is_low_white && (!image->colors || (image->colors[0] & 0xffffff) == 0);
        if (draw->method == SCENE_VOLUME_METHOD_MIP && is_black)
            low = fmax(low, image->low - 1e-5 * (fabs(image->low) + image->width));
        ranges[0] = (struct volume_range){ low, INFINITY };
        return 1;
    }
    const double entry = draw->width / (DRAW_VOLUME_TABLE - 1);
    size_t n = 0;
    for (int i = 0; i < DRAW_VOLUME_TABLE; i++) {
        if (!(draw->table[i][3] > 0))
            continue;
        double low = i == 0 ? -INFINITY : draw->low + (i - 1) * entry,
               high = i == DRAW_VOLUME_TABLE - 1 ? INFINITY : draw->low + (i + 1) * entry;
        if (n > 0 && (low <= ranges[n - 1].high || n == VOLUME_MAX_RANGES))
            ranges[n - 1].high = high;
        else
            ranges[n++] = (struct volume_range){ low, high };
    }
    for (size_t i = 0; i < n; i++)
        ranges[i].low = fmax(ranges[i].low, draw->cull - 2 * entry - 1e-5 * fabs(draw->cull));
    return n;
}

bool soft_volume_init(struct soft_volume *volume, const struct draw *draw, const struct draw_scope *scope, int width,
                      int height, int samples, struct error *err)
{
    const struct snapshot *snapshot = scope->snapshot;
    const struct volume *image = snapshot->plan->images[draw->subject.index].volume;
    *volume = (struct soft_volume){ .method = draw->volume.method,
                                    .voxels = image->voxels,
                                    .type = types[image->type],
                                    .step_voxels = (float)draw->volume.step_voxels,
                                    .step_limit_mm = (float)draw->volume.step_limit_mm,
                                    .is_linear = draw->volume.is_linear,
                                    .is_shaded = draw->volume.is_shaded,
                                    .lights = visible_lights(&snapshot->scene.lights, scope->camera),
                                    .samples = samples };
    for (int axis = 0; axis < 3; axis++)
        volume->size[axis] = image->grid.size[axis];
    set_rays(volume, scope->camera, &image->grid, width, height);
    set_planes(volume, scope->camera, &draw->clip, width, height);
    set_slices(volume, scope->camera, &image->grid, draw->volume.n_slices);
    set_values(volume, image, &draw->volume);
    set_shading(volume, scope->camera, &image->grid);
    struct volume_range ranges[VOLUME_MAX_RANGES];
    size_t n_ranges = seen_ranges(&draw->volume, ranges);
    if (volume->method == SCENE_VOLUME_METHOD_AVERAGE)
        return true;
    volume->leaps = volume_leaps_get(snapshot->derived, draw->subject.index, ranges, n_ranges, err);
    if (volume->leaps && volume->method == SCENE_VOLUME_METHOD_MIP)
        volume->bricks = volume_bricks_get(snapshot->derived, draw->subject.index, err);
    if (!volume->leaps || (volume->method == SCENE_VOLUME_METHOD_MIP && !volume->bricks))
        return false;
    volume->leap = volume->leaps->leap;
    for (int axis = 0; axis < 3; axis++)
        volume->n_bricks[axis] = volume->leaps->n[axis];
    return true;
}

void soft_volume_finish(struct soft_volume *volume)
{
    if (volume->leaps)
        derive_result_unref(&volume->leaps->base);
    if (volume->bricks)
        derive_result_unref(&volume->bricks->base);
    volume->leaps = NULL;
    volume->bricks = NULL;
    volume->leap = NULL;
}
