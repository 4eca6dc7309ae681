/* Draws caps by OpenGL: the inside of outlines by stencil parity, then the image where it is seen; and lines in planes.
 */
#include <math.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/render/gl/draw.h"
#include "core/render/gl/polygon.h"

/* Bits of the stencil. */
enum { STENCIL_INSIDE = 1, STENCIL_SEEN = 2 };

/* The rectangle around all outlines of a cap, in its plane. */
static struct plane_reach reach_of(const struct draw *draw)
{
    const struct draw_cap *cap = &draw->cap;
    struct box3 box = box3_empty();
    for (size_t r = 0; r < cap->n_regions; r++)
        for (size_t i = 0; i < 2 * cap->regions[r].lines->n; i++) {
            const double *p = cap->regions[r].lines->ends_lps_mm[i / 2][i % 2];
            box3_add(&box, vec3(p[0], p[1], p[2]));
        }
    return plane_reach(&draw->plane, &box);
}

/* Uploads the outlines of a region as instances. */
static bool send_segments(const struct gl_frame *frame, const struct cut_lines *lines, struct error *err)
{
    float *ends = mem_array(lines->n, 6 * sizeof *ends, UINT64_MAX, err);
    if (!ends)
        return false;
    for (size_t i = 0; i < 6 * lines->n; i++)
        ends[i] = (float)lines->ends_lps_mm[i / 6][i / 3 % 2][i % 3];
    frame->gl->BindVertexArray(frame->segment_array);
    frame->gl->BindBuffer(GL_ARRAY_BUFFER, frame->segments);
    frame->gl->BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(6 * lines->n * sizeof *ends), ends, GL_STREAM_DRAW);
    free(ends);
    return true;
}

/* Sets STENCIL_INSIDE where an odd number of triangles from the anchor to the segments lies. cleared: bits that are
 * cleared before. */
static void mark_inside(const struct gl_frame *frame, size_t n_segments, struct vec3 anchor, GLuint cleared)
{
    const struct gl *gl = frame->gl;
    const struct gl_program *program = &frame->programs->fan;
    gl->StencilMask(cleared);
    gl->Clear(GL_STENCIL_BUFFER_BIT);
    gl->ColorMask(0, 0, 0, 0);
    gl->Disable(GL_DEPTH_TEST);
    gl->StencilMask(STENCIL_INSIDE);
    gl->StencilFunc(GL_ALWAYS, 0, 0xff);
    gl->StencilOp(GL_KEEP, GL_KEEP, GL_INVERT);
    gl->UseProgram(program->name);
    gl->UniformMatrix4fv(program->clip_from_lps, 1, GL_FALSE, frame->clip_from_lps);
    gl->Uniform4f(program->anchor, (float)anchor.x, (float)anchor.y, (float)anchor.z, 1);
    gl->DrawArraysInstanced(GL_TRIANGLES, 0, 3, (GLsizei)n_segments);
    gl->ColorMask(1, 1, 1, 1);
}

static void draw_plain(const struct gl_frame *frame, const struct gl_polygon *polygon, uint32_t rgb, double opacity)
{
    const struct gl *gl = frame->gl;
    const struct gl_program *program = &frame->programs->plain;
    float vertices[GL_POLYGON_CORNERS][6] = { { 0 } };
    for (int i = 0; i < polygon->n; i++) {
        vertices[i][0] = (float)polygon->lps_mm[i].x;
        vertices[i][1] = (float)polygon->lps_mm[i].y;
        vertices[i][2] = (float)polygon->lps_mm[i].z;
    }
    gl->UseProgram(program->name);
    gl->UniformMatrix4fv(program->clip_from_lps, 1, GL_FALSE, frame->clip_from_lps);
    gl->Uniform4f(program->color, (float)(rgb >> 16 & 255) / 255.0f, (float)(rgb >> 8 & 255) / 255.0f,
                  (float)(rgb & 255) / 255.0f, 1);
    gl->Uniform1f(program->opacity, (float)opacity);
    gl->BindVertexArray(frame->polygon_array);
    gl->BindBuffer(GL_ARRAY_BUFFER, frame->polygon);
    gl->BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)((size_t)polygon->n * sizeof vertices[0]), vertices, GL_STREAM_DRAW);
    gl->DrawArrays(GL_TRIANGLE_FAN, 0, polygon->n);
}

/* Fills what is inside and not hidden with the dark colour, a little nearer than its plane, and marks it
 * STENCIL_SEEN. */
static void fill_dark(const struct gl_frame *frame, const struct gl_polygon *polygon)
{
    const struct gl *gl = frame->gl;
    gl->Enable(GL_DEPTH_TEST);
    gl->DepthFunc(GL_LEQUAL);
    gl->Enable(GL_POLYGON_OFFSET_FILL);
    gl->PolygonOffset(0, (float)-ceil(VISIBLE_CAP_DEPTH * (1 << 24))); /* in steps of a depth of 24 bits */
    gl->StencilMask(STENCIL_SEEN);
    gl->StencilFunc(GL_EQUAL, STENCIL_INSIDE | STENCIL_SEEN, STENCIL_INSIDE);
    gl->StencilOp(GL_KEEP, GL_KEEP, GL_REPLACE);
    draw_plain(frame, polygon, DRAW_CAP_DARK, 1);
    gl->Disable(GL_POLYGON_OFFSET_FILL);
    gl->DepthFunc(GL_LESS);
}

/* Paints the image and the region's colour where the cap is seen. */
static bool paint_seen(const struct gl_frame *frame, const struct draw *draw, const struct draw_cap_region *region,
                       const struct gl_polygon *polygon, struct error *err)
{
    const struct gl *gl = frame->gl;
    struct draw as_image = *draw;
    as_image.kind = DRAW_IMAGE;
    as_image.image = draw->cap.image;
    gl->Disable(GL_DEPTH_TEST);
    gl->StencilFunc(GL_EQUAL, STENCIL_SEEN, STENCIL_SEEN);
    gl->StencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
    if (draw->cap.has_image && !gl_draw_bare_image(frame, &as_image, err))
        return false;
    if (draw->cap.tint > 0) {
        gl->Enable(GL_BLEND);
        gl->BlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
        draw_plain(frame, polygon, region->color_rgb, draw->cap.tint);
        gl->Disable(GL_BLEND);
    }
    return !draw->cap.image.wash || gl_paint_wash(frame, draw->cap.image.wash, &draw->plane, &draw->clip, err);
}

static bool draw_lines(const struct gl_frame *frame, const struct draw *like, const struct cut_lines *lines,
                       uint32_t rgb, double width_px, struct error *err)
{
    const struct gl_shape shape = {
        .base = { .bounds_lps_mm = { { -INFINITY, -INFINITY, -INFINITY }, { INFINITY, INFINITY, INFINITY } } },
        .kind = SHAPE_LINES,
        .vertex_array = frame->segment_array,
        .n = (GLsizei)lines->n,
    };
    const struct draw line = {
        .clip = like->clip,
        .color_rgb = rgb,
        .opacity = 1,
        .shape = { .drawable = &shape.base, .look = { .size_px = width_px }, .cue = { .w = 1 } },
    };
    return send_segments(frame, lines, err) && gl_draw_shapes(frame, &line, 1, err);
}

bool gl_draw_isolines(const struct gl_frame *frame, const struct draw *draw, struct error *err)
{
    return draw_lines(frame, draw, draw->isolines.lines, draw->color_rgb, draw->isolines.width_px, err);
}

bool gl_draw_cap(const struct gl_frame *frame, const struct draw *draw, struct error *err)
{
    const struct gl *gl = frame->gl;
    const struct draw_cap *cap = &draw->cap;
    bool is_good = true;
    const struct plane_reach reach = reach_of(draw);
    struct gl_polygon polygon = gl_polygon_of_reach(&draw->plane, &reach);
    const struct vec3 anchor = polygon.lps_mm[0];
    gl_polygon_clip(&polygon, &draw->clip);
    gl->Enable(GL_STENCIL_TEST);
    for (size_t r = 0; is_good && polygon.n >= 3 && r < cap->n_regions; r++) {
        const struct draw_cap_region *region = &cap->regions[r];
        is_good = send_segments(frame, region->lines, err);
        if (!is_good)
            break;
        mark_inside(frame, region->lines->n, anchor, r > 0 && cap->tint <= 0 ? STENCIL_INSIDE : 0xff);
        fill_dark(frame, &polygon);
        if (cap->tint > 0 || r + 1 == cap->n_regions) /* without colours of regions the image is painted once */
            is_good = paint_seen(frame, draw, region, &polygon, err);
    }
    gl->Disable(GL_STENCIL_TEST);
    gl->StencilMask(0xff);
    gl->Enable(GL_DEPTH_TEST);
    for (size_t r = 0; is_good && cap->outline_px > 0 && r < cap->n_regions; r++)
        is_good = draw_lines(frame, draw, cap->regions[r].lines, cap->regions[r].color_rgb, cap->outline_px, err);
    return is_good && gl_check(gl, "drawing a cap", err);
}
