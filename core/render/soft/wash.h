#pragma once
/* Lays the colours of a dose, or of an image, over samples that were drawn before: the rules stand in
 * core/render/visible/draw_wash.h and, of textures of shapes, in draw.h. */
#include "core/render/soft/kernels.h"
#include "core/render/visible/draw_wash.h"

/* A quantity at the middles of samples: at + right x + down y + deeper depth, in sample (x, y) of the picture. */
struct soft_form {
    double at, right, down, deeper;
};
/* Where samples lie in a grid: index along each axis times w, and w. */
struct soft_places {
    struct soft_form index[3], w;
};

struct soft_wash {
    const float *rows[DOSE_MAX_ROWS];
    uint32_t n_rows, size[3];
    const uint8_t *tissue; /* NULL: rows[0] everywhere */
    uint32_t tissue_size[3];
    bool is_per_slice, has_rises;
    int n_knots;
    float knots[DRAW_WASH_MAX_KNOTS];
    float colors[DRAW_WASH_MAX_KNOTS][4], rises[DRAW_WASH_MAX_KNOTS][4]; /* red, green, blue 0..255; opacity 0..1 */
    struct soft_places places, tissue_places;
    float of_image[3][4], tissue_of_image[3][4]; /* in a volume: index = row . (index in the image's grid, 1) */
};

struct soft_volume;
/* A paint over the samples of a shape: a wash or an image. */
struct soft_paint {
    const struct soft_wash *wash;    /* NULL: the image is shown */
    const struct soft_volume *image; /* voxels, type, values and colours count */
    struct soft_places places;       /* in the image's grid */
    float color[3];                  /* the shape's own, 0..1: where there is no image */
};

/* The wash of samples on a plane; width, height: of the picture, in samples. */
void soft_wash_on_plane(struct soft_wash *wash, const struct draw_wash *draw, const struct plane *plane_lps,
                        const struct mat4 *clip_from_lps_mm, int width, int height);
/* Makes the wash of shape samples, located by their depths. */
void soft_wash_on_shapes(struct soft_wash *wash, const struct draw_wash *draw, const struct camera *camera, int width,
                         int height);
/* Makes the wash of samples of an image shown as a volume. */
void soft_wash_in_image(struct soft_wash *wash, const struct draw_wash *draw, const struct grid *image);
/* Places of shape samples in a grid, from their depths. */
struct soft_places soft_places_of_shapes(const struct grid *grid, const struct camera *camera, int width, int height);
