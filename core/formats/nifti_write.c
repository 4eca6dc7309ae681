/* Writes a volume as a NIfTI file. */
#include "core/formats/nifti_write.h"

#include <libdeflate.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/file_write.h"
#include "core/base/mem.h"

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "voxels are written as they lie in memory, as little-endian");

enum { GZIP_LEVEL = 1, CODE_SCANNER = 1, UNITS_MM = 2, HEADER_MOST = 544 };
#define EXACT_MM 1e-7 /* a corner may move by so much through rounding to 32 bits; beyond it NIfTI-2 is written */

/* Offsets of the header's fields and widths of its numbers, in bytes. */
struct layout {
    uint32_t header_bytes, voxels_at, real_bytes;
    const char *magic;
    size_t magic_bytes;
    int magic_at, dim, dim_bytes, datatype, bitpix, pixdim, vox_offset, slope, units, description, qform_code,
        code_bytes, quaternion, srow;
};
static const struct layout nifti1 = { 348, 352, 4,   "n+1", 4,   344, 40, 2,   70, 72,
                                      76,  108, 112, 123,   148, 252, 2,  256, 280 };
static const struct layout nifti2 = {
    540, 544, 8, "n+2\0\r\n\032\n", 8, 4, 16, 8, 12, 14, 104, 168, 176, 500, 240, 344, 4, 352, 400
};

static void put_whole(uint8_t *header, int at, int bytes, int64_t value)
{
    memcpy(header + at, &value, (size_t)bytes); /* little-endian: low bytes first */
}

static void put_real(uint8_t *header, const struct layout *layout, int first, int index, double value)
{
    float narrow = (float)value;
    const void *bytes = layout->real_bytes == 4 ? (const void *)&narrow : (const void *)&value;
    memcpy(header + first + index * (int)layout->real_bytes, bytes, layout->real_bytes);
}

static int datatype_code(enum voxel_type type)
{
    switch (type) {
    case VOXEL_U8: return 2;
    case VOXEL_I16: return 4;
    case VOXEL_U16: return 512;
    case VOXEL_F32: return 16;
    }
    return 0;
}

/* Turns the rotation with columns x, y, z into a unit quaternion (a, b, c, d) with a >= 0. The largest of the four
 * squares is the divisor, so no division is by a small number. */
static void quaternion_from_axes(struct vec3 x, struct vec3 y, struct vec3 z, double q[4])
{
    double squares[4] = { 1 + x.x + y.y + z.z, 1 + x.x - y.y - z.z, 1 - x.x + y.y - z.z,
                          1 - x.x - y.y + z.z }; /* four times the squares of a, b, c, d */
    int largest = 0;
    for (int i = 1; i < 4; i++)
        if (squares[i] > squares[largest])
            largest = i;
    double products[4][4] = {
        { squares[0], y.z - z.y, z.x - x.z, x.y - y.x },
        { y.z - z.y, squares[1], x.y + y.x, z.x + x.z },
        { z.x - x.z, x.y + y.x, squares[2], y.z + z.y },
        { x.y - y.x, z.x + x.z, y.z + z.y, squares[3] },
    }; /* 4 q[i] q[j] */
    double scale = 0.5 / sqrt(squares[largest]);
    if (products[largest][0] < 0)
        scale = -scale;
    for (int i = 0; i < 4; i++)
        q[i] = products[largest][i] * scale;
}

static struct vec3 ras_from_lps(struct vec3 v)
{
    return vec3(-v.x, -v.y, v.z);
}

static void put_geometry(uint8_t *header, const struct layout *layout, const struct grid *grid)
{
    struct vec3 columns[3], axes[3];
    for (int i = 0; i < 3; i++) {
        columns[i] = ras_from_lps(grid->lps_mm_from_ijk.columns[i]);
        axes[i] = vec3_normalize(columns[i]);
        put_real(header, layout, layout->pixdim, i + 1, vec3_length(columns[i]));
    }
    struct vec3 origin = ras_from_lps(grid->lps_mm_from_ijk.origin);
    double rows[3][4] = { { columns[0].x, columns[1].x, columns[2].x, origin.x },
                          { columns[0].y, columns[1].y, columns[2].y, origin.y },
                          { columns[0].z, columns[1].z, columns[2].z, origin.z } };
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 4; column++)
            put_real(header, layout, layout->srow, 4 * row + column, rows[row][column]);
    put_whole(header, layout->qform_code + layout->code_bytes, layout->code_bytes, CODE_SCANNER); /* the sform's code */

    double handedness = vec3_dot(vec3_cross(axes[0], axes[1]), axes[2]) < 0 ? -1 : 1;
    put_real(header, layout, layout->pixdim, 0, handedness);
    bool is_orthogonal = fabs(vec3_dot(axes[0], axes[1])) < 1e-5 && fabs(vec3_dot(axes[1], axes[2])) < 1e-5 &&
                         fabs(vec3_dot(axes[2], axes[0])) < 1e-5;
    if (!is_orthogonal)
        return; /* a sheared grid has no qform; readers use the sform */
    double q[4];
    quaternion_from_axes(axes[0], axes[1], vec3_scale(axes[2], handedness), q);
    double offsets[3] = { origin.x, origin.y, origin.z };
    for (int i = 0; i < 3; i++) {
        put_real(header, layout, layout->quaternion, i, q[i + 1]);
        put_real(header, layout, layout->quaternion, 3 + i, offsets[i]);
    }
    put_whole(header, layout->qform_code, layout->code_bytes, CODE_SCANNER);
}

static void put_header(uint8_t *header, const struct layout *layout, const struct volume *volume,
                       const char *description)
{
    put_whole(header, 0, 4, layout->header_bytes);
    put_whole(header, layout->dim, layout->dim_bytes, 3);
    for (int i = 0; i < 7; i++)
        put_whole(header, layout->dim + layout->dim_bytes * (i + 1), layout->dim_bytes,
                  i < 3 ? volume->grid.size[i] : 1);
    put_whole(header, layout->datatype, 2, datatype_code(volume->type));
    put_whole(header, layout->bitpix, 2, (int64_t)(8 * voxel_size(volume->type)));
    if (layout == &nifti1)
        put_real(header, layout, layout->vox_offset, 0, layout->voxels_at);
    else
        put_whole(header, layout->vox_offset, 8, layout->voxels_at);
    put_real(header, layout, layout->slope, 0, volume->slope);
    put_real(header, layout, layout->slope, 1, volume->offset);
    header[layout->units] = UNITS_MM;
    if (description)
        memcpy(header + layout->description, description, strnlen(description, 79));
    put_geometry(header, layout, &volume->grid);
    memcpy(header + layout->magic_at, layout->magic, layout->magic_bytes);
}

static double narrowed(double value)
{
    return (double)(float)value;
}

/* True if 32-bit numbers hold the geometry within EXACT_MM, and slope and offset exactly. */
static bool is_narrow_enough(const struct volume *volume)
{
    const struct affine *map = &volume->grid.lps_mm_from_ijk;
    struct affine narrow = { .origin =
                                 vec3(narrowed(map->origin.x), narrowed(map->origin.y), narrowed(map->origin.z)) };
    for (int i = 0; i < 3; i++)
        narrow.columns[i] = vec3(narrowed(map->columns[i].x), narrowed(map->columns[i].y), narrowed(map->columns[i].z));
    double furthest = 0;
    for (int corner = 0; corner < 8; corner++) {
        const uint32_t *size = volume->grid.size;
        struct vec3 at = vec3(corner & 1 ? size[0] - 1 : 0, corner & 2 ? size[1] - 1 : 0, corner & 4 ? size[2] - 1 : 0);
        furthest = fmax(furthest, vec3_length(vec3_sub(affine_point(map, at), affine_point(&narrow, at))));
    }
    return furthest <= EXACT_MM && volume->slope == narrowed(volume->slope) &&
           volume->offset == narrowed(volume->offset);
}

static bool ends_with_gz(const char *path)
{
    size_t n = strlen(path);
    return n >= 3 && strcmp(path + n - 3, ".gz") == 0;
}

static bool write_gzip(const char *path, const void *bytes, size_t n_bytes, struct error *err)
{
    bool is_written = false;
    void *packed = NULL;
    struct libdeflate_compressor *compressor = libdeflate_alloc_compressor(GZIP_LEVEL);
    if (!compressor) {
        error_set(err, ERROR_MEMORY, "no memory to compress");
        goto done;
    }
    size_t n_bound = libdeflate_gzip_compress_bound(compressor, n_bytes);
    packed = malloc(n_bound);
    if (!packed) {
        error_set(err, ERROR_MEMORY, "no memory for %zu bytes", n_bound);
        goto done;
    }
    size_t n_packed = libdeflate_gzip_compress(compressor, bytes, n_bytes, packed, n_bound);
    is_written = file_write(path, packed, n_packed, err);
done:
    free(packed);
    libdeflate_free_compressor(compressor);
    return is_written;
}

static bool write_as(const struct layout *layout, const char *path, const struct volume *volume,
                     const char *description, struct error *err)
{
    for (int i = 0; i < 3; i++)
        if (layout == &nifti1 && volume->grid.size[i] > INT16_MAX)
            return error_set(err, ERROR_LIMIT, "%s: %u voxels along axis %d are more than NIfTI-1 holds (%d)", path,
                             volume->grid.size[i], i, INT16_MAX);
    size_t n_voxel_bytes = grid_n_voxels(&volume->grid) * voxel_size(volume->type);
    size_t n_bytes = layout->voxels_at + n_voxel_bytes;
    uint8_t *bytes = mem_array(n_bytes, 1, VOLUME_MAX_BYTES + HEADER_MOST, err);
    if (!bytes) {
        error_prefix(err, "%s", path);
        return false;
    }
    put_header(bytes, layout, volume, description);
    memcpy(bytes + layout->voxels_at, volume->voxels, n_voxel_bytes);
    bool is_written =
        ends_with_gz(path) ? write_gzip(path, bytes, n_bytes, err) : file_write(path, bytes, n_bytes, err);
    free(bytes);
    return is_written;
}

bool nifti_write(const char *path, const struct volume *volume, const char *description, struct error *err)
{
    return write_as(&nifti1, path, volume, description, err);
}

bool nifti_write_exact(const char *path, const struct volume *volume, const char *description, struct error *err)
{
    return write_as(is_narrow_enough(volume) ? &nifti1 : &nifti2, path, volume, description, err);
}
