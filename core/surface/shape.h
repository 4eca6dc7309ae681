#pragma once
/* What a region is drawn as: triangles, lines or points, in patient space. Frozen once published. Knows no plan, scene
 * or GL. */
#include "core/region/outline.h"
#include "core/surface/mesh.h"
#include "core/surface/surface.h"

enum region_representation {
    REPRESENTATION_SURFACE,
    REPRESENTATION_OUTLINE,
    REPRESENTATION_POINTS,
    REPRESENTATION_UNIVELS,
    REPRESENTATION_SOLID,
    REPRESENTATION_NURBS,
    REPRESENTATION_FAN,
    REPRESENTATION_N
};
/* As in scene and API: "surface", "outline", "points", "univels", "solid", "nurbs", "fan". */
const char *region_representation_word(enum region_representation representation);
NODISCARD bool region_representation_from_word(const char *word, enum region_representation *representation);

enum nurbs_sampling { NURBS_TRACES, NURBS_DEGREE_BINS };

/* All that decides a shape besides the region's voxels. Fields that a representation does not use are 0 in a key
 * (shape_key_normalise), so that equal shapes have equal keys. */
struct shape_key {
    enum region_representation representation;
    enum surface_algorithm algorithm; /* surface */
    enum outline_method outline;      /* outline */
    bool has_inner_boundary;          /* points, solid: also where the region touches only its own descendants */
    int nurbs_order;                  /* nurbs: 2, 3, 4 */
    enum nurbs_sampling nurbs_sampling;
    int nurbs_bins; /* nurbs by degree bins: bins around, 8..360; by traces: samples around */
};
void shape_key_normalise(struct shape_key *key);
bool shape_key_equal(const struct shape_key *a, const struct shape_key *b); /* of normalised keys */

struct line_set {
    float *positions_lps_mm; /* [n_vertices][3] */
    uint32_t *indices;       /* [n_segments][2] */
    size_t n_vertices, n_segments;
    size_t n_lines; /* closed outlines they form */
};

/* One point a border voxel, at its centre. */
struct point_set {
    float *positions_lps_mm; /* [n_points][3] */
    float
        *normals; /* [n_points][3] unit, which way the border faces; 0 0 0 where no way is more outward than another */
    uint8_t *shade;             /* [n_points] 0..255: light from a fixed direction, worked out once (solid) */
    struct vec3 edge_lps_mm[3]; /* a voxel's three edges: what a point must cover to leave no gap */
    size_t n_points;
};

enum shape_kind { SHAPE_TRIANGLES, SHAPE_LINES, SHAPE_POINTS };

struct shape {
    enum shape_kind kind;
    bool is_faceted;   /* triangles: always shaded with one normal a triangle (univels, fan) */
    struct mesh *mesh; /* the one that kind says; the others are NULL */
    struct line_set *lines;
    struct point_set *points;
    struct box3 bounds_lps_mm;
    size_t n_bytes; /* of memory */
    _Atomic int references;
};
struct shape *shape_ref(const struct shape *shape);
void shape_unref(const struct shape *shape);
