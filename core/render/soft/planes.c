/* Draws slices through grids, row by row. */
#include "core/render/soft/planes.h"

#include <math.h>

/* m[row][column] */
struct mat3 {
    double m[3][3];
};

static double determinant(const struct mat3 *a)
{
    return a->m[0][0] * (a->m[1][1] * a->m[2][2] - a->m[1][2] * a->m[2][1]) -
           a->m[0][1] * (a->m[1][0] * a->m[2][2] - a->m[1][2] * a->m[2][0]) +
           a->m[0][2] * (a->m[1][0] * a->m[2][1] - a->m[1][1] * a->m[2][0]);
}

static bool invert(const struct mat3 *a, struct mat3 *inverse)
{
    double size = 1, d = determinant(a);
    for (int column = 0; column < 3; column++)
        size *= sqrt(a->m[0][column] * a->m[0][column] + a->m[1][column] * a->m[1][column] +
                     a->m[2][column] * a->m[2][column]);
    if (!(fabs(d) > 1e-12 * size)) /* the plane is seen edge-on */
        return false;
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++) {
            int i = (column + 1) % 3, j = (column + 2) % 3, k = (row + 1) % 3, l = (row + 2) % 3;
            inverse->m[row][column] = (a->m[i][k] * a->m[j][l] - a->m[i][l] * a->m[j][k]) / d;
        }
    return true;
}

static void clip_coordinates(const struct mat4 *matrix, struct vec3 p, double last, double clip[4])
{
    for (int row = 0; row < 4; row++)
        clip[row] =
            matrix->m[row] * p.x + matrix->m[4 + row] * p.y + matrix->m[8 + row] * p.z + matrix->m[12 + row] * last;
}

/* A point of the plane is origin + u right + v up. Its position in the picture times w is linear in (u, v, 1). The
 * inverse map gives u / w, v / w and 1 / w linear in the position, and so is every quantity over w that is linear on
 * the plane. */
void soft_plane_init(struct soft_plane *plane, const struct volume *volume, const struct plane *plane_lps,
                     const struct mat4 *clip_from_lps_mm, int width, int height)
{
    const struct grid *grid = &volume->grid;
    double clip[3][4];
    clip_coordinates(clip_from_lps_mm, plane_lps->right, 0, clip[0]);
    clip_coordinates(clip_from_lps_mm, plane_lps->up, 0, clip[1]);
    clip_coordinates(clip_from_lps_mm, plane_lps->origin_lps_mm, 1, clip[2]);
    struct vec3 index[3] = { affine_vector(&grid->ijk_from_lps_mm, plane_lps->right),
                             affine_vector(&grid->ijk_from_lps_mm, plane_lps->up),
                             affine_point(&grid->ijk_from_lps_mm, plane_lps->origin_lps_mm) };
    struct mat3 place, inverse;
    double linear[5][3];
    for (int c = 0; c < 3; c++) {
        place.m[0][c] = 0.5 * width * (clip[c][3] + clip[c][0]);
        place.m[1][c] = 0.5 * height * (clip[c][3] - clip[c][1]);
        place.m[2][c] = clip[c][3];
        linear[0][c] = index[c].x;
        linear[1][c] = index[c].y;
        linear[2][c] = index[c].z;
        linear[3][c] = c == 2;
        linear[4][c] = clip[c][2];
    }
    *plane = (struct soft_plane){ 0 };
    plane->is_empty = !invert(&place, &inverse);
    for (int i = 0; !plane->is_empty && i < 5; i++)
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++)
                plane->at[i][c] += linear[i][k] * inverse.m[k][c];
    for (int axis = 0; axis < 3; axis++)
        plane->texture.size[axis] = grid->size[axis];
    plane->texture.voxels = volume->voxels;
}

/* Narrows *first..*last to the x with value + step * x >= 0. */
static void narrow(double value, double step, double *first, double *last)
{
    if (step > 0)
        *first = fmax(*first, -value / step);
    else if (step < 0)
        *last = fmin(*last, -value / step);
    else if (value < 0)
        *last = -1;
}

void soft_plane_draw(const struct soft_plane *plane, const struct soft_kernels *kernels, const struct soft_band *band)
{
    if (plane->is_empty)
        return;
    for (int y = 0; y < band->n_rows; y++) {
        struct soft_row row;
        for (int i = 0; i < 5; i++) { /* at the middle of sample 0 */
            row.step[i] = plane->at[i][0];
            row.at[i] = plane->at[i][2] + plane->at[i][0] * 0.5 + plane->at[i][1] * (band->first_row + y + 0.5);
        }
        double first = 0, last = band->width - 1;
        narrow(row.at[3] - 1e-12, row.step[3], &first, &last); /* in front of the eye */
        for (int axis = 0; axis < 3; axis++) {
            double high = plane->texture.size[axis] - 0.5;
            narrow(row.at[axis] + 0.5 * row.at[3], row.step[axis] + 0.5 * row.step[3], &first, &last);
            narrow(high * row.at[3] - row.at[axis], high * row.step[3] - row.step[axis], &first, &last);
        }
        if (plane->texture.has_depth) {
            narrow(row.at[4] + 1, row.step[4], &first, &last);
            narrow(1 - row.at[4], -row.step[4], &first, &last);
        }
        int from = (int)ceil(fmin(first, band->width)), to = (int)floor(fmax(last, -1));
        size_t at = (size_t)y * (size_t)band->stride;
        if (from <= to)
            kernels->sample(&plane->texture, &row, from, to - from + 1, band->depth + at, band->color + at);
    }
}
