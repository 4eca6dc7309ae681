/* Adds masks to label layers, run by run. */
#include "core/region/contour/contour_layer.h"

#include <assert.h>
#include <string.h>

/* Calls run for every run of set bits until it returns false. */
static bool each_run(const struct mask *mask, bool (*run)(void *context, size_t at, uint32_t length), void *context)
{
    size_t n_rows = (size_t)mask->size[1] * mask->size[2];
    for (size_t row = 0; row < n_rows; row++) {
        const uint64_t *bits = mask->bits + row * mask->words;
        uint32_t i = 0;
        while (i < mask->size[0]) {
            uint64_t word = bits[i / 64] >> i % 64;
            if (word == 0) {
                i = (i / 64 + 1) * 64;
                continue;
            }
            i += (uint32_t)__builtin_ctzll(word);
            uint32_t from = i;
            while (i < mask->size[0]) { /* to the end of the run */
                uint64_t clear = ~bits[i / 64] >> i % 64;
                i = clear ? i + (uint32_t)__builtin_ctzll(clear) : (i / 64 + 1) * 64;
                if (clear)
                    break;
            }
            i = i < mask->size[0] ? i : mask->size[0];
            if (!run(context, row * mask->size[0] + from, i - from))
                return false;
        }
    }
    return true;
}

static bool is_clear_u8(void *voxels, size_t at, uint32_t length)
{
    const uint8_t *label = (const uint8_t *)voxels + at;
    for (uint32_t i = 0; i < length; i++)
        if (label[i])
            return false;
    return true;
}

static bool is_clear_u16(void *voxels, size_t at, uint32_t length)
{
    const uint16_t *label = (const uint16_t *)voxels + at;
    for (uint32_t i = 0; i < length; i++)
        if (label[i])
            return false;
    return true;
}

struct laying {
    struct volume *layer;
    uint16_t label;
};

static bool lay(void *context, size_t at, uint32_t length)
{
    const struct laying *laying = context;
    if (laying->layer->type == VOXEL_U8) {
        memset((uint8_t *)laying->layer->voxels + at, laying->label, length);
        return true;
    }
    for (uint32_t i = 0; i < length; i++)
        ((uint16_t *)laying->layer->voxels)[at + i] = laying->label;
    return true;
}

static bool suits(const struct mask *mask, const struct volume *layer)
{
    return memcmp(mask->size, layer->grid.size, sizeof mask->size) == 0 &&
           (layer->type == VOXEL_U8 || layer->type == VOXEL_U16);
}

bool mask_layer_is_free(const struct mask *mask, const struct volume *layer)
{
    assert(suits(mask, layer));
    return each_run(mask, layer->type == VOXEL_U8 ? is_clear_u8 : is_clear_u16, layer->voxels);
}

void mask_layer_put(const struct mask *mask, struct volume *layer, uint16_t label)
{
    assert(suits(mask, layer) && (layer->type == VOXEL_U16 || label <= UINT8_MAX));
    struct laying laying = { layer, label };
    each_run(mask, lay, &laying);
}

struct volume *mask_layer_create(const struct mask *mask, struct error *err)
{
    struct grid grid;
    if (!grid_init(&grid, mask->size, &mask->lps_mm_from_ijk, err))
        return NULL;
    struct volume *layer = volume_create(&grid, VOXEL_U8, err);
    if (layer)
        mask_layer_put(mask, layer, 1);
    return layer;
}
