/* The scene's lights in the axes of a picture. */
#include "core/render/visible/lights.h"

#include <math.h>

/* Translucent surfaces lie over the dark background and need more light to be seen. */
static const double more_for_translucent = 0.2;

/* So that the angles of proto/scene.json's defaults, of one decimal, give the same picture on any processor. */
static double thousandths(double x)
{
    return round(1000 * x) / 1000;
}

struct visible_lights visible_lights(const struct scene_light_style *style, const struct camera *camera)
{
    const double azimuth = style->azimuth_deg * MATH_PI / 180, elevation = style->elevation_deg * MATH_PI / 180;
    const double aside = thousandths(cos(elevation) * sin(azimuth)), up = thousandths(sin(elevation)),
                 ahead = thousandths(cos(elevation) * cos(azimuth));
    struct vec3 key = vec3(aside, up, ahead);
    if (style->frame == SCENE_LIGHT_FRAME_PATIENT) {
        struct vec3 lps = vec3(aside, -ahead, up); /* anterior is -P */
        key = vec3(vec3_dot(camera->right, lps), vec3_dot(camera->up, lps), -vec3_dot(camera->forward, lps));
    }
    return (struct visible_lights){ { (float)key.x, (float)key.y, (float)key.z },
                                    (float)(0.58 * style->intensity),
                                    (float)(0.18 * style->intensity),
                                    (float)(0.07 * style->intensity),
                                    (float)style->ambient,
                                    (float)(style->ambient + more_for_translucent) };
}
