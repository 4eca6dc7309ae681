#pragma once
/* Turning a particle's direction, and drawing its scattering. Inline. */
#include <math.h>

#include "core/transport/medium.h"
#include "core/transport/random.h"

/* Turns a unit vector by an angle, about it by one of 1024 azimuths. */
static inline void direction_turn(float direction[3], float cosine, const float azimuth[2])
{
    float square = 1.F - cosine * cosine, sine = square > 0 ? sqrtf(square) : 0, a = sine * azimuth[0],
          b = sine * azimuth[1];
    float u = direction[0], v = direction[1], w = direction[2], across = u * u + v * v;
    if (across < 1e-6F) {
        direction[0] = a;
        direction[1] = b;
        direction[2] = w > 0 ? cosine : -cosine;
        return;
    }
    float inverse = 1.F / sqrtf(across);
    direction[0] = u * cosine + (u * w * a - v * b) * inverse;
    direction[1] = v * cosine + (v * w * a + u * b) * inverse;
    direction[2] = w * cosine - across * inverse * a;
}

/* A cosine with a given mean: linear between -1 and 1 up to a mean of 1/3, beyond that even from 2 mean - 1 to 1. */
static inline float direction_cosine(float mean, uint64_t bits)
{
    float a = random_high(bits), b = random_low(bits);
    if (mean > .3334F)
        return 2 * mean - 1 + 2 * (1 - mean) * a;
    float share = ((float)(bits & 0xffff) + .5F) * (1.F / 65536.F);
    float of_one = share < 3 * fabsf(mean) && b > a ? b : a;
    return mean < 0 ? 1 - 2 * of_one : 2 * of_one - 1;
}

/* A Compton scattering: new direction and energy.
 * source  H. Kahn, Applications of Monte Carlo, RAND AECU-3259 (1954): drawing from Klein's and Nishina's formula */
static inline void photon_scatter(const struct particle_tables *tables, float direction[3], float *energy_mev,
                                  struct random *random)
{
    float alpha = *energy_mev * (1.F / .510999F), ratio, cosine;
    uint64_t bits;
    for (;;) {
        bits = random_bits(random);
        float a = random_high(bits), b = random_low(bits), c = random_unit(random);
        if (a * (9 + 2 * alpha) < 1 + 2 * alpha) {
            ratio = 1 + 2 * alpha * b;
            cosine = 1 - (ratio - 1) / alpha;
            if (c <= 4 * (1 / ratio - 1 / (ratio * ratio)))
                break;
        } else {
            ratio = (1 + 2 * alpha) / (1 + 2 * alpha * b);
            cosine = 1 - (ratio - 1) / alpha;
            if (c <= .5F * (cosine * cosine + 1 / ratio))
                break;
        }
    }
    *energy_mev /= ratio;
    direction_turn(direction, cosine, tables->azimuth[bits & 1023]);
}
