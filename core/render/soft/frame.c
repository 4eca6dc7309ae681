/* Prepares a picture: the draws of its list as the rasteriser's items and planes. */
#include "core/render/soft/frame.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/render/visible/cut.h"

_Static_assert((int)SOFT_MAX_CUTS >= (int)CLIP_MAX, "all clip planes can cut a draw");

static void put(float out[3], struct vec3 v)
{
    out[0] = (float)v.x;
    out[1] = (float)v.y;
    out[2] = (float)v.z;
}

static struct soft_lighting make_lighting(const struct soft_frame *frame, const struct draw *draw)
{
    const struct camera *camera = frame->scope->camera;
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
        l.color[c] = (float)(draw->color_rgb >> (16 - 8 * c) & 255) / 255.0f;
    l.opacity = (float)draw->opacity;
    l.is_rim = draw->shape.look.is_rim;
    l.is_two_sided = draw->shape.look.is_two_sided;
    return l;
}

/* A capped plane cuts off what lies in it, which the cap covers; another one does not. */
static struct soft_cuts make_cuts(const struct clip_set *clip)
{
    struct soft_cuts cuts = { .n = 0 };
    for (size_t i = 0; i < clip->n_planes; i++) {
        if (!clip_set_has(clip, i))
            continue;
        struct cut_plane cut = cut_plane(&clip->planes[i].plane);
        memcpy(cuts.normal[cuts.n], cut.normal, sizeof cut.normal);
        cuts.position[cuts.n++] = clip->planes[i].is_capped ? cut.position : nextafterf(cut.position, INFINITY);
    }
    return cuts;
}

static struct soft_item make_item(const struct soft_frame *frame, const struct draw *draw)
{
    double samples_per_px = (double)frame->width / frame->scope->snapshot->view.size_px[0];
    return (struct soft_item){
        .shape = (const struct soft_shape *)draw->shape.drawable,
        .lighting = make_lighting(frame, draw),
        .look = draw->shape.look,
        .cue = draw->shape.cue,
        .cuts = make_cuts(&draw->clip),
        .size =
            fmax(1, draw->shape.look.size_px * samples_per_px) * SOFT_SUB, /* at least a sample in a small picture */
    };
}

/* The plane through one of the plan's images, with the window low..low + width; everything drawn, in grey. */
static struct soft_plane make_grey(const struct soft_frame *frame, const struct draw *draw, size_t image, double low,
                                   double width, bool is_low_white)
{
    static const enum soft_voxel types[] = {
        [VOXEL_U8] = SOFT_U8, [VOXEL_I16] = SOFT_I16, [VOXEL_U16] = SOFT_U16, [VOXEL_F32] = SOFT_F32
    };
    const struct volume *volume = frame->scope->snapshot->plan->images[image].volume;
    struct soft_plane plane;
    soft_plane_init(&plane, volume, &draw->plane, &draw->clip, &frame->scope->camera->clip_from_lps_mm, frame->width,
                    frame->height);
    plane.texture.type = types[volume->type];
    plane.texture.grey_scale = (float)(volume->slope / width);
    plane.texture.grey_offset = (float)((volume->offset - low) / width);
    plane.texture.flip = is_low_white ? 255 : 0;
    plane.texture.is_linear = draw->image.is_linear;
    return plane;
}

static struct soft_plane make_image(const struct soft_frame *frame, const struct draw *draw)
{
    const struct draw_image *image = &draw->image;
    const struct draw_blend *blend = &image->blend;
    struct soft_plane plane =
        make_grey(frame, draw, draw->subject.index, image->low, image->width, image->is_low_white);
    plane.texture.cull = (float)image->cull;
    plane.texture.colors = image->colors;
    for (int c = 0; c < 3; c++)
        plane.texture.darkest[c] = visible_background[c];
    plane.texture.has_depth = draw->depth == DRAW_DEPTH_TESTED;
    if (blend->part > 0) {
        struct soft_plane second = make_grey(frame, draw, blend->image, blend->low, blend->width, blend->is_low_white);
        second.texture.colors = blend->colors;
        soft_plane_blend(&plane, &second, blend->part);
    }
    return plane;
}

static struct soft_plane make_labels(const struct soft_frame *frame, const struct draw *draw)
{
    const struct volume *volume = frame->scope->snapshot->plan->regions.layers[draw->subject.index];
    struct soft_plane plane;
    soft_plane_init(&plane, volume, &draw->plane, &draw->clip, &frame->scope->camera->clip_from_lps_mm, frame->width,
                    frame->height);
    plane.texture.type = volume->type == VOXEL_U8 ? SOFT_U8 : SOFT_U16; /* labels are never negative */
    plane.texture.palette = (const uint32_t *)(const void *)draw->palette;
    return plane;
}

static bool make_volume(struct soft_frame *frame, const struct draw *draw, struct error *err)
{
    frame->volume = mem_new(sizeof *frame->volume);
    return soft_volume_init(frame->volume, draw, frame->scope, frame->width, frame->height, frame->list->samples, err);
}

bool soft_frame_prepare(struct soft_frame *frame, struct error *err)
{
    const struct draw_list *list = frame->list;
    frame->items = mem_array(list->n_in_image, sizeof *frame->items, UINT64_MAX, err);
    frame->planes = frame->items ? mem_array(list->n_in_image, sizeof *frame->planes, UINT64_MAX, err) : NULL;
    if (!frame->planes)
        return false;
    for (size_t i = 0; i < list->n_in_image; i++) {
        const struct draw *draw = &list->draws[i];
        size_t n_layers = draw_list_n_layers(list, i); /* one more than there are, with a volume */
        frame->n_layers = n_layers > frame->n_layers ? n_layers : frame->n_layers;
        switch (draw->kind) {
        case DRAW_SHAPE: frame->items[frame->n_items++] = make_item(frame, draw); break;
        case DRAW_IMAGE: frame->planes[frame->n_planes++] = make_image(frame, draw); break;
        case DRAW_LABELS: frame->planes[frame->n_planes++] = make_labels(frame, draw); break;
        case DRAW_VOLUME:
            if (!make_volume(frame, draw, err))
                return false;
            break;
        case DRAW_CAP:
        case DRAW_OUTLINE:
        case DRAW_CHECK:
        case DRAW_GRID_CUT:
        case DRAW_GRID_BOX: break;
        }
    }
    return true;
}

void soft_frame_finish(struct soft_frame *frame)
{
    if (frame->volume)
        soft_volume_finish(frame->volume);
    free(frame->volume);
    free(frame->items);
    free(frame->planes);
}
