#pragma once
/* Orientation letters: the patient's direction at each edge of a picture. The rule of the page's
 * web/js/pane/letters.js; tests/data/edge_letters.json holds both to it. */
#include "core/math/vec.h"

/* "L", or "AR" for an oblique direction, dominant letter first: L R, P A, S I. direction: unit, patient LPS. */
void letters_of_direction(struct vec3 direction, char letters[3]);

struct edge_letters {
    char left[3], right[3], top[3], bottom[3];
};
/* right, up: unit axes of the picture in patient LPS. */
struct edge_letters letters_of_edges(struct vec3 right, struct vec3 up);
