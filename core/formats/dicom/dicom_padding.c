/* Padding value of images: read, counted, taken out. */
#include "core/formats/dicom/dicom_padding.h"

#include <math.h>

#define PADDING_VALUE DICOM_TAG(0x0028, 0x0120)
#define PADDING_LIMIT DICOM_TAG(0x0028, 0x0121)

static double with_sign_of_pixels(double value, const struct dicom_pixels *pixels)
{
    double all = ldexp(1, (int)pixels->bits_allocated);
    if (pixels->is_signed && value >= all / 2 && value < all)
        return value - all;
    return !pixels->is_signed && value < 0 && value >= -all / 2 ? value + all : value;
}

struct dicom_padding dicom_padding_read(const struct dicom_item *root, const struct dicom_pixels *pixels)
{
    struct dicom_padding padding = { false, 0, 0 };
    double value, limit;
    if (!dicom_number(root, PADDING_VALUE, &value))
        return padding;
    value = with_sign_of_pixels(value, pixels);
    limit = dicom_number(root, PADDING_LIMIT, &limit) ? with_sign_of_pixels(limit, pixels) : value;
    return (struct dicom_padding){ true, fmin(value, limit), fmax(value, limit) };
}

#define COUNT(type) \
    do { \
        const type *cell = cells; \
        for (size_t i = 0; i < n; i++) \
            found += cell[i] >= low && cell[i] <= high; \
    } while (0)

size_t dicom_padding_count(const struct dicom_padding *padding, enum voxel_type type, const void *cells, size_t n)
{
    size_t found = 0;
    if (!padding->is_given || padding->low > 65535 || padding->high < -32768)
        return 0;
    int32_t low = (int32_t)ceil(fmax(padding->low, -32768)), high = (int32_t)floor(fmin(padding->high, 65535));
    switch (type) {
    case VOXEL_U8: COUNT(uint8_t); break;
    case VOXEL_I16: COUNT(int16_t); break;
    case VOXEL_U16: COUNT(uint16_t); break;
    case VOXEL_F32: break;
    }
    return found;
}

#define CONVERT(type) \
    do { \
        const type *cell = cells; \
        for (size_t i = 0; i < n; i++) \
            out[i] = dicom_is_padding(padding, cell[i]) ? NAN : (float)(cell[i] * slope + offset); \
    } while (0)

void dicom_padding_convert(const struct dicom_padding *padding, enum voxel_type type, const void *cells, size_t n,
                           double slope, double offset, float *out)
{
    switch (type) {
    case VOXEL_U8: CONVERT(uint8_t); break;
    case VOXEL_I16: CONVERT(int16_t); break;
    case VOXEL_U16: CONVERT(uint16_t); break;
    case VOXEL_F32: break;
    }
}

void dicom_padding_report(const struct dicom_padding *padding, size_t n, size_t n_all, bool is_float, const char *where,
                          struct report *report)
{
    if (n == n_all)
        report_add(report, REPORT_WARNING, "image.padding", where, "All pixels hold the padding value (0028,0120)%s.",
                   is_float ? "; the image has no values" : ", so it was not believed");
    else if (padding->low < padding->high)
        report_add(report, REPORT_NOTE, "image.padding", where,
                   "%zu of %zu pixels hold padding (0028,0120), stored values of %.10g to %.10g: nothing was measured "
                   "there, and they have no value.",
                   n, n_all, padding->low, padding->high);
    else
        report_add(report, REPORT_NOTE, "image.padding", where,
                   "%zu of %zu pixels hold the padding value (0028,0120), stored as %.10g: nothing was measured there, "
                   "and they have no value.",
                   n, n_all, padding->low);
}
