#pragma once
/* Air inside a patient, as sinuses: blocks of it that a ball of 1 cm, rolling outside, does not reach. Neutrons cross
 * it from wall to wall. */
#include "core/transport/geometry.h"

#define INNER_AIR_BALL_CM 1.0

struct inner_air {
    float *coefficient_cm; /* by block: of diffusion, a third of the mean chord of its cavity; 0: not inner air */
};
/* ERROR_MEMORY */
NODISCARD bool inner_air_init(struct inner_air *air, const struct geometry *geometry, struct error *err);
void inner_air_finish(struct inner_air *air);
