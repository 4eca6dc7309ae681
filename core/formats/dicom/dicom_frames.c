/* Reads the geometry of multi-frame (enhanced) images: each frame has functional groups of its own beside the shared
 * ones. Source: DICOM PS3.3 C.7.6.16. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/formats/dicom/dicom_slices.h"
#include "core/formats/dicom/dicom_stacks.h"
#include "core/formats/dicom/dicom_tags.h"

/* The item of a functional group: the frame's own, else the shared one, else NULL. */
static const struct dicom_item *group_of(const struct dicom_item *frame, const struct dicom_item *shared, uint32_t tag)
{
    const struct dicom_item *own = frame ? dicom_item_at(frame, tag, 0) : NULL;
    return own ? own : shared ? dicom_item_at(shared, tag, 0) : NULL;
}

static bool get_finite(const struct dicom_item *item, uint32_t tag, double *values, size_t n)
{
    if (!item || dicom_numbers(item, tag, values, n) != n)
        return false;
    for (size_t i = 0; i < n; i++)
        if (!isfinite(values[i]))
            return false;
    return true;
}

/* Reads an optional number; an absent one leaves value unchanged. Returns false if it is present but malformed. */
static bool get_optional(const struct dicom_item *item, uint32_t tag, double *value)
{
    return !item || dicom_numbers(item, tag, NULL, 0) == 0 || get_finite(item, tag, value, 1);
}

bool dicom_frame_read(const struct dicom_item *frame, const struct dicom_item *shared, struct dicom_frame_place *place,
                      struct dicom_slice *slice)
{
    const struct dicom_item *measures = group_of(frame, shared, TAG_PIXEL_MEASURES);
    const struct dicom_item *values = group_of(frame, shared, TAG_FRAME_VALUES);
    if (!get_finite(group_of(frame, shared, TAG_PLANE_POSITIONS), TAG_POSITION, place->position_mm, 3) ||
        !get_finite(group_of(frame, shared, TAG_PLANE_ORIENTATIONS), TAG_ORIENTATION, place->cosines, 6) ||
        !get_finite(measures, TAG_SPACING, place->spacing_mm, 2) ||
        !(place->spacing_mm[0] > 0 && place->spacing_mm[1] > 0))
        return false;
    place->thickness_mm = place->between_mm = 0;
    slice->slope = 1;
    slice->offset = 0;
    if (!get_optional(measures, TAG_THICKNESS, &place->thickness_mm) ||
        !get_optional(measures, TAG_BETWEEN_SLICES, &place->between_mm) ||
        !get_optional(values, TAG_SLOPE, &slice->slope) || !get_optional(values, TAG_OFFSET, &slice->offset))
        return false;
    slice->position_lps_mm = vec3(place->position_mm[0], place->position_mm[1], place->position_mm[2]);
    return true;
}

bool dicom_frames_fit(const struct dicom_frame_place *a, const struct dicom_frame_place *b)
{
    for (int i = 0; i < 6; i++)
        if (!(fabs(a->cosines[i] - b->cosines[i]) <= 1e-3))
            return false;
    return fabs(a->spacing_mm[0] - b->spacing_mm[0]) <= 1e-3 * b->spacing_mm[0] &&
           fabs(a->spacing_mm[1] - b->spacing_mm[1]) <= 1e-3 * b->spacing_mm[1];
}

bool dicom_frames_find(const struct dicom_file *file, const char *path, size_t object, uint32_t n_frames,
                       struct dicom_slice *slices, size_t *n, struct dicom_plane *plane, struct report *report,
                       struct error *err)
{
    const struct dicom_item *root = dicom_root(file), *shared = dicom_item_at(root, TAG_SHARED_GROUPS, 0);
    size_t n_groups = dicom_n_items(root, TAG_FRAME_GROUPS);
    if (n_groups != n_frames)
        return error_set(err, ERROR_FORMAT, "%s: sequence (5200,9230) has %zu items for %u frames", path, n_groups,
                         n_frames);
    struct dicom_frame_place first = { 0 }, place;
    struct vec3 axes[3] = { { 0, 0, 0 }, { 0, 0, 0 }, { 0, 0, 0 } };
    double off;
    size_t n_others = 0, n_repeated = 0;
    *n = 0;
    for (uint32_t f = 0; f < n_frames; f++) {
        struct dicom_slice slice = { .object = object, .frame = f };
        if (!dicom_frame_read(dicom_item_at(root, TAG_FRAME_GROUPS, f), shared, &place, &slice))
            return error_set(
                err, ERROR_FORMAT,
                "%s: frame %u of %u does not say where it lies in the patient, or how large its pixels are, or a number of these "
                "or of its rescale is none",
                path, f + 1, n_frames);
        if (f == 0) {
            first = place;
            if (!dicom_axes(first.cosines, first.cosines + 3, axes, &off))
                return error_set(err, ERROR_FORMAT,
                                 "%s: the directions of its rows and columns (0020,0037) do not span a plane", path);
        }
        if (!dicom_frames_fit(&first, &place)) {
            n_others++;
            continue;
        }
        slice.along_mm = vec3_dot(axes[2], slice.position_lps_mm);
        slices[(*n)++] = slice;
    }
    *n = dicom_slices_sort(slices, *n, &n_repeated);
    if (n_others + n_repeated > 0)
        report_add(report, REPORT_WARNING, "image.frames-left-out", path,
                   "Of %u frames %zu have another orientation or pixel size than the first, "
                   "and %zu lie where an earlier one does; they are not shown.",
                   n_frames, n_others, n_repeated);
    memcpy(plane->row, first.cosines, sizeof plane->row);
    memcpy(plane->column, first.cosines + 3, sizeof plane->column);
    memcpy(plane->spacing_mm, first.spacing_mm, sizeof plane->spacing_mm);
    plane->thickness_mm = fmax(0, first.thickness_mm);
    return true;
}
