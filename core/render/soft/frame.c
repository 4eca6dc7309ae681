#include "core/render/soft/frame.h"

#include <math.h>
#include <stdlib.h>

#include "core/base/mem.h"

static const struct soft_shape *shape_of(const struct soft_frame *frame, size_t region, struct error *err)
{
    struct shape_key key = visible_shape_key(frame->snapshot, region);
    return soft_cache_shape(frame->cache, frame->snapshot->derived, region, &key, frame->options.detail, err);
}

static const struct box3 *bounds(void *context, size_t region, struct error *err)
{
    const struct soft_frame *frame = context;
    const struct soft_shape *shape = shape_of(frame, region, err);
    return shape ? &shape->bounds_lps_mm : NULL;
}

static void put(float out[3], struct vec3 v)
{
    out[0] = (float)v.x;
    out[1] = (float)v.y;
    out[2] = (float)v.z;
}

static struct soft_lighting make_lighting(const struct soft_frame *frame, const struct scene_region_style *style,
                                          const struct visible_look *look)
{
    const struct camera *camera = frame->camera;
    struct soft_lighting l = { 0 };
    for (int column = 0; column < 4; column++) {
        const double *m = &camera->clip_from_lps_mm.m[4 * column];
        l.row_x[column] = (float)(0.5 * SOFT_SUB * frame->width * (m[3] + m[0]));
        l.row_y[column] = (float)(0.5 * SOFT_SUB * frame->height * (m[3] - m[1]));
        l.row_z[column] = (float)m[2];
        l.row_w[column] = (float)m[3];
    }
    put(l.viewer, camera->is_parallel ? vec3_scale(camera->forward, -1) : camera->eye_lps_mm);
    l.viewer[3] = camera->is_parallel ? 0 : 1;
    put(l.right, camera->right);
    put(l.up, camera->up);
    put(l.towards, vec3_scale(camera->forward, -1));
    for (int c = 0; c < 3; c++)
        l.color[c] = (float)(style->color_rgb >> (16 - 8 * c) & 255) / 255.0f;
    l.opacity = (float)style->opacity;
    l.is_rim = look->is_rim;
    l.is_two_sided = look->is_two_sided;
    return l;
}

static void add_item(struct soft_frame *frame, const struct visible_shape *from, const struct soft_shape *shape,
                     bool is_opaque)
{
    struct shape_key key = visible_shape_key(frame->snapshot, from->region);
    struct visible_look look = visible_look(frame->snapshot, from->region, &key);
    double samples_per_px = (double)frame->width / frame->snapshot->view.size_px[0];
    frame->items[frame->n_items++] = (struct soft_item){
        .shape = shape,
        .lighting = make_lighting(frame, from->style, &look),
        .is_opaque = is_opaque,
        .look = look,
        .cue = visible_depth_cue(frame->camera, &shape->bounds_lps_mm),
        .size = fmax(1, look.size_px * samples_per_px) * SOFT_SUB, /* in a small picture thinner, but never gone */
    };
    frame->n_translucent += !is_opaque;
}

bool soft_collect_shapes(struct soft_frame *frame, struct render_timing *timing, struct error *err)
{
    const struct snapshot *snapshot = frame->snapshot;
    struct visible_shape *visible[2] = { NULL, NULL }; /* translucent, opaque */
    size_t n[2] = { 0, 0 };
    for (int is_opaque = 0; is_opaque < 2; is_opaque++) {
        visible[is_opaque] = visible_shapes(snapshot, frame->camera, &frame->camera->clip_from_lps_mm, is_opaque,
                                            bounds, frame, &n[is_opaque], err);
        if (!visible[is_opaque])
            goto fail;
    }
    frame->items = mem_array(n[0] + n[1], sizeof *frame->items, UINT64_MAX, err);
    if (!frame->items)
        goto fail;
    for (size_t i = 0; i < n[0] + n[1]; i++) {
        bool is_opaque = i < n[1];
        const struct visible_shape *from = is_opaque ? &visible[1][n[1] - 1 - i] : &visible[0][i - n[1]];
        const struct soft_shape *shape = shape_of(frame, from->region, err);
        if (!shape)
            goto fail;
        add_item(frame, from, shape, is_opaque);
        timing->n_triangles += shape->kind == SHAPE_TRIANGLES ? shape->n_primitives : 0;
        timing->is_light |= shape->is_light;
    }
    free(visible[0]);
    free(visible[1]);
    return true;
fail:
    free(visible[0]);
    free(visible[1]);
    return false;
}

static void add_image(struct soft_frame *frame, const struct plane *plane_lps)
{
    static const enum soft_voxel types[] = {
        [VOXEL_U8] = SOFT_U8, [VOXEL_I16] = SOFT_I16, [VOXEL_U16] = SOFT_U16, [VOXEL_F32] = SOFT_F32
    };
    const struct snapshot *snapshot = frame->snapshot;
    const struct scene_image_style *style = &snapshot->scene.image;
    const struct volume *volume = snapshot->plan->images[snapshot->image].volume;
    struct soft_plane *plane = &frame->planes[frame->n_planes++];
    bool is_in_space = !snapshot_is_pane(snapshot);
    double low = style->window.center - style->window.width / 2, width = style->window.width;
    soft_plane_init(plane, volume, plane_lps, &frame->camera->clip_from_lps_mm, frame->width, frame->height);
    plane->texture.type = types[volume->type];
    plane->texture.grey_scale = (float)(volume->slope / width);
    plane->texture.grey_offset = (float)((volume->offset - low) / width);
    plane->texture.cull = is_in_space ? (float)((style->cull_below - low) / width) : -INFINITY;
    plane->texture.flip = snapshot_is_low_white(snapshot) ? 255 : 0;
    plane->texture.is_linear = style->interpolation != SCENE_INTERPOLATION_NEAREST;
    plane->texture.has_depth = is_in_space;
}

static bool add_labels(struct soft_frame *frame, struct error *err)
{
    const struct snapshot *snapshot = frame->snapshot;
    const struct region_set *set = &snapshot->plan->regions;
    size_t layers[REGION_MAX_LAYERS];
    visible_layers(set, layers);
    frame->palettes = mem_array(set->n_layers, VISIBLE_N_LABELS * sizeof *frame->palettes, UINT64_MAX, err);
    if (!frame->palettes)
        return false;
    for (size_t i = 0; i < set->n_layers; i++) {
        const struct volume *volume = set->layers[layers[i]];
        uint32_t *palette = frame->palettes + i * VISIBLE_N_LABELS;
        if (visible_palette(snapshot, layers[i], (uint8_t(*)[4])palette) == 0)
            continue;
        if (volume->type == VOXEL_F32)
            return error_set(err, ERROR_UNSUPPORTED, "label layer %zu: a label layer of real numbers", layers[i]);
        struct soft_plane *plane = &frame->planes[frame->n_planes++];
        soft_plane_init(plane, volume, &snapshot->pane, &frame->camera->clip_from_lps_mm, frame->width, frame->height);
        plane->texture.type = volume->type == VOXEL_U8 ? SOFT_U8 : SOFT_U16; /* labels are never negative */
        plane->texture.palette = palette;
    }
    return true;
}

bool soft_collect_planes(struct soft_frame *frame, struct error *err)
{
    const struct snapshot *snapshot = frame->snapshot;
    if (snapshot_is_pane(snapshot)) {
        if (snapshot->image < 0)
            return add_labels(frame, err);
        add_image(frame, &snapshot->pane);
        return true;
    }
    for (size_t i = 0; snapshot->image >= 0 && i < snapshot->n_slices; i++)
        add_image(frame, &snapshot->slices[i]);
    return true;
}
