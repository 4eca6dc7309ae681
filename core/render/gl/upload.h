#pragma once
/* Uploads shapes and grids to the graphics card. */
#include "core/render/gl/table.h"
#include "core/render/visible/draw_cache.h"

struct gl_shape {
    struct drawable base;
    enum shape_kind kind;
    bool is_faceted; /* always shaded with one normal per triangle */
    GLuint vertex_array, vertices, indices;
    GLsizei n;                  /* indices of triangles; or instances of lines or points, four corners each */
    struct vec3 edge_lps_mm[3]; /* points: of the voxel they stand for */
};

struct gl_grid {
    struct drawable base;
    GLuint texture;
    double value_per_unit, value_at_zero; /* images: value = texture * value_per_unit + value_at_zero */
    int n_along_z; /* of a stack: volume v begins at voxel (0, size[1] (v / n_along_z), size[2] (v % n_along_z)) */
};

/* Particle tracks: the segments as the plan has them, and once more those that have a cross. */
struct gl_tracks {
    struct drawable base;
    GLuint vertex_array, buffers[2];
    size_t *crosses; /* [n_crosses] segments of the second buffer, ascending */
    size_t n_crosses;
};
/* NULL on failure. errors ERROR_GL, ERROR_MEMORY */
NODISCARD struct gl_tracks *gl_tracks_create(const struct gl *gl, const struct track_set *set, struct error *err);
void gl_tracks_destroy(const struct gl *gl, struct gl_tracks *tracks);

/* n_passes: of shading_normals. Adds the memory on the card to out->base.n_bytes. On failure too the caller deletes the
 * names in *out. errors ERROR_GL, ERROR_MEMORY */
NODISCARD bool gl_upload_shape(const struct gl *gl, const struct shape *shape, int n_passes, struct gl_shape *out,
                               struct error *err);
/* On failure the caller has nothing to delete. errors ERROR_GL, ERROR_MEMORY, ERROR_LIMIT more than the driver takes,
 * ERROR_UNSUPPORTED labels of real numbers */
NODISCARD bool gl_upload_grid(const struct gl *gl, const struct volume *volume, bool is_labels, struct gl_grid *out,
                              struct error *err);
/* Volumes of real numbers on one grid as one texture, as out->n_along_z says. errors as gl_upload_grid */
NODISCARD bool gl_upload_stack(const struct gl *gl, const struct volume *const *volumes, size_t n, struct gl_grid *out,
                               struct error *err);
