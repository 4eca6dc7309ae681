/* Makes and frees the rasteriser's drawables: vertices by component, indices as the shape has them. */
#include "core/render/soft/drawables.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/render/visible/shading.h"

static void destroy_shape(void *context, struct drawable *drawable)
{
    struct soft_shape *shape = (struct soft_shape *)drawable;
    (void)context;
    shape_unref(shape->shape);
    free(shape->positions);
    free(shape->normals);
    free(shape);
}

/* Stores vertices by component, so that one instruction works on several of them. Normals have 16 bits, fine enough for
 * shading. normals NULL: zeroes. */
static bool fill_vertices(struct soft_shape *made, const float *positions, const float *normals, size_t n,
                          struct error *err)
{
    made->positions = mem_large_array(n, 3 * sizeof *made->positions, UINT64_MAX, err);
    made->normals = made->positions ? mem_large_array(n, 3 * sizeof *made->normals, UINT64_MAX, err) : NULL;
    if (!made->normals)
        return false;
    for (size_t i = 0; i < n; i++)
        for (size_t axis = 0; axis < 3; axis++) {
            made->positions[axis * n + i] = positions[3 * i + axis];
            made->normals[axis * n + i] = normals ? (int16_t)(normals[3 * i + axis] * 32767.0f) : 0;
        }
    const float *p = made->positions;
    const int16_t *m = made->normals;
    made->points = (struct soft_points){ p, p + n, p + 2 * n, m, m + n, m + 2 * n };
    made->n_vertices = n;
    return true;
}

static bool fill_triangles(struct soft_shape *made, int n_passes, struct error *err)
{
    const struct mesh *mesh = made->shape->mesh;
    float *smooth = n_passes > 0 ? shading_normals(mesh, n_passes, err) : NULL;
    bool is_good = (smooth || n_passes == 0) &&
                   fill_vertices(made, mesh->positions_lps_mm, smooth ? smooth : mesh->normals, mesh->n_vertices, err);
    free(smooth);
    made->indices = mesh->indices;
    made->n_primitives = mesh->n_triangles;
    return is_good;
}

static bool fill(struct soft_shape *made, int n_passes, struct error *err)
{
    const struct shape *shape = made->shape;
    switch (shape->kind) {
    case SHAPE_TRIANGLES: return fill_triangles(made, n_passes, err);
    case SHAPE_LINES:
        made->indices = shape->lines->indices;
        made->n_primitives = shape->lines->n_segments;
        return fill_vertices(made, shape->lines->positions_lps_mm, NULL, shape->lines->n_vertices, err);
    case SHAPE_POINTS:
        memcpy(made->edge_lps_mm, shape->points->edge_lps_mm, sizeof made->edge_lps_mm);
        made->shade = shape->points->shade;
        made->n_primitives = shape->points->n_points;
        return fill_vertices(made, shape->points->positions_lps_mm, shape->points->normals, shape->points->n_points,
                             err);
    }
    return false;
}

static struct drawable *make_shape(void *context, const struct shape *shape, int n_passes, struct error *err)
{
    struct soft_shape *made = mem_new(sizeof *made);
    made->kind = shape->kind;
    made->is_faceted = shape->is_faceted;
    made->shape = shape_ref(shape);
    made->base.holds_shape = true;
    if (!fill(made, n_passes, err)) {
        destroy_shape(context, &made->base);
        return NULL;
    }
    made->base.n_bytes = sizeof *made + shape->n_bytes + made->n_vertices * 3 * (sizeof(float) + sizeof(int16_t));
    return &made->base;
}

struct drawable_maker soft_drawable_maker(void)
{
    return (struct drawable_maker){ .make_shape = make_shape, .destroy_shape = destroy_shape };
}
