#pragma once
/* Inside of contour filling: decides how the contours of one plane combine. Any thread.
 *
 *   a contour that repeats another   is left out
 *   a contour inside another         is a hole; one in that hole is an island, and so on
 *   contours that partly overlap     are a union
 *   planes of CLOSEDPLANAR_XOR alone combine by exclusive or, as DICOM PS3.3 C.8.8.6.3 says
 *
 * The result is a list of pieces per plane. A piece is the even-odd inside of its first layer, less those of its
 * cutting layers. The plane is the union of its pieces. Contours without partial overlaps need a single layer: nested
 * ones alternate by even-odd. */
#include "core/region/contour/contour_planes.h"

/* Contours that are filled together by even-odd. */
struct even_odd_layer {
    size_t first, end; /* members[first .. end) */
};

struct contour_part {
    size_t layer;
    bool is_cut; /* false: begins a piece */
};

struct contour_combining {
    const struct contour **members; /* the contours that stay, layer by layer; each once */
    struct even_odd_layer *layers;
    size_t n_layers;
    struct contour_part *parts;
    size_t n_parts, parts_room;
    size_t *part_starts, *layer_starts; /* [n_planes + 1] the parts and layers of each plane */
    size_t n_repeated;                  /* contours left out */
    size_t n_overlap_planes; /* planes on which contours overlap by more than CONTOUR_SAME_MM along their outline */
};

#define CONTOUR_MAX_COMPARED ((uint64_t)1 << 28) /* steps of comparing contours, per filling */
#define CONTOUR_SAME_MM \
    0.05 /* a contour that leaves another by less than this, on the mean of its length, is inside \
          */

/* u_lps, v_lps: unit vectors that span the planes. Errors: ERROR_LIMIT (more than CONTOUR_MAX_COMPARED steps),
 * ERROR_MEMORY. */
NODISCARD bool contour_combine(struct contour_combining *combining, const struct contour_planes *planes,
                               struct vec3 u_lps, struct vec3 v_lps, struct error *err);
void contour_combining_finish(struct contour_combining *combining);
