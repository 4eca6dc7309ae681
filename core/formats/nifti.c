#include "core/formats/nifti.h"

#include <float.h>
#include <math.h>
#include <nifti/nifti1.h>
#include <stdlib.h>
#include <string.h>

#include "core/formats/gzip.h"

/* The unpacked voxels of a file, aligned, in this machine's byte order. owned is what must be freed. */
struct voxels {
    void *data;
    void *owned;
    size_t n;
    const struct nifti_header *header;
    const char *name;
};

static void swap_bytes(uint8_t *data, size_t n, uint32_t width)
{
    uint16_t *v16 = (void *)data;
    uint32_t *v32 = (void *)data;
    uint64_t *v64 = (void *)data;
    switch (width) {
    case 2:
        for (size_t i = 0; i < n; i++)
            v16[i] = __builtin_bswap16(v16[i]);
        break;
    case 4:
        for (size_t i = 0; i < n; i++)
            v32[i] = __builtin_bswap32(v32[i]);
        break;
    case 8:
        for (size_t i = 0; i < n; i++)
            v64[i] = __builtin_bswap64(v64[i]);
        break;
    default: break;
    }
}

static bool unpack(const struct bytes *file, const char *name, const struct nifti_header *header, struct voxels *voxels,
                   struct error *err)
{
    size_t end = (size_t)(header->data_at + header->data_bytes);
    *voxels = (struct voxels){ .n = grid_n_voxels(&header->grid), .header = header, .name = name };
    bool is_packed = gzip_is(file->data, file->size);
    if (is_packed ? gzip_most(file->size) < end : file->size < end)
        return error_set(err, ERROR_FORMAT, "%s: cut short: %zu bytes%s, but %u x %u x %u voxels of %u bytes need %zu", name, file->size,
                         is_packed ? " of gzip" : "", header->grid.size[0], header->grid.size[1], header->grid.size[2],
                         header->voxel_bytes, end);
    if (!is_packed && !header->is_swapped && (uintptr_t)(file->data + header->data_at) % 8 == 0) {
        voxels->data = file->data + header->data_at; /* borrowed: only read from here on */
        return true;
    }
    size_t from = is_packed ? 0 : (size_t)header->data_at;
    uint8_t *buffer = malloc(end - from);
    if (!buffer)
        return error_set(err, ERROR_MEMORY, "%s: no memory for %zu bytes", name, end - from);
    if (is_packed) {
        if (!gzip_exact(file->data, file->size, name, buffer, end, err)) {
            free(buffer);
            return false;
        }
        if (header->data_at % 8 != 0)
            memmove(buffer, buffer + header->data_at, (size_t)header->data_bytes);
        voxels->data = buffer + (header->data_at % 8 != 0 ? 0 : header->data_at);
    } else {
        memcpy(buffer, file->data + from, (size_t)header->data_bytes);
        voxels->data = buffer;
    }
    voxels->owned = buffer;
    if (header->is_swapped)
        swap_bytes(voxels->data, voxels->n, header->voxel_bytes);
    return true;
}

/* RUN(type) for the C type of a NIfTI code. */
#define WITH_TYPE(code, RUN)                   \
    switch (code) {                            \
    case DT_UINT8: RUN(uint8_t); break;        \
    case DT_INT8: RUN(int8_t); break;          \
    case DT_INT16: RUN(int16_t); break;        \
    case DT_UINT16: RUN(uint16_t); break;      \
    case DT_INT32: RUN(int32_t); break;        \
    case DT_UINT32: RUN(uint32_t); break;      \
    case DT_INT64: RUN(int64_t); break;        \
    case DT_UINT64: RUN(uint64_t); break;      \
    case DT_FLOAT32: RUN(float); break;        \
    case DT_FLOAT64: RUN(double); break;       \
    default: break;                            \
    }

/* Smallest and largest stored value, and how many are not finite. */
struct span {
    double low, high;
    size_t n_not_finite;
};

static struct span measure(const struct voxels *voxels)
{
    struct span span = { 0 };
    size_t n = voxels->n;
#define MEASURE(type)                              \
    do {                                           \
        const type *in = voxels->data;             \
        type low = in[0], high = in[0];            \
        for (size_t i = 1; i < n; i++) {           \
            low = in[i] < low ? in[i] : low;       \
            high = in[i] > high ? in[i] : high;    \
        }                                          \
        span.low = (double)low;                    \
        span.high = (double)high;                  \
    } while (0)
#define MEASURE_FLOAT(type)                                                   \
    do {                                                                      \
        const type *in = voxels->data;                                        \
        type low = (type)INFINITY, high = -(type)INFINITY;                    \
        size_t bad = 0;                                                       \
        for (size_t i = 0; i < n; i++) {                                      \
            type v = in[i];                                                   \
            bad += !(v - v == 0);                                             \
            low = v < low && v >= -(type)FLT_MAX ? v : low;                \
            high = v > high && v <= (type)FLT_MAX ? v : high;              \
        }                                                                     \
        span.low = (double)low;                                               \
        span.high = (double)high;                                             \
        span.n_not_finite = bad;                                              \
    } while (0)
    switch (voxels->header->datatype) {
    case DT_FLOAT32: MEASURE_FLOAT(float); break;
    case DT_FLOAT64: MEASURE_FLOAT(double); break;
    default: WITH_TYPE(voxels->header->datatype, MEASURE)
    }
    if (span.low > span.high)
        span.low = span.high = 0;
    return span;
}

static bool is_float(int datatype)
{
    return datatype == DT_FLOAT32 || datatype == DT_FLOAT64;
}

static enum voxel_type image_type(int datatype, const struct span *span)
{
    if (is_float(datatype))
        return VOXEL_F32;
    if (span->low >= 0 && span->high <= UINT8_MAX)
        return VOXEL_U8;
    if (span->low >= INT16_MIN && span->high <= INT16_MAX)
        return VOXEL_I16;
    return span->low >= 0 && span->high <= UINT16_MAX ? VOXEL_U16 : VOXEL_F32;
}

static void convert(const struct voxels *voxels, struct volume *volume)
{
    size_t n = voxels->n;
#define CONVERT_TO(in_type, out_type)              \
    do {                                           \
        const in_type *in = voxels->data;          \
        out_type *out = volume->voxels;            \
        for (size_t i = 0; i < n; i++)             \
            out[i] = (out_type)in[i];              \
    } while (0)
#define CONVERT(in_type)                                               \
    switch (volume->type) {                                            \
    case VOXEL_U8: CONVERT_TO(in_type, uint8_t); break;                \
    case VOXEL_I16: CONVERT_TO(in_type, int16_t); break;               \
    case VOXEL_U16: CONVERT_TO(in_type, uint16_t); break;              \
    case VOXEL_F32: CONVERT_TO(in_type, float); break;                 \
    }
    if (is_float(voxels->header->datatype)) { /* never to whole numbers */
        if (voxels->header->datatype == DT_FLOAT32)
            CONVERT_TO(float, float);
        else {
            const double *in = voxels->data;
            float *out = volume->voxels;
            for (size_t i = 0; i < n; i++) /* what a float cannot hold is not a number to us */
                out[i] = in[i] >= -(double)FLT_MAX && in[i] <= (double)FLT_MAX ? (float)in[i] : NAN;
        }
        return;
    }
    WITH_TYPE(voxels->header->datatype, CONVERT)
}

static struct volume *make_image(const struct voxels *voxels, struct report *report, struct error *err)
{
    const struct nifti_header *header = voxels->header;
    struct span span = measure(voxels);
    struct volume *volume = volume_create(&header->grid, image_type(header->datatype, &span), err);
    if (!volume)
        return NULL;
    convert(voxels, volume);
    volume->slope = header->slope;
    volume->offset = header->offset;
    double a = span.low * header->slope + header->offset, b = span.high * header->slope + header->offset;
    volume->low = fmin(a, b);
    volume->high = fmax(a, b);
    if (span.n_not_finite > 0)
        report_add(report, REPORT_NOTE, "image.not-finite", voxels->name, "%zu of %zu values are not numbers.", span.n_not_finite,
                   voxels->n);
    if (volume->type == VOXEL_F32 && !is_float(header->datatype) && fmax(fabs(span.low), fabs(span.high)) > 16777216)
        report_add(report, REPORT_NOTE, "image.precision", voxels->name,
                   "Whole numbers up to %.0f were rounded to 24 bits of precision.", fmax(fabs(span.low), fabs(span.high)));
    return volume;
}

static bool refuse_label(const struct voxels *voxels, size_t at, double value, struct error *err)
{
    const uint32_t *size = voxels->header->grid.size;
    return error_set(err, ERROR_RANGE, "%s: voxel (%zu, %zu, %zu) is %g; a label must be a whole number from 0 to 65535", voxels->name,
                     at % size[0], at / size[0] % size[1], at / size[0] / size[1], value);
}

/* Labels of any type into 16 bits. Scaled labels may miss the whole number by the rounding of the scale. */
static bool labels_to_u16(const struct voxels *voxels, uint16_t *out, uint16_t *highest, struct error *err)
{
    size_t n = voxels->n;
    double slope = voxels->header->slope, offset = voxels->header->offset;
    uint16_t most = 0;
#define TO_U16(type)                                                         \
    do {                                                                     \
        const type *in = voxels->data;                                       \
        for (size_t i = 0; i < n; i++) {                                     \
            double value = (double)in[i] * slope + offset;                   \
            double label = floor(value + 0.5);                               \
            if (!(fabs(value - label) <= 1e-3 && label >= 0 && label <= UINT16_MAX)) \
                return refuse_label(voxels, i, value, err);                  \
            out[i] = (uint16_t)label;                                        \
            most = out[i] > most ? out[i] : most;                            \
        }                                                                    \
    } while (0)
    WITH_TYPE(voxels->header->datatype, TO_U16)
    *highest = most;
    return true;
}

static struct volume *make_labels(const struct voxels *voxels, struct error *err)
{
    const struct nifti_header *header = voxels->header;
    bool is_bytes = header->datatype == DT_UINT8 && header->slope == 1 && header->offset == 0;
    struct volume *wide = volume_create(&header->grid, is_bytes ? VOXEL_U8 : VOXEL_U16, err);
    uint16_t highest = 0;
    if (!wide)
        return NULL;
    if (is_bytes) {
        memcpy(wide->voxels, voxels->data, voxels->n);
        volume_measure(wide);
        return wide;
    }
    if (!labels_to_u16(voxels, wide->voxels, &highest, err)) {
        volume_unref(wide);
        return NULL;
    }
    if (highest > UINT8_MAX) {
        volume_measure(wide);
        return wide;
    }
    struct volume *narrow = volume_create(&header->grid, VOXEL_U8, err);
    if (narrow) {
        const uint16_t *in = wide->voxels;
        uint8_t *out = narrow->voxels;
        for (size_t i = 0; i < voxels->n; i++)
            out[i] = (uint8_t)in[i];
        volume_measure(narrow);
    }
    volume_unref(wide);
    return narrow;
}

static struct volume *make_mask(const struct voxels *voxels, struct report *report, struct error *err)
{
    struct volume *mask = volume_create(&voxels->header->grid, VOXEL_U8, err);
    if (!mask)
        return NULL;
    uint8_t *out = mask->voxels;
    size_t n = voxels->n, n_between = 0;
    double slope = voxels->header->slope, offset = voxels->header->offset;
#define TO_MASK(type)                                                \
    do {                                                             \
        const type *in = voxels->data;                               \
        for (size_t i = 0; i < n; i++) {                             \
            double value = (double)in[i] * slope + offset;           \
            out[i] = value >= 0.5;                                   \
            n_between += value > 0.001 && value < 0.999;             \
        }                                                            \
    } while (0)
    WITH_TYPE(voxels->header->datatype, TO_MASK)
    if (n_between > 0)
        report_add(report, REPORT_NOTE, "mask.fractional", voxels->name,
                   "%zu voxels hold values between 0 and 1; those of a half and more count as inside.", n_between);
    volume_measure(mask);
    return mask;
}

struct volume *nifti_read(const struct bytes *file, const char *name, enum nifti_use use, struct report *report, struct error *err)
{
    struct nifti_header header;
    struct voxels voxels;
    if (!nifti_peek(file, name, &header, report, err) || !unpack(file, name, &header, &voxels, err))
        return NULL;
    struct volume *volume = NULL;
    switch (use) {
    case NIFTI_IMAGE: volume = make_image(&voxels, report, err); break;
    case NIFTI_LABELS: volume = make_labels(&voxels, err); break;
    case NIFTI_MASK: volume = make_mask(&voxels, report, err); break;
    }
    free(voxels.owned);
    if (!volume && err && !strstr(err->text, name))
        error_prefix(err, "%s", name);
    return volume;
}
