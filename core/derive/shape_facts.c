/* Counts and measures a built shape. */
#include "core/derive/shape_facts.h"

#include <math.h>

void shape_facts_count(const struct shape *shape, struct shape_facts *facts)
{
    facts->distance_mean_mm = facts->distance_max_mm = NAN;
    facts->n_bytes = shape->n_bytes;
    switch (shape->kind) {
    case SHAPE_TRIANGLES:
        facts->n_triangles = shape->mesh->n_triangles;
        facts->n_vertices = shape->mesh->n_vertices;
        facts->area_mm2 = mesh_area_mm2(shape->mesh);
        facts->volume_mm3 = mesh_volume_mm3(shape->mesh);
        break;
    case SHAPE_LINES:
        facts->n_vertices = shape->lines->n_vertices;
        facts->n_lines = shape->lines->n_lines;
        break;
    case SHAPE_POINTS: facts->n_points = shape->points->n_points; break;
    }
}
