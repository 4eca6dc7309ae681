#pragma once
/* A beam: the line it enters along and its aperture. */
#include "core/math/vec.h"

struct beam {
    char id[64];
    struct vec3 entry_lps_mm, target_lps_mm; /* never the same point */
    double aperture_mm;                      /* diameter; not-a-number when unknown */
};
