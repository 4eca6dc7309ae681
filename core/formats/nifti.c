#include "core/formats/nifti.h"

#include <stdlib.h>

#include "core/formats/gzip.h"

struct volume *nifti_read(const struct bytes *file, const char *name, enum raw_use use, struct report *report, struct error *err)
{
    struct nifti_header header;
    struct raw_unpacked unpacked;
    if (!nifti_peek(file, name, &header, report, err))
        return NULL;
    struct raw_place place = { *file, gzip_is(file->data, file->size), header.is_swapped, header.data_at, header.data_bytes,
                               header.voxel_bytes };
    if (!raw_unpack(&place, name, &unpacked, report, err))
        return NULL;
    struct raw_voxels voxels = { unpacked.data, grid_n_voxels(&header.grid), header.type, &header.grid, header.slope, header.offset,
                                 name, &unpacked.owned };
    struct volume *volume = raw_read(&voxels, use, report, err);
    free(unpacked.owned);
    return volume;
}
