/* Uploads shapes to the graphics card: triangles with vertex normals, lines and points as instances. */
#include "core/render/gl/upload.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/render/visible/shading.h"

/* A normal has 16 bits a component: fine enough for shading, and less to fetch than floats. */
struct vertex {
    float position_lps_mm[3];
    int16_t normal[4];
};

struct point {
    struct vertex vertex;
    uint8_t shade[4]; /* the first; the others pad */
};

struct segment {
    float ends_lps_mm[2][3];
};

static void pack(const float *position, const float *normal, struct vertex *vertex)
{
    memcpy(vertex->position_lps_mm, position, sizeof vertex->position_lps_mm);
    for (int a = 0; a < 3; a++)
        vertex->normal[a] = (int16_t)(normal[a] * 32767.0f);
    vertex->normal[3] = 0;
}

static void send(const struct gl *gl, GLenum kind, const void *bytes, size_t n, struct gl_shape *out)
{
    gl->BufferData(kind, (GLsizeiptr)n, bytes, GL_STATIC_DRAW);
    out->base.n_bytes += n;
}

/* Sets up the attribute at location `place`. divisor 0: one value a vertex; 1: one an instance. */
static void attribute(const struct gl *gl, GLuint place, GLint n, GLenum type, size_t stride, size_t offset,
                      GLuint divisor)
{
    gl->VertexAttribPointer(place, n, type, type != GL_FLOAT, (GLsizei)stride, (const void *)offset);
    gl->EnableVertexAttribArray(place);
    gl->VertexAttribDivisor(place, divisor);
}

static bool send_triangles(const struct gl *gl, const struct mesh *mesh, int n_passes, struct gl_shape *out,
                           struct error *err)
{
    float *smooth = n_passes > 0 ? shading_normals(mesh, n_passes, err) : NULL;
    struct vertex *vertices =
        smooth || n_passes == 0 ? mem_array(mesh->n_vertices, sizeof *vertices, UINT64_MAX, err) : NULL;
    for (size_t i = 0; vertices && i < mesh->n_vertices; i++)
        pack(&mesh->positions_lps_mm[3 * i], smooth ? &smooth[3 * i] : &mesh->normals[3 * i], &vertices[i]);
    free(smooth);
    if (!vertices)
        return false;
    out->n = (GLsizei)(3 * mesh->n_triangles);
    gl->GenBuffers(1, &out->indices);
    gl->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, out->indices);
    send(gl, GL_ELEMENT_ARRAY_BUFFER, mesh->indices, 3 * mesh->n_triangles * sizeof(uint32_t), out);
    send(gl, GL_ARRAY_BUFFER, vertices, mesh->n_vertices * sizeof *vertices, out);
    attribute(gl, 0, 3, GL_FLOAT, sizeof *vertices, offsetof(struct vertex, position_lps_mm), 0);
    attribute(gl, 1, 3, GL_SHORT, sizeof *vertices, offsetof(struct vertex, normal), 0);
    free(vertices);
    return true;
}

static bool send_lines(const struct gl *gl, const struct line_set *lines, struct gl_shape *out, struct error *err)
{
    struct segment *segments = mem_array(lines->n_segments, sizeof *segments, UINT64_MAX, err);
    if (!segments)
        return false;
    for (size_t i = 0; i < lines->n_segments; i++)
        for (size_t end = 0; end < 2; end++)
            memcpy(segments[i].ends_lps_mm[end], &lines->positions_lps_mm[3 * (size_t)lines->indices[2 * i + end]],
                   3 * sizeof(float));
    out->n = (GLsizei)lines->n_segments;
    send(gl, GL_ARRAY_BUFFER, segments, lines->n_segments * sizeof *segments, out);
    for (GLuint end = 0; end < 2; end++)
        attribute(gl, end, 3, GL_FLOAT, sizeof *segments, end * sizeof segments->ends_lps_mm[0], 1);
    free(segments);
    return true;
}

static bool send_points(const struct gl *gl, const struct point_set *set, struct gl_shape *out, struct error *err)
{
    struct point *points = mem_array(set->n_points, sizeof *points, UINT64_MAX, err);
    if (!points)
        return false;
    for (size_t i = 0; i < set->n_points; i++) {
        pack(&set->positions_lps_mm[3 * i], &set->normals[3 * i], &points[i].vertex);
        memset(points[i].shade, set->shade[i], sizeof points[i].shade);
    }
    out->n = (GLsizei)set->n_points;
    memcpy(out->edge_lps_mm, set->edge_lps_mm, sizeof out->edge_lps_mm);
    send(gl, GL_ARRAY_BUFFER, points, set->n_points * sizeof *points, out);
    attribute(gl, 0, 3, GL_FLOAT, sizeof *points, offsetof(struct point, vertex.position_lps_mm), 1);
    attribute(gl, 1, 3, GL_SHORT, sizeof *points, offsetof(struct point, vertex.normal), 1);
    attribute(gl, 2, 1, GL_UNSIGNED_BYTE, sizeof *points, offsetof(struct point, shade), 1);
    free(points);
    return true;
}

static size_t n_primitives(const struct shape *shape)
{
    return shape->kind == SHAPE_TRIANGLES ? shape->mesh->n_triangles
           : shape->kind == SHAPE_LINES   ? shape->lines->n_segments
                                          : shape->points->n_points;
}

bool gl_upload_shape(const struct gl *gl, const struct shape *shape, int n_passes, struct gl_shape *out,
                     struct error *err)
{
    out->kind = shape->kind;
    out->is_faceted = shape->is_faceted;
    gl->GenVertexArrays(1, &out->vertex_array);
    gl->GenBuffers(1, &out->vertices);
    gl->BindVertexArray(out->vertex_array);
    gl->BindBuffer(GL_ARRAY_BUFFER, out->vertices);
    bool is_good = shape->kind == SHAPE_TRIANGLES ? send_triangles(gl, shape->mesh, n_passes, out, err)
                   : shape->kind == SHAPE_LINES   ? send_lines(gl, shape->lines, out, err)
                                                  : send_points(gl, shape->points, out, err);
    gl->BindVertexArray(0);
    if (!is_good || !gl_check(gl, "uploading a shape", err)) {
        error_prefix(err, "%zu triangles, lines or points", n_primitives(shape));
        return false;
    }
    return true;
}
