#pragma once
/* What of a snapshot is drawn, and in which order: the same for every back end. Knows no pixels and no GL. */
#include "core/derive/shapes.h"
#include "core/scene/snapshot.h"

/* What the scene wants a region drawn as; normalised. */
struct shape_key visible_shape_key(const struct snapshot *snapshot, size_t region);

/* A surface by the scene's algorithm, whatever regions are drawn as. */
struct shape_key visible_surface_key(const struct snapshot *snapshot);

/* The shapes that a picture of the snapshot needs, as far as the scene tells; wants holds as many as the plan has
 * regions. Returns how many. For building them before the picture is drawn: what is missing here the renderer has built
 * itself. */
size_t visible_wants(const struct snapshot *snapshot, enum surface_detail detail, struct shape_want *wants);
/* Regions that a picture of the snapshot should show and does not, because their shape cannot be had
 * (derive_shape_is_refused). After it was drawn. Fills the first VISIBLE_MAX_MISSING; returns how many there are. */
enum { VISIBLE_MAX_MISSING = 32 };
struct visible_missing {
    struct subject subject;
    struct error why;
};
size_t visible_missing(const struct snapshot *snapshot, enum surface_detail detail,
                       struct visible_missing missing[VISIBLE_MAX_MISSING]);
/* What a region's univels are compared with by the scene's check: what it is drawn as when that is made of triangles,
 * else a surface by the scene's algorithm. */
struct shape_key visible_checked_key(const struct snapshot *snapshot, size_t region);
bool visible_is_checked(const struct snapshot *snapshot, size_t region);

#define VISIBLE_ROUNDING 0.45
/* How a shape is lit and laid down, besides its geometry. */
struct visible_look {
    bool is_flat;    /* a normal a triangle */
    double rounding; /* univels: share of the light that falls as on a rounded surface, so that boxes that face the same
                        way can be told apart */
    bool is_two_sided; /* open surfaces: seen from behind too */
    bool is_rim;       /* denser towards the silhouette */
    bool is_baked;     /* points: light worked out in advance */
    bool is_covering;  /* points: as large as their voxel; else size_px */
    double size_px;    /* points: side of the square; lines: width; on the full picture */
};
struct visible_look visible_look(const struct snapshot *snapshot, size_t region, const struct shape_key *key);
/* Passes of shading_normals that suit a shape. */
int visible_shading_passes(const struct shape_key *key, uint32_t reduction);

/* One shape to draw. */
struct visible_shape {
    size_t region;
    const struct scene_region_style *style;
    double distance_mm; /* from the eye to the nearest point of its box */
    int order;          /* the style's */
    int depth;          /* in the hierarchy */
    uint64_t n_voxels;
};

/* The box around a region's shape, borrowed for this picture; NULL with err when there is no shape to be had. Empty
 * when the shape is, or when the region cannot be shown in this way: then there is nothing to draw. */
typedef const struct box3 *visible_bounds(void *context, size_t region, struct error *err);

/* The shapes that are wanted and can be seen: by the styles' order, then back to front (opaque ones are drawn from the
 * last one on). What lies outside clip_from_lps_mm's box is left out, and so is what an opaque closed surface encloses.
 * free(); NULL on failure. errors ERROR_MEMORY, and those of bounds */
NODISCARD struct visible_shape *visible_shapes(const struct snapshot *snapshot, const struct camera *camera,
                                               const struct mat4 *clip_from_lps_mm, bool is_opaque,
                                               visible_bounds *bounds, void *context, size_t *n, struct error *err);
/* Lines grow darker away from the viewer, so that near and far ones can be told apart: what their colour is times,
 * clamp(w + xyz . p, VISIBLE_DARKEST, 1), for a shape in this box. */
struct visible_cue {
    double x, y, z, w;
};
struct visible_cue visible_depth_cue(const struct camera *camera, const struct box3 *bounds_lps_mm);
#define VISIBLE_DARKEST 0.4
/* Lines lie so much nearer (depth 0 near .. 1 far) than they do: on a slice through them they can be seen. */
#define VISIBLE_LINE_DEPTH 2e-4

/* In exact order a surface counts as so much nearer for each one before it in visible_shapes' order (depth 0 near .. 1
 * far), so that surfaces that coincide keep one order all over. */
#define VISIBLE_RANK_DEPTH 5e-7

/* How many of them there can be at most. */
size_t visible_n_translucent(const struct snapshot *snapshot);

enum { VISIBLE_N_LABELS = 65536 };
/* Label to colour, RGBA, for a label layer's cross-section: of the region itself or, when that is hidden, of the
 * innermost visible one around it; alpha 0 where there is nothing to see. Returns how many labels have a colour. */
size_t visible_palette(const struct snapshot *snapshot, size_t layer, uint8_t (*colors)[4]);
/* Label layers from the lowest to the uppermost: those that hold outer regions lie under those that hold inner ones. */
void visible_layers(const struct region_set *set, size_t layers[REGION_MAX_LAYERS]);

/* Samples along a side of a pixel: stills take several, but a slice pane whose voxels are larger than its pixels has
 * nothing to gain. width_px is the picture's. */
int visible_samples(const struct snapshot *snapshot, const struct camera *camera, int width_px, bool is_still);

/* What is behind everything. */
extern const uint8_t visible_background[3];
