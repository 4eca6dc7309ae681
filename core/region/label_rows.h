#pragma once
/* Walks label layers by runs of equal labels. Skips whole words of equal voxels: most of a layer is the inside of a
 * region. Any thread. */
#include "core/volume/volume.h"

/* End of the run of equal labels that begins at index i of a row of n labels; type is VOXEL_U8 or VOXEL_U16. */
uint32_t label_row_end(enum voxel_type type, const void *row, uint32_t i, uint32_t n);

/* Calls run for each run of equal labels other than 0. Rows come in ascending j, then k. layer is U8 or U16. */
void label_rows_runs(const struct volume *layer,
                     void (*run)(void *context, uint16_t label, uint32_t i, uint32_t j, uint32_t k, uint32_t length),
                     void *context);

/* Counts faces between neighbouring voxels of different slots, in pairs, and faces on the outside of the grid.
 *
 *   slot    for each label 0..255 (U8) or 0..65535 (U16) a number below n_slots; labels of equal slot are not
 *           distinguished
 *   faces   [n_slots][n_slots], symmetric, zeroed by the caller
 *   border  [n_slots], zeroed by the caller */
void label_rows_faces(const struct volume *layer, const uint16_t *slot, size_t n_slots, uint64_t *faces,
                      uint64_t *border);
