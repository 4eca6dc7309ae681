#pragma once
/* What a scene wants its regions drawn as: which are shown, as which shapes, how they look. The same for every back
 * end. Their order is draw_list.h's. Knows no pixels and no GL. */
#include "core/derive/shapes.h"
#include "core/scene/snapshot.h"

/* True if the scene shows a region: visible and not wholly clear. */
bool visible_is_shown(const struct snapshot *snapshot, size_t region);
/* True if it is shown and has a voxel. */
bool visible_is_drawn(const struct snapshot *snapshot, size_t region);
/* True if the opaque closed surface of `outer`, a region around `region`, has that of `region` within it, so that this
 * cannot be seen from outside. */
bool visible_hides(const struct snapshot *snapshot, size_t outer, size_t region);
/* True if a box lies beyond one side of what the matrix shows. */
bool visible_is_out_of_sight(const struct mat4 *clip_from_lps_mm, const struct box3 *box);
/* How many translucent regions a picture can have at most, wherever its camera is. */
size_t visible_n_translucent(const struct snapshot *snapshot);

/* The method that the scene traces outlines by. */
enum outline_method visible_outline_method(const struct snapshot *snapshot);
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

/* Lines grow darker away from the viewer, so that near and far ones can be told apart: what their colour is times,
 * clamp(w + xyz . p, VISIBLE_DARKEST, 1), for a shape in this box. */
struct visible_cue {
    double x, y, z, w;
};
struct visible_cue visible_depth_cue(const struct camera *camera, const struct box3 *bounds_lps_mm);
#define VISIBLE_DARKEST 0.4
/* Lines lie so much nearer (depth 0 near .. 1 far) than they do: on a slice through them they can be seen. */
#define VISIBLE_LINE_DEPTH 2e-4

/* In exact order a translucent surface counts as so much nearer for each one before it in the draw list (depth 0 near
 * .. 1 far), so that surfaces that coincide keep one order all over. */
#define VISIBLE_RANK_DEPTH 5e-7

enum { VISIBLE_N_LABELS = 65536 };

/* Samples along a side of a pixel: stills take several, but a slice pane whose voxels are larger than its pixels has
 * nothing to gain. width_px is the picture's. */
int visible_samples(const struct snapshot *snapshot, const struct camera *camera, int width_px, bool is_still);

/* What is behind everything. */
extern const uint8_t visible_background[3];
