#pragma once
/* Options of a phantom and their limits. */
#include <stdint.h>

enum { PHANTOM_MIN_SIDE = 16, PHANTOM_MAX_SIDE = 1024 };
#define PHANTOM_MAX_VOXELS ((uint64_t)1 << 27)

struct phantom_options {
    uint32_t size[3]; /* voxels of image and labels along L, P, S; the field of view is always the same */
    uint64_t seed;    /* for the image's noise and the tracks; anatomy and dose do not depend on it */
};
extern const struct phantom_options phantom_defaults; /* 256 x 256 x 128, seed 1 */
