#pragma once
/* Slices through grids: planes, cut off at the grid's outer faces. */
#include "core/render/soft/kernels.h"
#include "core/scene/snapshot.h"

struct soft_plane {
    struct soft_texture texture;
    double at[5][3]; /* as in soft_row: value at sample (0, 0)'s corner, and what a sample to the right and down adds */
    bool is_empty;   /* seen from the edge */
};

/* Of a picture of width x height samples. texture's grid is volume's; its colours are the caller's to fill. */
void soft_plane_init(struct soft_plane *plane, const struct volume *volume, const struct plane *plane_lps,
                     const struct mat4 *clip_from_lps_mm, int width, int height);
void soft_plane_draw(const struct soft_plane *plane, const struct soft_kernels *kernels, const struct soft_band *band);
