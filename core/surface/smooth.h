#pragma once
/* Inside surface_smooth, for its tests: smoothing with given options. Any thread. */
#include "core/surface/smooth_options.h"
#include "core/surface/surface.h"

NODISCARD struct mesh *smooth_with(const struct smooth_options *smoothing, const struct mask *mask,
                                   const struct surface_options *options, struct error *err);
