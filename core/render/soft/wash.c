/* Prepares a colourwash for samples of planes, shapes and volumes. */
#include "core/render/soft/wash.h"

#include <string.h>

#include "core/render/soft/planes.h"

/* Values, rows and colours; not the places. */
static void init(struct soft_wash *wash, const struct draw_wash *draw)
{
    *wash = (struct soft_wash){ .n_rows = (uint32_t)draw->n_rows,
                                .is_per_slice = draw->is_per_slice,
                                .n_knots = draw->n_knots,
                                .tissue = draw->tissue ? draw->tissue->voxels : NULL };
    for (size_t r = 0; r < draw->n_rows; r++)
        wash->rows[r] = draw->rows[r]->voxels;
    for (int axis = 0; axis < 3; axis++) {
        wash->size[axis] = draw->rows[0]->grid.size[axis];
        wash->tissue_size[axis] = draw->tissue ? draw->tissue->grid.size[axis] : 1;
    }
    for (int k = 0; k < draw->n_knots; k++) {
        wash->knots[k] = draw->knots[k];
        for (int c = 0; c < 4; c++) {
            const float scale = c < 3 ? 255.0f : 1.0f;
            wash->colors[k][c] = draw->colors[k][c] * scale;
            wash->rises[k][c] = draw->rises[k][c] * scale;
            wash->has_rises |= wash->rises[k][c] != 0;
        }
    }
}

/* ---- planes ----------------------------------------------------------------------------------------------------- */

static struct soft_form form_of(const double at[3])
{
    return (struct soft_form){ at[2] + 0.5 * (at[0] + at[1]), at[0], at[1], 0 };
}

static struct soft_places places_on_plane(const struct volume *volume, const struct plane *plane_lps,
                                          const struct mat4 *clip_from_lps_mm, int width, int height)
{
    struct soft_plane plane;
    soft_plane_init(&plane, volume, plane_lps, &(struct clip_set){ 0 }, clip_from_lps_mm, width, height);
    return (struct soft_places){ { form_of(plane.at[0]), form_of(plane.at[1]), form_of(plane.at[2]) },
                                 form_of(plane.at[3]) };
}

void soft_wash_on_plane(struct soft_wash *wash, const struct draw_wash *draw, const struct plane *plane_lps,
                        const struct mat4 *clip_from_lps_mm, int width, int height)
{
    init(wash, draw);
    wash->places = places_on_plane(draw->rows[0], plane_lps, clip_from_lps_mm, width, height);
    if (draw->tissue)
        wash->tissue_places = places_on_plane(draw->tissue, plane_lps, clip_from_lps_mm, width, height);
}

/* ---- shapes ----------------------------------------------------------------------------------------------------- */

/* A row of the map from clip coordinates, as a form. */
static struct soft_form of_clip(const double row[4], int width, int height)
{
    double right = 2 * row[0] / width, down = -2 * row[1] / height;
    return (struct soft_form){ row[3] - row[0] + row[1] + 0.5 * (right + down), right, down, row[2] };
}

struct soft_places soft_places_of_shapes(const struct grid *grid, const struct camera *camera, int width, int height)
{
    const double *m = camera->lps_mm_from_clip.m;
    const struct affine *to_index = &grid->ijk_from_lps_mm;
    double rows[4][4];
    for (int column = 0; column < 4; column++) {
        const double w = m[4 * column + 3];
        struct vec3 lps = vec3(m[4 * column], m[4 * column + 1], m[4 * column + 2]);
        struct vec3 index = vec3_add(affine_vector(to_index, lps), vec3_scale(to_index->origin, w));
        rows[0][column] = index.x;
        rows[1][column] = index.y;
        rows[2][column] = index.z;
        rows[3][column] = w;
    }
    return (struct soft_places){ { of_clip(rows[0], width, height), of_clip(rows[1], width, height),
                                   of_clip(rows[2], width, height) },
                                 of_clip(rows[3], width, height) };
}

void soft_wash_on_shapes(struct soft_wash *wash, const struct draw_wash *draw, const struct camera *camera, int width,
                         int height)
{
    init(wash, draw);
    wash->places = soft_places_of_shapes(&draw->rows[0]->grid, camera, width, height);
    if (draw->tissue)
        wash->tissue_places = soft_places_of_shapes(&draw->tissue->grid, camera, width, height);
}

/* ---- volumes ---------------------------------------------------------------------------------------------------- */

static void index_from(const struct grid *image, const struct grid *grid, float rows[3][4])
{
    for (int column = 0; column < 4; column++) {
        struct vec3 lps = column < 3 ? image->lps_mm_from_ijk.columns[column] : image->lps_mm_from_ijk.origin;
        struct vec3 index =
            column < 3 ? affine_vector(&grid->ijk_from_lps_mm, lps) : affine_point(&grid->ijk_from_lps_mm, lps);
        rows[0][column] = (float)index.x;
        rows[1][column] = (float)index.y;
        rows[2][column] = (float)index.z;
    }
}

void soft_wash_in_image(struct soft_wash *wash, const struct draw_wash *draw, const struct grid *image)
{
    init(wash, draw);
    index_from(image, &draw->rows[0]->grid, wash->of_image);
    if (draw->tissue)
        index_from(image, &draw->tissue->grid, wash->tissue_of_image);
}
