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

/* The projection of the camera; colours stay 0. */
static struct soft_lighting make_projection(const struct soft_frame *frame)
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
    return l;
}

static struct soft_lighting make_lighting(const struct soft_frame *frame, const struct draw *draw)
{
    struct soft_lighting l = make_projection(frame);
    for (int c = 0; c < 3; c++)
        l.color[c] = (float)(draw->color_rgb >> (16 - 8 * c) & 255) / 255.0f;
    l.opacity = (float)draw->opacity;
    l.lights = visible_lights(&frame->scope->snapshot->scene.lights, frame->scope->camera);
    l.is_rim = draw->shape.look.is_rim;
    l.is_two_sided = draw->shape.look.is_two_sided;
    if (draw->shape.texture.kind == SCENE_TEXTURE_IMAGE)
        l.color[0] = l.color[1] = l.color[2] = 1;
    if (draw->shape.texture.kind != SCENE_TEXTURE_NONE && draw->depth != DRAW_DEPTH_LAYER)
        l.mark = SOFT_OPAQUE ^ SOFT_MARK;
    return l;
}

/* ---- washes ----------------------------------------------------------------------------------------------------- */

/* A wash over samples of a draw's plane; NULL: none. */
static const struct soft_wash *add_wash(struct soft_frame *frame, const struct draw_wash *wash,
                                        const struct plane *plane_lps)
{
    if (!wash)
        return NULL;
    struct soft_wash *added = &frame->washes[frame->n_washes++];
    if (wash->field)
        dose_field_need_plane(wash->field, plane_lps->origin_lps_mm, plane_lps->normal);
    soft_wash_on_plane(added, wash, plane_lps, &frame->scope->camera->clip_from_lps_mm, frame->width, frame->height);
    return added;
}

static const struct soft_wash *add_volume_wash(struct soft_frame *frame, const struct draw_wash *wash, size_t image)
{
    if (!wash)
        return NULL;
    struct soft_wash *added = &frame->washes[frame->n_washes++];
    if (wash->field) {
        struct box3 box = grid_bounds_lps_mm(&frame->scope->snapshot->plan->images[image].volume->grid);
        dose_field_need_box(wash->field, &box);
    }
    soft_wash_in_image(added, wash, &frame->scope->snapshot->plan->images[image].volume->grid);
    return added;
}

/* Adds the paint that a draw lays over its shape. Returns NULL if it lays none. */
static const struct soft_paint *add_paint(struct soft_frame *frame, const struct draw *draw)
{
    const struct draw_texture *texture = &draw->shape.texture;
    const struct camera *camera = frame->scope->camera;
    if (texture->kind == SCENE_TEXTURE_NONE)
        return NULL;
    struct soft_paint *paint = &frame->paints[frame->n_paints++];
    if (texture->kind == SCENE_TEXTURE_DOSE) {
        struct soft_wash *wash = &frame->washes[frame->n_washes++];
        if (texture->wash->field)
            dose_field_need_box(texture->wash->field, &draw->shape.drawable->bounds_lps_mm);
        soft_wash_on_shapes(wash, texture->wash, camera, frame->width, frame->height);
        paint->wash = wash;
        return paint;
    }
    const struct volume *image = frame->scope->snapshot->plan->images[texture->image_index].volume;
    if (!frame->texture) {
        frame->texture = mem_new(sizeof *frame->texture);
        soft_volume_init_image(frame->texture, image, &texture->image);
    }
    paint->image = frame->texture;
    paint->places = soft_places_of_shapes(&image->grid, camera, frame->width, frame->height);
    for (int c = 0; c < 3; c++)
        paint->color[c] = (float)(draw->color_rgb >> (16 - 8 * c) & 255) / 255.0f;
    return paint;
}

/* ---- draws ------------------------------------------------------------------------------------------------------ */

static struct soft_item make_item(const struct soft_frame *frame, const struct draw *draw)
{
    double samples_per_px = frame->width / snapshot_line_width(frame->scope->snapshot);
    return (struct soft_item){
        .shape = (const struct soft_shape *)draw->shape.drawable,
        .lighting = make_lighting(frame, draw),
        .look = draw->shape.look,
        .cue = draw->shape.cue,
        .cuts = soft_cuts_of(&draw->clip),
        .size =
            fmax(1, draw->shape.look.size_px * samples_per_px) * SOFT_SUB, /* at least a sample in a small picture */
    };
}

/* The plane through one of the plan's images, with the window low..low + width; everything drawn, in grey or in tones
 * (draw_image; NULL: none). */
static struct soft_plane make_grey(const struct soft_frame *frame, const struct draw *draw, size_t image, double low,
                                   double width, bool is_low_white, bool is_linear, const uint32_t *tones)
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
    const int top = tones ? DRAW_TONES - 1 : 255;
    plane.texture.top = (float)top;
    plane.texture.flip = is_low_white ? (uint32_t)top : 0;
    plane.texture.colors = tones;
    plane.texture.is_linear = is_linear;
    return plane;
}

/* The plane of a draw, of an image or a cap, with the image on it; without a wash. */
static struct soft_plane make_image(const struct soft_frame *frame, const struct draw *draw,
                                    const struct draw_image *image)
{
    const struct draw_blend *blend = &image->blend;
    struct soft_plane plane = make_grey(frame, draw, draw->subject.index, image->low, image->width, image->is_low_white,
                                        image->is_linear, image->tones);
    plane.texture.cull = (float)image->cull;
    if (!image->tones)
        plane.texture.colors = image->colors;
    for (int c = 0; c < 3; c++)
        plane.texture.darkest[c] = visible_background[c];
    plane.texture.has_depth = draw->depth == DRAW_DEPTH_TESTED;
    if (blend->part > 0) {
        struct soft_plane second = make_grey(frame, draw, blend->image, blend->low, blend->width, blend->is_low_white,
                                             image->is_linear, blend->tones);
        if (!blend->tones)
            second.texture.colors = blend->colors;
        soft_plane_blend(&plane, &second, blend->part);
    }
    return plane;
}

static struct soft_plane make_slice(struct soft_frame *frame, const struct draw *draw)
{
    struct soft_plane plane = make_image(frame, draw, &draw->image);
    plane.wash = add_wash(frame, draw->image.wash, &draw->plane);
    plane.texture.alpha = plane.wash ? SOFT_MARK : SOFT_OPAQUE;
    return plane;
}

static struct soft_plane make_wash(struct soft_frame *frame, const struct draw *draw)
{
    struct soft_plane plane;
    soft_plane_init(&plane, draw->wash->rows[0], &draw->plane, &draw->clip, &frame->scope->camera->clip_from_lps_mm,
                    frame->width, frame->height);
    plane.wash = add_wash(frame, draw->wash, &draw->plane);
    plane.is_wash_alone = true;
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

static void add_marks(struct soft_frame *frame, const struct draw *draw)
{
    soft_marks_init(&frame->marks[frame->n_marks++], draw, &frame->scope->camera->clip_from_lps_mm, frame->width,
                    frame->height, frame->width / snapshot_line_width(frame->scope->snapshot));
}

static bool make_volume(struct soft_frame *frame, const struct draw *draw, struct error *err)
{
    frame->volume = mem_new(sizeof *frame->volume);
    if (!soft_volume_init(frame->volume, draw, frame->scope, frame->width, frame->height, frame->list->samples, err))
        return false;
    frame->volume->wash = add_volume_wash(frame, draw->volume.wash, draw->subject.index);
    frame->volume->face_wash = add_volume_wash(frame, draw->volume.image.wash, draw->subject.index);
    return true;
}

static void make_tracks(struct soft_frame *frame, const struct draw *draw)
{
    frame->tracks = mem_new(sizeof *frame->tracks);
    soft_track_view_init(frame->tracks, draw, frame->scope, frame->width, frame->height, frame->n_bands);
    frame->n_track_chunks = soft_track_n_chunks(&draw->tracks);
}

/* ---- caps ------------------------------------------------------------------------------------------------------- */

/* The lines of an outline or of a dose as a shape. */
static bool make_outline(struct soft_shape *shape, const struct cut_lines *lines, struct error *err)
{
    size_t n = 2 * lines->n;
    *shape = (struct soft_shape){ .kind = SHAPE_LINES, .n_vertices = n, .n_primitives = lines->n };
    shape->positions = mem_array(n, 3 * sizeof *shape->positions, UINT64_MAX, err);
    shape->normals = shape->positions ? mem_array(n, 3 * sizeof *shape->normals, UINT64_MAX, err) : NULL;
    uint32_t *indices = shape->normals ? mem_array(n, sizeof *indices, UINT64_MAX, err) : NULL;
    if (!indices)
        return false;
    shape->indices = indices;
    for (size_t i = 0; i < n; i++) {
        for (size_t axis = 0; axis < 3; axis++)
            shape->positions[axis * n + i] = (float)lines->ends_lps_mm[i / 2][i % 2][axis];
        indices[i] = (uint32_t)i;
    }
    const float *p = shape->positions;
    const int16_t *m = shape->normals;
    shape->points = (struct soft_points){ p, p + n, p + 2 * n, m, m + n, m + 2 * n };
    return true;
}

static void free_outline(struct soft_shape *shape)
{
    free(shape->positions);
    free(shape->normals);
    free((void *)shape->indices);
}

static bool add_line(struct soft_frame *frame, const struct draw *like, const struct cut_lines *lines, uint32_t rgb,
                     double width_px, struct error *err)
{
    const struct draw line = {
        .clip = like->clip,
        .color_rgb = rgb,
        .opacity = 1,
        .shape = { .look = { .size_px = width_px }, .cue = { .w = 1 } },
    };
    struct soft_shape *shape = &frame->outlines[frame->n_outlines++];
    if (!make_outline(shape, lines, err))
        return false;
    struct soft_item *item = &frame->items[frame->n_items++];
    *item = make_item(frame, &line);
    item->shape = shape;
    return true;
}

static bool add_outlines(struct soft_frame *frame, const struct draw *draw, struct error *err)
{
    for (size_t i = 0; draw->cap.outline_px > 0 && i < draw->cap.n_regions; i++) {
        const struct draw_cap_region *region = &draw->cap.regions[i];
        if (!add_line(frame, draw, region->lines, region->color_rgb, draw->cap.outline_px, err))
            return false;
    }
    return true;
}

static bool add_cap(struct soft_frame *frame, const struct draw *draw, struct error *err)
{
    const struct plan *plan = frame->scope->snapshot->plan;
    const struct draw_cap *style = &draw->cap;
    const struct volume *volume = style->has_image ? plan->images[draw->subject.index].volume : NULL;
    struct soft_cap *cap = &frame->caps[frame->n_caps++];
    if (!volume)
        soft_plane_init(&cap->plane, NULL, &draw->plane, &draw->clip, &frame->scope->camera->clip_from_lps_mm,
                        frame->width, frame->height);
    else
        cap->plane = make_image(frame, draw, &style->image);
    cap->wash = add_wash(frame, style->image.wash, &draw->plane);
    cap->dark = DRAW_CAP_DARK >> 16 | (DRAW_CAP_DARK & 0xff00) | (DRAW_CAP_DARK & 255) << 16 | 0xff000000u;
    struct soft_lighting projection = make_projection(frame);
    return soft_cap_init(cap, draw, &projection, frame->height, frame->n_bands, err) && add_outlines(frame, draw, err);
}

/* ---- all -------------------------------------------------------------------------------------------------------- */

static bool make_arrays(struct soft_frame *frame, struct error *err)
{
    const struct draw_list *list = frame->list;
    size_t n = list->n_in_image, n_caps = 0, n_outlines = 0, n_marks = 0;
    for (size_t i = 0; i < n; i++) {
        n_marks += list->draws[i].kind == DRAW_MARKS;
        n_outlines += list->draws[i].kind == DRAW_ISOLINES;
        if (list->draws[i].kind == DRAW_CAP) {
            n_caps++;
            n_outlines += list->draws[i].cap.n_regions;
        }
    }
    frame->items = mem_array(n + n_outlines, sizeof *frame->items, UINT64_MAX, err);
    frame->planes = frame->items ? mem_array(n, sizeof *frame->planes, UINT64_MAX, err) : NULL;
    frame->marks = frame->planes ? mem_array(n_marks, sizeof *frame->marks, UINT64_MAX, err) : NULL;
    frame->caps = frame->marks ? mem_array(n_caps, sizeof *frame->caps, UINT64_MAX, err) : NULL;
    frame->outlines = frame->caps ? mem_array(n_outlines, sizeof *frame->outlines, UINT64_MAX, err) : NULL;
    frame->paints = frame->outlines ? mem_array(n, sizeof *frame->paints, UINT64_MAX, err) : NULL;
    /* one a draw, but two of a volume */
    frame->washes = frame->paints ? mem_array(list->wash ? n + 1 : 0, sizeof *frame->washes, UINT64_MAX, err) : NULL;
    return frame->washes != NULL;
}

bool soft_frame_prepare(struct soft_frame *frame, struct error *err)
{
    const struct draw_list *list = frame->list;
    if (!make_arrays(frame, err))
        return false;
    for (size_t i = 0; i < list->n_in_image; i++) {
        const struct draw *draw = &list->draws[i];
        size_t n_layers = draw_list_n_layers(list, i); /* one more than there are, with a volume */
        frame->n_layers = n_layers > frame->n_layers ? n_layers : frame->n_layers;
        switch (draw->kind) {
        case DRAW_SHAPE:
            frame->items[frame->n_items] = make_item(frame, draw);
            frame->items[frame->n_items++].paint = add_paint(frame, draw);
            break;
        case DRAW_IMAGE: frame->planes[frame->n_planes++] = make_slice(frame, draw); break;
        case DRAW_WASH: frame->planes[frame->n_planes++] = make_wash(frame, draw); break;
        case DRAW_LABELS: frame->planes[frame->n_planes++] = make_labels(frame, draw); break;
        case DRAW_CAP:
            if (!add_cap(frame, draw, err))
                return false;
            break;
        case DRAW_VOLUME:
            if (!make_volume(frame, draw, err))
                return false;
            break;
        case DRAW_TRACKS: make_tracks(frame, draw); break;
        case DRAW_MARKS: add_marks(frame, draw); break;
        case DRAW_ISOLINES:
            if (!add_line(frame, draw, draw->isolines.lines, draw->color_rgb, draw->isolines.width_px, err))
                return false;
            break;
        case DRAW_OUTLINE:
        case DRAW_CHECK:
        case DRAW_GRID_CUT:
        case DRAW_GRID_BOX:
        case DRAW_STROKES:
        case DRAW_AXES:
        case DRAW_BEAM_EYE: break;
        }
    }
    return true;
}

void soft_frame_finish(struct soft_frame *frame)
{
    for (size_t i = 0; i < frame->n_caps; i++)
        soft_cap_finish(&frame->caps[i]);
    for (size_t i = 0; i < frame->n_outlines; i++)
        free_outline(&frame->outlines[i]);
    if (frame->volume)
        soft_volume_finish(frame->volume);
    free(frame->volume);
    free(frame->tracks);
    free(frame->washes);
    free(frame->paints);
    free(frame->texture);
    free(frame->items);
    free(frame->planes);
    free(frame->marks);
    free(frame->caps);
    free(frame->outlines);
}
