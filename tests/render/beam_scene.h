#pragma once
/* A plan of a plate and a body with one beam, and measurements in pictures of it. */
#include "tests/render/shots.h"

enum { PX_PER_MM = 3, MIDDLE_X = SHOTS_WIDTH / 2, MIDDLE_Y = SHOTS_HEIGHT / 2 };

/* A body behind the middle, 20 mm thick, and a plate before it, 10 mm thick, on the patient's left. */
enum { BEAM_SCENE_BODY = 0x20c020, BEAM_SCENE_PLATE = 0xc02020, BEAM_SCENE_RGB = 0x2040ff };
/* The plan's box is a cube of 80 mm around the origin. */
#define DIAGONAL (80 * sqrt(3))
#define SIZE (0.03 * DIAGONAL) /* of heads, crosses and dashes */

struct plan *beam_plan(struct vec3 entry, struct vec3 target, double aperture_mm);
/* Towards the patient's left, 10 mm above the middle. */
struct plan *beam_plan_sideways(double aperture_mm);
/* The beam alone, in BEAM_SCENE_RGB: regions are invisible; translucency is plain. */
struct scene beam_scene(const struct plan *plan);

/* Pixels of a point, in a picture from the front with the origin in its middle. */
int column_of(double x_mm);
int row_of(double z_mm);

bool has_color(const uint8_t *pixel, uint32_t rgb); /* within 2 of 255 */
bool is_background(const uint8_t *pixel);
/* Rows of a column, or columns of a row, from the first to the last that is not background; false: all is. */
bool extent_of_column(const struct image *image, int x, int *first, int *last);
bool extent_of_row(const struct image *image, int y, int *first, int *last);
