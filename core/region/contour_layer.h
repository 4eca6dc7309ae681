#pragma once
/* Masks laid into label layers: several regions share one as long as they share no voxel. */
#include "core/region/mask.h"

/* Whether no voxel of the mask carries a label yet. layer is U8 or U16, of the mask's size. */
bool mask_layer_is_free(const struct mask *mask, const struct volume *layer);
/* Gives the mask's voxels the label; what they carried is lost. */
void mask_layer_put(const struct mask *mask, struct volume *layer, uint16_t label);
/* A new U8 layer on the grid that carries 1 where the mask is set. errors ERROR_LIMIT, ERROR_MEMORY */
NODISCARD struct volume *mask_layer_create(const struct mask *mask, struct error *err);
