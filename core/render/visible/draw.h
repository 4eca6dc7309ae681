#pragma once
/* The draw list of a picture: what is drawn, how, and in which order. Made from a snapshot by draw_list.h; the back
 * ends execute the draws one after the other and decide no order themselves. Knows no pixels and no GL. */
#include "core/derive/subject.h"
#include "core/render/visible/cut.h"
#include "core/render/visible/draw_cache.h"
#include "core/render/visible/visible.h"
#include "core/scene/camera.h"

/* In the order of drawing. Lines (of tracks) come after translucent shapes. */
enum draw_pass {
    DRAW_OPAQUE,      /* opaque shapes, the nearest first */
    DRAW_PLANES,      /* images and labels on planes, caps */
    DRAW_TRANSLUCENT, /* a volume; translucent shapes: by the scene's order, then the farthest first */
    DRAW_OVERLAY      /* lines painted over the finished picture by overlay.h, not by a back end */
};

enum draw_kind {
    DRAW_SHAPE,    /* triangles, lines or points */
    DRAW_IMAGE,    /* an image on a plane */
    DRAW_LABELS,   /* some labels of a label layer on a plane */
    DRAW_CAP,      /* what a clip plane cuts through, closed with the image */
    DRAW_VOLUME,   /* an image as a volume */
    DRAW_OUTLINE,  /* overlay: the outline of a region's surface or univels on a plane */
    DRAW_CHECK,    /* overlay: where univels and surface of a region differ on a plane */
    DRAW_GRID_CUT, /* overlay: where a plane cuts the grids of a dose */
    DRAW_GRID_BOX  /* overlay: the edges of the grids of a dose */
};

enum draw_depth {
    DRAW_DEPTH_NONE,   /* lies over all that was drawn before it */
    DRAW_DEPTH_TESTED, /* hidden by nearer draws, hides farther ones */
    /* Its nearest sheet goes into a layer of its own. The layers of consecutive draws are tested against what was drawn
     * before the first of them and composed together. */
    DRAW_DEPTH_LAYER
};

/* The half-spaces that a draw is cut off by: what lies more than CLIP_SLACK_MM above any of the planes is not drawn. */
struct clip_set {
    const struct clip_plane *planes; /* the snapshot's */
    size_t n_planes;
    uint32_t left_out; /* bit i is set: planes[i] does not cut this draw */
};
static inline bool clip_set_has(const struct clip_set *set, size_t i)
{
    return !(set->left_out >> i & 1);
}

struct draw_shape {
    const struct drawable *drawable; /* made by the back end; its bounds are not empty */
    struct visible_look look;
    struct visible_cue cue; /* of lines */
};

/* Grey = (value - low) / width; drawn where it is cull or more. */
struct draw_image {
    double low, width; /* in the image's unit */
    double cull;       /* as grey; -infinity: drawn everywhere */
    bool is_low_white; /* grey 0 is white, 1 is black */
    bool is_linear;    /* interpolated between voxels */
};

/* A region in a cap: closed outlines in the clip plane, by the even-odd rule. */
struct draw_cap_region {
    size_t region;
    const struct cut_lines *lines; /* owned by the list or its cache; where the plane cuts the very shape drawn */
    uint32_t color_rgb;
};

/* Closes a cut: every sample of the plane that is inside one of the regions is opaque and shows the image, dark where
 * there is none, as far as no other clip plane cuts it. */
struct draw_cap {
    const struct draw_cap_region *regions; /* the lowest rank first: of several at a point the last one counts */
    size_t n_regions;
    bool has_image,
        has_volume;     /* has_volume: also where the volume is seen: the image's value is volume_from or more */
    double volume_from; /* in the image's unit */
    struct draw_image image;
    double tint;       /* part of the region's colour in the mixed one; 0: none */
    double outline_px; /* width of the regions' outlines on the full picture; 0: none */
};
/* The colour of a cap where there is no image. */
#define DRAW_CAP_DARK 0x14120fu

/* An image as a volume. The ray is sampled in the image's grid; what nearer opaque draws hide is left out, and its
 * samples are mixed with translucent layers in their order of depth. */
enum { DRAW_VOLUME_TABLE = 1024 };
struct draw_volume {
    enum scene_volume_method method;
    /* Of the method ray: colour 0..1 and absorption per mm (natural: light exp(-a d) passes d mm), not premultiplied,
     * at DRAW_VOLUME_TABLE values from low to low + width, both included; constant beyond. The list's. */
    const float (*table)[4];
    double low, width;
    double cull;             /* in the image's unit; smaller values are not drawn; -infinity: all are */
    struct draw_image image; /* window and colours of the methods slices, mip and average */
    int n_slices;            /* of the method slices */
    bool is_linear, is_shaded;
    bool is_still; /* full quality */
};

struct draw_lines {
    double width_px;            /* on the full picture */
    enum outline_method method; /* DRAW_OUTLINE of univels */
    bool is_of_surface;         /* DRAW_OUTLINE: of the surface, not of univels */
    bool may_be_univels;        /* of univels, by method, as long as the surface is not built */
    struct shape_key key;       /* of the surface */
};

struct draw {
    enum draw_pass pass;
    enum draw_kind kind;
    enum draw_depth depth;
    struct subject subject;
    struct clip_set clip;
    struct plane plane; /* of images, labels, outlines, checks, cuts */
    uint32_t color_rgb;
    double opacity;
    union { /* the member that kind names */
        struct draw_shape shape;
        struct draw_image image;
        const uint8_t *palette; /* DRAW_LABELS: [VISIBLE_N_LABELS][4], label to RGBA, alpha 0: not drawn; the list's */
        struct draw_cap cap;
        struct draw_volume volume;
        struct draw_lines lines;
    };
};

struct draw_list {
    struct draw *draws;
    size_t n, capacity;
    size_t n_in_image; /* those before DRAW_OVERLAY, for the back end */
    int samples;       /* along a side of a pixel */
    /* True: the layers of each sample are composed in their own order of depth, where a layer counts as nearer by
     * VISIBLE_RANK_DEPTH for each layer before it. False: in the order of the list. */
    bool is_order_exact;
    size_t n_layers_planned; /* translucent draws there are at most, wherever the camera is */
    size_t n_triangles;
    bool is_coarse;            /* some shape is of reduced detail */
    uint8_t *palettes;         /* of DRAW_LABELS */
    struct draw_cache_use use; /* keeps the drawables until the list is destroyed */
};

/* The inputs of a draw list; borrowed. */
struct draw_scope {
    const struct snapshot *snapshot;
    const struct camera *camera; /* the snapshot's, resolved */
    enum surface_detail detail;
    struct draw_cache *cache;
    bool is_still; /* false: the next picture comes soon */
};

/* Appends a draw. errors ERROR_MEMORY */
NODISCARD bool draw_list_add(struct draw_list *list, const struct draw *draw, struct error *err);
/* How many draws from `first` on have the depth rule DRAW_DEPTH_LAYER, one after the other. */
size_t draw_list_n_layers(const struct draw_list *list, size_t first);
