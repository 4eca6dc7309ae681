#pragma once
/* Where a ray meets the isodose surfaces that a picture shows. Any thread. */
#include "core/scene/isodoses.h"

struct pick_isodose_hit {
    double t_mm; /* along the ray */
    struct subject subject;
    double opacity;
};
/* The nearest point of each surface that clip planes leave; returns how many. direction: of unit length. May build the
 * surfaces, which a picture of the snapshot needs too. */
size_t pick_isodoses(const struct snapshot *snapshot, struct vec3 origin_lps_mm, struct vec3 direction,
                     struct pick_isodose_hit hits[ISODOSES_MAX]);
