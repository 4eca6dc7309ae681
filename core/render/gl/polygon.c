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
