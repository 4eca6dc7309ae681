#pragma once
/* Ambient occlusion of a finished still: hollows of opaque surfaces and volumes are darker. From the depth of its
 * pixels alone, so that all back ends share it. */
#include "core/base/image.h"
#include "core/scene/camera.h"

/* Reach of the darkening, as a part of the plan's diagonal. */
#define OCCLUSION_RADIUS_PART 0.06
/* The colour of a point that sees no light from around is multiplied by this. */
#define OCCLUSION_DARKEST 0.45

/* Multiplies each pixel of a surface by 1 - (1 - OCCLUSION_DARKEST) (1 - v). v is the part of the light from the half
 * space before the surface, weighted by the cosine with its normal, that nothing within radius_mm keeps off: with the
 * elevation e of the horizon above the tangent plane, the mean of cos^2 e over the azimuths. A plane is not changed.
 *
 *   depth   [height_px][width_px], 0 near .. 1 far; 1: nothing; negative: of something that keeps light off (a slice, a
 *           cap, a cut face), but is not darkened itself
 *   errors  ERROR_MEMORY
 *   thread  any; works with several
 *   source  L. Bavoil, M. Sainz, R. Dimitrov, Image-space horizon-based ambient occlusion, SIGGRAPH 2008 talks.
 *           Differs: the horizon is found by azimuth in the tangent plane from points spread over the disc around a
 *           pixel, by the same pattern in every picture. */
NODISCARD bool occlusion_darken(struct image *image, const float *depth, const struct camera *camera, double radius_mm,
                                struct error *err);
