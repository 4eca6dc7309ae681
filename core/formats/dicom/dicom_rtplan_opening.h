#pragma once
/* Inside the RT Plan reader: the field opening left by jaws, leaves, blocks and applicator, in the plane of the
 * isocentre. Any thread; one struct opening per beam. */
#include "core/beam/beam.h"
#include "core/formats/dicom/dicom_numbers.h"

enum { OPENING_MAX_DEVICES = 8, OPENING_MAX_LEAVES = 400 }; /* per beam; pairs per device; more are an error */
#define OPENING_MOST_MM \
    500.0 /* largest distance of a jaw or leaf from the isocentre: treatment machines open to 200 mm and retract a \
             little further */

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
};

/* Reads devices, blocks and applicator of a beam. Set opening->doubts before.
 *
 *   errors  ERROR_LIMIT more than OPENING_MAX_DEVICES or OPENING_MAX_LEAVES */
NODISCARD bool opening_init(struct opening *opening, const struct dicom_item *beam, struct error *err);
/* Applies the device positions of a control point; number counts from 1. */
void opening_move(struct opening *opening, const struct dicom_item *control_point, size_t number);
/* Extends delivery's hull of all openings by the current one; at the first control point also fills jaws and area. */
void opening_measure(const struct opening *opening, bool is_first, struct beam_delivery *delivery);
/* The diameter if the opening is round and no device cuts into it; else NaN. */
double opening_diameter_mm(const struct opening *opening, const struct beam_delivery *delivery);
