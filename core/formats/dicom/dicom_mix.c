/* Mixes planes of cells. */
#include "core/formats/dicom/dicom_mix.h"

#include <math.h>

#define MIX(type, nearest) \
    do { \
        const type *a = low, *b = high; \
        type *to = out; \
        for (size_t i = 0; i < n; i++) \
            to[i] = (type)nearest((double)a[i] + weight * ((double)b[i] - (double)a[i])); \
    } while (0)

void dicom_planes_mix(enum voxel_type type, const void *low, const void *high, double weight, void *out, size_t n)
{
    switch (type) {
    case VOXEL_U8: MIX(uint8_t, lrint); break;
    case VOXEL_I16: MIX(int16_t, lrint); break;
    case VOXEL_U16: MIX(uint16_t, lrint); break;
    case VOXEL_F32: MIX(float, ); break;
    }
}
