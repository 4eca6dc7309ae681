#pragma once
/* Inside the RT Plan reader: what jaws, leaves, blocks and applicators leave open, in the plane of the isocentre. */
#include "core/beam/beam.h"
#include "core/formats/dicom/dicom_numbers.h"

enum { OPENING_MAX_DEVICES = 8, OPENING_MAX_LEAVES = 400 };
#define OPENING_MOST_MM \
    500.0 /* from the isocentre to a jaw or leaf: treatment machines open to 200 mm and draw back a little further */

/* Devices and where they stand; positions stay until a control point moves them. */
struct opening_device {
    char type[17]; /* "X", "ASYMX", "Y", "ASYMY", "MLCX", "MLCY" */
    size_t n_pairs;
    double boundaries_mm[OPENING_MAX_LEAVES + 1]; /* of leaves */
    double positions_mm[2 * OPENING_MAX_LEAVES];  /* first all of one side, then all of the other */
    bool is_placed;
};

struct opening {
    struct dicom_doubts *doubts; /* the caller's: what cannot be used, or cannot be */
    struct opening_device devices[OPENING_MAX_DEVICES];
    size_t n_devices;
    double block_x_mm[2], block_y_mm[2], block_cm2; /* of aperture blocks; not-a-number without one */
    double round_mm; /* diameter of a round block or applicator; not-a-number without one */
};

/* Devices, blocks and applicator of a beam; opening->doubts is set. errors ERROR_LIMIT RTPLAN_MAX_LEAVES */
NODISCARD bool opening_init(struct opening *opening, const struct dicom_item *beam, struct error *err);
/* Takes over the positions that a control point (by its number from 1) gives. */
void opening_move(struct opening *opening, const struct dicom_item *control_point, size_t number);
/* Adds the opening as it stands to the hull; at the first control point also jaws and area. */
void opening_measure(const struct opening *opening, bool is_first, struct beam_delivery *delivery);
/* Diameter when the opening is round and nothing cuts into it. */
double opening_diameter_mm(const struct opening *opening, const struct beam_delivery *delivery);
