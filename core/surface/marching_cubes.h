#pragma once
/* Inside of surface_marching_cubes, for its tests: the same code compiled for any processor and for one with bit counting. */
#include "core/surface/surface.h"

enum marching_cubes_code { MARCHING_CUBES_BEST, MARCHING_CUBES_PORTABLE };

NODISCARD struct mesh *marching_cubes_with(enum marching_cubes_code code, const struct mask *mask, const struct surface_options *options,
                                           struct error *err);
