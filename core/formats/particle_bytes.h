#pragma once
/* Numbers of a file of particles, in the byte order it says. Inline. */
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

static inline uint64_t particle_bytes_whole(const uint8_t *at, int n, bool is_big)
{
    uint64_t value = 0;
    for (int i = 0; i < n; i++)
        value = value << 8 | at[is_big ? i : n - 1 - i];
    return value;
}
static inline double particle_bytes_float(const uint8_t *at, bool is_big)
{
    uint32_t bits = (uint32_t)particle_bytes_whole(at, 4, is_big);
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}
static inline double particle_bytes_double(const uint8_t *at, bool is_big)
{
    uint64_t bits = particle_bytes_whole(at, 8, is_big);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}
