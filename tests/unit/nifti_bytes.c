/* Writes NIfTI files for tests, field by field. */
#include "tests/unit/nifti_bytes.h"

#include <libdeflate.h>
#include <stdlib.h>
#include <string.h>

static void put(struct nifti_bytes *file, size_t at, uint64_t value, size_t n)
{
    for (size_t i = 0; i < n; i++)
        file->data[at + (file->is_big ? n - 1 - i : i)] = (uint8_t)(value >> (8 * i));
}

void nifti_put_i16(struct nifti_bytes *file, size_t at, int value)
{
    put(file, at, (uint64_t)(int64_t)value, 2);
}
void nifti_put_i32(struct nifti_bytes *file, size_t at, int64_t value)
{
    put(file, at, (uint64_t)value, 4);
}
void nifti_put_i64(struct nifti_bytes *file, size_t at, int64_t value)
{
    put(file, at, (uint64_t)value, 8);
}
void nifti_put_f32(struct nifti_bytes *file, size_t at, double value)
{
    float narrow = (float)value;
    uint32_t raw;
    memcpy(&raw, &narrow, sizeof raw);
    put(file, at, raw, 4);
}
void nifti_put_f64(struct nifti_bytes *file, size_t at, double value)
{
    uint64_t raw;
    memcpy(&raw, &value, sizeof raw);
    put(file, at, raw, 8);
}

struct nifti_bytes nifti_bytes_make(int nx, int ny, int nz, int datatype, int bitpix, size_t n_data, bool is_big)
{
    struct nifti_bytes file = { .size = 352 + n_data, .is_big = is_big };
    file.data = calloc(file.size, 1);
    nifti_put_i32(&file, 0, 348);
    nifti_put_i16(&file, 40, 3);
    nifti_put_i16(&file, 42, nx);
    nifti_put_i16(&file, 44, ny);
    nifti_put_i16(&file, 46, nz);
    nifti_put_i16(&file, 70, datatype);
    nifti_put_i16(&file, 72, bitpix);
    for (size_t i = 0; i < 4; i++)
        nifti_put_f32(&file, 76 + 4 * i, 1);
    nifti_put_f32(&file, 108, 352);
    file.data[123] = 2; /* millimetres */
    memcpy(file.data + 344, "n+1", 4);
    return file;
}

void nifti_bytes_free(struct nifti_bytes *file)
{
    free(file->data);
    file->data = NULL;
}

void nifti_put_sform(struct nifti_bytes *file, const double rows[3][4])
{
    nifti_put_i16(file, 254, 1);
    for (size_t i = 0; i < 3; i++)
        for (size_t j = 0; j < 4; j++)
            nifti_put_f32(file, 280 + 16 * i + 4 * j, rows[i][j]);
}

struct bytes nifti_bytes_pack(const uint8_t *data, size_t size)
{
    struct libdeflate_compressor *compressor = libdeflate_alloc_compressor(6);
    size_t bound = libdeflate_gzip_compress_bound(compressor, size);
    struct bytes packed = { malloc(bound), 0 };
    packed.size = libdeflate_gzip_compress(compressor, data, size, packed.data, bound);
    libdeflate_free_compressor(compressor);
    return packed;
}
