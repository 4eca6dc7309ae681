#pragma once
/* The draw list of a picture: what is drawn, how, and in which order. Made from a snapshot by draw_list.h; the back
 * ends execute the draws one after the other and decide no order themselves. Knows no pixels and no GL. */
#include "core/derive/subject.h"
#include "core/render/visible/draw_cache.h"
#include "core/render/visible/visible.h"
#include "core/scene/camera.h"

/* In the order of drawing. A volume comes between planes and translucent shapes, lines (of tracks) after those. */
enum draw_pass {
    DRAW_OPAQUE,      /* opaque shapes, the nearest first */
    DRAW_PLANES,      /* images and labels on planes */
    DRAW_TRANSLUCENT, /* translucent shapes: by the scene's order, then the farthest first */
    DRAW_OVERLAY      /* lines painted over the finished picture by overlay.h, not by a back end */
};

enum draw_kind {
    DRAW_SHAPE,    /* triangles, lines or points */
    DRAW_IMAGE,    /* an image on a plane */
    DRAW_LABELS,   /* some labels of a label layer on a plane */
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

/* The half-spaces that a draw is cut off by: what lies above any of the planes is not drawn. No scene has one yet. */
struct clip_set {
    const struct plane *planes; /* owned by the list */
    size_t n_planes;
};

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
