/* Draws marked univels on planes by OpenGL. */
#include <math.h>

#include "core/render/gl/draw.h"
#include "core/render/visible/visible.h"

/* Bits of the stencil. */
enum { STENCIL_NOT_BEHIND = 1 };

static void set_program(const struct gl_frame *frame, const struct draw *draw)
{
    const struct gl *gl = frame->gl;
    const struct gl_program *program = &frame->programs->marks;
    const uint32_t *size = draw->marks.labels->grid.size, rgb = draw->color_rgb;
    double samples_per_px = (double)frame->target->width_px / frame->view_line_width;
    gl->UseProgram(program->name);
    gl->UniformMatrix4fv(program->clip_from_lps, 1, GL_FALSE, frame->clip_from_lps);
    gl->Uniform4f(program->scale, (float)size[0], (float)size[1], (float)size[2], 0);
    gl->Uniform4f(program->color, (float)(rgb >> 16 & 255) / 255.0f, (float)(rgb >> 8 & 255) / 255.0f,
                  (float)(rgb & 255) / 255.0f, 1);
    gl->Uniform4f(program->stripes, (float)DRAW_MARKS_STRIPE, (float)DRAW_MARKS_BLACK,
                  (float)fmax(2, draw->marks.stripe_px * samples_per_px),
                  (float)fmax(1, draw->marks.edge_px * samples_per_px));
    gl->Uniform1i(program->first_row, frame->first_row);
    gl->Uniform1i(program->source, 0);
}

/* Draws where the picture's depth is the polygon's, within the slack to either side: first sets the stencil where the
 * picture is not farther than the polygon with the slack, then draws there where it is not nearer. */
static void draw_in_plane(const struct gl_frame *frame, const struct grid *grid, const struct gl_polygon *polygon)
{
    const struct gl *gl = frame->gl;
    const float slack = (float)ceil(2 * VISIBLE_CAP_DEPTH * (1 << 24)); /* in steps of a depth of 24 bits */
    gl->Enable(GL_STENCIL_TEST);
    gl->StencilMask(0xff);
    gl->Clear(GL_STENCIL_BUFFER_BIT);
    gl->StencilFunc(GL_ALWAYS, STENCIL_NOT_BEHIND, 0xff);
    gl->StencilOp(GL_KEEP, GL_KEEP, GL_REPLACE);
    gl->Enable(GL_POLYGON_OFFSET_FILL);
    gl->DepthMask(0);
    gl->ColorMask(0, 0, 0, 0);
    gl->PolygonOffset(1, slack);
    gl->DepthFunc(GL_GEQUAL);
    gl_draw_polygon(frame, grid, polygon);
    gl->StencilFunc(GL_EQUAL, STENCIL_NOT_BEHIND, 0xff);
    gl->StencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
    gl->ColorMask(1, 1, 1, 1);
    gl->PolygonOffset(-1, -slack);
    gl->DepthFunc(GL_LEQUAL);
    gl_draw_polygon(frame, grid, polygon);
    gl->DepthFunc(GL_LESS);
    gl->DepthMask(1);
    gl->Disable(GL_POLYGON_OFFSET_FILL);
    gl->Disable(GL_STENCIL_TEST);
}

bool gl_draw_marks(const struct gl_frame *frame, const struct draw *draw, struct error *err)
{
    const struct gl *gl = frame->gl;
    const struct volume *volume = draw->marks.labels;
    struct gl_polygon polygon = gl_slice_polygon(&volume->grid, &draw->plane, &draw->clip);
    if (polygon.n < 3)
        return true;
    const struct gl_grid *labels =
        (const struct gl_grid *)draw_cache_volumes(frame->cache, frame->plan, &volume, 1, true, err);
    if (!labels)
        return false;
    set_program(frame, draw);
    gl->BindTexture(GL_TEXTURE_3D, labels->texture);
    gl->Enable(GL_BLEND);
    gl->BlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
    if (draw->depth == DRAW_DEPTH_TESTED)
        draw_in_plane(frame, &volume->grid, &polygon);
    else
        gl_draw_polygon(frame, &volume->grid, &polygon);
    gl->Disable(GL_BLEND);
    gl->BindTexture(GL_TEXTURE_3D, 0);
    return gl_check(gl, "drawing marks", err);
}
