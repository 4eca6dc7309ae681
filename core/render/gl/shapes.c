#include <stdlib.h>

#include "core/base/mem.h"
#include "core/render/gl/draw.h"
#include "core/render/visible/visible.h"

/* One shape to draw. */
struct item {
    const struct gl_shape *shape;
    const struct scene_region_style *style;
    struct visible_look look;
};

static const struct gl_shape *shape_of(const struct gl_frame *frame, size_t region, struct error *err)
{
    struct shape_key key = visible_shape_key(frame->snapshot, region);
    return gl_cache_shape(frame->gl, frame->cache, frame->snapshot->derived, region, &key, frame->detail, err);
}

static const struct box3 *bounds(void *context, size_t region, struct error *err)
{
    const struct gl_shape *shape = shape_of(context, region, err);
    return shape ? &shape->bounds_lps_mm : NULL;
}

/* The shapes that are wanted and can be seen, back to front; is_opaque picks the kind. Gives NULL on failure. */
static struct item *collect(const struct gl_frame *frame, bool is_opaque, size_t *n_items, struct error *err)
{
    const struct snapshot *snapshot = frame->snapshot;
    struct gl_frame context = *frame;
    struct mat4 clip_from_lps_mm;
    for (int i = 0; i < 16; i++)
        clip_from_lps_mm.m[i] = (double)frame->clip_from_lps[i];
    struct visible_shape *visible =
        visible_shapes(snapshot, frame->camera, &clip_from_lps_mm, is_opaque, bounds, &context, n_items, err);
    struct item *items = visible ? mem_array(*n_items, sizeof *items, UINT64_MAX, err) : NULL;
    for (size_t i = 0; items && i < *n_items; i++) {
        struct shape_key key = visible_shape_key(snapshot, visible[i].region);
        const struct gl_shape *shape = shape_of(frame, visible[i].region, err);
        if (!shape) { /* it was there a moment ago, so this does not come about */
            free(items);
            items = NULL;
            break;
        }
        items[i] = (struct item){ shape, visible[i].style, visible_look(snapshot, visible[i].region, &key) };
    }
    free(visible);
    return items;
}

static const struct gl_program *use_program(const struct gl_frame *frame, const struct item *item)
{
    const struct gl *gl = frame->gl;
    const struct camera *camera = frame->camera;
    const struct gl_programs *programs = frame->programs;
    bool is_flat = item->look.is_flat || item->shape->is_faceted;
    const struct gl_program *program = item->shape->kind == SHAPE_LINES    ? &programs->lines
                                       : item->shape->kind == SHAPE_POINTS ? &programs->points
                                       : is_flat                           ? &programs->faceted
                                                                           : &programs->smooth;
    const struct vec3 *r = &camera->right, *u = &camera->up, *f = &camera->forward, *e = &camera->eye_lps_mm;
    const float eye_from_lps[9] = { (float)r->x,  (float)u->x, (float)-f->x, (float)r->y, (float)u->y,
                                    (float)-f->y, (float)r->z, (float)u->z,  (float)-f->z };
    uint32_t rgb = item->style->color_rgb;
    gl->UseProgram(program->name);
    gl->UniformMatrix4fv(program->clip_from_lps, 1, GL_FALSE, frame->clip_from_lps);
    gl->UniformMatrix3fv(program->eye_from_lps, 1, GL_FALSE, eye_from_lps);
    if (camera->is_parallel)
        gl->Uniform4f(program->viewer, (float)-f->x, (float)-f->y, (float)-f->z, 0);
    else
        gl->Uniform4f(program->viewer, (float)e->x, (float)e->y, (float)e->z, 1);
    gl->Uniform4f(program->color, (float)(rgb >> 16 & 255) / 255.0f, (float)(rgb >> 8 & 255) / 255.0f,
                  (float)(rgb & 255) / 255.0f, 1);
    gl->Uniform1f(program->opacity, (float)item->style->opacity);
    gl->Uniform1i(program->is_rim, item->look.is_rim);
    gl->Uniform1i(program->is_two_sided, item->look.is_two_sided);
    gl->Uniform1f(program->rounding, (float)item->look.rounding);
    return program;
}

static void draw_triangles(const struct gl_frame *frame, const struct item *item)
{
    const struct gl *gl = frame->gl;
    gl->FrontFace(GL_CW); /* counter-clockwise, in a picture drawn upside down */
    gl->CullFace(GL_BACK);
    if (!item->look.is_two_sided)
        gl->Enable(GL_CULL_FACE);
    gl->DrawElements(GL_TRIANGLES, item->shape->n, GL_UNSIGNED_INT, NULL);
    gl->Disable(GL_CULL_FACE);
}

static void draw_rectangles(const struct gl_frame *frame, const struct item *item, const struct gl_program *program)
{
    const struct gl *gl = frame->gl;
    struct visible_cue cue = visible_depth_cue(frame->camera, &item->shape->bounds_lps_mm);
    double samples_per_px = (double)frame->target->width_px / frame->snapshot->view.size_px[0];
    float edges[3][4];
    for (int i = 0; i < 3; i++)
        for (int row = 0; row < 4; row++) {
            const struct vec3 *e = &item->shape->edge_lps_mm[i];
            const float *m = frame->clip_from_lps + row;
            edges[i][row] = m[0] * (float)e->x + m[4] * (float)e->y + m[8] * (float)e->z;
        }
    gl->Uniform2f(program->half_view, (float)frame->target->width_px / 2.0f, (float)frame->target->height_px / 2.0f);
    gl->Uniform1f(program->half_size,
                  (float)(fmax(1, item->look.size_px * samples_per_px) / 2)); /* never gone in a small picture */
    gl->Uniform4f(program->cue, (float)cue.x, (float)cue.y, (float)cue.z, (float)cue.w);
    gl->Uniform4fv(program->edges, 3, &edges[0][0]);
    gl->Uniform1i(program->is_baked, item->look.is_baked);
    gl->Uniform1i(program->is_covering, item->look.is_covering);
    gl->DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, item->shape->n);
}

static void draw_item(const struct gl_frame *frame, const struct item *item)
{
    const struct gl_program *program = use_program(frame, item);
    frame->gl->BindVertexArray(item->shape->vertex_array);
    if (item->shape->kind == SHAPE_TRIANGLES)
        draw_triangles(frame, item);
    else
        draw_rectangles(frame, item, program);
    frame->timing->n_triangles += item->shape->n_triangles;
    frame->timing->is_light |= item->shape->is_light;
}

bool gl_draw_opaque_shapes(const struct gl_frame *frame, struct error *err)
{
    size_t n;
    struct item *items = collect(frame, true, &n, err);
    if (!items)
        return false;
    frame->gl->Enable(GL_DEPTH_TEST);
    for (size_t i = n; i-- > 0;)
        draw_item(frame, &items[i]);
    free(items);
    return gl_check(frame->gl, "drawing opaque shapes", err);
}

/* The layers over the picture. */
static void compose(const struct gl_frame *frame, int n)
{
    const struct gl *gl = frame->gl;
    const struct gl_program *program = &frame->programs->compose;
    bool is_exact = frame->snapshot->scene.surface.translucent_order == SCENE_TRANSLUCENT_ORDER_EXACT;
    gl->BindFramebuffer(GL_FRAMEBUFFER, frame->target->over);
    gl->Disable(GL_DEPTH_TEST);
    gl->Enable(GL_BLEND);
    gl->BlendFuncSeparate(GL_ONE, GL_SRC_ALPHA, GL_ZERO, GL_ONE);
    gl->UseProgram(program->name);
    gl->Uniform1i(program->source, 0);
    gl->Uniform1i(program->depths, 1);
    gl->Uniform1i(program->before, 2);
    gl->Uniform1i(program->n_layers, n);
    gl->Uniform1f(program->rank_depth, is_exact ? (float)VISIBLE_RANK_DEPTH : 0);
    gl->ActiveTexture(GL_TEXTURE2);
    gl->BindTexture(GL_TEXTURE_2D, frame->target->depth);
    gl->ActiveTexture(GL_TEXTURE1);
    gl->BindTexture(GL_TEXTURE_2D_ARRAY, frame->layers->depth);
    gl->ActiveTexture(GL_TEXTURE0);
    gl->BindTexture(GL_TEXTURE_2D_ARRAY, frame->layers->color);
    gl->BindVertexArray(frame->no_vertices);
    gl->DrawArrays(GL_TRIANGLES, 0, 3);
    gl->BindTexture(GL_TEXTURE_2D_ARRAY, 0);
    gl->ActiveTexture(GL_TEXTURE1);
    gl->BindTexture(GL_TEXTURE_2D_ARRAY, 0);
    gl->ActiveTexture(GL_TEXTURE2);
    gl->BindTexture(GL_TEXTURE_2D, 0);
    gl->ActiveTexture(GL_TEXTURE0);
    gl->Disable(GL_BLEND);
    gl->BindFramebuffer(GL_FRAMEBUFFER, frame->target->framebuffer);
}

bool gl_draw_translucent_shapes(const struct gl_frame *frame, struct error *err)
{
    size_t n;
    struct item *items = collect(frame, false, &n, err);
    if (!items)
        return false;
    bool is_good = n == 0 || gl_layers_resize(frame->gl, frame->layers, frame->target,
                                              n < GL_LAYERS_MAX ? (int)n : GL_LAYERS_MAX, err);
    for (size_t first = 0; is_good && first < n; first += GL_LAYERS_MAX) {
        int n_here = n - first < GL_LAYERS_MAX ? (int)(n - first) : GL_LAYERS_MAX;
        frame->gl->Enable(GL_DEPTH_TEST);
        for (int i = 0; i < n_here; i++) {
            gl_layers_bind(frame->gl, frame->layers, i);
            draw_item(frame, &items[first + (size_t)i]);
        }
        compose(frame, n_here);
    }
    free(items);
    return is_good && gl_check(frame->gl, "drawing translucent shapes", err);
}
