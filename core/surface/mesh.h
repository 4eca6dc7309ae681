#pragma once
/* A triangle mesh in patient LPS, mm. Frozen once published. Any thread. */
#include <stddef.h>
#include <stdint.h>

#include "core/base/error.h"
#include "core/math/vec.h"

struct mesh {
    float *positions_lps_mm; /* [n_vertices][3] */
    float *normals;          /* [n_vertices][3] unit vectors, outward; NULL before mesh_make_normals */
    uint32_t *indices;       /* [n_triangles][3], counter-clockwise as seen from outside */
    size_t n_vertices, n_triangles;
    struct box3 bounds_lps_mm;
    _Atomic int references;
};

/* Creates a mesh with uninitialized positions and indices. Errors: ERROR_MEMORY, ERROR_LIMIT. */
NODISCARD struct mesh *mesh_create(size_t n_vertices, size_t n_triangles, struct error *err);
struct mesh *mesh_ref(const struct mesh *mesh);
void mesh_unref(const struct mesh *mesh);

/* Sets each vertex normal to the area-weighted mean of its triangles' normals; equal bytes for any number of
 * threads. */
NODISCARD bool mesh_make_normals(struct mesh *mesh, int n_threads, struct error *err);
void mesh_measure_bounds(struct mesh *mesh);
double mesh_area_mm2(const struct mesh *mesh);
double mesh_volume_mm3(const struct mesh *mesh); /* enclosed volume, signed: positive if triangles wind outward */
/* Number of directed edges without exactly one opposite; 0 means closed and consistently wound. SIZE_MAX if there is no
 * memory to tell. */
size_t mesh_open_edges(const struct mesh *mesh);
/* Euler number: used vertices - edges + faces. LONG_MIN if there is no memory to tell. */
long mesh_euler(const struct mesh *mesh);
