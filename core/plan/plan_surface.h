#pragma once
/* Inside core/plan: surfaces of regions, built and not yet kept. */
#include "core/plan/plan.h"
#include "core/region/mask.h"

/* What facts can tell from a shape alone. */
void plan_count_shape(const struct shape *shape, struct surface_facts *facts);
/* With all facts, from the region's mask (mask_from_region). errors as surface_make */
NODISCARD struct shape *plan_build_surface(const struct mask *mask, enum surface_algorithm algorithm, int n_threads,
                                           struct surface_facts *facts, struct error *err);
/* reduction 2 or more; on the calling thread alone. */
NODISCARD struct shape *plan_build_light_surface(const struct mask *full, enum surface_algorithm algorithm,
                                                 uint32_t reduction, struct surface_facts *facts, struct error *err);
/* The reduction of all light surfaces by this algorithm; 1: the full ones are light enough; 0: no memory to tell. What
 * was built on the way is kept. */
NODISCARD uint32_t plan_light_reduction(struct plan *plan, enum surface_algorithm algorithm, struct error *err);
