/* Draws images and label layers on planes by OpenGL, as the polygon where the plane cuts the grid. */
#include "core/render/gl/draw.h"
#include "core/render/gl/polygon.h"
#include "core/render/visible/color_map.h"

void gl_draw_polygon(const struct gl_frame *frame, const struct grid *grid, const struct gl_polygon *polygon)
{
    const struct gl *gl = frame->gl;
    float vertices[GL_POLYGON_CORNERS][6];
    for (int i = 0; i < polygon->n; i++) {
        struct vec3 p = polygon->lps_mm[i], ijk = affine_point(&grid->ijk_from_lps_mm, p);
        vertices[i][0] = (float)p.x;
        vertices[i][1] = (float)p.y;
        vertices[i][2] = (float)p.z;
        vertices[i][3] = (float)((ijk.x + 0.5) / grid->size[0]);
        vertices[i][4] = (float)((ijk.y + 0.5) / grid->size[1]);
        vertices[i][5] = (float)((ijk.z + 0.5) / grid->size[2]);
    }
    gl->BindVertexArray(frame->polygon_array);
    gl->BindBuffer(GL_ARRAY_BUFFER, frame->polygon);
    gl->BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)((size_t)polygon->n * sizeof vertices[0]), vertices, GL_STREAM_DRAW);
    gl->DrawArrays(GL_TRIANGLE_FAN, 0, polygon->n);
}

/* Maps 0..1 over the outer faces of `from` to 0..1 over those of `to`. */
static void place_matrix(const struct grid *to, const struct grid *from, float out[16])
{
    struct affine lps = from->lps_mm_from_ijk, ijk = to->ijk_from_lps_mm;
    const struct vec3 corner = affine_point(&ijk, affine_point(&lps, vec3(-0.5, -0.5, -0.5)));
    const struct vec3 columns[4] = { affine_vector(&ijk, vec3_scale(lps.columns[0], from->size[0])),
                                     affine_vector(&ijk, vec3_scale(lps.columns[1], from->size[1])),
                                     affine_vector(&ijk, vec3_scale(lps.columns[2], from->size[2])),
                                     vec3_add(corner, vec3(0.5, 0.5, 0.5)) };
    for (int c = 0; c < 4; c++) {
        out[4 * c] = (float)(columns[c].x / to->size[0]);
        out[4 * c + 1] = (float)(columns[c].y / to->size[1]);
        out[4 * c + 2] = (float)(columns[c].z / to->size[2]);
        out[4 * c + 3] = c == 3;
    }
}

void gl_set_window(const struct gl *gl, struct gl_window at, const struct gl_grid *texels,
                   const struct draw_image *image)
{
    const double width = image->width;
    gl->Uniform2f(at.grey, (float)(texels->value_per_unit / width),
                  (float)((texels->value_at_zero - image->low) / width));
    gl->Uniform2f(at.ends, image->is_low_white ? 1 : 0, image->is_low_white ? 0 : 1);
    gl->Uniform1f(at.tone, (float)(1 / image->gamma));
}

static struct draw_image window_of(const struct draw_blend *blend)
{
    return (struct draw_image){
        .low = blend->low, .width = blend->width, .gamma = blend->gamma, .is_low_white = blend->is_low_white
    };
}

static void fill_colors(const uint32_t *colors, uint8_t row[4 * COLOR_MAP_LEVELS])
{
    for (int level = 0; level < COLOR_MAP_LEVELS; level++)
        for (int c = 0; c < 4; c++)
            row[4 * level + c] = (uint8_t)(colors ? colors[level] >> 8 * c : (uint32_t)level);
}

void gl_bind_colors(const struct gl_frame *frame, int unit, const uint32_t *first, const uint32_t *second)
{
    const struct gl *gl = frame->gl;
    uint8_t colors[2][4 * COLOR_MAP_LEVELS];
    fill_colors(first, colors[0]);
    fill_colors(second, colors[1]);
    gl->ActiveTexture(GL_TEXTURE0 + (GLenum)unit);
    gl->BindTexture(GL_TEXTURE_2D, frame->palette);
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    gl->TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, COLOR_MAP_LEVELS, 2, 0, GL_RGBA, GL_UNSIGNED_BYTE, colors);
}

/* Sets the uniforms of the program `colors` that `image` does not have. Texture units: 1 colours, 2 second image. */
static bool set_colors(const struct gl_frame *frame, const struct draw *draw, const struct grid *grid,
                       struct error *err)
{
    const struct gl *gl = frame->gl;
    const struct gl_program *program = &frame->programs->colors[draw->image.is_linear];
    const struct draw_blend *blend = &draw->image.blend;
    gl->Uniform1i(program->palette, 1);
    gl->Uniform1i(program->second, 2);
    gl->Uniform1f(program->part, (float)blend->part);
    gl_bind_colors(frame, 1, draw->image.colors, blend->colors);
    if (!(blend->part > 0))
        return true;
    const struct gl_grid *texels =
        (const struct gl_grid *)draw_cache_grid(frame->cache, frame->plan,
                                                (struct subject){ SUBJECT_IMAGE, blend->image, 0 }, err);
    if (!texels)
        return false;
    float matrix[16];
    place_matrix(&frame->plan->images[blend->image].volume->grid, grid, matrix);
    gl->UniformMatrix4fv(program->second_from_at, 1, GL_FALSE, matrix);
    const struct draw_image window = window_of(blend);
    gl_set_window(gl, (struct gl_window){ program->second_grey, program->second_ends, program->second_tone }, texels,
                  &window);
    gl->ActiveTexture(GL_TEXTURE2);
    gl->BindTexture(GL_TEXTURE_3D, texels->texture);
    return true;
}

bool gl_draw_bare_image(const struct gl_frame *frame, const struct draw *draw, struct error *err)
{
    const struct gl *gl = frame->gl;
    const struct draw_image *image = &draw->image;
    const bool has_colors = image->colors || image->blend.part > 0;
    const struct gl_program *program =
        has_colors ? &frame->programs->colors[image->is_linear] : &frame->programs->image[image->is_linear];
    const struct grid *grid = &frame->plan->images[draw->subject.index].volume->grid;
    struct gl_polygon polygon = gl_slice_polygon(grid, &draw->plane, &draw->clip);
    if (polygon.n < 3)
        return true;
    const struct gl_grid *texels =
        (const struct gl_grid *)draw_cache_grid(frame->cache, frame->plan, draw->subject, err);
    if (!texels)
        return false;
    gl->UseProgram(program->name);
    gl->UniformMatrix4fv(program->clip_from_lps, 1, GL_FALSE, frame->clip_from_lps);
    gl_set_window(gl, (struct gl_window){ program->grey, program->ends, program->tone }, texels, image);
    gl->Uniform1f(program->cull, (float)image->cull);
    gl->Uniform1i(program->source, 0);
    if (has_colors && !set_colors(frame, draw, grid, err))
        return false;
    gl->ActiveTexture(GL_TEXTURE0);
    gl->BindTexture(GL_TEXTURE_3D, texels->texture);
    gl_draw_polygon(frame, grid, &polygon);
    gl->BindTexture(GL_TEXTURE_3D, 0);
    return gl_check(gl, "drawing a slice", err);
}

bool gl_draw_labels(const struct gl_frame *frame, const struct draw *draw, struct error *err)
{
    const struct gl *gl = frame->gl;
    const struct gl_program *program = &frame->programs->labels;
    const struct grid *grid = &frame->plan->regions.layers[draw->subject.index]->grid;
    struct gl_polygon polygon = gl_slice_polygon(grid, &draw->plane, &draw->clip);
    if (polygon.n < 3)
        return true;
    const struct gl_grid *labels =
        (const struct gl_grid *)draw_cache_grid(frame->cache, frame->plan, draw->subject, err);
    if (!labels)
        return false;
    gl->UseProgram(program->name);
    gl->UniformMatrix4fv(program->clip_from_lps, 1, GL_FALSE, frame->clip_from_lps);
    gl->Uniform4f(program->scale, (float)grid->size[0], (float)grid->size[1], (float)grid->size[2], 0);
    gl->Uniform1i(program->source, 0);
    gl->Uniform1i(program->palette, 1);
    gl->ActiveTexture(GL_TEXTURE1);
    gl->BindTexture(GL_TEXTURE_2D, frame->palette);
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    gl->TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 256, 256, 0, GL_RGBA, GL_UNSIGNED_BYTE, draw->palette);
    gl->ActiveTexture(GL_TEXTURE0);
    gl->BindTexture(GL_TEXTURE_3D, labels->texture);
    gl_draw_polygon(frame, grid, &polygon);
    gl->BindTexture(GL_TEXTURE_3D, 0);
    return gl_check(gl, "drawing a cross-section", err);
}
