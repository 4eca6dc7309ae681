/* Makes a point for every border voxel, with the direction it faces and its shade under one fixed light. */
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/surface/shape_border.h"
#include "core/surface/shape_make.h"
#include "core/surface/shape_parts.h"

static uint8_t shade_of(struct vec3 normal, struct vec3 light)
{
    double facing = (1 + vec3_dot(normal, light)) /
                    2; /* 0 away from the light .. 1 towards it; 0.5 for a point without a direction */
    return (uint8_t)(255 * (SHAPE_LIGHT_AMBIENT + (1 - SHAPE_LIGHT_AMBIENT) * facing) + 0.5);
}

static bool points_create(struct point_set *points, struct error *err)
{
    points->positions_lps_mm = mem_large_array(points->n_points, 3 * sizeof *points->positions_lps_mm, UINT64_MAX, err);
    points->shade = points->positions_lps_mm ? mem_array(points->n_points, 1, UINT64_MAX, err) : NULL;
    return points->shade != NULL;
}

struct point_set *shape_points(const struct mask *mask, int n_threads, struct error *err)
{
    struct shape_border *border = shape_border_create(mask, SHAPE_MAX_POINTS, n_threads, err);
    if (!border)
        return NULL;
    struct point_set *points = mem_new(sizeof *points);
    points->n_points = border->n;
    for (int axis = 0; axis < 3; axis++)
        points->edge_lps_mm[axis] = mask->lps_mm_from_ijk.columns[axis];
    if (!points_create(points, err)) {
        free(points->positions_lps_mm);
        free(points);
        shape_border_destroy(border);
        return NULL;
    }
    points->normals = border->normals;
    border->normals = NULL;
    struct vec3 light = vec3_normalize(SHAPE_LIGHT_LPS);
    for (size_t at = 0; at < points->n_points; at++) {
        const uint16_t *ijk = border->ijk + 3 * at;
        const float *n = points->normals + 3 * at;
        struct vec3 p = affine_point(&mask->lps_mm_from_ijk, vec3(ijk[0], ijk[1], ijk[2]));
        points->positions_lps_mm[3 * at] = (float)p.x;
        points->positions_lps_mm[3 * at + 1] = (float)p.y;
        points->positions_lps_mm[3 * at + 2] = (float)p.z;
        points->shade[at] = shade_of(vec3((double)n[0], (double)n[1], (double)n[2]), light);
    }
    shape_border_destroy(border);
    return points;
}
