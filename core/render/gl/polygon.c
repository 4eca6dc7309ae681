/* Cuts convex polygons. Source: I. E. Sutherland, G. W. Hodgman, Reentrant Polygon Clipping, CACM 1974. */
#include "core/render/gl/polygon.h"

struct gl_polygon gl_polygon_of_reach(const struct plane *plane, const struct plane_reach *reach)
{
    return (struct gl_polygon){ 4,
                                { plane_point(plane, reach->low_right_mm, reach->low_up_mm),
                                  plane_point(plane, reach->high_right_mm, reach->low_up_mm),
                                  plane_point(plane, reach->high_right_mm, reach->high_up_mm),
                                  plane_point(plane, reach->low_right_mm, reach->high_up_mm) } };
}

void gl_polygon_keep(struct gl_polygon *polygon, const double inside[GL_POLYGON_CORNERS])
{
    struct gl_polygon kept = { 0 };
    for (int i = 0; i < polygon->n; i++) {
        int next = (i + 1) % polygon->n;
        struct vec3 a = polygon->lps_mm[i], b = polygon->lps_mm[next];
        double fa = inside[i], fb = inside[next];
        if (fa >= 0 && kept.n < GL_POLYGON_CORNERS)
            kept.lps_mm[kept.n++] = a;
        if ((fa >= 0) != (fb >= 0) && kept.n < GL_POLYGON_CORNERS)
            kept.lps_mm[kept.n++] = vec3_add(a, vec3_scale(vec3_sub(b, a), fa / (fa - fb)));
    }
    *polygon = kept;
}

void gl_polygon_clip(struct gl_polygon *polygon, const struct clip_set *clip)
{
    double inside[GL_POLYGON_CORNERS];
    for (size_t c = 0; c < clip->n_planes; c++) {
        if (!clip_set_has(clip, c))
            continue;
        for (int i = 0; i < polygon->n; i++)
            inside[i] = CLIP_SLACK_MM - plane_height_mm(&clip->planes[c].plane, polygon->lps_mm[i]);
        gl_polygon_keep(polygon, inside);
    }
}

/* Distance of a point from one of the grid's outer faces, in voxels; positive inside. */
static double inside_face(const struct grid *grid, int face, struct vec3 p_lps_mm)
{
    struct vec3 ijk = affine_point(&grid->ijk_from_lps_mm, p_lps_mm);
    double at = face / 2 == 0 ? ijk.x : face / 2 == 1 ? ijk.y : ijk.z;
    return face % 2 ? grid->size[face / 2] - 0.5 - at : at + 0.5;
}

struct gl_polygon gl_slice_polygon(const struct grid *grid, const struct plane *plane, const struct clip_set *clip)
{
    struct box3 box = grid_bounds_lps_mm(grid);
    struct plane upright = plane_upright(plane);
    struct plane_reach reach = plane_reach(&upright, &box);
    struct gl_polygon polygon = gl_polygon_of_reach(&upright, &reach);
    for (int face = 0; face < 6; face++) {
        double inside[GL_POLYGON_CORNERS];
        for (int i = 0; i < polygon.n; i++)
            inside[i] = inside_face(grid, face, polygon.lps_mm[i]);
        gl_polygon_keep(&polygon, inside);
    }
    gl_polygon_clip(&polygon, clip);
    return polygon;
}
