#pragma once
/* What the render tests share: one renderer at a time, pictures of a plan, and questions to ask a picture. */
#include "core/render/render.h"
#include "tests/check.h"
#include "tests/derived_of.h"
#include "tests/made_plan.h"

/* Graphics drivers do not get on with sanitizers: then only our own rasteriser is asked. */
#if defined(__SANITIZE_THREAD__) || defined(__SANITIZE_ADDRESS__)
enum { SHOTS_SANITIZED = 1 };
#else
enum { SHOTS_SANITIZED = 0 };
#endif

extern struct renderer *shots_renderer; /* the back end under test */

/* Runs the tests on every back end that works here; gives main's exit status. */
int shots_run(const char *name, const struct CMUnitTest *tests, size_t n_tests);

/* A scene of the plan's own colours with everything opaque, no slices in space. */
struct scene shots_scene(const struct plan *plan);
struct scene_region_style *shots_style(struct scene *scene, const char *id);
/* A parallel view of a kind: target in the middle, so many pixels a millimetre across the smaller side. */
struct view shots_view(enum scene_kind kind, struct vec3 target_lps_mm, double pixels_per_mm);
/* The same from a direction in space. */
struct view shots_view_from(struct vec3 target_lps_mm, struct vec3 from, struct vec3 up, double pixels_per_mm);

/* Takes scene and view. Fails the test when there is no picture. */
struct image *shots_take(struct plan *plan, struct scene scene, struct view view, const struct render_options *options,
                         struct render_timing *timing);
/* Full size, full detail, not anti-aliased. */
struct image *shots_plain(struct plan *plan, struct scene scene, struct view view);

/* The plan is destroyed, and what the renderer keeps of it. */
void shots_forget(struct plan *plan);

const uint8_t *shots_pixel(const struct image *image, int x, int y);
/* Shares of red, green and blue, within 2 of 255: a rounding each for light, blend and store. */
void shots_expect_color(const uint8_t *pixel, const double color[3]);
/* Mean position of the pixels whose named channel (0 red, 1 green, 2 blue) is larger than both others by 40; how many.
 */
size_t shots_centroid(const struct image *image, int channel, double *x_px, double *y_px);

/* Light on a surface that faces the viewer squarely, by the shader's published constants: key (0.426, 0.568, 0.704) at
 * 0.58, fill (-0.741, 0.106, 0.663) at 0.18, gloss 0.07 key^16, ambient 0.3 where opaque and 0.5 where translucent. */
double shots_facing_light(double color, bool is_opaque);

enum { SHOTS_WIDTH = 400, SHOTS_HEIGHT = 300 };
extern const uint8_t shots_background[3];
