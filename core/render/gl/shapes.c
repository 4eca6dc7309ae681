/* Draws shapes by OpenGL: triangles, lines and points, and the composition of translucent layers. */
#include "core/render/gl/draw.h"

#include <stdlib.h>

#include "core/base/mem.h"
#include "core/render/visible/draw_clip.h"
#include "core/render/visible/visible.h"

static const struct gl_shape *shape_of(const struct draw *draw)
{
    return (const struct gl_shape *)draw->shape.drawable;
}

/* A capped plane cuts off what lies in it, which the cap covers; another one does not. Wider than single precision
 * rounds heights, narrower than can be seen. */
static const double in_plane_mm = 1e-4;

/* Sets the program's clip planes to those that cut the draw; returns how many. */
static int set_clips(const struct gl_frame *frame, const struct gl_program *program, const struct clip_set *clip)
{
    float planes[CLIP_MAX][4];
    int n = 0;
    for (size_t i = 0; i < clip->n_planes; i++) {
        if (!clip_set_has(clip, i))
            continue;
        const struct plane *plane = &clip->planes[i].plane;
        planes[n][0] = -(float)plane->normal.x;
        planes[n][1] = -(float)plane->normal.y;
        planes[n][2] = -(float)plane->normal.z;
        planes[n++][3] = (float)(plane_position_mm(plane) + (clip->planes[i].is_capped ? 0 : in_plane_mm));
    }
    frame->gl->Uniform1i(program->n_clips, n);
    if (n > 0)
        frame->gl->Uniform4fv(program->clips, n, &planes[0][0]);
    return n;
}

static const struct gl_program *program_of(const struct gl_programs *programs, const struct draw *draw)
{
    const struct gl_shape *shape = shape_of(draw);
    bool is_flat = draw->shape.look.is_flat || shape->is_faceted, has_clips = draw_clip_cuts(&draw->clip);
    if (shape->kind == SHAPE_LINES)
        return &programs->lines;
    if (shape->kind == SHAPE_POINTS)
        return &programs->points;
    if (draw->shape.texture.kind != SCENE_TEXTURE_NONE)
        return is_flat ? &programs->faceted_textured : &programs->smooth_textured;
    if (has_clips)
        return is_flat ? &programs->faceted_clipped : &programs->smooth_clipped;
    return is_flat ? &programs->faceted : &programs->smooth;
}

static const struct gl_program *use_program(const struct gl_frame *frame, const struct draw *draw)
{
    const struct gl *gl = frame->gl;
    const struct camera *camera = frame->camera;
    const struct gl_program *program = program_of(frame->programs, draw);
    const struct vec3 *r = &camera->right, *u = &camera->up, *f = &camera->forward, *e = &camera->eye_lps_mm;
    const float eye_from_lps[9] = { (float)r->x,  (float)u->x, (float)-f->x, (float)r->y, (float)u->y,
                                    (float)-f->y, (float)r->z, (float)u->z,  (float)-f->z };
    uint32_t rgb = draw->color_rgb;
    gl->UseProgram(program->name);
    gl->UniformMatrix4fv(program->clip_from_lps, 1, GL_FALSE, frame->clip_from_lps);
    gl->UniformMatrix3fv(program->eye_from_lps, 1, GL_FALSE, eye_from_lps);
    if (camera->is_parallel)
        gl->Uniform4f(program->viewer, (float)-f->x, (float)-f->y, (float)-f->z, 0);
    else
        gl->Uniform4f(program->viewer, (float)e->x, (float)e->y, (float)e->z, 1);
    gl->Uniform4f(program->color, (float)(rgb >> 16 & 255) / 255.0f, (float)(rgb >> 8 & 255) / 255.0f,
                  (float)(rgb & 255) / 255.0f, 1);
    gl->Uniform1f(program->opacity, (float)draw->opacity);
    gl_set_lights(frame, program);
    gl->Uniform1i(program->is_rim, draw->shape.look.is_rim);
    gl->Uniform1i(program->is_two_sided, draw->shape.look.is_two_sided);
    gl->Uniform1f(program->rounding, (float)draw->shape.look.rounding);
    return program;
}

static void draw_triangles(const struct gl_frame *frame, const struct draw *draw, int n_clips)
{
    const struct gl *gl = frame->gl;
    const struct gl_shape *shape = shape_of(draw);
    for (int i = 0; i < n_clips; i++)
        gl->Enable(GL_CLIP_DISTANCE0 + (GLenum)i);
    gl->FrontFace(GL_CW); /* counter-clockwise in patient space, but the picture is drawn upside down */
    gl->CullFace(GL_BACK);
    if (!draw->shape.look.is_two_sided)
        gl->Enable(GL_CULL_FACE);
    gl->DrawElements(GL_TRIANGLES, shape->n, GL_UNSIGNED_INT, NULL);
    gl->Disable(GL_CULL_FACE);
    for (int i = 0; i < n_clips; i++)
        gl->Disable(GL_CLIP_DISTANCE0 + (GLenum)i);
}

static void draw_rectangles(const struct gl_frame *frame, const struct draw *draw, const struct gl_program *program)
{
    const struct gl *gl = frame->gl;
    const struct gl_shape *shape = shape_of(draw);
    const struct visible_cue cue = draw->shape.cue;
    double samples_per_px = (double)frame->target->width_px / frame->view_line_width;
    float edges[3][4];
    for (int i = 0; i < 3; i++)
        for (int row = 0; row < 4; row++) {
            const struct vec3 *e = &shape->edge_lps_mm[i];
            const float *m = frame->clip_from_lps + row;
            edges[i][row] = m[0] * (float)e->x + m[4] * (float)e->y + m[8] * (float)e->z;
        }
    gl->Uniform2f(program->half_view, (float)frame->target->width_px / 2.0f, (float)frame->target->height_px / 2.0f);
    gl->Uniform1f(program->half_size, (float)(fmax(1, draw->shape.look.size_px * samples_per_px) /
                                              2)); /* at least a pixel wide in a small picture */
    gl->Uniform4f(program->cue, (float)cue.x, (float)cue.y, (float)cue.z, (float)cue.w);
    gl->Uniform4fv(program->edges, 3, &edges[0][0]);
    gl->Uniform1i(program->is_baked, draw->shape.look.is_baked);
    gl->Uniform1i(program->is_covering, draw->shape.look.is_covering);
    gl->DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, shape->n);
}

static bool draw_shape(const struct gl_frame *frame, const struct draw *draw, struct error *err)
{
    const struct gl_program *program = use_program(frame, draw);
    if (draw->shape.texture.kind != SCENE_TEXTURE_NONE && !gl_set_texture(frame, program, draw, err))
        return false;
    int n_clips = set_clips(frame, program, &draw->clip);
    frame->gl->BindVertexArray(shape_of(draw)->vertex_array);
    if (shape_of(draw)->kind == SHAPE_TRIANGLES)
        draw_triangles(frame, draw, n_clips);
    else
        draw_rectangles(frame, draw, program);
    return true;
}

/* True if the shape can be seen in the band. */
static bool is_in_sight(const struct gl_frame *frame, const struct draw *draw)
{
    struct mat4 clip_from_lps_mm;
    for (int i = 0; i < 16; i++)
        clip_from_lps_mm.m[i] = (double)frame->clip_from_lps[i];
    return !visible_is_out_of_sight(&clip_from_lps_mm, &draw->shape.drawable->bounds_lps_mm);
}

bool gl_draw_shapes(const struct gl_frame *frame, const struct draw *draws, size_t n, struct error *err)
{
    for (size_t i = 0; i < n; i++)
        if (is_in_sight(frame, &draws[i]) && !draw_shape(frame, &draws[i], err))
            return false;
    return gl_check(frame->gl, "drawing opaque shapes", err);
}

/* Composes the first n layers over the picture, with a volume unless it is NULL. */
static bool compose(const struct gl_frame *frame, int n, const struct draw *volume, struct error *err)
{
    const struct gl *gl = frame->gl;
    const struct gl_programs *programs = frame->programs;
    const bool is_washed = volume && (volume->volume.wash || volume->volume.image.wash);
    const struct gl_program *program = is_washed ? &programs->volume_washed
                                       : volume  ? &programs->volume
                                                 : &programs->compose;
    gl->UseProgram(program->name);
    if (volume && !gl_set_volume(frame, program, volume, err))
        return false;
    gl->BindFramebuffer(GL_FRAMEBUFFER, frame->target->over);
    gl->Disable(GL_DEPTH_TEST);
    gl->Enable(GL_BLEND);
    gl->BlendFuncSeparate(GL_ONE, GL_SRC_ALPHA, GL_ZERO, GL_ONE);
    gl->Uniform1i(program->source, 0);
    gl->Uniform1i(program->depths, 1);
    gl->Uniform1i(program->before, 2);
    gl->Uniform1i(program->n_layers, n);
    gl->Uniform1f(program->rank_depth, frame->list->is_order_exact ? (float)VISIBLE_RANK_DEPTH : 0);
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
    if (volume)
        gl_unset_volume(frame);
    gl->Disable(GL_BLEND);
    gl->BindFramebuffer(GL_FRAMEBUFFER, frame->target->framebuffer);
    return true;
}

bool gl_draw_layers(const struct gl_frame *frame, const struct draw *draws, size_t n, struct error *err)
{
    const struct draw **seen = mem_array(n, sizeof *seen, UINT64_MAX, err);
    const struct draw *volume = NULL;
    size_t n_seen = 0;
    for (size_t i = 0; seen && i < n; i++)
        if (draws[i].kind == DRAW_VOLUME)
            volume = &draws[i];
        else if (is_in_sight(frame, &draws[i]))
            seen[n_seen++] = &draws[i];
    bool is_good = seen && (n_seen == 0 || gl_layers_resize(frame->gl, frame->layers, frame->target,
                                                            n_seen < GL_LAYERS_MAX ? (int)n_seen : GL_LAYERS_MAX, err));
    for (size_t first = 0; is_good && (first < n_seen || (first == 0 && volume)); first += GL_LAYERS_MAX) {
        int n_here = n_seen - first < GL_LAYERS_MAX ? (int)(n_seen - first) : GL_LAYERS_MAX;
        frame->gl->Enable(GL_DEPTH_TEST);
        for (int i = 0; is_good && i < n_here; i++) {
            gl_layers_bind(frame->gl, frame->layers, i);
            is_good = draw_shape(frame, seen[first + (size_t)i], err);
        }
        is_good = is_good && compose(frame, n_here, first == 0 ? volume : NULL, err);
    }
    free(seen);
    return is_good && gl_check(frame->gl, "drawing translucent shapes", err);
}
