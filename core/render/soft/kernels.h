#pragma once
/* The inner loops of the software rasteriser, for any processor and for those with AVX2; both give the same bytes.
 * A colour is a 32-bit word: red in the lowest byte, alpha in the highest. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/render/visible/lights.h"

/* Sub-samples along a side of a sample. Vertices are rounded to them; coverage is computed exactly from there on. */
enum { SOFT_SUB_BITS = 8, SOFT_SUB = 1 << SOFT_SUB_BITS };
/* Triangles with a vertex farther from the picture's corner than this are clipped; in sub-samples (32768 samples). */
enum { SOFT_GUARD = 1 << 23 };
/* In x: marks such a vertex, or one in front of the near plane. */
#define SOFT_CLIPPED INT32_MIN
/* Alpha of drawn opaque samples; of those that wait for the colours of wash.h it is SOFT_MARK. */
#define SOFT_OPAQUE 0xff000000u
#define SOFT_MARK 0xfd000000u
/* Rows of samples in a band. */
enum { SOFT_BAND_ROWS = 32 };
/* Samples in a vector; and padding of a row, as drawing touches up to SOFT_LANES - 1 samples beyond a triangle. */
enum { SOFT_LANES = 8, SOFT_PADDING = 2 * SOFT_LANES };

struct soft_vertex {
    int32_t x, y;   /* sub-samples, y down; x == SOFT_CLIPPED: invalid */
    float z;        /* -1 near .. 1 far */
    uint32_t shade; /* shaded colour and opacity */
};

/* Projects and shades the vertices of a shape. Rows of matrices are applied to (x, y, z, 1). */
struct soft_lighting {
    float row_x[4], row_y[4], row_z[4], row_w[4]; /* give sub-samples times w, depth times w, w */
    float viewer[4]; /* perspective: the eye and 1; parallel: the direction towards the viewer and 0 */
    float right[3], up[3], towards[3]; /* axes of eye space, in patient space */
    float color[3], opacity;
    struct visible_lights lights;
    bool is_rim, is_two_sided;
    uint32_t mark; /* flips bits of the shaded colour's alpha */
};

/* Positions and normals by component. */
struct soft_points {
    const float *x, *y, *z;
    const int16_t *nx, *ny, *nz; /* 32767 is 1 */
};

/* Planes that cut a shape off, as cut.h cuts its mesh: what is at the position along the normal or beyond is cut off.
 */
enum { SOFT_MAX_CUTS = 8 };
struct soft_cuts {
    float normal[SOFT_MAX_CUTS][3], position[SOFT_MAX_CUTS];
    int n;
};

/* Rows of samples. stride: from row to row, at least SOFT_PADDING more than width. */
struct soft_band {
    int first_row, n_rows, width, stride;
    float *depth;
    uint32_t *color;
};

/* The nearest sheet of one translucent shape, in rows of the same size. Depth is 1 and colour 0 where there is none,
 * and everywhere between pictures. */
struct soft_layer {
    float *depth;
    uint32_t *color;
    int range[2]; /* the columns that may hold something: range[0] <= x < range[1] */
};
enum { SOFT_MAX_LAYERS = 1123 };

/* Triangles to draw into a band. A ref is the number of a triangle of indices; with SOFT_EXTRA, of one of extras. With
 * SOFT_RECTANGLE too, it is a rectangle with the depth and colour of its first corner, left and above; the second
 * corner is right and below, the third is unused. */
#define SOFT_EXTRA 0x80000000u
#define SOFT_RECTANGLE 0x40000000u
struct soft_triangles {
    const uint32_t *refs;
    size_t n_refs;
    const uint32_t *indices;
    const struct soft_vertex *vertices;
    const struct soft_vertex *extras;
};

/* A row of samples of a plane through a grid: index along each of the three axes times 1 / w, then 1 / w, then depth;
 * at the first sample, and the step from sample to sample. */
struct soft_row {
    double at[5], step[5];
    const struct soft_blend *blend;    /* NULL: none */
    double blend_at[3], blend_step[3]; /* the same as the first three, in the grid of blend */
};

enum soft_voxel { SOFT_U8, SOFT_U16, SOFT_I16, SOFT_F32 };
struct soft_texture {
    const void *voxels;
    enum soft_voxel type;
    uint32_t size[3];
    float grey_scale, grey_offset,
        cull;                /* grey = value * scale + offset, 0 .. 1; not drawn where it is less than cull */
    float top;               /* the highest level: 255, of a table of tones DRAW_TONES - 1 */
    uint32_t flip;           /* as top: grey 0 is white, 1 is black; else 0 */
    uint32_t darkest[3];     /* red, green and blue of a grey are at least this */
    const uint32_t *palette; /* by label; NULL: grey */
    const uint32_t *colors;  /* by level 0..top, as draw_image has them; NULL: grey, and top is 255 */
    bool is_linear, has_depth;
    uint32_t alpha; /* of drawn samples, as a word; of labels the palette's */
};

/* A second image over a plane's: where it lies inside its grid and is finite, it makes `part` of the colour. */
struct soft_blend {
    struct soft_texture texture; /* no palette, no cull, no depth */
    float part;
};

/* How the samples of a cap are drawn. */
struct soft_cover {
    const struct soft_texture *texture; /* NULL: dark everywhere */
    int image_first, image_end;         /* the samples of the row that the texture's grid holds */
    const uint32_t *tints;              /* by sample of the row, mixed with the texture; NULL: none */
    uint32_t tint;                      /* parts of 256 of them */
    uint32_t dark;                      /* the colour where the texture has none */
    uint32_t mark;                      /* flips bits of the drawn samples' alpha */
    float nearer;                       /* than the row's depth */
};

struct soft_kernels {
    const char *name;
    void (*shade)(const struct soft_lighting *lighting, const struct soft_points *points, size_t first, size_t n,
                  struct soft_vertex *out);
    /* Fills above, after `shade`: bit c of a vertex is set where cut c cuts it off. Such a vertex becomes invalid. */
    void (*classify)(const struct soft_cuts *cuts, const struct soft_points *points, size_t first, size_t n,
                     uint8_t *above, struct soft_vertex *vertices);
    /* Widens range to the columns that were drawn to. */
    void (*raster)(const struct soft_band *band, const struct soft_triangles *triangles, int range[2]);
    /* Blends the layers' samples that are nearer than the band's depth over its colours, and clears the layers.
     * rank_depth > 0: at each sample the farthest first, where a layer counts as this much nearer for each layer before
     * it; else in the order of the layers. */
    void (*compose)(const struct soft_band *band, struct soft_layer *layers, int n_layers, float rank_depth);
    /* Draws samples first .. first + n - 1 of a row of a plane. */
    void (*sample)(const struct soft_texture *texture, const struct soft_row *row, int first, int n, float *depth,
                   uint32_t *color);
    /* Draws samples first .. first + n - 1 of a row of a cap where they are nearer than the depth. */
    void (*cover)(const struct soft_cover *cover, const struct soft_row *row, int first, int n, float *depth,
                  uint32_t *color);
    /* Means of 2 x 2 samples of two rows: n pixels. */
    void (*halve)(const uint32_t *upper, const uint32_t *lower, int n, uint32_t *out);
};

extern const struct soft_kernels soft_kernels_portable;
const struct soft_kernels *soft_kernels_best(void); /* the fastest on this processor */
/* The shaded colour of one point, as `shade` computes it. Both directions are unit vectors. */
uint32_t soft_light(const struct soft_lighting *lighting, const float normal_lps[3], const float towards_lps[3]);
