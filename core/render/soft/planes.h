#pragma once
/* Draws slices through grids: planes, cut off at the grid's outer faces and at clip planes. */
#include "core/render/soft/kernels.h"
#include "core/render/visible/draw.h"
#include "core/scene/snapshot.h"

struct soft_wash;

struct soft_plane {
    struct soft_texture texture;
    double at[5]
             [3]; /* the five quantities of soft_row: change with a sample right, down; value at the picture's corner */
    double cuts[SOFT_MAX_CUTS][3]; /* depth below each clip plane that cuts it, times 1 / w: as at. Drawn where >= 0 */
    int n_cuts;
    bool is_empty; /* seen edge-on */
    bool has_blend;
    struct soft_blend blend;
    double blend_at[3][3]; /* as at, in the grid of blend */
    const struct soft_wash
        *wash;          /* over what is drawn; NULL: none. The caller fills it, with texture.alpha SOFT_MARK */
    bool is_wash_alone; /* texture has the dose's grid and is not drawn: the wash lies over all samples */
};

/* For a picture of width x height samples. Fills texture's voxels and size; the caller fills its type and colours.
 * volume NULL: a plane without a grid. */
void soft_plane_init(struct soft_plane *plane, const struct volume *volume, const struct plane *plane_lps,
                     const struct clip_set *clip, const struct mat4 *clip_from_lps_mm, int width, int height);
/* A row of samples of the picture, and the first and last of them that the picture's sides, the eye, the clip planes
 * and with has_depth near and far plane leave. */
struct soft_row soft_plane_row(const struct soft_plane *plane, int y, int width, double *first, double *last);
/* Narrows them to the samples within the grid's outer faces. */
void soft_plane_narrow(const struct soft_plane *plane, const struct soft_row *row, double *first, double *last);
/* Lays a second image over it; second: a plane of the same picture, its texture filled. */
void soft_plane_blend(struct soft_plane *plane, const struct soft_plane *second, double part);
void soft_plane_draw(const struct soft_plane *plane, const struct soft_kernels *kernels, const struct soft_band *band);
