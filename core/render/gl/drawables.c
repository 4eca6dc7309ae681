/* Makes and frees OpenGL's drawables: shapes as vertex buffers, grids as textures. */
#include "core/render/gl/drawables.h"

#include <stdlib.h>

#include "core/base/mem.h"

static void destroy_shape(void *context, struct drawable *drawable)
{
    const struct gl *gl = context;
    struct gl_shape *shape = (struct gl_shape *)drawable;
    gl->DeleteVertexArrays(1, &shape->vertex_array);
    gl->DeleteBuffers(1, &shape->vertices);
    gl->DeleteBuffers(1, &shape->indices);
    free(shape);
}

static struct drawable *make_shape(void *context, const struct shape *shape, int n_passes, struct error *err)
{
    struct gl_shape *made = mem_new(sizeof *made);
    made->base.n_bytes = sizeof *made;
    if (gl_upload_shape(context, shape, n_passes, made, err))
        return &made->base;
    destroy_shape(context, &made->base);
    return NULL;
}

static void destroy_grid(void *context, struct drawable *drawable)
{
    const struct gl *gl = context;
    struct gl_grid *grid = (struct gl_grid *)drawable;
    gl->DeleteTextures(1, &grid->texture);
    free(grid);
}

static struct drawable *make_grid(void *context, const struct volume *const *volumes, size_t n, bool is_labels,
                                  struct error *err)
{
    struct gl_grid *made = mem_new(sizeof *made);
    if (n == 1 ? gl_upload_grid(context, volumes[0], is_labels, made, err)
               : gl_upload_stack(context, volumes, n, made, err))
        return &made->base;
    free(made);
    return NULL;
}

static void destroy_tracks(void *context, struct drawable *drawable)
{
    gl_tracks_destroy(context, (struct gl_tracks *)drawable);
}

static struct drawable *make_tracks(void *context, const struct track_set *set, struct error *err)
{
    struct gl_tracks *made = gl_tracks_create(context, set, err);
    return made ? &made->base : NULL;
}

struct drawable_maker gl_drawable_maker(const struct gl *gl)
{
    return (struct drawable_maker){ make_shape,     destroy_shape,        make_grid, destroy_grid, make_tracks,
                                    destroy_tracks, (void *)(uintptr_t)gl };
}
