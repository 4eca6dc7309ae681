#pragma once
/* Unpacks and converts the voxels of a file, in any scalar type, to a volume: an image, a label map or a mask. Shared
 * by the readers of grids; knows no file format. */
#include "core/formats/folder.h"
#include "core/report/report.h"
#include "core/volume/volume.h"

enum raw_type { RAW_I8, RAW_U8, RAW_I16, RAW_U16, RAW_I32, RAW_U32, RAW_I64, RAW_U64, RAW_F32, RAW_F64 };
uint32_t raw_type_bytes(enum raw_type type);

struct raw_voxels {
    const void *data; /* aligned for its type, in this machine's byte order */
    size_t n;
    enum raw_type type;
    const struct grid *grid;
    double slope, offset; /* value = stored * slope + offset */
    const char *name;     /* of the file, for error and report */
    uint8_t **owned; /* memory that holds data; raw_read may give it to the volume and set it to NULL. NULL: data is
                        borrowed */
};

/* Where the voxels lie in the bytes of a file. */
struct raw_place {
    struct bytes file; /* when is_packed: from the start of the gzip stream; borrowed */
    bool is_packed;
    bool is_swapped;     /* the byte order is the other one than this machine's */
    uint64_t data_at;    /* offset of the voxels, unpacked */
    uint64_t data_bytes; /* at most VOLUME_MAX_BYTES */
    uint32_t voxel_bytes;
};

/* The unpacked voxels: data lies in the file's own bytes when they can be used as they are, else in owned, which the
 * caller frees. raw_unpack reports bytes after the voxels.
 * errors ERROR_FORMAT cut short or damaged, found before memory is allocated when the sizes show it; ERROR_MEMORY */
struct raw_unpacked {
    uint8_t *data;
    uint8_t *owned;
};
NODISCARD bool raw_unpack(const struct raw_place *place, const char *name, struct raw_unpacked *unpacked,
                          struct report *report, struct error *err);

enum raw_use {
    RAW_IMAGE,  /* values, in the smallest voxel type that holds all of them */
    RAW_LABELS, /* whole numbers 0..65535, as U8 or U16; ERROR_RANGE for any other value, with its place */
    RAW_MASK    /* U8, 1 where the value is 0.5 or more */
};

/* Converts the voxels to a volume.
 *   returns  the volume, measured. One reference, the caller's; NULL on failure.
 *   errors   ERROR_RANGE, ERROR_LIMIT, ERROR_MEMORY */
NODISCARD struct volume *raw_read(const struct raw_voxels *voxels, enum raw_use use, struct report *report,
                                  struct error *err);
