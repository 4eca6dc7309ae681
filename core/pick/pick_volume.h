#pragma once
/* Picking in an image that is drawn as a volume, computed from its voxels and transfer function, not from the
 * picture. */
#include "core/scene/snapshot.h"

struct pick_volume_hit {
    double t_mm;    /* along the ray */
    double alpha;   /* how much of what lies behind it the volume covers, all along the ray, 0 to 1 */
    bool is_on_cap; /* where a capped clip plane cuts what is seen */
};

/* Where a ray meets the snapshot's volume. ray: where half of its light is absorbed. slices: where the value first
 * reaches cull_below. mip, average: where the value is largest. What clip planes cut off is not met; a capped one is
 * met where it cuts what is seen. Values are those of the picture: between voxels or of the nearest, beyond the
 * outermost centres as at them, culled below cull_below. direction: of unit length. False: no volume is shown, or the
 * ray meets none. thread any */
bool pick_volume(const struct snapshot *snapshot, struct vec3 origin_lps_mm, struct vec3 direction,
                 struct pick_volume_hit *hit);
