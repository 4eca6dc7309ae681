#pragma once
/* Where the words beside points of a picture go so that no two cover each other. Pure; pixels, y down. */
#include <stdbool.h>
#include <stddef.h>

struct label_box {
    int left, top, width, height;
};
struct label_placing {
    int width_px, height_px; /* of the picture */
    int aside_px;            /* between a point and its words, across and down to the middle of their capitals */
    int rim_px, above_px;    /* of a box: left of its words; above the middle of their capitals */
    int step_px;             /* between two places that are tried */
    struct label_box *taken; /* the caller's, with room for one more for each call */
    size_t n_taken, n_fixed; /* the first n_fixed keep words away from every place but the usual one */
};

/* Finds the place of words of box->width x box->height beside the point: above it and to the right as usual, at its
 * other corners, else the nearest free place of the picture. The place is taken from then on. False: nothing is free,
 * and the box has the usual place.   thread: any */
bool label_place(struct label_placing *placing, int x, int y, struct label_box *box);
/* Whether the box lies so far from the point that a line has to join them. Its end at the box. */
bool label_is_far(const struct label_placing *placing, int x, int y, const struct label_box *box, int end[2]);
