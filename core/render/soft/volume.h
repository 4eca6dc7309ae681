#pragma once
/* Draws an image as a volume: rays through its grid, mixed with the translucent layers of each sample in their order of
 * depth. The rule that rays follow stands in core/render/visible/draw.h. */
#include "core/render/soft/kernels.h"
#include "core/render/visible/draw.h"

enum { SOFT_RAY_PLANES = 16 };

/* A quantity that is linear in the place in the picture: at its corner, change with a sample right, and down. */
struct soft_linear {
    double at, right, down;
};

/* A clip plane along a ray: height of the ray's origin above it, and change of it with a mm of depth. */
struct soft_ray_plane {
    struct soft_linear origin_mm, per_depth;
    bool is_capped;
};

/* A volume in a picture, ready to be drawn. Depth is the distance from the eye along the line of sight, mm; the length
 * of a ray is measured from the eye (parallel: from the eye's plane). */
struct soft_volume {
    enum scene_volume_method method;
    /* the grid */
    const void *voxels;
    enum soft_voxel type;
    uint32_t size[3];
    struct volume_leaps *leaps;   /* a reference */
    const uint8_t *leap;          /* of leaps; NULL: nothing is skipped */
    struct volume_bricks *bricks; /* of mip: a reference */
    uint32_t n_bricks[3];
    /* rays: index of the origin, and change of it with a mm of depth; the same in the picture's axes right, up */
    struct soft_linear origin[3], per_depth[3], right, up;
    double near_mm;
    double depth_scale, depth_offset; /* depth = scale / (z - offset); parallel: (z - offset) scale */
    bool is_parallel;
    struct soft_ray_plane planes[SOFT_RAY_PLANES];
    int n_planes;
    /* values: t = raw scale + offset is an entry of the table, or of other methods grey 0..1; less than cull is not
     * there */
    float scale, offset, cull;
    float value_scale, value_offset; /* t of a value in the image's unit */
    float step_voxels, step_limit_mm;
    double first_depth, part_depth; /* slices: of the first plane; from plane to plane */
    int n_slices;
    bool is_linear, is_shaded;
    int samples; /* along a side of a pixel */
    float absorption[DRAW_VOLUME_TABLE];
    uint32_t color[DRAW_VOLUME_TABLE];
    float to_eye[3][3]; /* from the change of t with an index to its gradient along right, up, towards the viewer */
    float gradient;     /* that is lit half */
    struct visible_lights lights;
    /* colours of values: grey = t grey_scale + grey_offset */
    float grey_scale, grey_offset;
    float top; /* the highest level */
    uint32_t flip, darkest[3];
    const uint32_t *colors;                   /* by level 0..top; NULL: grey, and top is 255 */
    const struct soft_wash *wash, *face_wash; /* of samples, of cut faces; NULL: none. The caller fills them */
};

/* Sets how values of an image become colours in its window, as far as `paint` needs it: voxels, type, size, scale,
 * offset, interpolation and colours. */
struct draw_image;
void soft_volume_init_image(struct soft_volume *volume, const struct volume *image, const struct draw_image *look);

/* A place in the picture is in samples. table: the draw's. What it takes from the store is given back by
 * soft_volume_finish. errors ERROR_MEMORY */
NODISCARD bool soft_volume_init(struct soft_volume *volume, const struct draw *draw, const struct draw_scope *scope,
                                int width, int height, int samples, struct error *err);
void soft_volume_finish(struct soft_volume *volume);
/* Fills per_pixel: the volume with one ray for each pixel of the picture, that of its first sample. Borrows from
 * `volume`. */
void soft_volume_per_pixel(const struct soft_volume *volume, struct soft_volume *per_pixel);

struct soft_wash;
struct soft_paint;
struct soft_volume_kernels {
    const char *name;
    /* Blends the volume and the layers over the band's colours, as compose of soft_kernels does for layers alone, and
     * clears the layers. */
    void (*compose)(const struct soft_volume *volume, const struct soft_band *band, struct soft_layer *layers,
                    int n_layers, float rank_depth);
    /* Depths 0 near .. 1 far where a volume of the method ray has absorbed half of the light, of SOFT_LANES pixels side
     * by side: negative on a cut face, 1 where it absorbs less. x, y: the first one's place, in the units of the
     * volume's rays. opaque: depths -1 .. 1 of the opaque draws. */
    void (*depths)(const struct soft_volume *volume, int x, int y, const float opaque[SOFT_LANES],
                   float depth[SOFT_LANES]);
    /* Lays a wash over those of n samples of a plane, from (x, y) of the picture on, whose alpha is `mark`; it becomes
     * SOFT_OPAQUE. color: the band's row. */
    void (*wash)(const struct soft_wash *wash, int x, int y, int n, uint32_t mark, uint32_t *color);
    /* Lays a wash or an image over the samples of a shape, in the columns range[0] .. range[1] - 1 of the band: with
     * opaque NULL over those with the alpha SOFT_MARK, which becomes SOFT_OPAQUE; else over those of a layer that are
     * nearer than `opaque`. */
    void (*paint)(const struct soft_paint *paint, const struct soft_band *band, const int range[2],
                  const float *opaque);
};
extern const struct soft_volume_kernels soft_volume_kernels_portable;
/* Those that go with the rasteriser's. */
const struct soft_volume_kernels *soft_volume_kernels_of(const struct soft_kernels *kernels);
