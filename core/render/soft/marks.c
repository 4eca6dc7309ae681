/* Draws marked univels on planes, row by row. */
#include "core/render/soft/marks.h"

#include <math.h>

void soft_marks_init(struct soft_marks *marks, const struct draw *draw, const struct mat4 *clip_from_lps_mm, int width,
                     int height, double samples_per_px)
{
    soft_plane_init(&marks->plane, draw->marks.labels, &draw->plane, &draw->clip, clip_from_lps_mm, width, height);
    const double *depth = marks->plane.at[4];
    marks->plane.texture.has_depth = draw->depth == DRAW_DEPTH_TESTED;
    marks->color_rgb = draw->color_rgb;
    marks->stripe = (float)fmax(2, draw->marks.stripe_px * samples_per_px);
    marks->edge = (float)fmax(1, draw->marks.edge_px * samples_per_px);
    marks->slack = (float)(4 * VISIBLE_CAP_DEPTH + fabs(depth[0]) + fabs(depth[1])); /* depth is -1 .. 1 */
}

/* Index along each axis times 1 / w, then 1 / w, at the middle of sample 0 of a row. */
struct line {
    double at[4];
};

static struct line line_of(const struct soft_plane *plane, double y)
{
    struct line line;
    for (int c = 0; c < 4; c++)
        line.at[c] = plane->at[c][0] * 0.5 + plane->at[c][1] * (y + 0.5) + plane->at[c][2];
    return line;
}

static bool is_marked(const struct soft_plane *plane, const struct line *line, double x)
{
    const uint32_t *size = plane->texture.size;
    const double w = 1 / (line->at[3] + plane->at[3][0] * x);
    uint32_t voxel[3];
    for (int axis = 0; axis < 3; axis++) {
        double at = (line->at[axis] + plane->at[axis][0] * x) * w + 0.5;
        if (!(at >= 0 && at < size[axis]))
            return false;
        voxel[axis] = (uint32_t)at;
    }
    return ((const uint8_t *)
                plane->texture.voxels)[voxel[0] + size[0] * (voxel[1] + (size_t)size[1] * (size_t)voxel[2])] != 0;
}

static uint32_t mix(uint32_t under, uint32_t rgb, double part)
{
    uint32_t mixed = 0xff000000u;
    for (int c = 0; c < 3; c++) {
        double from = under >> 8 * c & 255, to = rgb >> (16 - 8 * c) & 255;
        mixed |= (uint32_t)(from + (to - from) * part + 0.5) << 8 * c;
    }
    return mixed;
}

/* The part of color_rgb in the mixed colour; of black: negative. */
static double part_at(const struct soft_marks *marks, const struct line lines[3], int x, int y)
{
    const struct soft_plane *plane = &marks->plane;
    const double edge = (double)marks->edge;
    if (!is_marked(plane, &lines[1], x))
        return 0;
    if (!is_marked(plane, &lines[1], x - edge) || !is_marked(plane, &lines[1], x + edge) ||
        !is_marked(plane, &lines[0], x) || !is_marked(plane, &lines[2], x))
        return 1;
    return fmodf((float)(x + y), marks->stripe) < marks->stripe / 2 ? DRAW_MARKS_STRIPE : -DRAW_MARKS_BLACK;
}

static void draw_row(const struct soft_marks *marks, int y, int width, const float *depth, uint32_t *color)
{
    const struct soft_plane *plane = &marks->plane;
    double first, last;
    struct soft_row row = soft_plane_row(plane, y, width, &first, &last);
    soft_plane_narrow(plane, &row, &first, &last);
    const struct line lines[3] = { line_of(plane, y - (double)marks->edge), line_of(plane, y),
                                   line_of(plane, y + (double)marks->edge) };
    int end = (int)floor(fmax(last, -1)) + 1;
    for (int x = (int)ceil(fmin(first, width)); x < end; x++) {
        double away = row.at[4] + row.step[4] * x - (double)depth[x];
        if (plane->texture.has_depth && !(fabs(away) <= (double)marks->slack))
            continue;
        double part = part_at(marks, lines, x, y);
        if (part > 0 || part < 0)
            color[x] = mix(color[x], part > 0 ? marks->color_rgb : 0, fabs(part));
    }
}

void soft_marks_draw(const struct soft_marks *marks, const struct soft_band *band)
{
    for (int y = 0; !marks->plane.is_empty && y < band->n_rows; y++)
        draw_row(marks, band->first_row + y, band->width, band->depth + (size_t)y * (size_t)band->stride,
                 band->color + (size_t)y * (size_t)band->stride);
}
