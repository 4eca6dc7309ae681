#pragma once
/* Adds masks to label layers: several regions share a layer as long as they share no voxel. Any thread; the layer is
 * the caller's alone. */
#include "core/region/mask.h"

/* Returns true if no voxel of the mask has a label yet. layer is U8 or U16, of the mask's size. */
bool mask_layer_is_free(const struct mask *mask, const struct volume *layer);
/* Sets the label of the mask's voxels; replaces the labels they had. */
void mask_layer_put(const struct mask *mask, struct volume *layer, uint16_t label);
/* Creates a U8 layer on the mask's grid with label 1 in the mask. Errors: ERROR_LIMIT, ERROR_MEMORY. */
NODISCARD struct volume *mask_layer_create(const struct mask *mask, struct error *err);
