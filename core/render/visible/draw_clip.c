/* Finds which clip planes cut a box, or a slice through a grid. */
#include "core/render/visible/draw_clip.h"

#include <math.h>

struct clip_set draw_clip_set(const struct snapshot *snapshot, bool is_clipped)
{
    if (!is_clipped || snapshot_is_pane(snapshot))
        return (struct clip_set){ 0 };
    return (struct clip_set){ .planes = snapshot->clips, .n_planes = snapshot->n_clips };
}

/* Narrows the set by the heights of a body's lowest and highest point above plane i. False: the plane cuts all off. */
static bool leave_out(struct clip_set *set, size_t i, double low_mm, double high_mm)
{
    if (high_mm <= CLIP_SLACK_MM)
        set->left_out |= 1u << i;
    return low_mm <= CLIP_SLACK_MM;
}

bool draw_clip_box(struct clip_set *set, const struct box3 *box)
{
    for (size_t i = 0; i < set->n_planes; i++) {
        struct plane_reach reach = plane_reach(&set->planes[i].plane, box);
        if (clip_set_has(set, i) && !leave_out(set, i, reach.low_mm, reach.high_mm))
            return false;
    }
    return true;
}

/* The corners of the polygon in which a plane cuts a grid's outer faces, in no order; returns how many. */
static int slice_corners(const struct plane *plane, const struct grid *grid, struct vec3 found[24])
{
    struct vec3 corners[8];
    int n = 0;
    cut_grid_corners(grid, corners);
    for (int a = 0; a < 8; a++)
        for (int axis = 1; axis < 8; axis *= 2) {
            int b = a | axis;
            double low = plane_height_mm(plane, corners[a]), high = plane_height_mm(plane, corners[b]);
            if (a == b)
                continue;
            if (fabs(low) <= CLIP_SLACK_MM) /* also where an edge lies in the plane */
                found[n++] = plane_nearest(plane, corners[a]);
            if (fabs(high) <= CLIP_SLACK_MM)
                found[n++] = plane_nearest(plane, corners[b]);
            else if (fabs(low) > CLIP_SLACK_MM && (low < 0) != (high < 0))
                found[n++] = vec3_add(corners[a], vec3_scale(vec3_sub(corners[b], corners[a]), low / (low - high)));
        }
    return n;
}

bool draw_clip_slice(struct clip_set *set, const struct plane *plane, const struct grid *grid)
{
    struct vec3 corners[24];
    int n = slice_corners(plane, grid, corners);
    for (size_t i = 0; i < set->n_planes; i++) {
        double low_mm = INFINITY, high_mm = -INFINITY;
        for (int corner = 0; corner < n; corner++) {
            double height_mm = plane_height_mm(&set->planes[i].plane, corners[corner]);
            low_mm = fmin(low_mm, height_mm);
            high_mm = fmax(high_mm, height_mm);
        }
        if (clip_set_has(set, i) && !leave_out(set, i, low_mm, high_mm))
            return false;
    }
    return n > 0;
}

bool draw_clip_cuts(const struct clip_set *set)
{
    for (size_t i = 0; i < set->n_planes; i++)
        if (clip_set_has(set, i))
            return true;
    return false;
}

bool draw_clip_opens(const struct clip_set *set)
{
    for (size_t i = 0; i < set->n_planes; i++)
        if (clip_set_has(set, i) && !set->planes[i].is_capped)
            return true;
    return false;
}
