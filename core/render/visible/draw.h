#pragma once
/* The draw list of a picture: what is drawn, how, and in which order. Made from a snapshot by draw_list.h; the back
 * ends execute the draws one after the other and decide no order themselves. Knows no pixels and no GL. */
#include <math.h>

#include "core/derive/subject.h"
#include "core/render/visible/cut.h"
#include "core/render/visible/draw_cache.h"
#include "core/render/visible/visible.h"
#include "core/scene/camera.h"
#include "core/scene/tracks_shown.h"

struct draw_wash;     /* draw_wash.h */
struct dose_scale;    /* core/scene/dose_scale.h */
struct dose_coverage; /* core/derive/dose_coverage.h */
struct isoline_cache; /* isoline_cache.h */

/* In the order of drawing. */
enum draw_pass {
    DRAW_OPAQUE,      /* opaque shapes, the nearest first */
    DRAW_PLANES,      /* images and labels on planes, caps, tracks */
    DRAW_TRANSLUCENT, /* a volume; translucent shapes: by the scene's order, then the farthest first */
    DRAW_OVERLAY      /* lines painted over the finished picture by overlay.h, not by a back end */
};

enum draw_kind {
    DRAW_SHAPE,    /* triangles, lines or points */
    DRAW_IMAGE,    /* an image on a plane */
    DRAW_LABELS,   /* some labels of a label layer on a plane */
    DRAW_CAP,      /* what a clip plane cuts through, closed with the image */
    DRAW_VOLUME,   /* an image as a volume */
    DRAW_WASH,     /* a colourwash on a slice pane without an image, over all that was drawn before it */
    DRAW_TRACKS,   /* particle tracks; one at most */
    DRAW_MARKS,    /* marked univels on a plane, over what is drawn in it before */
    DRAW_ISOLINES, /* isodose lines of one value; on a slice pane in the overlay */
    DRAW_OUTLINE,  /* overlay: the outline of a region's surface or univels on a plane */
    DRAW_CHECK,    /* overlay: where univels and surface of a region differ on a plane */
    DRAW_GRID_CUT, /* overlay: where a plane cuts the grids of a dose */
    DRAW_GRID_BOX, /* overlay: the edges of the grids of a dose */
    DRAW_STROKES,  /* overlay: line segments, computed with the list */
    DRAW_AXES,     /* overlay: the patient axes of the plan (core/scene/axes.h) */
    DRAW_BEAM_EYE  /* overlay: crosshair and aperture ring of the view's beam (beam_eye_marks.h) */
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

/* A second image over an image, on its own grid: where it has a finite value the colour is (1 - part) of the first's
 * and part of its own. The first image decides where anything is drawn. */
struct draw_blend {
    double part;            /* 0: none */
    size_t image;           /* index in the plan */
    double low, width;      /* as in draw_image */
    bool is_low_white;      /* as in draw_image */
    const uint32_t *colors; /* as in draw_image */
    double gamma;           /* as in draw_image */
    const uint32_t *tones;  /* as in draw_image */
};

/* Greys of a table of tones: at a gamma of 5 the darkest two are still less than 50 of 255 apart. */
enum { DRAW_TONES = 4096 };
/* Grey = (value - low) / width; drawn where it is cull or more. */
struct draw_image {
    double low, width;      /* in the image's unit */
    double cull;            /* as grey; -infinity: drawn everywhere */
    bool is_low_white;      /* grey 0 is white, 1 is black */
    bool is_linear;         /* interpolated between voxels */
    const uint32_t *colors; /* by level 0..255 of what is_low_white leaves (color_map.h); NULL: grey */
    double gamma;           /* the level is that grey to the power 1 / gamma; > 0 */
    const uint32_t *tones;  /* [DRAW_TONES] colours by grey, gamma and colours applied; the list's; NULL: gamma is 1 */
    struct draw_blend blend;
    const struct draw_wash *wash; /* over the finished colour; the list's; NULL: none */
};

/* Colours the triangles of a shape (`texture` of proto/scene.json) at the very point of the surface that a sample
 * shows; other shapes have none.
 *
 * Image: the shape is lit as if it were white, and each channel multiplied with that of the image's colour there,
 * without the least grey of visible_background and without its blend; where there is no finite value, or outside the
 * image's outer faces, with that of the region's colour.
 *
 * Dose: the wash lies over the shaded colour. The opacity of a translucent shape stays as it is. */
struct draw_texture {
    enum scene_texture kind;      /* SCENE_TEXTURE_NONE: none of the others counts */
    size_t image_index;           /* in the plan; of SCENE_TEXTURE_IMAGE */
    struct draw_image image;      /* SCENE_TEXTURE_IMAGE: window and colours, nothing culled; without a wash */
    const struct draw_wash *wash; /* SCENE_TEXTURE_DOSE: draw_wash_of_region; the list's */
};

struct draw_shape {
    const struct drawable *drawable; /* made by the back end; its bounds are not empty */
    struct visible_look look;
    struct visible_cue cue; /* of lines */
    struct draw_texture texture;
};

/* A region in a cap: closed outlines in the clip plane, by the even-odd rule. */
struct draw_cap_region {
    size_t region;
    const struct cut_lines *lines; /* cap_cache's, in use by the list; where the plane cuts the very shape drawn */
    uint32_t color_rgb;
};

/* Closes a cut: every sample of the plane that is inside one of the regions is opaque and shows the image, dark where
 * there is none, as far as no other clip plane cuts it. */
struct draw_cap {
    const struct draw_cap_region *regions; /* the lowest rank first: of several at a point the last one counts */
    size_t n_regions;
    bool has_image;
    struct draw_image image; /* its wash is valid also without has_image, and lies over the mixed colour */
    double tint;             /* part of the region's colour in the mixed one; 0: none */
    double outline_px;       /* width of the regions' outlines on the full picture; 0: none */
};
/* The colour of a cap where there is no image. */
#define DRAW_CAP_DARK 0x14120fu

/* An image as a volume.
 *
 * A ray of a sample of the picture goes from its entry to its end, in mm from the eye (parallel: from the eye's plane).
 * Entry: into the grid's outer faces, past the near plane and the draw's clip planes. End: out of them, or at the
 * nearer opaque draw. A translucent layer divides it there. Values are taken in the image's grid, beyond the outermost
 * voxel centres as at them; what is not finite or less than cull is not there.
 *
 * Method ray: from its entry, and again from each layer, the ray has intervals of length h, the last one shorter; h =
 * min(step_voxels / (indices that the ray passes per mm, along the axis where these are most), step_limit_mm). An
 * interval of length d has the value v at its part draw_volume_jitter and passes exp(-absorption(v) d) of the light.
 * Its colour is the table's; with is_shaded it is lit by the light of surfaces (two-sided, opaque) with the gradient g,
 * by central differences one voxel to either side, as the normal: of that light l counts f + (l - f) g^2 / (g^2 +
 * gradient^2) with f = DRAW_VOLUME_FLAT, its gloss likewise from 0; a gradient that is not finite counts as 0. Where
 * the ray enters through a capped clip plane and the value there absorbs, it shows the colour of `image` there, opaque.
 *
 * Method slices: n_slices planes at right angles to the line of sight, at the middles of n_slices equal parts of the
 * extent of the grid's outer faces along it. The nearest one that is there is opaque, in the colours of `image`.
 *
 * Methods mip and average: intervals as above; the largest value, or the mean of the values weighted with the lengths,
 * in the colours c of `image`: c + (1 - max c) of what is behind. It counts as in front of all layers. */
enum { DRAW_VOLUME_TABLE = 1024 };
#define DRAW_VOLUME_FLAT 0.8
struct draw_volume {
    enum scene_volume_method method;
    /* For the method ray: colour 0..1 and absorption per mm (natural: light exp(-a d) passes d mm), not premultiplied,
     * at DRAW_VOLUME_TABLE values from low to low + width, both included; constant beyond. A value takes the nearest
     * entry. The list's; NULL with other methods. */
    const float (*table)[4];
    double low, width;
    double cull;             /* in the image's unit; smaller values are not drawn; -infinity: all are */
    struct draw_image image; /* window and colours of the methods slices, mip and average, and of cut faces; its wash
                                lies over cut faces only */
    /* Over the lit colour of each sample of the method ray, and over the planes of the method slices; the list's; NULL:
     * none. Values of mip and average belong to no point */
    const struct draw_wash *wash;
    int n_slices; /* of the method slices */
    bool is_linear, is_shaded;
    bool is_still;        /* full quality */
    double step_voxels;   /* above; of each sample of the picture: several samples of a pixel share its steps */
    double step_limit_mm; /* above */
    double gradient;      /* above, in the image's unit per mm; > 0 */
};

/* At which part of an interval its value is taken, 0..1: so that neighbouring rays do not change value at the same
 * depth and no rings show. x, y: the sample's column and row in the picture; samples: of the list. A low-discrepancy
 * sequence over the pixels (M. Roberts, R2); the samples of a pixel are spread evenly. */
#define DRAW_VOLUME_JITTER_X 3242174889u
#define DRAW_VOLUME_JITTER_Y 2447445414u
static inline float draw_volume_jitter(uint32_t x, uint32_t y, int samples)
{
    uint32_t shift = samples > 1;
    uint32_t hash = (x >> shift) * DRAW_VOLUME_JITTER_X + (y >> shift) * DRAW_VOLUME_JITTER_Y;
    float pixel = (float)(hash >> 8) * 0x1p-24f;
    return samples > 1 ? 0.25f * ((float)(((x ^ y) & 1) + 2 * (x & 1)) + pixel) : pixel;
}

/* Marked univels on a plane: where the volume is not 0, in stripes that run down to the left, with an edge along their
 * border, so that no colour alone tells them. In space (DRAW_DEPTH_TESTED) only where the picture shows that very
 * plane: its depth is the plane's, within twice VISIBLE_CAP_DEPTH and the plane's slope over a sample. Of the mixed
 * colour the stripes have this part of color_rgb, between them it has this part of black, so that stripes show on their
 * own colour too; the edge has color_rgb alone. Depth stays. */
#define DRAW_MARKS_STRIPE 0.65
#define DRAW_MARKS_BLACK 0.3
struct draw_marks {
    const struct volume *labels; /* U8; the list's */
    /* On the full picture: from stripe to stripe; of the edge, which is as strong as can be. A sample is of the edge if
     * one that is edge_px to the left or right of it, above or below in the plane is not marked */
    double stripe_px, edge_px;
};

/* Lines of one colour, unshaded. In the overlay they have a dark rim. */
struct draw_isolines {
    const struct cut_lines *lines; /* isoline_cache's, in use by the list */
    double width_px;               /* on the full picture */
};

/* Lines of one colour in the plane of a slice pane; opaque ones have a dark rim. */
struct draw_strokes {
    struct cut_lines *lines; /* the draw's */
    double width_px;         /* on the full picture */
};

/* Particle tracks, each segment a line of the look of its class (track_class_look), in the order of the files.
 *
 * What clip planes cut off is not drawn, nor what is nearer to the eye than nearest_mm along the line of sight. The
 * rest keeps its place in the picture also beyond the near and the far plane; its depth is theirs there, so that tracks
 * from outside the plan's box are whole. Position, depth and cue change evenly along the line in the picture.
 *
 * w is the width of a line in samples, at least 1. A still covers the samples within w / 2 of the line, across and
 * beyond its ends. Other pictures take whole samples for w; 1 is thin: a chain of samples, of which each column (each
 * row, where the line rises by more than it runs) from the first end's to the second's has one. At a clip plane the
 * last samples are kept whose middles are below the plane at the depth of the line, so that a cap covers the line that
 * ends there. A segment without length is a dot.
 *
 * Dashes are counted from the first end of what is drawn. A cross lies square to the picture, its arms along the
 * diagonals from -s to s, s = DRAW_TRACKS_CROSS_PX + w / 2; it is drawn where the segment's second end is. */
struct draw_tracks {
    const struct track_set *set; /* the plan's */
    struct tracks_shown shown;   /* which of its segments */
    double width_px;             /* on the full picture */
    bool is_still;               /* else widths are whole samples */
    struct visible_cue cue;      /* w = 1 and no slope: none */
    double nearest_mm;
};
#define DRAW_TRACKS_CROSS_PX 4.0
/* The farthest depth of tracks, 0 near .. 1 far: before the background. */
#define DRAW_TRACKS_FAR 0.9999999
/* The width of lines in samples, and whether they are thin. */
static inline double draw_tracks_width(const struct draw_tracks *tracks, double samples_per_px)
{
    double width = fmax(1, tracks->width_px * samples_per_px);
    return tracks->is_still ? width : floor(width);
}
static inline bool draw_tracks_are_thin(const struct draw_tracks *tracks, double samples_per_px)
{
    return !tracks->is_still && draw_tracks_width(tracks, samples_per_px) < 2;
}
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
        const struct draw_wash *wash; /* DRAW_WASH */
        struct draw_marks marks;
        struct draw_isolines isolines;
        struct draw_strokes strokes;
        struct draw_tracks tracks;
        struct draw_lines lines;
    };
};

struct draw_list {
    struct draw *draws;
    size_t n, capacity;
    size_t n_in_image; /* those before DRAW_OVERLAY, for the back end */
    int samples;       /* along a side of a pixel */
    /* True: the layers of each sample are composed in their own order of depth, where a layer counts as nearer by
     * VISIBLE_RANK_DEPTH for each layer before it. False: in the order of the list. With a volume always true. */
    bool is_order_exact;
    size_t n_layers_planned; /* translucent draws there are at most, wherever the camera is */
    size_t n_triangles;
    bool is_coarse;                      /* some shape is of reduced detail */
    uint8_t *palettes;                   /* of DRAW_LABELS */
    float (*transfer)[4];                /* of DRAW_VOLUME */
    uint32_t *tones[2];                  /* of the image shown and the one blended over it; NULL: gamma is 1 */
    struct draw_cap_region *cap_regions; /* of DRAW_CAP */
    size_t n_cap_regions;
    /* [height_px][width_px] of the picture, filled by the back end for occlusion.h: at the first sample of each pixel;
     * negative where a draw of DRAW_PLANES or a volume's cut face covers the rest. A volume of the method ray is where
     * it alone has absorbed half of the light; translucent shapes are not there. NULL: not wanted */
    float *depth;
    bool reads_dose_in_parts;       /* the scope's */
    struct dose_scale *dose;        /* draw_dose.h; NULL: not asked for */
    struct draw_wash *wash;         /* draw_wash.h; NULL: none */
    struct draw_wash *row_washes;   /* of textures, by row; NULL: none */
    struct dose_coverage *coverage; /* of DRAW_MARKS; NULL: none */
    struct draw_cache_use use;      /* keeps the drawables until the list is destroyed */
};

/* The inputs of a draw list; borrowed. */
struct draw_scope {
    const struct snapshot *snapshot;
    const struct camera *camera; /* the snapshot's, resolved */
    enum surface_detail detail;
    struct draw_cache *cache;
    bool is_still;                  /* false: the next picture comes soon */
    struct cap_cache *caps;         /* NULL: no caps are drawn */
    struct isoline_cache *isolines; /* NULL: no isodose lines are drawn */
    /* The back end asks for the parts of a wash that it reads (struct draw_wash), so that no more is combined. */
    bool reads_dose_in_parts;
};

/* Appends a draw. errors ERROR_MEMORY */
NODISCARD bool draw_list_add(struct draw_list *list, const struct draw *draw, struct error *err);
/* How many draws from `first` on have the depth rule DRAW_DEPTH_LAYER, one after the other. */
size_t draw_list_n_layers(const struct draw_list *list, size_t first);
