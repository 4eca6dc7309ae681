#pragma once
/* Voxels as a file holds them, in any scalar type, into a volume: an image, a label map or a mask. What the readers of
 * grids share; knows no file format. */
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
    const char *name;     /* for the sentences */
    uint8_t **owned;      /* memory that holds data and may become the volume's: it is NULL then; NULL: there is none */
};

/* Where the voxels lie in bytes from a file. */
struct raw_place {
    struct bytes file; /* from the gzip stream on when is_packed; borrowed */
    bool is_packed;
    bool is_swapped;     /* the byte order is not this machine's */
    uint64_t data_at;    /* where voxels begin, unpacked */
    uint64_t data_bytes; /* at most VOLUME_MAX_BYTES */
    uint32_t voxel_bytes;
};

/* The voxels themselves: data lies in the file's own bytes where these will do, else in owned, which the caller frees.
 * Bytes behind the voxels are reported. errors ERROR_FORMAT cut short or damaged, told before memory is taken where the
 * sizes tell it; ERROR_MEMORY */
struct raw_unpacked {
    uint8_t *data;
    uint8_t *owned;
};
NODISCARD bool raw_unpack(const struct raw_place *place, const char *name, struct raw_unpacked *unpacked,
                          struct report *report, struct error *err);

enum raw_use {
    RAW_IMAGE,  /* values, in the smallest voxel type that holds them */
    RAW_LABELS, /* whole numbers 0..65535, U8 or U16; errors ERROR_RANGE any other, with its place */
    RAW_MASK    /* U8, 1 inside: half and more */
};

/*   returns  the volume, measured. One reference, the caller's; NULL on failure.
 *   errors   ERROR_RANGE, ERROR_LIMIT, ERROR_MEMORY */
NODISCARD struct volume *raw_read(const struct raw_voxels *voxels, enum raw_use use, struct report *report,
                                  struct error *err);
