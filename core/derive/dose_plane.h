#pragma once
/* The values of a dose's field on a lattice in a plane, and lines of equal value through them. */
#include "core/derive/dose_field.h"
#include "core/dose/isolines.h"

/* The points of a lattice: sample (u, v) is at map(u, v, 0). */
struct dose_lattice {
    struct affine lps_mm_from_uv; /* columns 0 and 1 lie in the plane; column 2 is not used */
    uint32_t size[2];             /* each 1..ISOLINES_MAX_SIDE */
    bool is_by_slice;             /* bilinear within the nearest slice k of the dose's grid, instead of tri-linear */
};

struct dose_plane {
    struct dose_lattice lattice;
    float *values; /* [size[1]][size[0]]; NaN: there is none */
    uint8_t *rows; /* of the tissue at each sample; NULL: one row holds everywhere */
};

/* Samples as dose_field_value does; with is_by_slice, at the nearest slice. errors ERROR_MEMORY; thread any, uses all
 * cores */
NODISCARD struct dose_plane *dose_plane_create(const struct dose_field *field, const struct dose_lattice *lattice,
                                               struct error *err);
void dose_plane_destroy(struct dose_plane *plane);
size_t dose_plane_n_bytes(const struct dose_plane *plane);

/* Lines of a value, in the field's unit, in coordinates of the lattice. Between two samples in univels with different
 * weights the line is where the values along the edge change sides: on the border of the univels, if they jump there.
 * field: the one that was sampled. errors ERROR_MEMORY */
NODISCARD bool dose_plane_trace(const struct dose_plane *plane, const struct dose_field *field, double level,
                                struct isolines *lines, struct error *err);
