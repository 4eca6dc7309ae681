#pragma once
/* A shape: what a region is drawn as, in triangles, lines or points, patient LPS, mm. Frozen once published. Knows no
 * plan, scene or GL. Any thread. */
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
/* Words as in scene and API: "surface", "outline", "points", "univels", "solid", "nurbs", "fan". */
const char *region_representation_word(enum region_representation representation);
NODISCARD bool region_representation_from_word(const char *word, enum region_representation *representation);

enum nurbs_sampling { NURBS_TRACES, NURBS_DEGREE_BINS };

/* Everything that decides a shape besides the region's voxels. shape_key_normalise sets the fields that a
 * representation does not use to 0, so that equal shapes have equal keys. */
struct shape_key {
    enum region_representation representation;
    enum surface_algorithm algorithm; /* for surface */
    enum outline_method outline;      /* for outline */
    bool has_inner_boundary; /* for points, solid: also points where the region touches only its own descendants */
    int nurbs_order;         /* for nurbs: 2, 3, 4 */
    enum nurbs_sampling nurbs_sampling;
    int nurbs_bins; /* for nurbs: number of degree bins, 8..360, or of samples per trace */
};
void shape_key_normalise(struct shape_key *key);
bool shape_key_equal(const struct shape_key *a, const struct shape_key *b); /* both keys normalised */

struct line_set {
    float *positions_lps_mm; /* [n_vertices][3] */
    uint32_t *indices;       /* [n_segments][2] */
    size_t n_vertices, n_segments;
    size_t n_lines; /* number of closed outlines */
};

/* One point per border voxel, at its centre. */
struct point_set {
    float *positions_lps_mm; /* [n_points][3] */
    float *normals; /* [n_points][3] unit vectors, direction the border faces; 0 0 0 where no direction is more outward
                       than another */
    uint8_t *shade; /* [n_points] 0..255: shade under a fixed light, computed once (solid) */
    struct vec3 edge_lps_mm[3]; /* the edges of a voxel: what a point must cover to leave no gap */
    size_t n_points;
};

enum shape_kind { SHAPE_TRIANGLES, SHAPE_LINES, SHAPE_POINTS };

struct shape {
    enum shape_kind kind;
    bool is_faceted;   /* triangles are always shaded with one normal each (univels, fan) */
    struct mesh *mesh; /* the one that kind names; the others are NULL */
    struct line_set *lines;
    struct point_set *points;
    struct box3 bounds_lps_mm;
    size_t n_bytes; /* memory in bytes */
    _Atomic int references;
};
struct shape *shape_ref(const struct shape *shape);
void shape_unref(const struct shape *shape);
