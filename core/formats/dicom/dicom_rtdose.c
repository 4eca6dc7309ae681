/* Reads one RT Dose object: geometry, values, component, references. */
#include "core/formats/dicom/dicom_rtdose.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/formats/dicom/dicom_coded.h"
#include "core/formats/dicom/dicom_numbers.h"
#include "core/formats/dicom/dicom_rtdose_dvh.h"

#define RTDOSE_CLASS "1.2.840.10008.5.1.4.1.1.481.2"
#define MOST_GY 1000.0
#define EVEN_SHARE 0.02 /* share of the plane distance by which planes may miss even positions */

enum {
    SOP_CLASS = DICOM_TAG(0x0008, 0x0016),
    SOP_INSTANCE = DICOM_TAG(0x0008, 0x0018),
    MODALITY = DICOM_TAG(0x0008, 0x0060),
    SERIES_DESCRIPTION = DICOM_TAG(0x0008, 0x103e),
    REFERENCED_INSTANCE = DICOM_TAG(0x0008, 0x1155),
    SLICE_THICKNESS = DICOM_TAG(0x0018, 0x0050),
    IMAGE_POSITION = DICOM_TAG(0x0020, 0x0032),
    IMAGE_ORIENTATION = DICOM_TAG(0x0020, 0x0037),
    FRAME_UID = DICOM_TAG(0x0020, 0x0052),
    PIXEL_SPACING = DICOM_TAG(0x0028, 0x0030),
    DOSE_UNITS = DICOM_TAG(0x3004, 0x0002),
    DOSE_TYPE = DICOM_TAG(0x3004, 0x0004),
    DOSE_COMMENT = DICOM_TAG(0x3004, 0x0006),
    SUMMATION_TYPE = DICOM_TAG(0x3004, 0x000a),
    FRAME_OFFSETS = DICOM_TAG(0x3004, 0x000c),
    GRID_SCALING = DICOM_TAG(0x3004, 0x000e),
    REFERENCED_PLAN_SEQUENCE = DICOM_TAG(0x300c, 0x0002),
    REFERENCED_BEAM_SEQUENCE = DICOM_TAG(0x300c, 0x0004),
    REFERENCED_BEAM = DICOM_TAG(0x300c, 0x0006),
    REFERENCED_FRACTION_SEQUENCE = DICOM_TAG(0x300c, 0x0020),
    REFERENCED_STRUCTS_SEQUENCE = DICOM_TAG(0x300c, 0x0060)
};

/* Positions of the frames. */
struct planes {
    struct vec3 row, column; /* unit vectors along a row and down a column */
    struct vec3 first_lps_mm, normal;
    double row_mm, column_mm; /* distances between rows and between columns */
    double *at_mm; /* of each frame along the normal, counted from the first frame; ascending or descending */
    size_t n;
};

struct reading {
    const struct dicom_item *root;
    const char *where;
    struct report *report;
};

/* ---- geometry --------------------------------------------------------------------------------------------------- */

static bool read_three(const struct reading *reading, uint32_t tag, const char *name, double *values, size_t n,
                       struct error *err)
{
    size_t found = dicom_numbers(reading->root, tag, values, n);
    if (found != n)
        return error_set(err, ERROR_FORMAT, "%s: %s (%04x,%04x) has %zu values, expected %zu", reading->where, name,
                         tag >> 16, tag & 0xffff, found, n);
    for (size_t i = 0; i < n; i++)
        if (!isfinite(values[i]) || fabs(values[i]) > 1e6)
            return error_set(err, ERROR_RANGE, "%s: %s (%04x,%04x): value %zu is %g, expected a number of a patient",
                             reading->where, name, tag >> 16, tag & 0xffff, i + 1, values[i]);
    return true;
}

static bool read_frame(const struct reading *reading, struct planes *planes, struct error *err)
{
    double at[3], cosines[6], spacing_mm[2];
    if (!read_three(reading, IMAGE_POSITION, "Image Position (Patient)", at, 3, err) ||
        !read_three(reading, IMAGE_ORIENTATION, "Image Orientation (Patient)", cosines, 6, err) ||
        !read_three(reading, PIXEL_SPACING, "Pixel Spacing", spacing_mm, 2, err))
        return false;
    struct vec3 row = vec3(cosines[0], cosines[1], cosines[2]), column = vec3(cosines[3], cosines[4], cosines[5]);
    if (!(fabs(vec3_length(row) - 1) < 0.01 && fabs(vec3_length(column) - 1) < 0.01 &&
          fabs(vec3_dot(row, column)) < 0.01))
        return error_set(
            err, ERROR_RANGE,
            "%s: Image Orientation (0020,0037) is %g %g %g, %g %g %g, expected two unit vectors at right angles",
            reading->where, row.x, row.y, row.z, column.x, column.y, column.z);
    planes->row = vec3_normalize(row);
    planes->column = vec3_normalize(column);
    planes->normal = vec3_normalize(vec3_cross(row, column));
    planes->first_lps_mm = vec3(at[0], at[1], at[2]);
    planes->row_mm = spacing_mm[0]; /* PixelSpacing gives the row distance first */
    planes->column_mm = spacing_mm[1];
    return true;
}

static bool is_axial(const struct planes *planes)
{
    return fabs(planes->normal.z) > 0.9999;
}

/* Makes the offsets relative to the first frame. The standard (PS3.3 C.8.8.3.2) has two conventions: offsets from the
 * first plane along the normal, or for axial planes the z of each plane. */
static void make_relative(const struct reading *reading, struct planes *planes)
{
    double first_mm = planes->at_mm[0], direction = 1;
    double step_mm = planes->n > 1 ? fabs(planes->at_mm[1] - first_mm) : 1;
    if (first_mm == 0)
        return;
    bool is_absolute = is_axial(planes) && fabs(first_mm - planes->first_lps_mm.z) <= fmax(0.01, 0.1 * step_mm);
    if (is_absolute)
        direction = planes->normal.z < 0 ? -1 : 1;
    else
        report_add(
            reading->report, REPORT_WARNING, "dose.offsets-doubtful", reading->where,
            "The first frame's offset is %g mm, neither 0 nor the z of its position (%g mm); offsets were counted from the first.",
            first_mm, planes->first_lps_mm.z);
    for (size_t i = 0; i < planes->n; i++)
        planes->at_mm[i] = direction * (planes->at_mm[i] - first_mm);
}

static bool check_order(const struct reading *reading, const struct planes *planes, struct error *err)
{
    bool is_up = planes->n < 2 || planes->at_mm[1] > planes->at_mm[0];
    for (size_t i = 1; i < planes->n; i++) {
        double step_mm = planes->at_mm[i] - planes->at_mm[i - 1];
        if (!(is_up ? step_mm > 1e-6 : step_mm < -1e-6))
            return error_set(
                err, ERROR_RANGE,
                "%s: Grid Frame Offset Vector (3004,000c): frame %zu is %g mm from the one before, expected "
                "frames that go one way",
                reading->where, i + 1, step_mm);
    }
    return true;
}

static bool read_offsets(const struct reading *reading, struct planes *planes, uint32_t n_frames, struct error *err)
{
    planes->n = n_frames;
    planes->at_mm = mem_array(n_frames, sizeof *planes->at_mm, UINT64_MAX, err);
    if (!planes->at_mm)
        return false;
    size_t n = dicom_numbers(reading->root, FRAME_OFFSETS, planes->at_mm, n_frames);
    if (n_frames == 1) {
        planes->at_mm[0] = 0;
        return true;
    }
    if (n != n_frames)
        return error_set(err, ERROR_FORMAT,
                         "%s: Grid Frame Offset Vector (3004,000c) has %zu values, expected %u, one a frame",
                         reading->where, n, n_frames);
    for (size_t i = 0; i < n; i++)
        if (!(fabs(planes->at_mm[i]) <= 1e6))
            return error_set(err, ERROR_RANGE,
                             "%s: Grid Frame Offset Vector (3004,000c): value %zu is no number of a patient",
                             reading->where, i + 1);
    make_relative(reading, planes);
    return check_order(reading, planes, err);
}

/* Distance of the planes if they are even, else 0. */
static double even_step_mm(const struct planes *planes)
{
    double step_mm = (planes->at_mm[planes->n - 1] - planes->at_mm[0]) / (double)(planes->n - 1);
    for (size_t i = 0; i < planes->n; i++)
        if (!(fabs(planes->at_mm[i] - planes->at_mm[0] - (double)i * step_mm) <= EVEN_SHARE * fabs(step_mm)))
            return 0;
    return step_mm;
}

static double smallest_step_mm(const struct planes *planes)
{
    double least_mm = INFINITY;
    for (size_t i = 1; i < planes->n; i++)
        least_mm = fmin(least_mm, fabs(planes->at_mm[i] - planes->at_mm[i - 1]));
    return least_mm;
}

static bool make_grid(const struct reading *reading, const struct planes *planes, const struct dicom_pixels *pixels,
                      size_t n_planes, double step_mm, struct grid *grid, struct error *err)
{
    struct affine map = { { vec3_scale(planes->row, planes->column_mm), vec3_scale(planes->column, planes->row_mm),
                            vec3_scale(planes->normal, step_mm) },
                          planes->first_lps_mm };
    uint32_t size[3] = { pixels->columns, pixels->rows, (uint32_t)n_planes };
    if (grid_init(grid, size, &map, err))
        return true;
    error_prefix(err, "%s", reading->where);
    return false;
}

/* Thickness to show a single plane with: its slice thickness, else its column distance. */
static double lone_thickness_mm(const struct reading *reading, const struct planes *planes)
{
    double mm;
    if (!dicom_number(reading->root, SLICE_THICKNESS, &mm) || !(mm > 0 && mm <= 1e4))
        mm = planes->column_mm;
    report_add(reading->report, REPORT_NOTE, "dose.single-plane", reading->where,
               "The dose is a single plane; it is shown %g mm thick.", mm);
    return mm;
}

/* ---- values ----------------------------------------------------------------------------------------------------- */

static enum voxel_type type_for(const struct dicom_pixels *pixels)
{
    return pixels->bits_allocated == 32 ? VOXEL_F32 : pixels->is_signed ? VOXEL_I16 : VOXEL_U16;
}

static void scale_32(float *out, const void *stored, size_t n, bool is_signed, double scaling)
{
    if (is_signed)
        for (size_t i = 0; i < n; i++)
            out[i] = (float)(((const int32_t *)stored)[i] * scaling);
    else
        for (size_t i = 0; i < n; i++)
            out[i] = (float)(((const uint32_t *)stored)[i] * scaling);
}

static struct volume *read_even(const struct dicom_file *file, const struct dicom_pixels *pixels,
                                const struct grid *grid, double scaling, struct dicom_coded *coded, struct error *err)
{
    enum voxel_type type = type_for(pixels);
    struct volume *volume = volume_create(grid, type, err);
    size_t n = (size_t)pixels->rows * pixels->columns;
    void *frame = volume && type == VOXEL_F32 ? mem_array(n, sizeof(uint32_t), VOLUME_MAX_BYTES, err) : NULL;
    bool is_read = volume && (type != VOXEL_F32 || frame);
    for (uint32_t k = 0; is_read && k < pixels->n_frames; k++) {
        uint8_t *out = (uint8_t *)volume->voxels + k * n * voxel_size(type);
        is_read = dicom_pixels_read(file, k, type == VOXEL_F32 ? frame : out, err);
        dicom_coded_count(coded, file, pixels);
        if (is_read && type == VOXEL_F32)
            scale_32((float *)(void *)out, frame, n, pixels->is_signed, scaling);
    }
    free(frame);
    if (!is_read) {
        volume_unref(volume);
        return NULL;
    }
    volume->slope = type == VOXEL_F32 ? 1 : scaling;
    return volume;
}

static bool read_scaled_frame(const struct dicom_file *file, const struct dicom_pixels *pixels, uint32_t k,
                              double scaling, void *stored, float *out, struct dicom_coded *coded, struct error *err)
{
    if (!dicom_pixels_read(file, k, stored, err))
        return false;
    dicom_coded_count(coded, file, pixels);
    size_t n = (size_t)pixels->rows * pixels->columns;
    if (pixels->bits_allocated == 32) {
        scale_32(out, stored, n, pixels->is_signed, scaling);
        return true;
    }
    for (size_t i = 0; i < n; i++)
        out[i] = (float)((pixels->is_signed ? ((const int16_t *)stored)[i] : ((const uint16_t *)stored)[i]) * scaling);
    return true;
}

/* Interpolates linearly between the two planes around each even plane. */
static struct volume *read_uneven(const struct dicom_file *file, const struct dicom_pixels *pixels,
                                  const struct planes *planes, const struct grid *grid, double step_mm, double scaling,
                                  struct dicom_coded *coded, struct error *err)
{
    size_t n = (size_t)pixels->rows * pixels->columns;
    struct volume *volume = volume_create(grid, VOXEL_F32, err);
    void *stored = mem_array(n, sizeof(uint32_t), VOLUME_MAX_BYTES, err);
    float *low = mem_array(n, sizeof *low, VOLUME_MAX_BYTES, err),
          *high = mem_array(n, sizeof *high, VOLUME_MAX_BYTES, err);
    bool is_read = volume && stored && low && high &&
                   read_scaled_frame(file, pixels, 0, scaling, stored, low, coded, err) &&
                   read_scaled_frame(file, pixels, 1, scaling, stored, high, coded, err);
    uint32_t frame = 0; /* buffers: low is plane `frame`, high the next */
    for (uint32_t k = 0; is_read && k < grid->size[2]; k++) {
        double along_mm = fabs(k * step_mm);
        while (is_read && frame + 2 < planes->n && fabs(planes->at_mm[frame + 1]) < along_mm) {
            float *next = low;
            low = high;
            high = next;
            frame++;
            is_read = read_scaled_frame(file, pixels, frame + 1, scaling, stored, high, coded, err);
        }
        double from_mm = fabs(planes->at_mm[frame]), to_mm = fabs(planes->at_mm[frame + 1]);
        float share = (float)fmin(fmax((along_mm - from_mm) / (to_mm - from_mm), 0), 1);
        float *out = (float *)volume->voxels + k * n;
        for (size_t i = 0; is_read && i < n; i++)
            out[i] = low[i] + share * (high[i] - low[i]);
    }
    free(stored);
    free(low);
    free(high);
    if (is_read)
        return volume;
    volume_unref(volume);
    return NULL;
}

static struct volume *read_values(const struct reading *reading, const struct dicom_file *file,
                                  const struct dicom_pixels *pixels, const struct planes *planes, double scaling,
                                  struct dicom_coded *coded, struct error *err)
{
    struct grid grid;
    double step_mm = planes->n == 1 ? lone_thickness_mm(reading, planes) : even_step_mm(planes);
    if (step_mm != 0)
        return make_grid(reading, planes, pixels, planes->n, step_mm, &grid, err)
                   ? read_even(file, pixels, &grid, scaling, coded, err)
                   : NULL;
    double least_mm = smallest_step_mm(planes), length_mm = planes->at_mm[planes->n - 1];
    double n = round(fabs(length_mm) / least_mm) + 1;
    if (n > VOLUME_MAX_SIDE) {
        error_set(err, ERROR_LIMIT, "%s: frames from %g mm apart over %g mm would need %g even planes; the limit is %d",
                  reading->where, least_mm, fabs(length_mm), n, VOLUME_MAX_SIDE);
        return NULL;
    }
    step_mm = length_mm / (n - 1);
    if (!make_grid(reading, planes, pixels, (size_t)n, step_mm, &grid, err))
        return NULL;
    report_add(
        reading->report, REPORT_WARNING, "dose.offsets-uneven", reading->where,
        "The %zu frames are not evenly spaced (from %g mm on); the dose was interpolated linearly onto %g planes %.4g mm apart.",
        planes->n, least_mm, n, fabs(step_mm));
    return read_uneven(file, pixels, planes, &grid, step_mm, scaling, coded, err);
}

static void report_surplus(const struct reading *reading, const struct dicom_pixels *pixels)
{
    double frame = (double)pixels->rows * pixels->columns * (pixels->bits_allocated / 8);
    if (pixels->surplus_bytes > 0)
        report_add(
            reading->report, REPORT_WARNING, "dicom.surplus-pixels", reading->where,
            "The pixel data hold %llu bytes more than the %u frames that the file declares (%.4g frames more); they "
            "are not shown.",
            (unsigned long long)pixels->surplus_bytes, pixels->n_frames, (double)pixels->surplus_bytes / frame);
}

/* ---- one object ------------------------------------------------------------------------------------------------- */

static void add_beams(struct rtdose *dose, const struct dicom_item *item)
{
    size_t n = dicom_n_items(item, REFERENCED_BEAM_SEQUENCE);
    for (size_t i = 0; i < n && dose->n_beams < RTDOSE_MAX_BEAMS; i++)
        dose->n_beams += dicom_integer(dicom_item_at(item, REFERENCED_BEAM_SEQUENCE, i), REFERENCED_BEAM,
                                       &dose->beams[dose->n_beams]);
}

static void read_references(struct rtdose *dose, const struct dicom_item *root)
{
    const struct dicom_item *plan = dicom_item_at(root, REFERENCED_PLAN_SEQUENCE, 0),
                            *structs = dicom_item_at(root, REFERENCED_STRUCTS_SEQUENCE, 0);
    if (structs)
        dicom_text(structs, REFERENCED_INSTANCE, dose->structs_uid, sizeof dose->structs_uid);
    if (!plan)
        return;
    dicom_text(plan, REFERENCED_INSTANCE, dose->plan_uid, sizeof dose->plan_uid);
    size_t n = dicom_n_items(plan, REFERENCED_FRACTION_SEQUENCE);
    for (size_t i = 0; i < n; i++)
        add_beams(dose, dicom_item_at(plan, REFERENCED_FRACTION_SEQUENCE, i));
}

static void read_words(struct rtdose *dose, const struct dicom_item *root)
{
    dicom_text(root, DOSE_TYPE, dose->type, sizeof dose->type);
    dicom_text(root, SUMMATION_TYPE, dose->summation, sizeof dose->summation);
    dicom_text(root, DOSE_UNITS, dose->units, sizeof dose->units);
    dicom_text(root, SERIES_DESCRIPTION, dose->description, sizeof dose->description);
    dicom_text(root, DOSE_COMMENT, dose->comment, sizeof dose->comment);
    dicom_text(root, SOP_INSTANCE, dose->uid, sizeof dose->uid);
    dicom_text(root, FRAME_UID, dose->frame_uid, sizeof dose->frame_uid);
    dose->ppm = NAN;
    enum dose_quantity quantities[2];
    double ppm[2];
    bool is_said[2], is_stated[2];
    is_said[0] = rtdose_component_from_text(dose->description, &quantities[0], &ppm[0], &is_stated[0]);
    is_said[1] = rtdose_component_from_text(dose->comment, &quantities[1], &ppm[1], &is_stated[1]);
    int best = is_said[1] && (!is_said[0] || (is_stated[1] && !is_stated[0]));
    bool contradicts = is_said[0] && is_said[1] && is_stated[0] == is_stated[1] && quantities[0] != quantities[1];
    if (!is_said[best] || contradicts)
        return;
    dose->is_component = true;
    dose->is_stated = is_stated[best];
    dose->quantity = quantities[best];
    dose->ppm = ppm[best];
}

static bool check_kind(const struct reading *reading, const struct dicom_pixels *pixels, double *scaling,
                       struct error *err)
{
    if (pixels->bits_allocated != 16 && pixels->bits_allocated != 32)
        return error_set(err, ERROR_UNSUPPORTED, "%s: dose of %u bits a value, expected 16 or 32", reading->where,
                         pixels->bits_allocated);
    if (!dicom_number(reading->root, GRID_SCALING, scaling))
        return error_set(err, ERROR_FORMAT, "%s: no Dose Grid Scaling (3004,000e), so the values are in no unit",
                         reading->where);
    if (!(*scaling > 0 && *scaling < 1e30))
        return error_set(err, ERROR_RANGE, "%s: Dose Grid Scaling (3004,000e) is %g, expected a number above 0",
                         reading->where, *scaling);
    return true;
}

bool rtdose_read(const struct dicom_file *file, const char *where, struct rtdose *dose, struct report *report,
                 struct error *err)
{
    const struct dicom_item *root = dicom_root(file);
    struct reading reading = { root, where, report };
    char class[DICOM_UID_SIZE], modality[17];
    dicom_text(root, SOP_CLASS, class, sizeof class);
    dicom_text(root, MODALITY, modality, sizeof modality);
    if (strcmp(class, RTDOSE_CLASS) != 0 && strcmp(modality, "RTDOSE") != 0)
        return error_set(err, ERROR_UNSUPPORTED, "%s: a DICOM object of modality \"%s\", expected RTDOSE", where,
                         modality);
    dicom_numbers_report(file, 0, where, report);
    struct dicom_pixels pixels;
    struct planes planes = { 0 };
    struct rtdose read = { 0 };
    struct dicom_coded coded = { 0 };
    double scaling;
    bool is_read = dicom_pixels_look(file, &pixels, err) && check_kind(&reading, &pixels, &scaling, err) &&
                   read_frame(&reading, &planes, err) && read_offsets(&reading, &planes, pixels.n_frames, err);
    if (is_read)
        read.values = read_values(&reading, file, &pixels, &planes, scaling, &coded, err);
    free(planes.at_mm);
    if (!read.values)
        return false;
    dicom_coded_report(&coded, file, &pixels, where, report);
    report_surplus(&reading, &pixels);
    read_words(&read, root);
    read_references(&read, root);
    if (!rtdose_read_dvhs(&read, root, where, report, err)) {
        rtdose_finish(&read);
        return false;
    }
    volume_measure(read.values);
    read.is_all_zero = read.values->low == 0 && read.values->high == 0;
    if (strcmp(read.units, "GY") == 0 && read.values->high > MOST_GY)
        report_add(report, REPORT_WARNING, "dose.doubtful", where,
                   "The dose reaches %g Gy, expected at most %g: Dose Grid Scaling (3004,000E) is %g.",
                   read.values->high, MOST_GY, scaling);
    if (read.values->low < 0)
        report_add(report, REPORT_WARNING, "dose.negative", where, "The dose goes down to %g.", read.values->low);
    *dose = read;
    return true;
}

void rtdose_finish(struct rtdose *dose)
{
    volume_unref(dose->values);
    dose->values = NULL;
    free(dose->stated);
    dose->stated = NULL;
    dose->n_stated = 0;
}

void rtdose_check_frame(struct rtdose *dose, const char *image_frame_uid, const char *where, struct report *report)
{
    bool is_known = dose->frame_uid[0] && image_frame_uid && image_frame_uid[0];
    dose->has_frame = true;
    dose->frame = !is_known                                       ? DOSE_FRAME_UNKNOWN
                  : strcmp(dose->frame_uid, image_frame_uid) == 0 ? DOSE_FRAME_SAME
                                                                  : DOSE_FRAME_DIFFERS;
    if (!is_known)
        report_add(report, REPORT_NOTE, "dose.no-frame", where,
                   "%s names no frame of reference, so nothing says that the dose fits the image.",
                   dose->frame_uid[0] ? "The image" : "The dose");
    else if (dose->frame == DOSE_FRAME_DIFFERS)
        report_add(report, REPORT_WARNING, "dose.frame-differs", where,
                   "The dose is in another frame of reference than the image and may be shifted against it.");
}
