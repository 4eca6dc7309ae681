#pragma once
/* Chooses for each region of a scene if it is shown, as which shape and with which look. The same for every back end;
 * draw_list.h decides the order. Knows no pixels and no GL. */
#include "core/derive/shapes.h"
#include "core/scene/camera.h"
#include "core/scene/snapshot.h"

/* True if the scene shows a region: visible, opacity > 0. */
bool visible_is_shown(const struct snapshot *snapshot, size_t region);
/* True if it is shown and has a voxel. */
bool visible_is_drawn(const struct snapshot *snapshot, size_t region);
/* True if `outer`, an ancestor of `region`, is drawn as an opaque closed surface that encloses the shape of `region`,
 * so that this cannot be seen from outside. */
bool visible_hides(const struct snapshot *snapshot, size_t outer, size_t region);
/* The place of a region among those that overlap it on a slice. On top, greatest: the higher order, the inner in the
 * hierarchy, the smaller, the later in the plan. */
struct visible_rank {
    size_t region;
    int order, depth;
    uint64_t n_voxels;
};
struct visible_rank visible_rank(const struct snapshot *snapshot, size_t region);
int visible_rank_compare(const void *left, const void *right); /* for qsort; 0 only for one and the same region */
/* True if a box lies wholly beyond one of the six sides of the view volume. */
bool visible_is_out_of_sight(const struct mat4 *clip_from_lps_mm, const struct box3 *box);
/* The number of translucent regions with any camera, at most. */
size_t visible_n_translucent(const struct snapshot *snapshot);

/* The scene's method of tracing outlines of univels; OUTLINE_TRACED if it outlines surfaces. */
enum outline_method visible_outline_method(const struct snapshot *snapshot);
/* The key of the shape that the scene wants a region drawn as; normalised. */
struct shape_key visible_shape_key(const struct snapshot *snapshot, size_t region);

/* The key of a surface by the scene's algorithm. */
struct shape_key visible_surface_key(const struct snapshot *snapshot);

/* The shape whose triangles a cap closes: of a surface, univels and nurbs the one that is drawn, of solid points the
 * region's surface. False: the region is not drawn as a closed body. */
bool visible_body(const struct snapshot *snapshot, size_t region, enum surface_detail detail, struct shape_want *want);

/* Lists the shapes to build before a picture of the snapshot is drawn; shapes that the list lacks are built while it is
 * drawn. A moving slice pane waits for no surface to outline: it outlines univels until the surface is there. Fills
 * wants, which has room for twice n_regions of the plan; returns the number. */
size_t visible_wants(const struct snapshot *snapshot, enum surface_detail detail, bool is_still,
                     struct shape_want *wants);
/* The regions that a picture, once drawn, does not show as the scene wants, because their shape was refused
 * (derive_shape_is_refused). Fills the first VISIBLE_MAX_MISSING; returns how many there are. */
enum { VISIBLE_MAX_MISSING = 32 };
struct visible_missing {
    struct subject subject;
    struct error why;
};
size_t visible_missing(const struct snapshot *snapshot, enum surface_detail detail,
                       struct visible_missing missing[VISIBLE_MAX_MISSING]);
/* The key of the shape that the check compares a region's univels with: the region's own if that has triangles, else a
 * surface by the scene's algorithm. */
struct shape_key visible_checked_key(const struct snapshot *snapshot, size_t region);
bool visible_is_checked(const struct snapshot *snapshot, size_t region);
/* The key of the shape that a slice pane outlines: the region's own if that is closed, else a surface by the scene's
 * algorithm. */
struct shape_key visible_outlined_key(const struct snapshot *snapshot, size_t region);
/* True if a slice pane shows where its plane cuts the region's surface, unless the region is checked. */
bool visible_has_outlined_surface(const struct snapshot *snapshot, size_t region);

#define VISIBLE_ROUNDING 0.45
/* How a shape is shaded and rasterised. */
struct visible_look {
    bool is_flat; /* shaded with one normal per triangle */
    double
        rounding; /* univels: share of the shading by vertex normals, which tells boxes that face the same way apart */
    bool is_two_sided; /* open surfaces: their back is drawn too */
    bool is_rim;       /* denser towards the silhouette */
    bool is_baked;     /* points: shaded in advance, by point_set's shade */
    bool is_covering;  /* points: as large as their voxel; else size_px */
    double size_px;    /* points: side of the square; lines: width; on the full picture */
};
struct visible_look visible_look(const struct snapshot *snapshot, size_t region, const struct shape_key *key);
/* The number of passes of shading_normals for a shape. */
int visible_shading_passes(const struct shape_key *key, uint32_t reduction);

/* Depth cue: lines grow darker away from the viewer. The colour of a point p of a shape in the box is multiplied by
 * clamp(w + xyz . p, VISIBLE_DARKEST, 1). */
struct visible_cue {
    double x, y, z, w;
};
struct visible_cue visible_depth_cue(const struct camera *camera, const struct box3 *bounds_lps_mm);
#define VISIBLE_DARKEST 0.4
/* Lines are drawn this much nearer (depth 0 near .. 1 far), so that they are visible on a slice they lie in. */
#define VISIBLE_LINE_DEPTH 2e-4

/* Caps are drawn this much nearer, so that they cover what lies in their plane. */
#define VISIBLE_CAP_DEPTH 1e-6

/* In exact order a translucent surface counts as this much nearer for each one before it in the draw list (depth 0 near
 * .. 1 far), so that coinciding surfaces have the same order in every sample. */
#define VISIBLE_RANK_DEPTH 5e-7

enum { VISIBLE_N_LABELS = 65536 };

/* Samples along a side of a pixel: 2 for stills, 1 for moving pictures and for slice panes whose voxels are larger than
 * their pixels. width_px: of the picture. */
int visible_samples(const struct snapshot *snapshot, const struct camera *camera, int width_px, bool is_still);

/* The colour of the background, RGB: the page's colour of an empty pane (--pane in web/css/tokens.css). Each channel of
 * an image's grey is at least this, so that air fades into the pane and the image's box does not show. */
extern const uint8_t visible_background[3];
/* The colour that pictures of the snapshot are cleared to: the scene's in 3-D views, else visible_background. */
void visible_ground(const struct snapshot *snapshot, uint8_t rgb[3]);
/* True if dark ink has more contrast than light ink on it: WCAG 2.2, relative luminance above 0.179. */
bool visible_ground_is_light(const struct snapshot *snapshot);
