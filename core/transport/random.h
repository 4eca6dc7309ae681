#pragma once
/* Random numbers of a history: small, fast, and equal on every machine. Inline, without state of their own. */
#include <stdint.h>

struct random {
    uint64_t state;
};

/* source  G. L. Steele, D. Lea, C. H. Flood, Fast splittable pseudorandom number generators, OOPSLA 2014 */
static inline uint64_t random_bits(struct random *random)
{
    uint64_t bits = random->state += UINT64_C(0x9e3779b97f4a7c15);
    bits = (bits ^ (bits >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    bits = (bits ^ (bits >> 27)) * UINT64_C(0x94d049bb133111eb);
    return bits ^ (bits >> 31);
}

/* Numbers of a stream, as of one history: streams of different numbers or seeds have nothing in common. */
static inline struct random random_of(uint64_t seed, uint64_t stream)
{
    struct random random = { seed };
    random.state = random_bits(&random) ^ (stream * UINT64_C(0xd1342543de82ef95));
    random.state = random_bits(&random);
    return random;
}

/* Above 0 and below 1. The high and the low half of the same bits are independent. */
static inline float random_high(uint64_t bits)
{
    return ((float)(bits >> 41) + .5F) * (1.F / 8388608.F);
}
static inline float random_low(uint64_t bits)
{
    return ((float)((bits >> 16) & 0x7fffff) + .5F) * (1.F / 8388608.F);
}
/* The last sixteen bits, independent of both. */
static inline float random_last(uint64_t bits)
{
    return ((float)(uint16_t)bits + .5F) * (1.F / 65536.F);
}
static inline float random_unit(struct random *random)
{
    return random_high(random_bits(random));
}
