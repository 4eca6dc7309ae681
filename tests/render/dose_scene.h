#pragma once
/* A plan with an image, nested regions and a dose on a turned grid of its own, for tests of pictures of dose; and the
 * comparison of two back ends. */
#include "tests/render/shots.h"

/* Regions: "target", a ball of 18 mm around target_mm, inside "body", an ellipsoid of 40 x 34 x 38 mm around the
 * origin, on a layer of 1.3 mm. The dose, Gy: 60 - |p - peak_mm|. Image and dose go beyond the body on most sides;
 * has_hole: the total has no value (NaN) where x + y < -20. Beside the total there is boron per ppm, some Gy at 20 ppm.
 */
extern const struct vec3 dose_scene_target_mm, dose_scene_peak_mm;
struct plan *dose_scene_plan(bool has_hole);
double dose_scene_dose(struct vec3 lps_mm);
double dose_scene_label(struct vec3 lps_mm); /* 0, 1 body, 2 target */

/* All regions hidden, the file's dose in Gy, no image slices in space. */
struct scene dose_scene(const struct plan *plan);

/* Draws a picture with the back end under test and with the software rasteriser, and fails unless they agree: PSNR of
 * at least 40 dB over the pixels that show something, of which there are at least least_drawn. Skips what needs no
 * comparison. make: the scene; called twice. */
void dose_scene_expect_agreement(struct scene (*make)(const struct plan *plan, const void *look), const void *look,
                                 struct view view, bool is_still, size_t least_drawn);
