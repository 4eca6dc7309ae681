#pragma once
/* A triangle mesh in patient space. Frozen once published. */
#include <stddef.h>
#include <stdint.h>

#include "core/base/error.h"
#include "core/math/vec.h"

struct mesh {
    float *positions_lps_mm; /* [n_vertices][3] */
    float *normals;          /* [n_vertices][3] unit, outward; NULL before mesh_make_normals */
    uint32_t *indices;       /* [n_triangles][3], counter-clockwise seen from outside */
    size_t n_vertices, n_triangles;
    struct box3 bounds_lps_mm;
    _Atomic int references;
};

/* Positions and indices are there to be filled, not zeroed. errors ERROR_MEMORY, ERROR_LIMIT */
NODISCARD struct mesh *mesh_create(size_t n_vertices, size_t n_triangles, struct error *err);
struct mesh *mesh_ref(const struct mesh *mesh);
void mesh_unref(const struct mesh *mesh);

/* Area-weighted sum of the triangles at each vertex; equal for any number of threads. */
NODISCARD bool mesh_make_normals(struct mesh *mesh, int n_threads, struct error *err);
void mesh_measure_bounds(struct mesh *mesh);
double mesh_area_mm2(const struct mesh *mesh);
double mesh_volume_mm3(const struct mesh *mesh); /* enclosed, signed: positive when triangles wind outward */
/* Directed edges without exactly one opposite, so 0 says closed and consistently wound; SIZE_MAX when there is no
 * memory to tell. */
size_t mesh_open_edges(const struct mesh *mesh);
/* Vertices that are used - edges + faces; LONG_MIN when there is no memory to tell. */
long mesh_euler(const struct mesh *mesh);
