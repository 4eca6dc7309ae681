/* Allocating and freeing pictures. */
#include "core/base/image.h"

#include <stdlib.h>

#include "core/base/mem.h"

struct image *image_create(int width_px, int height_px, struct error *err)
{
    if (width_px < 1 || height_px < 1 || width_px > IMAGE_MAX_SIDE_PX || height_px > IMAGE_MAX_SIDE_PX) {
        error_set(err, ERROR_RANGE, "a picture of %d x %d pixels: each side must be 1 to %d", width_px, height_px,
                  IMAGE_MAX_SIDE_PX);
        return NULL;
    }
    struct image *image = mem_new(sizeof *image);
    image->width_px = width_px;
    image->height_px = height_px;
    image->rgba = mem_array((size_t)width_px * (size_t)height_px, 4, UINT64_MAX, err);
    if (!image->rgba) {
        free(image);
        return NULL;
    }
    return image;
}

void image_destroy(struct image *image)
{
    if (!image)
        return;
    free(image->rgba);
    free(image);
}
