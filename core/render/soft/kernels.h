#pragma once
/* The inner loops of the software rasteriser, for any processor and for one with AVX2; both give the same bytes.
 * Samples are packed as they lie in an image: red in the lowest byte, alpha in the highest. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Sub-samples along a sample: vertices are rounded to these, and all decisions about coverage are exact from there on.
 */
enum { SOFT_SUB_BITS = 8, SOFT_SUB = 1 << SOFT_SUB_BITS };
/* Vertices farther from the picture's corner than this (in sub-samples) go through the clipper: 32768 samples. */
enum { SOFT_GUARD = 1 << 23 };
/* Marks such a vertex, and one before the near plane, in x. */
#define SOFT_CLIPPED INT32_MIN
/* Rows of samples in a band. */
enum { SOFT_BAND_ROWS = 32 };
/* A vector of samples, and what rows are padded by: drawing may touch SOFT_LANES - 1 samples beyond a triangle. */
enum { SOFT_LANES = 8, SOFT_PADDING = 2 * SOFT_LANES };

struct soft_vertex {
    int32_t x, y;   /* sub-samples, y down; x == SOFT_CLIPPED: not to be used */
    float z;        /* -1 near .. 1 far */
    uint32_t shade; /* lit colour and opacity */
};

/* What turns a surface's vertices into soft_vertex. Rows of matrices are applied to (x, y, z, 1). */
struct soft_lighting {
    float row_x[4], row_y[4], row_z[4], row_w[4]; /* to sub-samples (times w), depth (times w), w */
    float viewer[4];                              /* eye and 1, or direction towards the viewer and 0 */
    float right[3], up[3], towards[3];            /* axes of the eye's space */
    float color[3], opacity;
    bool is_rim, is_two_sided;
};

/* Positions and normals by component. */
struct soft_points {
    const float *x, *y, *z;
    const int16_t *nx, *ny, *nz; /* 32767: 1 */
};

/* Some rows of samples. Rows are stride apart, at least SOFT_PADDING longer than the picture. */
struct soft_band {
    int first_row, n_rows, width, stride;
    float *depth;
    uint32_t *color;
};

/* What one translucent region has in the same rows: its nearest sheet. Where it has none, and everywhere between
 * pictures, depth 1 and colour 0. */
struct soft_layer {
    float *depth;
    uint32_t *color;
    int range[2]; /* the columns touched, [0] <= x < [1] */
};
enum { SOFT_MAX_LAYERS = 1024 };

/* Triangles to draw into a band: refs count the triangles of indices, or with SOFT_EXTRA those of extras. With
 * SOFT_RECTANGLE too it is a rectangle of one depth and colour: from the first corner, left and above, to the second;
 * the third is nothing. */
#define SOFT_EXTRA 0x80000000u
#define SOFT_RECTANGLE 0x40000000u
struct soft_triangles {
    const uint32_t *refs;
    size_t n_refs;
    const uint32_t *indices;
    const struct soft_vertex *vertices;
    const struct soft_vertex *extras;
};

/* One row of a plane through a grid: index along each axis times 1 / w, 1 / w and depth, at the first sample and a
 * sample's step. */
struct soft_row {
    double at[5], step[5];
};

enum soft_voxel { SOFT_U8, SOFT_U16, SOFT_I16, SOFT_F32 };
struct soft_texture {
    const void *voxels;
    enum soft_voxel type;
    uint32_t size[3];
    float grey_scale, grey_offset, cull; /* grey = value * scale + offset, 0 .. 1; left out where less than cull */
    uint32_t flip;                       /* 255: grey 0 is white, 1 is black; else 0 */
    const uint32_t *palette;             /* by label; NULL: grey */
    bool is_linear, has_depth;
};

struct soft_kernels {
    const char *name;
    void (*shade)(const struct soft_lighting *lighting, const struct soft_points *points, size_t first, size_t n,
                  struct soft_vertex *out);
    /* range grows to the columns touched, [0] <= x < [1]. */
    void (*raster)(const struct soft_band *band, const struct soft_triangles *triangles, int range[2]);
    /* Lays what is nearer than the band's depth over its colours, and clears the layers. rank_depth > 0: at each sample
     * the farther first, where a layer counts as so much nearer for each one before it; else in the order of the
     * layers. */
    void (*compose)(const struct soft_band *band, struct soft_layer *layers, int n_layers, float rank_depth);
    /* Samples first .. first + n of a row of a plane. */
    void (*sample)(const struct soft_texture *texture, const struct soft_row *row, int first, int n, float *depth,
                   uint32_t *color);
    /* Mean of 2 x 2 samples. */
    void (*halve)(const uint32_t *upper, const uint32_t *lower, int n, uint32_t *out);
};

extern const struct soft_kernels soft_kernels_portable;
const struct soft_kernels *soft_kernels_best(void); /* on this processor */
/* The light that falls on one point; normal of length 1. What shade does, for a single one. */
uint32_t soft_light(const struct soft_lighting *lighting, const float normal_lps[3], const float towards_lps[3]);
