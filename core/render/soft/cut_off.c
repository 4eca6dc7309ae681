/* Cuts triangles and segments off at clip planes, in patient space. */
#include <math.h>
#include <string.h>

#include "core/render/soft/chunk.h"
#include "core/render/visible/cut.h"
#include "core/render/visible/draw.h"

struct soft_cuts soft_cuts_of(const struct clip_set *clip)
{
    struct soft_cuts cuts = { .n = 0 };
    for (size_t i = 0; i < clip->n_planes; i++) {
        if (!clip_set_has(clip, i))
            continue;
        struct cut_plane cut = cut_plane(&clip->planes[i].plane);
        memcpy(cuts.normal[cuts.n], cut.normal, sizeof cut.normal);
        cuts.position[cuts.n++] = clip->planes[i].is_capped ? cut.position : nextafterf(cut.position, INFINITY);
    }
    return cuts;
}

/* A corner before projection. */
struct point {
    struct vec3 lps_mm;
    double at_mm[SOFT_MAX_CUTS]; /* along the normals of the cuts */
    double shade[4];
    const struct soft_vertex *own;
};
enum { MAX_POINTS = 4 + SOFT_MAX_CUTS };

static struct point vertex_point(const struct soft_item *item, uint32_t vertex)
{
    const struct soft_points *points = &item->shape->points;
    float x = points->x[vertex], y = points->y[vertex], z = points->z[vertex];
    struct point point = { .lps_mm = { (double)x, (double)y, (double)z }, .own = &item->vertices[vertex] };
    for (int c = 0; c < item->cuts.n; c++)
        point.at_mm[c] = (double)cut_position(x, y, z, item->cuts.normal[c]);
    return point;
}

static bool is_above(const struct soft_cuts *cuts, int cut, const struct point *point)
{
    return point->at_mm[cut] >= (double)cuts->position[cut];
}

/* The point on the edge between two points on different sides of a cut. */
static struct point meet(const struct soft_cuts *cuts, int cut, const struct point *a, const struct point *b)
{
    const struct point *below = is_above(cuts, cut, a) ? b : a, *above = below == a ? b : a;
    double share = cut_share(below->at_mm[cut], above->at_mm[cut], (double)cuts->position[cut]);
    struct point point = { .lps_mm = cut_between(below->lps_mm, above->lps_mm, share) };
    for (int c = 0; c < cuts->n; c++)
        point.at_mm[c] = below->at_mm[c] + share * (above->at_mm[c] - below->at_mm[c]);
    for (int c = 0; c < 4; c++)
        point.shade[c] = below->shade[c] + share * (above->shade[c] - below->shade[c]);
    return point;
}

/* Source: I. E. Sutherland, G. W. Hodgman, Reentrant Polygon Clipping, CACM 1974. */
static int cut_off(const struct soft_cuts *cuts, int cut, const struct point *points, int n, struct point *kept)
{
    int n_kept = 0;
    for (int i = 0; i < n; i++) {
        const struct point *a = &points[i], *b = &points[(i + 1) % n];
        bool is_a_above = is_above(cuts, cut, a);
        if (!is_a_above)
            kept[n_kept++] = *a;
        if (is_a_above != is_above(cuts, cut, b) && n_kept < MAX_POINTS)
            kept[n_kept++] = meet(cuts, cut, a, b);
    }
    return n_kept;
}

void soft_cut_polygon(const struct soft_item *item, const uint32_t *vertices, int n, const uint32_t *shades,
                      struct soft_polygon *polygon)
{
    struct point points[2][MAX_POINTS + 1];
    uint8_t above = 0;
    int from = 0;
    for (int i = 0; i < n; i++) {
        points[0][i] = vertex_point(item, vertices[i]);
        for (int c = 0; c < 4; c++)
            points[0][i].shade[c] = (double)(shades[i] >> 8 * c & 255);
        above |= item->above[vertices[i]];
    }
    for (int cut = 0; cut < item->cuts.n; cut++)
        if (above >> cut & 1) {
            n = cut_off(&item->cuts, cut, points[from], n, points[1 - from]);
            from = 1 - from;
        }
    polygon->n = n;
    for (int i = 0; i < n; i++) {
        const struct point *point = &points[from][i];
        struct soft_corner *corner = &polygon->corners[i];
        soft_project(&item->lighting, point->lps_mm.x, point->lps_mm.y, point->lps_mm.z, corner);
        for (int c = 0; c < 4; c++)
            corner->shade[c] = point->shade[c];
        corner->own = point->own;
    }
}

bool soft_cut_segment(const struct soft_item *item, const uint32_t vertices[2], struct vec3 ends_lps_mm[2])
{
    struct point ends[2] = { vertex_point(item, vertices[0]), vertex_point(item, vertices[1]) };
    for (int cut = 0; cut < item->cuts.n; cut++) {
        bool is_first_above = is_above(&item->cuts, cut, &ends[0]);
        if (is_first_above == is_above(&item->cuts, cut, &ends[1])) {
            if (is_first_above)
                return false;
            continue;
        }
        ends[is_first_above ? 0 : 1] = meet(&item->cuts, cut, &ends[0], &ends[1]);
    }
    ends_lps_mm[0] = ends[0].lps_mm;
    ends_lps_mm[1] = ends[1].lps_mm;
    return true;
}
