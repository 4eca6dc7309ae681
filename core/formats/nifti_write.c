#include "core/formats/nifti_write.h"

#include <libdeflate.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/file_write.h"
#include "core/base/mem.h"

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "voxels are written as they lie in memory, as little-endian");

enum { HEADER_BYTES = 348, VOXELS_AT = 352, GZIP_LEVEL = 1 };

/* Where the header's fields stand, in bytes. */
enum {
    AT_SIZE = 0, AT_DIM = 40, AT_DATATYPE = 70, AT_BITPIX = 72, AT_PIXDIM = 76, AT_VOX_OFFSET = 108, AT_SLOPE = 112, AT_INTER = 116,
    AT_UNITS = 123, AT_DESCRIPTION = 148, AT_QFORM_CODE = 252, AT_SFORM_CODE = 254, AT_QUATERNION = 256, AT_QOFFSET = 268,
    AT_SROW = 280, AT_MAGIC = 344
};
enum { CODE_SCANNER = 1, UNITS_MM = 2 };

static void put_i16(uint8_t *header, int at, int value)
{
    int16_t v = (int16_t)value;
    memcpy(header + at, &v, sizeof v);
}

static void put_i32(uint8_t *header, int at, int32_t value)
{
    memcpy(header + at, &value, sizeof value);
}

static void put_f32(uint8_t *header, int at, double value)
{
    float v = (float)value;
    memcpy(header + at, &v, sizeof v);
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

/* Rotation with columns x, y, z as a unit quaternion (a, b, c, d) with a >= 0. Each component is taken from the largest
 * of the four squares, so no division is by a small number. */
static void quaternion_from_axes(struct vec3 x, struct vec3 y, struct vec3 z, double q[4])
{
    double squares[4] = { 1 + x.x + y.y + z.z, 1 + x.x - y.y - z.z, 1 - x.x + y.y - z.z, 1 - x.x - y.y + z.z }; /* four times */
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

static void put_geometry(uint8_t *header, const struct grid *grid)
{
    struct vec3 columns[3], axes[3];
    for (int i = 0; i < 3; i++) {
        columns[i] = ras_from_lps(grid->lps_mm_from_ijk.columns[i]);
        axes[i] = vec3_normalize(columns[i]);
        put_f32(header, AT_PIXDIM + 4 * (i + 1), vec3_length(columns[i]));
    }
    struct vec3 origin = ras_from_lps(grid->lps_mm_from_ijk.origin);
    double rows[3][4] = { { columns[0].x, columns[1].x, columns[2].x, origin.x },
                          { columns[0].y, columns[1].y, columns[2].y, origin.y },
                          { columns[0].z, columns[1].z, columns[2].z, origin.z } };
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 4; column++)
            put_f32(header, AT_SROW + 16 * row + 4 * column, rows[row][column]);
    put_i16(header, AT_SFORM_CODE, CODE_SCANNER);

    double handedness = vec3_dot(vec3_cross(axes[0], axes[1]), axes[2]) < 0 ? -1 : 1;
    put_f32(header, AT_PIXDIM, handedness);
    bool is_orthogonal = fabs(vec3_dot(axes[0], axes[1])) < 1e-5 && fabs(vec3_dot(axes[1], axes[2])) < 1e-5 &&
                         fabs(vec3_dot(axes[2], axes[0])) < 1e-5;
    if (!is_orthogonal)
        return; /* a sheared grid has no qform; readers fall back on the sform */
    double q[4];
    quaternion_from_axes(axes[0], axes[1], vec3_scale(axes[2], handedness), q);
    double offsets[3] = { origin.x, origin.y, origin.z };
    for (int i = 0; i < 3; i++) {
        put_f32(header, AT_QUATERNION + 4 * i, q[i + 1]);
        put_f32(header, AT_QOFFSET + 4 * i, offsets[i]);
    }
    put_i16(header, AT_QFORM_CODE, CODE_SCANNER);
}

static void put_header(uint8_t *header, const struct volume *volume, const char *description)
{
    put_i32(header, AT_SIZE, HEADER_BYTES);
    put_i16(header, AT_DIM, 3);
    for (int i = 0; i < 7; i++)
        put_i16(header, AT_DIM + 2 * (i + 1), i < 3 ? (int)volume->grid.size[i] : 1);
    put_i16(header, AT_DATATYPE, datatype_code(volume->type));
    put_i16(header, AT_BITPIX, (int)(8 * voxel_size(volume->type)));
    put_f32(header, AT_VOX_OFFSET, VOXELS_AT);
    put_f32(header, AT_SLOPE, volume->slope);
    put_f32(header, AT_INTER, volume->offset);
    header[AT_UNITS] = UNITS_MM;
    if (description)
        memcpy(header + AT_DESCRIPTION, description, strnlen(description, 79));
    put_geometry(header, &volume->grid);
    memcpy(header + AT_MAGIC, "n+1", 4);
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

bool nifti_write(const char *path, const struct volume *volume, const char *description, struct error *err)
{
    for (int i = 0; i < 3; i++)
        if (volume->grid.size[i] > INT16_MAX)
            return error_set(err, ERROR_LIMIT, "%s: %u voxels along axis %d are more than NIfTI-1 holds (%d)", path, volume->grid.size[i],
                             i, INT16_MAX);
    size_t n_voxel_bytes = grid_n_voxels(&volume->grid) * voxel_size(volume->type);
    size_t n_bytes = VOXELS_AT + n_voxel_bytes;
    uint8_t *bytes = mem_array(n_bytes, 1, VOLUME_MAX_BYTES + VOXELS_AT, err);
    if (!bytes) {
        error_prefix(err, "%s", path);
        return false;
    }
    put_header(bytes, volume, description);
    memcpy(bytes + VOXELS_AT, volume->voxels, n_voxel_bytes);
    bool is_written = ends_with_gz(path) ? write_gzip(path, bytes, n_bytes, err) : file_write(path, bytes, n_bytes, err);
    free(bytes);
    return is_written;
}
