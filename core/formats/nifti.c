/* Reads NIfTI voxels into a volume. */
#include "core/formats/nifti.h"

#include <stdlib.h>

#include "core/formats/gzip.h"
#include "core/formats/text.h"

static struct volume *read_voxels(const struct nifti_header *header, const struct bytes *file, bool is_packed,
                                  const char *name, enum raw_use use, struct report *report, struct error *err)
{
    struct raw_unpacked unpacked;
    struct raw_place place = { *file,           is_packed,          header->is_swapped,
                               header->data_at, header->data_bytes, header->voxel_bytes };
    if (!raw_unpack(&place, name, &unpacked, report, err))
        return NULL;
    struct raw_voxels voxels = { unpacked.data, grid_n_voxels(&header->grid),
                                 header->type,  &header->grid,
                                 header->slope, header->offset,
                                 name,          &unpacked.owned };
    struct volume *volume = raw_read(&voxels, use, report, err);
    free(unpacked.owned);
    return volume;
}

struct volume *nifti_read(const struct bytes *file, const char *name, enum raw_use use, struct report *report,
                          struct error *err)
{
    struct nifti_header header;
    if (!nifti_peek(file, name, &header, report, err))
        return NULL;
    if (!nifti_check_place(&header, false, name, err))
        return NULL;
    return read_voxels(&header, file, gzip_is(file->data, file->size), name, use, report, err);
}

struct volume *nifti_read_pair(const struct bytes *head, const char *head_name, const struct bytes *voxels,
                               const char *voxels_name, enum raw_use use, struct report *report, struct error *err)
{
    struct nifti_header header;
    bool is_packed = text_has_ending(voxels_name, ".gz");
    if (!nifti_peek(head, head_name, &header, report, err) || !nifti_check_place(&header, true, head_name, err))
        return NULL;
    if (is_packed && !gzip_is(voxels->data, voxels->size)) {
        error_set(err, ERROR_FORMAT, "%s: byte 0: expected a gzip stream, which begins with 1f 8b", voxels_name);
        return NULL;
    }
    return read_voxels(&header, voxels, is_packed, voxels_name, use, report, err);
}
