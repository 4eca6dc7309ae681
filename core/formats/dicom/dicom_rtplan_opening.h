#pragma once
/* Inside the RT Plan reader: the field opening left by jaws, leaves, blocks and applicator, in the plane of the
 * isocentre. Any thread; one struct opening per beam. */
#include "core/beam/beam.h"
#include "core/formats/dicom/dicom_numbers.h"

enum { OPENING_MAX_DEVICES = 8, OPENING_MAX_LEAVES = 400 }; /* per beam; pairs per device; more are an error */
#define OPENING_MOST_MM \
    500.0 /* largest distance of a jaw or leaf from the isocentre: treatment machines open to 200 mm and retract a \
             little further */

#define OPENING_WIDE_MM 1e4 /* coordinate of a side that no device limits */

/* A rectangle; a side that no device limits is at OPENING_WIDE_MM. */
struct opening_rectangle {
    double x[2], y[2];
};

/* A beam limiting device and its positions, which apply until a control point changes them. */
struct opening_device {
    char type[17]; /* RT Beam Limiting Device Type: "X", "ASYMX", "Y", "ASYMY", "MLCX", "MLCY" */
    size_t n_pairs;
    double boundaries_mm[OPENING_MAX_LEAVES + 1]; /* between neighbouring leaves */
    double positions_mm[2 * OPENING_MAX_LEAVES];  /* n_pairs of one side, then n_pairs of the other */
    bool is_placed;
};

struct opening {
    struct dicom_doubts *doubts; /* the caller's; collects positions and devices that cannot be used */
    struct opening_device devices[OPENING_MAX_DEVICES];
    size_t n_devices;
    double block_x_mm[2], block_y_mm[2], block_cm2; /* of aperture blocks; NaN without one */
    double round_mm;                                /* diameter of a round block or applicator; NaN without one */
    struct beam_outline blocks;                     /* of aperture blocks; without polygons if has_lost_blocks */
    bool has_lost_blocks;                           /* they have too many points to be kept */
};

static inline void opening_narrow(double side[2], double low, double high)
{
    side[0] = fmax(side[0], low);
    side[1] = fmin(side[1], high);
}
bool opening_is_leaves(const struct opening_device *device);
bool opening_moves_along_x(const struct opening_device *device);
/* The opening between the jaws; has_x and has_y are false for a direction without jaws. */
struct opening_rectangle opening_jaws(const struct opening *opening, bool *has_x, bool *has_y);
/* The opening between a pair of leaves, inside the jaws. False: it is closed. */
bool opening_between(const struct opening_device *device, size_t pair, const struct opening_rectangle *jaws,
                     struct opening_rectangle *gap);

/* Reads devices, blocks and applicator of a beam. Set opening->doubts before.
 *
 *   errors  ERROR_LIMIT more than OPENING_MAX_DEVICES or OPENING_MAX_LEAVES */
NODISCARD bool opening_init(struct opening *opening, const struct dicom_item *beam, struct error *err);
/* Applies the device positions of a control point; number counts from 1. */
void opening_move(struct opening *opening, const struct dicom_item *control_point, size_t number);
/* Extends delivery's hull of all openings by the current one; at the first control point also fills jaws and area. */
void opening_measure(const struct opening *opening, bool is_first, struct beam_delivery *delivery);
/* The outline of the current opening, which is not closed (dicom_rtplan_outline.c). */
void opening_outline(const struct opening *opening, struct beam_outline *outline);
/* The diameter if the opening is round and no device cuts into it; else NaN. */
double opening_diameter_mm(const struct opening *opening, const struct beam_delivery *delivery);
