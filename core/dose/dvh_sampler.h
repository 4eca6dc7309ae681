#pragma once
/* Inside core/dose: doses at univel centres, row by row of a label grid. */
#include "core/dose/dvh_kernels.h"
#include "core/volume/volume.h"

struct dvh_sampler {
    const struct grid *labels, *dose;
    struct affine dose_from_label; /* index to index */
    size_t strides[3];             /* of the dose's axes, in voxels */
    bool is_parallel;              /* each label axis runs along one of the dose's axes */
    int dose_axis[3];              /* parallel: that axis, by label axis */
    struct dvh_axis along[3];      /* parallel: by label axis */
    uint32_t low, high;            /* parallel: the dose voxels that a row of labels needs */
    const struct dvh_kernels *kernels;
};

/* Both grids are borrowed. errors ERROR_MEMORY */
NODISCARD bool dvh_sampler_init(struct dvh_sampler *sampler, const struct grid *labels, const struct grid *dose,
                                bool is_general, struct error *err);
void dvh_sampler_finish(struct dvh_sampler *sampler);

/* Floats that a row of scratch has to hold. */
size_t dvh_sampler_scratch(const struct dvh_sampler *sampler);
/* Values of a dose at univels from to to - 1 of row (j, k), at out[from] and on; NaN where there is none. out has room
 * for the row and DVH_PADDING. */
void dvh_sampler_row(const struct dvh_sampler *sampler, const float *dose, uint32_t j, uint32_t k, uint32_t from,
                     uint32_t to, float *scratch, float *out);
/* The value at one point of the label grid's index space. */
float dvh_sampler_point(const struct dvh_sampler *sampler, const float *dose, struct vec3 ijk);
