#pragma once
/* Shared by the render tests: one renderer at a time, pictures of a plan, and measurements in a picture. */
#include "core/render/render.h"
#include "tests/check.h"
#include "tests/derived_of.h"
#include "tests/made_plan.h"

/* Graphics drivers do not run under sanitizers: then only our own rasteriser is tested. */
#if defined(__SANITIZE_THREAD__) || defined(__SANITIZE_ADDRESS__)
enum { SHOTS_SANITIZED = 1 };
#else
enum { SHOTS_SANITIZED = 0 };
#endif

extern struct renderer *shots_renderer; /* the back end under test */

/* Runs the tests on every back end that works here; returns main's exit status. */
int shots_run(const char *name, const struct CMUnitTest *tests, size_t n_tests);
/* Like shots_run, with Mesa's software driver once: behind OSMesa it is the same as behind EGL. */
int shots_run_drivers(const char *name, const struct CMUnitTest *tests, size_t n_tests);
/* Like shots_run, on our own rasteriser alone: for things that the OpenGL back ends do not draw yet. */
int shots_run_soft(const char *name, const struct CMUnitTest *tests, size_t n_tests);

/* A scene with the plan's own colours, all regions opaque, no slices in space. */
struct scene shots_scene(const struct plan *plan);
struct scene_region_style *shots_style(struct scene *scene, const char *id);
/* A parallel view of a kind, with the target in the middle. */
struct view shots_view(enum scene_kind kind, struct vec3 target_lps_mm, double pixels_per_mm);
/* A parallel view into space, from the direction `from`. */
struct view shots_view_from(struct vec3 target_lps_mm, struct vec3 from, struct vec3 up, double pixels_per_mm);

/* Consumes scene and view. Fails the test if there is no picture. timing: NULL if not wanted. */
struct image *shots_take(struct plan *plan, struct scene scene, struct view view, const struct render_options *options,
                         struct render_timing *timing);
/* Full size, full detail, not anti-aliased. */
struct image *shots_plain(struct plan *plan, struct scene scene, struct view view);

/* Destroys the plan and what the renderer keeps of it. */
void shots_forget(struct plan *plan);

const uint8_t *shots_pixel(const struct image *image, int x, int y);
/* color: shares of red, green and blue. Within 2 of 255: shading, blending and storing round once each. */
void shots_expect_color(const uint8_t *pixel, const double color[3]);
/* Mean position of the pixels whose channel (0 red, 1 green, 2 blue) is larger than both others by 40. Returns how many
 * there are. */
size_t shots_centroid(const struct image *image, int channel, double *x_px, double *y_px);

/* The shaded colour of a surface that faces the viewer, by the constants of the light: key (0.426, 0.568, 0.704) at
 * 0.58, fill (-0.741, 0.106, 0.663) at 0.18, gloss 0.07 key^16, ambient 0.3 if opaque and 0.5 if translucent. */
double shots_facing_light(double color, bool is_opaque);

enum { SHOTS_WIDTH = 400, SHOTS_HEIGHT = 300 };
extern const uint8_t shots_background[3];
