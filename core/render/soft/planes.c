/* Draws slices through grids, row by row. */
#include "core/render/soft/planes.h"

#include <math.h>
#include <string.h>

#include "core/render/soft/volume.h"

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
static void over_w(const double linear[3], const struct mat3 *inverse, double at[3])
{
    for (int c = 0; c < 3; c++) {
        at[c] = 0;
        for (int k = 0; k < 3; k++)
            at[c] += linear[k] * inverse->m[k][c];
    }
}

static void init_cuts(struct soft_plane *plane, const struct plane *lps, const struct clip_set *clip,
                      const struct mat3 *inverse)
{
    for (size_t i = 0; i < clip->n_planes; i++) {
        const struct plane *cut = &clip->planes[i].plane;
        const double below[3] = { -vec3_dot(lps->right, cut->normal), -vec3_dot(lps->up, cut->normal),
                                  CLIP_SLACK_MM - plane_height_mm(cut, lps->origin_lps_mm) };
        if (clip_set_has(clip, i))
            over_w(below, inverse, plane->cuts[plane->n_cuts++]);
    }
}

void soft_plane_init(struct soft_plane *plane, const struct volume *volume, const struct plane *plane_lps,
                     const struct clip_set *clip, const struct mat4 *clip_from_lps_mm, int width, int height)
{
    double corner[3][4];
    clip_coordinates(clip_from_lps_mm, plane_lps->right, 0, corner[0]);
    clip_coordinates(clip_from_lps_mm, plane_lps->up, 0, corner[1]);
    clip_coordinates(clip_from_lps_mm, plane_lps->origin_lps_mm, 1, corner[2]);
    struct vec3 index[3] = { { 0, 0, 0 } };
    if (volume) {
        const struct affine *ijk = &volume->grid.ijk_from_lps_mm;
        index[0] = affine_vector(ijk, plane_lps->right);
        index[1] = affine_vector(ijk, plane_lps->up);
        index[2] = affine_point(ijk, plane_lps->origin_lps_mm);
    }
    struct mat3 place, inverse;
    double linear[5][3];
    for (int c = 0; c < 3; c++) {
        place.m[0][c] = 0.5 * width * (corner[c][3] + corner[c][0]);
        place.m[1][c] = 0.5 * height * (corner[c][3] - corner[c][1]);
        place.m[2][c] = corner[c][3];
        linear[0][c] = index[c].x;
        linear[1][c] = index[c].y;
        linear[2][c] = index[c].z;
        linear[3][c] = c == 2;
        linear[4][c] = corner[c][2];
    }
    *plane = (struct soft_plane){ 0 };
    plane->is_empty = !invert(&place, &inverse);
    for (int i = 0; !plane->is_empty && i < 5; i++)
        over_w(linear[i], &inverse, plane->at[i]);
    if (!plane->is_empty)
        init_cuts(plane, plane_lps, clip, &inverse);
    for (int axis = 0; volume && axis < 3; axis++)
        plane->texture.size[axis] = volume->grid.size[axis];
    plane->texture.voxels = volume ? volume->voxels : NULL;
    plane->texture.alpha = SOFT_OPAQUE;
}

void soft_plane_blend(struct soft_plane *plane, const struct soft_plane *second, double part)
{
    plane->has_blend = true;
    plane->blend = (struct soft_blend){ second->texture, (float)part };
    memcpy(plane->blend_at, second->at, sizeof plane->blend_at);
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

/* At the middle of sample 0 of row y. */
static double at_row(const double at[3], int y)
{
    return at[2] + at[0] * 0.5 + at[1] * (y + 0.5);
}

struct soft_row soft_plane_row(const struct soft_plane *plane, int y, int width, double *first, double *last)
{
    struct soft_row row;
    for (int i = 0; i < 5; i++) {
        row.step[i] = plane->at[i][0];
        row.at[i] = at_row(plane->at[i], y);
    }
    row.blend = plane->has_blend ? &plane->blend : NULL;
    for (int i = 0; i < 3 && plane->has_blend; i++) {
        row.blend_step[i] = plane->blend_at[i][0];
        row.blend_at[i] = at_row(plane->blend_at[i], y);
    }
    *first = 0;
    *last = width - 1;
    narrow(row.at[3] - 1e-12, row.step[3], first, last); /* in front of the eye */
    for (int cut = 0; cut < plane->n_cuts; cut++)
        narrow(at_row(plane->cuts[cut], y), plane->cuts[cut][0], first, last);
    if (plane->texture.has_depth) {
        narrow(row.at[4] + 1, row.step[4], first, last);
        narrow(1 - row.at[4], -row.step[4], first, last);
    }
    return row;
}

void soft_plane_narrow(const struct soft_plane *plane, const struct soft_row *row, double *first, double *last)
{
    for (int axis = 0; axis < 3; axis++) {
        double high = plane->texture.size[axis] - 0.5;
        narrow(row->at[axis] + 0.5 * row->at[3], row->step[axis] + 0.5 * row->step[3], first, last);
        narrow(high * row->at[3] - row->at[axis], high * row->step[3] - row->step[axis], first, last);
    }
}

void soft_plane_draw(const struct soft_plane *plane, const struct soft_kernels *kernels, const struct soft_band *band)
{
    if (plane->is_empty)
        return;
    for (int y = 0; y < band->n_rows; y++) {
        double first, last;
        struct soft_row row = soft_plane_row(plane, band->first_row + y, band->width, &first, &last);
        soft_plane_narrow(plane, &row, &first, &last);
        int from = (int)ceil(fmin(first, band->width)), to = (int)floor(fmax(last, -1));
        size_t at = (size_t)y * (size_t)band->stride;
        if (from > to)
            continue;
        if (!plane->is_wash_alone)
            kernels->sample(&plane->texture, &row, from, to - from + 1, band->depth + at, band->color + at);
        if (plane->wash)
            soft_volume_kernels_of(kernels)->wash(plane->wash, from, band->first_row + y, to - from + 1,
                                                  plane->is_wash_alone ? SOFT_OPAQUE : SOFT_MARK, band->color + at);
    }
}
