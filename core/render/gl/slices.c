/* Draws images and label layers on planes by OpenGL, as the polygon where the plane cuts the grid. */
#include "core/render/gl/draw.h"

/* The clipping starts from a rectangle, and each of the grid's six faces adds at most one corner. */
enum { MAX_CORNERS = 10 };

struct polygon {
    int n;
    struct vec3 lps_mm[MAX_CORNERS];
};

/* Distance of a point from one of the grid's outer faces, in voxels; positive inside. */
static double inside_face(const struct grid *grid, int face, struct vec3 p_lps_mm)
{
    struct vec3 ijk = affine_point(&grid->ijk_from_lps_mm, p_lps_mm);
    double at = face / 2 == 0 ? ijk.x : face / 2 == 1 ? ijk.y : ijk.z;
    return face % 2 ? grid->size[face / 2] - 0.5 - at : at + 0.5;
}

/* Clips the polygon at one face. Source: I. E. Sutherland, G. W. Hodgman, Reentrant Polygon Clipping, CACM 1974. */
static void clip_face(const struct grid *grid, int face, struct polygon *polygon)
{
    struct polygon kept = { 0 };
    for (int i = 0; i < polygon->n; i++) {
        struct vec3 a = polygon->lps_mm[i], b = polygon->lps_mm[(i + 1) % polygon->n];
        double fa = inside_face(grid, face, a), fb = inside_face(grid, face, b);
        if (fa >= 0 && kept.n < MAX_CORNERS)
            kept.lps_mm[kept.n++] = a;
        if ((fa >= 0) != (fb >= 0) && kept.n < MAX_CORNERS)
            kept.lps_mm[kept.n++] = vec3_add(a, vec3_scale(vec3_sub(b, a), fa / (fa - fb)));
    }
    *polygon = kept;
}

/* The polygon in which a plane cuts a grid's outer faces; n < 3: the plane misses the grid. */
static struct polygon slice_polygon(const struct grid *grid, const struct plane *plane)
{
    struct box3 box = grid_bounds_lps_mm(grid);
    struct plane upright = plane_upright(plane);
    struct plane_reach reach = plane_reach(&upright, &box);
    struct polygon polygon = { 4,
                               { plane_point(&upright, reach.low_right_mm, reach.low_up_mm),
                                 plane_point(&upright, reach.high_right_mm, reach.low_up_mm),
                                 plane_point(&upright, reach.high_right_mm, reach.high_up_mm),
                                 plane_point(&upright, reach.low_right_mm, reach.high_up_mm) } };
    for (int face = 0; face < 6; face++)
        clip_face(grid, face, &polygon);
    return polygon;
}

static void draw_polygon(const struct gl_frame *frame, const struct grid *grid, const struct polygon *polygon)
{
    const struct gl *gl = frame->gl;
    float vertices[MAX_CORNERS][6];
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

bool gl_draw_image(const struct gl_frame *frame, const struct draw *draw, struct error *err)
{
    const struct gl *gl = frame->gl;
    const struct draw_image *image = &draw->image;
    const struct gl_program *program = &frame->programs->image;
    const struct grid *grid = &frame->plan->images[draw->subject.index].volume->grid;
    struct polygon polygon = slice_polygon(grid, &draw->plane);
    if (polygon.n < 3)
        return true;
    const struct gl_grid *texels =
        (const struct gl_grid *)draw_cache_grid(frame->cache, frame->plan, draw->subject, err);
    if (!texels)
        return false;
    GLint filter = image->is_linear ? GL_LINEAR : GL_NEAREST;
    gl->UseProgram(program->name);
    gl->UniformMatrix4fv(program->clip_from_lps, 1, GL_FALSE, frame->clip_from_lps);
    gl->Uniform2f(program->grey, (float)(texels->value_per_unit / image->width),
                  (float)((texels->value_at_zero - image->low) / image->width));
    gl->Uniform2f(program->ends, image->is_low_white ? 1 : 0, image->is_low_white ? 0 : 1);
    gl->Uniform1f(program->cull, (float)image->cull);
    gl->Uniform1i(program->source, 0);
    gl->ActiveTexture(GL_TEXTURE0);
    gl->BindTexture(GL_TEXTURE_3D, texels->texture);
    gl->TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, filter);
    gl->TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, filter);
    draw_polygon(frame, grid, &polygon);
    gl->BindTexture(GL_TEXTURE_3D, 0);
    return gl_check(gl, "drawing a slice", err);
}

bool gl_draw_labels(const struct gl_frame *frame, const struct draw *draw, struct error *err)
{
    const struct gl *gl = frame->gl;
    const struct gl_program *program = &frame->programs->labels;
    const struct grid *grid = &frame->plan->regions.layers[draw->subject.index]->grid;
    struct polygon polygon = slice_polygon(grid, &draw->plane);
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
    draw_polygon(frame, grid, &polygon);
    gl->BindTexture(GL_TEXTURE_3D, 0);
    return gl_check(gl, "drawing a cross-section", err);
}
