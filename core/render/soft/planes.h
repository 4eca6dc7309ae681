#pragma once
/* Draws slices through grids: planes, cut off at the grid's outer faces. */
#include "core/render/soft/kernels.h"
#include "core/scene/snapshot.h"

struct soft_plane {
    struct soft_texture texture;
    double at[5]
             [3]; /* the five quantities of soft_row: change with a sample right, down; value at the picture's corner */
    bool is_empty; /* seen edge-on */
};

/* For a picture of width x height samples. Fills texture's voxels and size; the caller fills its type and colours. */
void soft_plane_init(struct soft_plane *plane, const struct volume *volume, const struct plane *plane_lps,
                     const struct mat4 *clip_from_lps_mm, int width, int height);
void soft_plane_draw(const struct soft_plane *plane, const struct soft_kernels *kernels, const struct soft_band *band);
