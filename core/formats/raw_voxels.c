/* Unpacks and converts the voxels of a file to a volume. */
#include "core/formats/raw_voxels.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/formats/gzip.h"

uint32_t raw_type_bytes(enum raw_type type)
{
    switch (type) {
    case RAW_I8:
    case RAW_U8: return 1;
    case RAW_I16:
    case RAW_U16: return 2;
    case RAW_I32:
    case RAW_U32:
    case RAW_F32: return 4;
    case RAW_I64:
    case RAW_U64:
    case RAW_F64: return 8;
    }
    return 0;
}

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

/* Reports bytes after the voxels: header and file do not belong together, or one was changed. */
static void note_more(uint64_t n_more, const struct raw_place *place, const char *name, struct report *report)
{
    if (n_more > 0)
        report_add(report, REPORT_WARNING, "image.bytes-behind", name,
                   "%llu bytes follow the %llu bytes of voxels that the header speaks of; they "
                   "were left.",
                   (unsigned long long)n_more, (unsigned long long)place->data_bytes);
}

bool raw_unpack(const struct raw_place *place, const char *name, struct raw_unpacked *unpacked, struct report *report,
                struct error *err)
{
    const struct bytes *file = &place->file;
    size_t end = (size_t)(place->data_at + place->data_bytes);
    *unpacked = (struct raw_unpacked){ 0 };
    if (place->is_packed ? gzip_most(file->size) < end : file->size < end)
        return error_set(err, ERROR_FORMAT, "%s: cut short: %zu bytes%s, but %llu voxels of %u bytes need %zu", name,
                         file->size, place->is_packed ? " of gzip" : "",
                         (unsigned long long)(place->data_bytes / place->voxel_bytes), place->voxel_bytes, end);
    if (!place->is_packed)
        note_more(file->size - end, place, name, report);
    if (!place->is_packed && !place->is_swapped && (uintptr_t)(file->data + place->data_at) % 8 == 0) {
        unpacked->data = file->data + place->data_at; /* borrowed, and only read from here on */
        return true;
    }
    size_t from = place->is_packed ? 0 : (size_t)place->data_at;
    uint64_t n_more = 0;
    uint8_t *buffer = mem_large_array(end - from, 1, UINT64_MAX, err);
    if (!buffer) {
        error_prefix(err, "%s", name);
        return false;
    }
    unpacked->data = unpacked->owned = buffer;
    if (!place->is_packed) {
        memcpy(buffer, file->data + from, (size_t)place->data_bytes);
    } else if (!gzip_exact(file->data, file->size, name, buffer, end, &n_more, err)) {
        free(buffer);
        *unpacked = (struct raw_unpacked){ 0 };
        return false;
    } else if (place->data_at % 8 != 0) {
        memmove(buffer, buffer + place->data_at, (size_t)place->data_bytes);
    } else {
        unpacked->data = buffer + place->data_at;
    }
    note_more(n_more, place, name, report);
    if (place->is_swapped)
        swap_bytes(unpacked->data, (size_t)(place->data_bytes / place->voxel_bytes), place->voxel_bytes);
    return true;
}

/* Calls RUN(type) with the C type of a raw type. */
#define WITH_TYPE(code, RUN) \
    switch (code) { \
    case RAW_U8: RUN(uint8_t); break; \
    case RAW_I8: RUN(int8_t); break; \
    case RAW_I16: RUN(int16_t); break; \
    case RAW_U16: RUN(uint16_t); break; \
    case RAW_I32: RUN(int32_t); break; \
    case RAW_U32: RUN(uint32_t); break; \
    case RAW_I64: RUN(int64_t); break; \
    case RAW_U64: RUN(uint64_t); break; \
    case RAW_F32: RUN(float); break; \
    case RAW_F64: RUN(double); break; \
    }

/* Smallest and largest stored value, and the number of values that are not finite. */
struct span {
    double low, high;
    size_t n_not_finite;
};

static struct span measure(const struct raw_voxels *voxels)
{
    struct span span = { 0 };
    size_t n = voxels->n;
#define MEASURE(type) \
    do { \
        const type *in = voxels->data; \
        type low = in[0], high = in[0]; \
        for (size_t i = 1; i < n; i++) { \
            low = in[i] < low ? in[i] : low; \
            high = in[i] > high ? in[i] : high; \
        } \
        span.low = (double)low; \
        span.high = (double)high; \
    } while (0)
#define MEASURE_FLOAT(type) \
    do { \
        const type *in = voxels->data; \
        type low = (type)INFINITY, high = -(type)INFINITY; \
        size_t bad = 0; \
        for (size_t i = 0; i < n; i++) { \
            type v = in[i]; \
            bad += !(v - v == 0); \
            low = v < low && v >= -(type)FLT_MAX ? v : low; \
            high = v > high && v <= (type)FLT_MAX ? v : high; \
        } \
        span.low = (double)low; \
        span.high = (double)high; \
        span.n_not_finite = bad; \
    } while (0)
    switch (voxels->type) {
    case RAW_F32: MEASURE_FLOAT(float); break;
    case RAW_F64: MEASURE_FLOAT(double); break;
    default: WITH_TYPE(voxels->type, MEASURE)
    }
    if (span.low > span.high)
        span.low = span.high = 0;
    return span;
}

static bool is_float(enum raw_type type)
{
    return type == RAW_F32 || type == RAW_F64;
}

static enum voxel_type image_type(enum raw_type type, const struct span *span)
{
    if (is_float(type))
        return VOXEL_F32;
    if (span->low >= 0 && span->high <= UINT8_MAX)
        return VOXEL_U8;
    if (span->low >= INT16_MIN && span->high <= INT16_MAX)
        return VOXEL_I16;
    return span->low >= 0 && span->high <= UINT16_MAX ? VOXEL_U16 : VOXEL_F32;
}

static void convert(const struct raw_voxels *voxels, struct volume *volume)
{
    size_t n = voxels->n;
#define CONVERT_TO(in_type, out_type) \
    do { \
        const in_type *in = voxels->data; \
        out_type *out = volume->voxels; \
        for (size_t i = 0; i < n; i++) \
            out[i] = (out_type)in[i]; \
    } while (0)
#define CONVERT(in_type) \
    switch (volume->type) { \
    case VOXEL_U8: CONVERT_TO(in_type, uint8_t); break; \
    case VOXEL_I16: CONVERT_TO(in_type, int16_t); break; \
    case VOXEL_U16: CONVERT_TO(in_type, uint16_t); break; \
    case VOXEL_F32: CONVERT_TO(in_type, float); break; \
    }
    if (is_float(voxels->type)) { /* floats are never converted to whole numbers */
        if (voxels->type == RAW_F32)
            CONVERT_TO(float, float);
        else {
            const double *in = voxels->data;
            float *out = volume->voxels;
            for (size_t i = 0; i < n; i++) /* a value beyond the range of a float becomes not-a-number */
                out[i] = in[i] >= -(double)FLT_MAX && in[i] <= (double)FLT_MAX ? (float)in[i] : NAN;
        }
        return;
    }
    WITH_TYPE(voxels->type, CONVERT)
}

/* True if the volume can own the voxels as they are, without a copy. */
static bool can_take(const struct raw_voxels *voxels, enum voxel_type type)
{
    static const enum raw_type same[] = {
        [VOXEL_U8] = RAW_U8, [VOXEL_I16] = RAW_I16, [VOXEL_U16] = RAW_U16, [VOXEL_F32] = RAW_F32
    };
    return voxels->owned && *voxels->owned && voxels->type == same[type];
}

static struct volume *take_voxels(const struct raw_voxels *voxels, enum voxel_type type)
{
    uint8_t *owned = *voxels->owned;
    if (owned != voxels->data)
        memmove(owned, voxels->data, voxels->n * voxel_size(type));
    *voxels->owned = NULL;
    return volume_take(voxels->grid, type, owned);
}

static struct volume *make_image(const struct raw_voxels *voxels, struct report *report, struct error *err)
{
    struct span span = measure(voxels);
    enum voxel_type type = image_type(voxels->type, &span);
    bool is_taken = can_take(voxels, type);
    struct volume *volume = is_taken ? take_voxels(voxels, type) : volume_create(voxels->grid, type, err);
    if (!volume)
        return NULL;
    if (!is_taken)
        convert(voxels, volume);
    volume->slope = voxels->slope;
    volume->offset = voxels->offset;
    double a = span.low * voxels->slope + voxels->offset, b = span.high * voxels->slope + voxels->offset;
    volume->low = fmin(a, b);
    volume->high = fmax(a, b);
    if (span.n_not_finite > 0)
        report_add(report, REPORT_NOTE, "image.not-finite", voxels->name, "%zu of %zu values are not numbers.",
                   span.n_not_finite, voxels->n);
    if (volume->type == VOXEL_F32 && !is_float(voxels->type) && fmax(fabs(span.low), fabs(span.high)) > 16777216)
        report_add(report, REPORT_NOTE, "image.precision", voxels->name,
                   "Whole numbers up to %.0f were rounded to 24 bits of precision.",
                   fmax(fabs(span.low), fabs(span.high)));
    return volume;
}

static bool refuse_label(const struct raw_voxels *voxels, size_t at, double value, struct error *err)
{
    const uint32_t *size = voxels->grid->size;
    return error_set(err, ERROR_RANGE,
                     "%s: voxel (%zu, %zu, %zu) is %g; a label must be a whole number from 0 to 65535", voxels->name,
                     at % size[0], at / size[0] % size[1], at / size[0] / size[1], value);
}

/* Converts labels of any type to 16 bits. Scaled labels may differ from a whole number by the rounding of the scale. */
static bool labels_to_u16(const struct raw_voxels *voxels, uint16_t *out, uint16_t *highest, struct error *err)
{
    size_t n = voxels->n;
    double slope = voxels->slope, offset = voxels->offset;
    uint16_t most = 0;
#define TO_U16(type) \
    do { \
        const type *in = voxels->data; \
        for (size_t i = 0; i < n; i++) { \
            double value = (double)in[i] * slope + offset; \
            double label = floor(value + 0.5); \
            if (!(fabs(value - label) <= 1e-3 && label >= 0 && label <= UINT16_MAX)) \
                return refuse_label(voxels, i, value, err); \
            out[i] = (uint16_t)label; \
            most = out[i] > most ? out[i] : most; \
        } \
    } while (0)
    WITH_TYPE(voxels->type, TO_U16)
    *highest = most;
    return true;
}

static struct volume *make_labels(const struct raw_voxels *voxels, struct error *err)
{
    bool is_bytes = voxels->type == RAW_U8 && voxels->slope == 1 && voxels->offset == 0;
    struct volume *wide = volume_create(voxels->grid, is_bytes ? VOXEL_U8 : VOXEL_U16, err);
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
    struct volume *narrow = volume_create(voxels->grid, VOXEL_U8, err);
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

static struct volume *make_mask(const struct raw_voxels *voxels, struct report *report, struct error *err)
{
    struct volume *mask = volume_create(voxels->grid, VOXEL_U8, err);
    if (!mask)
        return NULL;
    uint8_t *out = mask->voxels;
    size_t n = voxels->n, n_between = 0;
    double slope = voxels->slope, offset = voxels->offset;
#define TO_MASK(type) \
    do { \
        const type *in = voxels->data; \
        for (size_t i = 0; i < n; i++) { \
            double value = (double)in[i] * slope + offset; \
            out[i] = value >= 0.5; \
            n_between += value > 0.001 && value < 0.999; \
        } \
    } while (0)
    WITH_TYPE(voxels->type, TO_MASK)
    if (n_between > 0)
        report_add(report, REPORT_NOTE, "mask.fractional", voxels->name,
                   "%zu voxels hold values between 0 and 1; those of a half and more count as inside.", n_between);
    volume_measure(mask);
    return mask;
}

struct volume *raw_read(const struct raw_voxels *voxels, enum raw_use use, struct report *report, struct error *err)
{
    struct volume *volume = NULL;
    switch (use) {
    case RAW_IMAGE: volume = make_image(voxels, report, err); break;
    case RAW_LABELS: volume = make_labels(voxels, err); break;
    case RAW_MASK: volume = make_mask(voxels, report, err); break;
    }
    if (!volume && err && !strstr(err->text, voxels->name))
        error_prefix(err, "%s", voxels->name);
    return volume;
}
