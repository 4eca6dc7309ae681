#pragma once
/* Isodose surfaces as results of the store: the surface on which a dose has a value, and the field and its bricks that
 * all levels of a dose have in common. */
#include "core/derive/dose_field.h"
#include "core/derive/shape_facts.h"
#include "core/derive/shapes.h"

enum isodose_grid {
    /* The dose's own grid. Where each tissue has its own weights, a voxel takes those of the tissue at its centre. */
    ISODOSE_ON_DOSE,
    /* The regions' grid (that of tissue_rows): a univel has the dose at its centre (dose_field_value). */
    ISODOSE_ON_UNIVELS
};

/* Compared by its bytes: zeroed before it is filled. */
struct isodose_choice {
    struct dose_choice dose;
    enum isodose_grid grid;
    enum surface_algorithm algorithm;
    double value; /* in the field's unit */
};

struct isodose_shape {
    struct derive_result base;
    struct shape *shape;      /* triangles with normals (isosurface.h); none where the dose does not reach the value */
    struct shape_facts facts; /* counts and time; the rest is not-a-number before isodose_shape_measure */
};

/* A coarse surface, for moving pictures, is made from every second voxel along each axis, or every third and so on, so
 * that it has about ISODOSE_COARSE_TRIANGLES at most, and no more than ISODOSE_COARSE_UNIVELS are interpolated for it.
 */
enum { ISODOSE_COARSE_TRIANGLES = 80000, ISODOSE_COARSE_UNIVELS = 2000000, ISODOSE_MAX_REDUCTION = 6 };

/* One reference, the caller's, dropped by derive_result_unref(&result->base).
 * errors  those of dose_field_get; ERROR_NOT_FOUND univels are wanted and the plan has no region; ERROR_LIMIT;
 *         ERROR_MEMORY
 * thread  any; uses all cores */
NODISCARD struct isodose_shape *isodose_shape_get(struct derive *derive, const struct isodose_choice *choice,
                                                  enum surface_detail detail, struct error *err);
/* The facts with area and enclosed volume. volume_mm3 is not-a-number if the surface is open: where the dose's grid or
 * what has a value ends. */
void isodose_shape_measure(const struct isodose_shape *isodose, struct shape_facts *facts);
