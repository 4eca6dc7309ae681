#pragma once
/* The figures of a built shape, for people to read: counts, area, volume, distance from the univels, time, memory. */
#include "core/surface/shape.h"

struct shape_facts {
    size_t n_triangles, n_vertices; /* vertices of triangles or of lines */
    size_t n_lines, n_points;       /* closed outlines; points */
    double area_mm2, volume_mm3;    /* of triangles; volume: enclosed, not-a-number for a fan: its triangles overlap */
    double univel_volume_mm3;       /* of the mask the shape is made from, descendants included */
    uint64_t n_univels;
    double distance_mean_mm, distance_max_mm; /* by derive_shape_distance; not-a-number: not measured */
    double build_ms;
    uint64_t n_bytes;   /* of memory */
    uint32_t reduction; /* univels merged into one along their shortest edge: 1 for a full shape, and for a coarse one
                           that any reduction would empty */
};

/* Fills what the shape alone tells: counts, area, volume, memory; distances become not-a-number. */
void shape_facts_count(const struct shape *shape, struct shape_facts *facts);
