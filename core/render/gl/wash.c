/* Draws colourwashes by OpenGL: over planes, and the textures of shapes. */
#include <string.h>

#include "core/render/gl/draw.h"
#include "core/render/visible/draw_wash.h"

/* Units of the textures; those of an image come first. */
enum { UNIT_IMAGE = 0, UNIT_COLORS = 1, UNIT_ROWS = 5, UNIT_TISSUE = 6 };

/* Bit of the stencil: the image is seen. */
enum { STENCIL_SEEN = 1 };

enum { KNOTS = (DRAW_WASH_MAX_KNOTS + 3) / 4 };
_Static_assert(KNOTS == 10 && DRAW_WASH_MAX_KNOTS == 40, "the shader has room for all knots");

static void set_map(const struct gl *gl, GLint uniform, const struct affine *map)
{
    const struct vec3 columns[4] = { map->columns[0], map->columns[1], map->columns[2], map->origin };
    float matrix[16];
    for (int c = 0; c < 4; c++) {
        matrix[4 * c] = (float)columns[c].x;
        matrix[4 * c + 1] = (float)columns[c].y;
        matrix[4 * c + 2] = (float)columns[c].z;
        matrix[4 * c + 3] = c == 3;
    }
    gl->UniformMatrix4fv(uniform, 1, GL_FALSE, matrix);
}

static void set_size(const struct gl *gl, GLint uniform, const struct grid *grid, int w)
{
    gl->Uniform4f(uniform, (float)grid->size[0], (float)grid->size[1], (float)grid->size[2], (float)w);
}

static void set_knots(const struct gl *gl, const struct gl_program *program, const struct draw_wash *wash)
{
    float knots[KNOTS][4] = { 0 };
    memcpy(knots, wash->knots, (size_t)wash->n_knots * sizeof wash->knots[0]);
    gl->Uniform1i(program->n_knots, wash->n_knots);
    gl->Uniform4fv(program->knots, KNOTS, &knots[0][0]);
    gl->Uniform4fv(program->knot_colors, wash->n_knots, &wash->colors[0][0]);
    gl->Uniform4fv(program->knot_rises, wash->n_knots, &wash->rises[0][0]);
}

struct affine gl_lps_from_faces(const struct grid *grid)
{
    const struct affine *map = &grid->lps_mm_from_ijk;
    return (struct affine){ { vec3_scale(map->columns[0], grid->size[0]), vec3_scale(map->columns[1], grid->size[1]),
                              vec3_scale(map->columns[2], grid->size[2]) },
                            affine_point(map, vec3(-0.5, -0.5, -0.5)) };
}

bool gl_set_wash(const struct gl_frame *frame, const struct gl_program *program, const struct draw_wash *wash,
                 const struct affine *lps_from_place, struct error *err)
{
    const struct gl *gl = frame->gl;
    gl->Uniform1i(program->wash_rows, UNIT_ROWS);
    gl->Uniform1i(program->wash_tissue, UNIT_TISSUE);
    if (!wash)
        return true;
    const struct gl_grid *rows = (const struct gl_grid *)draw_cache_volumes(frame->cache, frame->plan, wash->rows,
                                                                            wash->n_rows, false, err),
                         *tissue = NULL;
    if (rows && wash->tissue)
        tissue = (const struct gl_grid *)draw_cache_volumes(frame->cache, frame->plan, &wash->tissue, 1, true, err);
    if (!rows || (wash->tissue && !tissue))
        return false;
    const struct grid *grid = &wash->rows[0]->grid, *tissues = wash->tissue ? &wash->tissue->grid : grid;
    const struct affine to_rows = affine_compose(&grid->ijk_from_lps_mm, lps_from_place),
                        to_tissue = affine_compose(&tissues->ijk_from_lps_mm, lps_from_place);
    set_map(gl, program->wash_from_place, &to_rows);
    set_map(gl, program->tissue_from_place, &to_tissue);
    set_size(gl, program->wash_size, grid, rows->n_along_z);
    set_size(gl, program->tissue_size, tissues, wash->tissue != NULL);
    gl->Uniform1i(program->n_rows, (GLint)wash->n_rows);
    gl->Uniform1i(program->is_per_slice, wash->is_per_slice);
    set_knots(gl, program, wash);
    gl->ActiveTexture(GL_TEXTURE0 + UNIT_ROWS);
    gl->BindTexture(GL_TEXTURE_3D, rows->texture);
    gl->ActiveTexture(GL_TEXTURE0 + UNIT_TISSUE);
    gl->BindTexture(GL_TEXTURE_3D, tissue ? tissue->texture : 0);
    gl->ActiveTexture(GL_TEXTURE0);
    return true;
}

/* ---- planes ----------------------------------------------------------------------------------------------------- */

bool gl_paint_wash(const struct gl_frame *frame, const struct draw_wash *wash, const struct plane *plane,
                   const struct clip_set *clip, struct error *err)
{
    const struct gl *gl = frame->gl;
    const struct gl_program *program = &frame->programs->wash;
    const struct grid *grid = &wash->rows[0]->grid;
    struct gl_polygon polygon = gl_slice_polygon(grid, plane, clip);
    if (polygon.n < 3)
        return true;
    const struct affine lps_from_at = gl_lps_from_faces(grid);
    gl->UseProgram(program->name);
    gl->UniformMatrix4fv(program->clip_from_lps, 1, GL_FALSE, frame->clip_from_lps);
    if (!gl_set_wash(frame, program, wash, &lps_from_at, err))
        return false;
    gl->Enable(GL_BLEND);
    gl->BlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
    gl_draw_polygon(frame, grid, &polygon);
    gl->Disable(GL_BLEND);
    return gl_check(gl, "drawing a wash", err);
}

bool gl_draw_wash(const struct gl_frame *frame, const struct draw *draw, struct error *err)
{
    return gl_paint_wash(frame, draw->wash, &draw->plane, &draw->clip, err);
}

/* The wash lies where the image is drawn, which the stencil keeps. */
bool gl_draw_image(const struct gl_frame *frame, const struct draw *draw, struct error *err)
{
    const struct gl *gl = frame->gl;
    if (!draw->image.wash)
        return gl_draw_bare_image(frame, draw, err);
    gl->Enable(GL_STENCIL_TEST);
    gl->StencilMask(0xff);
    gl->Clear(GL_STENCIL_BUFFER_BIT);
    gl->StencilFunc(GL_ALWAYS, STENCIL_SEEN, 0xff);
    gl->StencilOp(GL_KEEP, GL_KEEP, GL_REPLACE);
    bool is_good = gl_draw_bare_image(frame, draw, err);
    gl->StencilFunc(GL_EQUAL, STENCIL_SEEN, 0xff);
    gl->StencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
    gl->Disable(GL_DEPTH_TEST);
    is_good = is_good && gl_paint_wash(frame, draw->image.wash, &draw->plane, &draw->clip, err);
    if (draw->depth != DRAW_DEPTH_NONE)
        gl->Enable(GL_DEPTH_TEST);
    gl->Disable(GL_STENCIL_TEST);
    return is_good;
}

/* ---- shapes ----------------------------------------------------------------------------------------------------- */

static bool set_image(const struct gl_frame *frame, const struct gl_program *program,
                      const struct draw_texture *texture, struct error *err)
{
    const struct gl *gl = frame->gl;
    const struct grid *grid = &frame->plan->images[texture->image_index].volume->grid;
    const struct draw_image *image = &texture->image;
    const struct affine lps_from_faces = gl_lps_from_faces(grid);
    struct affine faces_from_lps = { 0 };
    const struct gl_grid *texels =
        (const struct gl_grid *)draw_cache_grid(frame->cache, frame->plan,
                                                (struct subject){ SUBJECT_IMAGE, texture->image_index, 0 }, err);
    if (!texels || !affine_invert(&lps_from_faces, &faces_from_lps))
        return false;
    set_map(gl, program->source_from_lps, &faces_from_lps);
    gl_set_window(gl, (struct gl_window){ program->grey, program->ends, program->tone }, texels, image);
    gl->Uniform1i(program->is_linear, image->is_linear);
    gl_bind_colors(frame, UNIT_COLORS, image->colors, NULL);
    gl->ActiveTexture(GL_TEXTURE0 + UNIT_IMAGE);
    gl->BindTexture(GL_TEXTURE_3D, texels->texture);
    return true;
}

bool gl_set_texture(const struct gl_frame *frame, const struct gl_program *program, const struct draw *draw,
                    struct error *err)
{
    const struct gl *gl = frame->gl;
    const struct draw_texture *texture = &draw->shape.texture;
    const struct affine same = { { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, { 0, 0, 0 } };
    const bool is_washed = texture->kind == SCENE_TEXTURE_DOSE;
    uint32_t rgb = draw->color_rgb;
    gl->Uniform1i(program->is_washed, is_washed);
    gl->Uniform1i(program->source, UNIT_IMAGE);
    gl->Uniform1i(program->palette, UNIT_COLORS);
    if (!gl_set_wash(frame, program, is_washed ? texture->wash : NULL, &same, err))
        return false;
    if (is_washed)
        return true;
    gl->Uniform4f(program->color, 1, 1, 1, 1);
    gl->Uniform4f(program->region_color, (float)(rgb >> 16 & 255) / 255.0f, (float)(rgb >> 8 & 255) / 255.0f,
                  (float)(rgb & 255) / 255.0f, 1);
    return set_image(frame, program, texture, err);
}
