#pragma once
/* Hand-made NIfTI files for tests: bytes at the offsets of nifti1.h and nifti2.h, written one by one. */
#include <stddef.h>
#include <stdint.h>

#include "core/formats/folder.h"

struct nifti_bytes {
    uint8_t *data;
    size_t size;
    bool is_big;
};

/* A NIfTI-1 header of nx x ny x nz voxels with no orientation, and n_data bytes of zeros after it. */
struct nifti_bytes nifti_bytes_make(int nx, int ny, int nz, int datatype, int bitpix, size_t n_data, bool is_big);
void nifti_bytes_free(struct nifti_bytes *file);
void nifti_put_i16(struct nifti_bytes *file, size_t at, int value);
void nifti_put_i32(struct nifti_bytes *file, size_t at, int64_t value);
void nifti_put_i64(struct nifti_bytes *file, size_t at, int64_t value);
void nifti_put_f32(struct nifti_bytes *file, size_t at, double value);
void nifti_put_f64(struct nifti_bytes *file, size_t at, double value);
/* sform_code 1 and its rows */
void nifti_put_sform(struct nifti_bytes *file, const double rows[3][4]);
/* Gzip of the file as one member. */
struct bytes nifti_bytes_pack(const uint8_t *data, size_t size);
