/* Memory that the voxels of a file take. */
#include "core/load/part_reader.h"

/* Bytes per voxel in memory, as raw_read chooses the type; a signed byte becomes 16 bits. */
static uint64_t bytes_kept(enum raw_type type, enum raw_use use)
{
    switch (use) {
    case RAW_MASK: return 1;
    case RAW_LABELS: return type == RAW_U8 || type == RAW_I8 ? 1 : 2;
    case RAW_IMAGE: break;
    }
    switch (type) {
    case RAW_U8: return 1;
    case RAW_I8:
    case RAW_I16:
    case RAW_U16: return 2;
    default: return 4;
    }
}

struct part_need part_need_of_voxels(uint64_t n_voxels, enum raw_type type, enum raw_use use, uint64_t file_bytes,
                                     bool is_copied, bool is_taken)
{
    uint64_t raw = n_voxels * raw_type_bytes(type);
    if (use == RAW_IMAGE && is_taken && bytes_kept(type, use) == raw_type_bytes(type))
        is_copied = false; /* the unpacked bytes become the volume's voxels */
    uint64_t wide =
        use == RAW_LABELS && type != RAW_U8 ? n_voxels : 0; /* labels are read as 16 bits, then narrowed to 8 */
    return (struct part_need){ n_voxels * bytes_kept(type, use), file_bytes + (is_copied ? raw : 0) + wide };
}
