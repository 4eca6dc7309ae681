#pragma once
/* Convex solids under clip planes: a plan of them, and what a ray along each pixel meets, by geometry. */
#include "core/scene/camera.h"
#include "tests/render/shots.h"

/* A ball, or a box along the patient axes. */
struct solid {
    bool is_box;
    struct vec3 centre_mm;
    double radius_mm;    /* of a ball */
    struct vec3 half_mm; /* of a box */
    uint32_t rgb;
    bool is_exempt; /* from the clip planes */
};

enum { CUT_MAX_SOLIDS = 5, CUT_GREY = 128 };
struct cut_scene {
    const struct solid *solids;
    size_t n_solids;
    struct plan *plan;
    struct scene scene;
};

/* The solids as regions a, b, c, ... on a layer of its own each, in a cube of 1 mm voxels; an image of one value, which
 * the window makes CUT_GREY. */
struct cut_scene cut_scene_create(const struct solid *solids, size_t n, enum scene_representation representation,
                                  enum scene_algorithm algorithm);
struct cut_scene cut_scene_create_on(const struct grid *grid, const struct solid *solids, size_t n,
                                     enum scene_representation representation, enum scene_algorithm algorithm);
void cut_scene_destroy(struct cut_scene *cut);

/* The thing seen in a pixel. Colours are told apart by hue. */
enum { SEEN_BACKGROUND = -1, SEEN_CAP = -2, SEEN_DARK_CAP = -3, SEEN_OTHER = -4 }; /* else the number of a solid */

struct cut_counts {
    size_t n_compared, n_wrong; /* pixels whose neighbourhood shows one thing */
    size_t n_cap, n_cracks;     /* background where the whole neighbourhood shows something */
    double cap_share;           /* of the pixels, by geometry */
};
/* Draws the scene and compares each pixel with the geometry. margin_px: how far around a pixel the geometry must show
 * one thing for it to be compared: what the solids' surfaces may be off. */
struct cut_counts cut_scene_compare(const struct cut_scene *cut, struct view view, double margin_px, bool is_still);

/* Numbers of a fixed sequence: uniform in 0 .. 1, directions uniform on the sphere. */
double cut_random(void);
struct vec3 cut_random_direction(void);
/* A view into space from a direction, parallel or in perspective from 160 mm. */
struct view cut_view(struct vec3 from, bool is_parallel);
/* Enables the free plane, at a distance from the origin along its normal. */
void cut_free(struct scene *scene, struct vec3 normal, double distance_mm, bool is_capped);
