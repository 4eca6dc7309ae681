#pragma once
/* The lights of a scene (lights in proto/scene.json) as both back ends compute with them. */
#include "core/scene/camera.h"

struct visible_lights {
    float key[3];     /* unit vector towards the key light: to the right of the picture, up, towards the viewer */
    float key_light;  /* on a surface that faces it */
    float fill_light; /* the same of the light from the left that fills shadows */
    float gloss;      /* added to the colour, where the key light is mirrored */
    float ambient, ambient_translucent;
};
struct visible_lights visible_lights(const struct scene_light_style *style, const struct camera *camera);
