#pragma once
/* Shared by the tests of the colourwash: a plan with a linear dose on any grid, scenes that show it, and what each
 * pixel must show by geometry. */
#include "core/scene/camera.h"
#include "tests/render/shots.h"

/* The dose at a point, in Gy: linear. */
struct wash_field {
    struct vec3 gradient; /* per mm */
    double at_origin;
};
double wash_linear(const struct wash_field *field, struct vec3 p);

/* A cube of 64 mm around the origin, of 1 mm voxels: an image of one value, two regions (a: x < 4, b: the rest) within
 * a box of half sides 24, 20 and 22 mm; and a total dose in Gy on its own grid. */
struct plan *wash_plan(const struct grid *dose_grid, const struct wash_field *field);
bool wash_is_in_box(struct vec3 p);
static const struct vec3 wash_box_mm = { 24, 20, 22 };

/* A number of a fixed sequence: 0 .. 1. */
double wash_random(void);
/* A grid that holds about 50 mm in each direction: anisotropic, turned, its middle anywhere within 3 mm of the origin;
 * every other one is sheared, every third one left-handed. */
struct grid wash_random_grid(int number);

/* Levels at 20, 40, 60 and 80 Gy, and 3 Gy of the lowest hidden: values under 23 Gy have no colour. */
enum { WASH_LEVELS = 4 };
extern const uint32_t wash_colors[WASH_LEVELS];
struct scene wash_scene(const struct plan *plan, bool is_smooth, double opacity);

/* The value at an index of the dose's grid by the closed form: linear between the outermost centres, beyond them as
 * there, none beyond the outer faces. is_sure: the point is not so near a face that rounding decides. */
bool wash_value(const struct grid *grid, const struct wash_field *field, bool is_per_slice, struct vec3 p,
                double *value, bool *is_sure);

/* Patient points that pixels show; false for pixels that are not compared. */
struct wash_places {
    bool (*point)(const struct wash_places *places, int x, int y, struct vec3 *p);
    struct camera camera;
    struct plane plane;
    double slack;            /* levels of 255 besides half a one, of rounding the result, and single precision */
    bool is_over_background; /* the wash lies also where the picture without it shows the background */
};
bool wash_on_plane(const struct wash_places *places, int x, int y, struct vec3 *p); /* where a ray meets `plane` */
bool wash_on_box(const struct wash_places *places, int x, int y, struct vec3 *p);   /* where it enters the box */

/* The dose at a point, if any; is_sure as above. */
struct wash_dose {
    bool (*value)(const struct wash_dose *dose, struct vec3 p, double *value, bool *is_sure);
    const struct grid *grid;
    const struct wash_field *field;
    bool is_per_slice;
};
bool wash_dose_linear(const struct wash_dose *dose, struct vec3 p, double *value, bool *is_sure);

/* Takes the picture of the scene with and without the wash and compares each pixel: (1 - opacity) of the one without
 * and opacity of the colour, within rounding. A pixel is left out if its value is within 0.02 pixels of a level. Fails
 * unless n_least pixels have a colour. Consumes scene. */
void wash_expect(struct plan *plan, struct scene scene, struct view view, struct wash_places places,
                 const struct wash_dose *dose, size_t n_least, const char *what);
