/* Draws a volume by OpenGL: the uniforms and textures of the program that composes it with the translucent layers. */
#include <float.h>
#include <string.h>

#include "core/render/gl/draw.h"

/* Units of the textures; those of the layers come first. */
enum { UNIT_GRID = 3, UNIT_TABLE = 4 };

static void set_vector(const struct gl *gl, GLint uniform, struct vec3 v, double w)
{
    gl->Uniform4f(uniform, (float)v.x, (float)v.y, (float)v.z, (float)w);
}

static void set_columns(const struct gl *gl, GLint uniform, struct vec3 a, struct vec3 b, struct vec3 c)
{
    const float columns[9] = { (float)a.x, (float)a.y, (float)a.z, (float)b.x, (float)b.y,
                               (float)b.z, (float)c.x, (float)c.y, (float)c.z };
    gl->UniformMatrix3fv(uniform, 1, GL_FALSE, columns);
}

/* A row of a matrix times a direction. */
static double row_times(const struct mat4 *matrix, int row, struct vec3 v)
{
    const double *m = matrix->m + row;
    return m[0] * v.x + m[4] * v.y + m[8] * v.z;
}

static void set_rays(const struct gl_frame *frame, const struct gl_program *program)
{
    const struct gl *gl = frame->gl;
    const struct camera *camera = frame->camera;
    const struct mat4 *clip = &camera->clip_from_lps_mm;
    struct vec3 r = camera->right, u = camera->up, f = camera->forward, e = camera->eye_lps_mm;
    gl->Uniform4f(program->picture, (float)frame->target->width_px, (float)frame->n_rows, (float)frame->first_row, 0);
    gl->Uniform4f(program->unproject, (float)row_times(clip, 2, f), (float)(row_times(clip, 2, e) + clip->m[14]),
                  (float)row_times(clip, 3, f), (float)(row_times(clip, 3, e) + clip->m[15]));
    set_vector(gl, program->ray_eye, e, camera->is_parallel);
    set_vector(gl, program->ray_forward, f, 0);
    set_vector(gl, program->ray_right, vec3_scale(r, 1 / row_times(clip, 0, r)), 0);
    set_vector(gl, program->ray_up, vec3_scale(u, 1 / row_times(clip, 1, u)), 0);
    set_columns(gl, program->eye_from_lps, vec3(r.x, u.x, -f.x), vec3(r.y, u.y, -f.y), vec3(r.z, u.z, -f.z));
    gl->Uniform1i(program->samples, frame->list->samples);
}

static void set_grid(const struct gl_frame *frame, const struct gl_program *program, const struct grid *grid)
{
    const struct gl *gl = frame->gl;
    const struct affine *ijk_from_lps = &grid->ijk_from_lps_mm;
    set_columns(gl, program->ijk_from_lps, ijk_from_lps->columns[0], ijk_from_lps->columns[1],
                ijk_from_lps->columns[2]);
    set_vector(gl, program->eye_ijk, affine_point(ijk_from_lps, frame->camera->eye_lps_mm), 0);
    gl->Uniform4f(program->size, (float)grid->size[0], (float)grid->size[1], (float)grid->size[2], 0);
}

/* Where the planes of the method slices are along forward. */
static void set_sheets(const struct gl_frame *frame, const struct gl_program *program, const struct grid *grid, int n)
{
    const struct camera *camera = frame->camera;
    double low = INFINITY, high = -INFINITY;
    for (int corner = 0; corner < 8; corner++) {
        struct vec3 p = affine_point(&grid->lps_mm_from_ijk, vec3(corner & 1 ? grid->size[0] - 0.5 : -0.5,
                                                                  corner & 2 ? grid->size[1] - 0.5 : -0.5,
                                                                  corner & 4 ? grid->size[2] - 0.5 : -0.5));
        double z = vec3_dot(vec3_sub(p, camera->eye_lps_mm), camera->forward);
        low = fmin(low, z);
        high = fmax(high, z);
    }
    double spacing = (high - low) / n;
    frame->gl->Uniform4f(program->sheets, (float)(low + spacing / 2), (float)spacing, (float)n, 0);
}

static void set_clips(const struct gl_frame *frame, const struct gl_program *program, const struct clip_set *clip)
{
    float clips[CLIP_MAX][4];
    int n = 0, capped = 0;
    for (size_t i = 0; i < clip->n_planes; i++) {
        const struct plane *plane = &clip->planes[i].plane;
        if (clip->left_out >> i & 1)
            continue;
        capped |= (int)clip->planes[i].is_capped << n;
        clips[n][0] = (float)plane->normal.x;
        clips[n][1] = (float)plane->normal.y;
        clips[n][2] = (float)plane->normal.z;
        clips[n++][3] = (float)(plane_height_mm(plane, frame->camera->eye_lps_mm) - CLIP_SLACK_MM);
    }
    frame->gl->Uniform1i(program->capped, capped);
    frame->gl->Uniform1i(program->n_clips, n);
    if (n > 0)
        frame->gl->Uniform4fv(program->clips, n, &clips[0][0]);
}

/* Rows of the texture `table`: colours and absorptions of the transfer function; colours of the image's levels. */
static void bind_table(const struct gl_frame *frame, const struct gl_program *program, const struct draw_volume *volume)
{
    const struct gl *gl = frame->gl;
    float rows[2][DRAW_VOLUME_TABLE][4] = { 0 };
    if (volume->table)
        memcpy(rows[0], volume->table, sizeof rows[0]);
    for (uint32_t level = 0; level < 256; level++)
        for (int c = 0; c < 3; c++)
            rows[1][level][c] =
                (float)(volume->image.colors ? volume->image.colors[level] >> 8 * c & 255 : level) / 255.0f;
    gl->ActiveTexture(GL_TEXTURE0 + UNIT_TABLE);
    gl->BindTexture(GL_TEXTURE_2D, frame->transfer);
    gl->Uniform1i(program->table, UNIT_TABLE);
    gl->TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, DRAW_VOLUME_TABLE, 2, 0, GL_RGBA, GL_FLOAT, rows);
}

bool gl_set_volume(const struct gl_frame *frame, const struct gl_program *program, const struct draw *draw,
                   struct error *err)
{
    const struct gl *gl = frame->gl;
    const struct draw_volume *volume = &draw->volume;
    const struct draw_image *image = &volume->image;
    const struct grid *grid = &frame->plan->images[draw->subject.index].volume->grid;
    const struct gl_grid *texels =
        (const struct gl_grid *)draw_cache_grid(frame->cache, frame->plan, draw->subject, err);
    if (!texels)
        return false;
    set_rays(frame, program);
    set_grid(frame, program, grid);
    set_sheets(frame, program, grid, volume->n_slices);
    set_clips(frame, program, &draw->clip);
    gl->Uniform1i(program->method, (GLint)volume->method);
    gl->Uniform1i(program->is_linear, volume->is_linear);
    gl->Uniform1i(program->is_shaded, volume->is_shaded);
    gl->Uniform4f(program->values, (float)texels->value_per_unit, (float)texels->value_at_zero, (float)volume->low,
                  (float)((DRAW_VOLUME_TABLE - 1) / (volume->width > 0 ? volume->width : 1)));
    gl->Uniform4f(program->march, (float)volume->step_voxels, (float)volume->step_limit_mm,
                  (float)frame->camera->near_mm, (float)volume->gradient);
    gl->Uniform1f(program->cull, (float)fmax(volume->cull, -(double)FLT_MAX));
    gl->Uniform2f(program->grey, (float)(1 / image->width), (float)(-image->low / image->width));
    gl->Uniform2f(program->ends, image->is_low_white ? 1 : 0, image->is_low_white ? 0 : 1);
    gl->Uniform1f(program->tone, (float)(1 / image->gamma));
    gl_set_lights(frame, program);
    const struct draw_wash *wash = volume->wash ? volume->wash : image->wash;
    if (wash && !gl_set_wash(frame, program, wash, &grid->lps_mm_from_ijk, err))
        return false;
    gl->Uniform1i(program->is_face_washed, image->wash != NULL);
    gl->Uniform1i(program->is_ray_washed, volume->wash != NULL);
    bind_table(frame, program, volume);
    gl->ActiveTexture(GL_TEXTURE0 + UNIT_GRID);
    gl->BindTexture(GL_TEXTURE_3D, texels->texture);
    gl->TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    gl->TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl->Uniform1i(program->grid, UNIT_GRID);
    return gl_check(gl, "setting up a volume", err);
}

void gl_unset_volume(const struct gl_frame *frame)
{
    const struct gl *gl = frame->gl;
    gl->ActiveTexture(GL_TEXTURE0 + UNIT_GRID);
    gl->TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_NEAREST); /* slices read the same texture */
    gl->TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl->BindTexture(GL_TEXTURE_3D, 0);
    gl->ActiveTexture(GL_TEXTURE0 + UNIT_TABLE);
    gl->BindTexture(GL_TEXTURE_2D, 0);
    gl->ActiveTexture(GL_TEXTURE0);
}

bool gl_draw_volume_depth(const struct gl_frame *frame, const struct draw *draw, struct error *err)
{
    const struct gl *gl = frame->gl;
    const struct gl_program *program = &frame->programs->volume_depth;
    if (!gl_layers_resize(gl, frame->layers, frame->target, 1, err))
        return false;
    gl_layers_bind(gl, frame->layers, 0);
    gl->UseProgram(program->name);
    if (!gl_set_volume(frame, program, draw, err))
        return false;
    gl->Uniform1i(program->before, 0);
    gl->ActiveTexture(GL_TEXTURE0);
    gl->BindTexture(GL_TEXTURE_2D, frame->target->depth);
    gl->Enable(GL_DEPTH_TEST);
    gl->BindVertexArray(frame->no_vertices);
    gl->DrawArrays(GL_TRIANGLES, 0, 3);
    gl->BindTexture(GL_TEXTURE_2D, 0);
    gl_unset_volume(frame);
    return gl_check(gl, "drawing the depths of a volume", err);
}
