#pragma once
/* The light on a surface, the same as in core/render/gl/shaders/light.glsl: a key light, a weak fill light from the
 * left, both of the scene (core/render/visible/lights.h), a soft rim; translucency as in proto/scene.json. Has no
 * branches, so that compilers vectorise it. */
#include <math.h>

#include "core/render/soft/kernels.h"

/* s^3.6, that is edge^1.8 for s = sqrt(edge); error below 7e-5, a fiftieth of a grey level */
#define LIGHT_RIM(s) ((s) * (s) * (s) * (0.16669681f + (s) * (1.21131124f + (s) * (-0.52702127f + (s)*0.14907992f))))
#define LIGHT_CLAMP(x) ((x) > 0.0f ? (x) : 0.0f)
#define LIGHT_BYTE(x) ((uint32_t)(int32_t)(((x) < 1.0f ? (x) : 1.0f) * 255.0f + 0.5f))

/* n: normal, t: direction towards the viewer; unit vectors in patient space. */
__attribute__((always_inline)) static inline uint32_t light_at(const struct soft_lighting *s, float nx, float ny,
                                                               float nz, float tx, float ty, float tz)
{
    const float cosine = nx * tx + ny * ty + nz * tz;
    const float side = (s->is_two_sided & (cosine < 0.0f)) ? -1.0f : 1.0f; /* the side that is seen */
    const float facing = side * cosine;
    float edge = 1.0f - LIGHT_CLAMP(facing);
    edge = LIGHT_CLAMP(edge);
    const float ex = side * (s->right[0] * nx + s->right[1] * ny + s->right[2] * nz),
                ey = side * (s->up[0] * nx + s->up[1] * ny + s->up[2] * nz),
                ez = side * (s->towards[0] * nx + s->towards[1] * ny + s->towards[2] * nz);
    const struct visible_lights *lights = &s->lights;
    const float key_cosine = lights->key[0] * ex + lights->key[1] * ey + lights->key[2] * ez,
                fill_cosine = -0.741f * ex + 0.106f * ey + 0.663f * ez;
    const float key = LIGHT_CLAMP(key_cosine), fill = LIGHT_CLAMP(fill_cosine);
    const float key_2 = key * key, key_4 = key_2 * key_2, key_8 = key_4 * key_4,
                gloss = lights->gloss * (key_8 * key_8);
    const float ambient = s->opacity < 1.0f ? lights->ambient_translucent : lights->ambient;
    const float lit = ambient + lights->key_light * key + lights->fill_light * fill + 0.24f * (edge * edge);
    const float root = sqrtf(edge), rim = s->is_rim ? 1.82f * s->opacity : 0.0f,
                flat = s->is_rim ? 0.3f * s->opacity : s->opacity;
    const float alpha = flat + rim * LIGHT_RIM(root);
    const float red = s->color[0] * lit + gloss, green = s->color[1] * lit + gloss, blue = s->color[2] * lit + gloss;
    return (LIGHT_BYTE(red) | LIGHT_BYTE(green) << 8 | LIGHT_BYTE(blue) << 16 | LIGHT_BYTE(alpha) << 24) ^ s->mark;
}
