#pragma once
/* Inside the extraction of isosurfaces: the voxels of a field as bits, in the working grid of marching cubes. */
#include "core/surface/isosurface.h"
#include "core/surface/marching_rows.h"

struct iso_bits {
    const struct volume *field;
    const struct iso_bricks *bricks; /* NULL: all voxels are read */
    float level;                     /* the smallest float that is inside */
    enum marching_cubes_code code;
    struct marching_rows grid;   /* the working grid: part of the field's; bit: the voxel is inside */
    struct marching_rows valued; /* the same grid; bit: the voxel has a value. bits NULL: all have one */
};

/* Sets level, and start and size of the working grid: the bricks through which the surface passes and the next one
 * along each axis. False: it passes through none. iso is finite. */
bool iso_bits_place(struct iso_bits *bits, double iso);
/* Makes both grids' bits and the rows of the first. Errors: ERROR_MEMORY. */
NODISCARD bool iso_bits_make(struct iso_bits *bits, int n_parts, struct error *err);
void iso_bits_finish(struct iso_bits *bits);
/* Returns the bits as a mask of the whole field. Errors: ERROR_MEMORY. */
NODISCARD struct mask *iso_bits_mask(struct iso_bits *bits, int n_parts, struct error *err);

/* If some voxels have no value (isosurface_gaps.c): the crossed edges of a word of row y, z that are vertices, and its
 * cells with triangles. */
struct crossings iso_kept_crossings(const struct iso_bits *bits, const struct around *rows, uint32_t y, uint32_t z,
                                    uint32_t w);
void iso_count_kept(const struct iso_bits *bits, uint32_t z); /* counts what the rows of a slice own */
/* Writes the triangles of a row of cells. */
void iso_write_kept_triangles(const struct iso_bits *bits, const struct row *row, const struct around *rows, uint32_t y,
                              uint32_t z);

/* isosurface_make by one of the compiled versions, for tests: both give the same bytes. */
NODISCARD struct mesh *isosurface_with(enum marching_cubes_code code, enum surface_algorithm algorithm,
                                       const struct volume *field, const struct iso_bricks *bricks, double iso,
                                       const struct surface_options *options, struct error *err);
