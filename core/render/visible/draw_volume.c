/* The image as a volume, as a draw: its transfer function as a table, its steps. */
#include "core/render/visible/draw_volume.h"

#include <math.h>

#include "core/base/mem.h"
#include "core/render/visible/draw_planes.h"
#include "core/render/visible/draw_wash.h"

/* An opacity of 1 would be an absorption without end. */
static const double most_opacity = 0.999;
/* Voxels along a ray from sample to sample, while moving and in a still. The four samples of a pixel of a still take
 * their values in turn, so it has four times as many to a voxel. The mean of many values needs fewer of them. */
static const double steps[][2] = { [SCENE_VOLUME_METHOD_RAY] = { 1, 1 },
                                   [SCENE_VOLUME_METHOD_SLICES] = { 1, 1 },
                                   [SCENE_VOLUME_METHOD_MIP] = { 1, 2 },
                                   [SCENE_VOLUME_METHOD_AVERAGE] = { 2, 4 } };
/* Gradient from which a sample is lit, per mm, as a fraction of the value range over which the transfer function
 * changes. Noise is below it, a surface above. */
static const double least_gradient = 0.03;

static double channel(const struct scene_transfer_point *point, int c)
{
    return c == 3 ? fmin(point->opacity, most_opacity) : (double)(point->color_rgb >> (16 - 8 * c) & 255) / 255;
}

void draw_volume_table(const struct scene_transfer_point *points, size_t n, double low, double width,
                       float table[DRAW_VOLUME_TABLE][4])
{
    size_t next = 0; /* the first point above the value */
    for (int i = 0; i < DRAW_VOLUME_TABLE; i++) {
        double value = low + width * i / (DRAW_VOLUME_TABLE - 1);
        while (next < n && points[next].value <= value)
            next++;
        const struct scene_transfer_point *a = &points[next > 0 ? next - 1 : 0], *b = &points[next < n ? next : n - 1];
        double part = a->value < b->value ? (value - a->value) / (b->value - a->value) : 0;
        for (int c = 0; c < 4; c++) {
            double mixed = channel(a, c) + part * (channel(b, c) - channel(a, c));
            table[i][c] = (float)(c == 3 ? -log1p(-mixed) : mixed);
        }
    }
}

/* The values between which the transfer function changes, as far as the image has them. */
static void table_range(const struct scene_volume_style *style, const struct volume *volume, double *low, double *width)
{
    double high = style->points[style->n_points - 1].value;
    *low = style->points[0].value;
    if (volume->low < volume->high) {
        high = fmin(high, volume->high);
        *low = fmin(fmax(*low, volume->low), high);
    }
    *width = high - *low;
    if (!(*width > 0)) /* a single value; or all of the image lies beyond the points */
        *width = fmax(1e-6 * fabs(*low), 1e-9);
    *low -= 0.002 * *width; /* two entries more at either end, for a step at an outer point */
    *width *= 1.004;
}

static bool has_opacity(const struct scene_volume_style *style)
{
    for (size_t i = 0; i < style->n_points; i++)
        if (style->points[i].opacity > 0)
            return true;
    return false;
}

/* Window and colours of the image shown; a second image is not blended over a volume. */
static struct draw_image look_of_image(const struct draw_list *list, const struct snapshot *snapshot)
{
    const struct scene_volume_style *style = &snapshot->scene.image.volume;
    struct draw_image image = draw_image_shown(list, snapshot, false);
    image.cull = (style->cull_below - image.low) / image.width;
    image.is_linear = style->interpolation != SCENE_INTERPOLATION_NEAREST;
    image.blend = (struct draw_blend){ .gamma = 1 };
    return image;
}

bool draw_volume(struct draw_list *list, const struct draw_scope *scope, struct error *err)
{
    const struct snapshot *snapshot = scope->snapshot;
    const struct scene_volume_style *style = &snapshot->scene.image.volume;
    bool is_ray = style->method == SCENE_VOLUME_METHOD_RAY;
    if (snapshot_is_pane(snapshot) || snapshot->image < 0 || !style->visible || (is_ray && !has_opacity(style)))
        return true;
    const struct volume *volume = snapshot->plan->images[snapshot->image].volume;
    struct vec3 spacing_mm = grid_spacing_mm(&volume->grid);
    double step = steps[style->method][list->samples > 1];
    struct draw_volume draw = {
        .method = style->method,
        .cull = style->cull_below,
        .image = look_of_image(list, snapshot),
        .n_slices = (int)style->steps,
        .is_linear = style->interpolation != SCENE_INTERPOLATION_NEAREST,
        .is_shaded = style->shaded,
        .is_still = scope->is_still,
        .step_voxels = step,
        .step_limit_mm = 2 * step * fmin(spacing_mm.x, fmin(spacing_mm.y, spacing_mm.z)),
    };
    draw.image.wash = draw_wash_shown(list, snapshot);
    if (snapshot->scene.dose.wash.volume && (is_ray || style->method == SCENE_VOLUME_METHOD_SLICES))
        draw.wash = draw.image.wash;
    if (is_ray) {
        list->transfer = mem_array(DRAW_VOLUME_TABLE, sizeof *list->transfer, UINT64_MAX, err);
        if (!list->transfer)
            return false;
        table_range(style, volume, &draw.low, &draw.width);
        draw_volume_table(style->points, style->n_points, draw.low, draw.width, list->transfer);
        draw.table = (const float(*)[4])list->transfer;
        draw.gradient = least_gradient * draw.width;
    }
    list->is_order_exact = true;
    return draw_list_add(list,
                         &(struct draw){
                             .pass = DRAW_TRANSLUCENT,
                             .kind = DRAW_VOLUME,
                             .depth = DRAW_DEPTH_LAYER,
                             .subject = { SUBJECT_IMAGE, (size_t)snapshot->image, 0 },
                             .clip = { snapshot->clips, snapshot->n_clips, style->clipped ? 0 : UINT32_MAX },
                             .opacity = 1,
                             .volume = draw,
                         },
                         err);
}
