#pragma once
/* An index of a mesh's triangles along a patient axis: finds the few that a plane across the axis can cut. Frozen. Any
 * thread. */
#include "core/surface/mesh.h"

struct mesh_slabs {
    /* Triangles sorted by the slab that holds their lowest coordinate: slab s has triangles[starts[s]] ..
     * triangles[starts[s + 1] - 1]. */
    uint32_t *triangles; /* [n_triangles] */
    uint32_t *starts;    /* [n_slabs + 2], the last unused */
    uint32_t n_slabs;
    float low_mm, slabs_per_mm; /* slab 0 begins at low_mm */
    float longest_mm;           /* extent of the longest triangle along the axis */
    size_t n_bytes;             /* memory in bytes */
};

/* axis: 0 L, 1 P, 2 S. errors ERROR_MEMORY */
NODISCARD struct mesh_slabs *mesh_slabs_create(const struct mesh *mesh, int axis, struct error *err);
void mesh_slabs_destroy(struct mesh_slabs *slabs);
/* The triangles with a vertex below the position and one at or above it, and some more: triangles[*first] ..
 * triangles[*end - 1]. */
void mesh_slabs_find(const struct mesh_slabs *slabs, float position_mm, size_t *first, size_t *end);
