/* Finds the grid that the frames of a segmentation span, and the plane of each frame. */
#include "core/formats/dicom/dicom_seg_grid.h"

#include <math.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/formats/dicom/dicom_slices.h"
#include "core/formats/dicom/dicom_stacks.h"
#include "core/formats/dicom/dicom_tags.h"

#define TAG_SEGMENT_IDENTIFICATION DICOM_TAG(0x0062, 0x000A)
#define TAG_REFERENCED_SEGMENT DICOM_TAG(0x0062, 0x000B)
enum {
    MARGIN = 1
}; /* empty planes at either end: writers omit empty frames, so the outermost frames are not the border of the scan */
#define MOST_SHIFT 0.5 /* in pixels: how far a plane may lie beside the straight line through the planes */

struct placing {
    struct seg_grid *grid;
    const char *where;
    struct dicom_slice *slices; /* the frames used: number and position */
    size_t n_slices;
    struct dicom_frame_place first;
    struct vec3 axes[3];
};

static bool segment_of(const struct dicom_item *frame, const struct dicom_item *shared, int64_t *number)
{
    const struct dicom_item *own = frame ? dicom_item_at(frame, TAG_SEGMENT_IDENTIFICATION, 0) : NULL;
    if (!own && shared)
        own = dicom_item_at(shared, TAG_SEGMENT_IDENTIFICATION, 0);
    return own && dicom_integer(own, TAG_REFERENCED_SEGMENT, number);
}

static bool find_frames(struct placing *placing, const struct dicom_item *root, struct report *report,
                        struct error *err)
{
    const struct dicom_item *shared = dicom_item_at(root, TAG_SHARED_GROUPS, 0);
    uint32_t n_frames = placing->grid->n_frames;
    size_t n_groups = dicom_n_items(root, TAG_FRAME_GROUPS), n_others = 0;
    if (n_groups != n_frames)
        return error_set(err, ERROR_FORMAT, "%s: sequence (5200,9230) has %zu items for %u frames", placing->where,
                         n_groups, n_frames);
    for (uint32_t f = 0; f < n_frames; f++) {
        const struct dicom_item *item = dicom_item_at(root, TAG_FRAME_GROUPS, f);
        struct seg_frame *frame = &placing->grid->frames[f];
        struct dicom_slice slice = { .frame = f };
        struct dicom_frame_place place;
        double off;
        if (!dicom_frame_read(item, shared, &place, &slice))
            return error_set(
                err, ERROR_FORMAT,
                "%s: frame %u of %u does not say where it lies in the patient, or how large its pixels are",
                placing->where, f + 1, n_frames);
        if (!segment_of(item, shared, &frame->segment))
            return error_set(err, ERROR_FORMAT, "%s: frame %u of %u does not say which segment it is of (0062,000B)",
                             placing->where, f + 1, n_frames);
        if (f == 0) {
            placing->first = place;
            if (!dicom_axes(place.cosines, place.cosines + 3, placing->axes, &off))
                return error_set(err, ERROR_FORMAT,
                                 "%s: the directions of its rows and columns (0020,0037) do not span a plane",
                                 placing->where);
        }
        if (!dicom_frames_fit(&placing->first, &place)) {
            n_others++;
            continue;
        }
        frame->is_used = true;
        slice.along_mm = vec3_dot(placing->axes[2], slice.position_lps_mm);
        placing->slices[placing->n_slices++] = slice;
    }
    if (n_others > 0)
        report_add(report, REPORT_WARNING, "image.frames-left-out", placing->where,
                   "Of %u frames %zu have another orientation or pixel size than the "
                   "first; they are not shown.",
                   n_frames, n_others);
    return true;
}

static int by_place(const void *a, const void *b)
{
    double left = ((const struct dicom_slice *)a)->along_mm, right = ((const struct dicom_slice *)b)->along_mm;
    return left < right ? -1 : left > right;
}

/* Largest distance of a frame from the nearest whole plane, in planes. */
static double worst_place(const struct placing *placing, double pitch_mm)
{
    double worst = 0;
    for (size_t i = 0; i < placing->n_slices; i++) {
        double at = (placing->slices[i].along_mm - placing->slices[0].along_mm) / pitch_mm;
        worst = fmax(worst, fabs(at - floor(at + 0.5)));
    }
    return worst;
}

/* Reports a plane distance that is not the file's. With one plane, only the file can tell its thickness. */
static void report_pitch(const struct placing *placing, size_t n_places, double pitch_mm, struct report *report)
{
    const struct dicom_frame_place *first = &placing->first;
    if (n_places == 1 && !(first->between_mm > 0) && !(first->thickness_mm > 0))
        report_add(report, REPORT_WARNING, "geometry.assumed", placing->where,
                   "Its frames lie on one plane, and neither a distance of planes "
                   "(0018,0088) nor a thickness (0018,0050) is given; %g mm was taken as its thickness.",
                   pitch_mm);
    else if (n_places > 1 && pitch_mm != first->between_mm && first->thickness_mm > 0 &&
             pitch_mm > first->thickness_mm * (1 + DICOM_EVEN))
        report_add(report, REPORT_WARNING, "image.thickness-differs", placing->where,
                   "Frames are %g mm thick (0018,0050) and lie %g mm apart, and the "
                   "distance of planes (0018,0088) does not say so; each was taken as %g mm thick.",
                   first->thickness_mm, pitch_mm, pitch_mm);
}

/* Finds plane distance and number of planes; false if frames are uneven or the planes too many. A frame nearer than
 * DICOM_SAME_PLACE_MM to the last plane found shares it. */
static bool find_pitch(const struct placing *placing, double *pitch_mm, double *n_planes, struct report *report,
                       struct error *err)
{
    double extent = placing->slices[placing->n_slices - 1].along_mm - placing->slices[0].along_mm, least = INFINITY;
    double place_mm = placing->slices[0].along_mm;
    size_t n_places = 1;
    for (size_t i = 1; i < placing->n_slices; i++) {
        double gap = placing->slices[i].along_mm - place_mm;
        if (!(gap >= DICOM_SAME_PLACE_MM))
            continue;
        place_mm = placing->slices[i].along_mm;
        least = fmin(least, gap);
        n_places++;
    }
    const struct dicom_frame_place *first = &placing->first;
    *n_planes = 1;
    *pitch_mm = first->between_mm > 0 ? first->between_mm : first->thickness_mm > 0 ? first->thickness_mm : 1;
    if (n_places > 1) {
        if (!(first->between_mm > 0 && worst_place(placing, first->between_mm) <= DICOM_EVEN &&
              first->between_mm <= least * (1 + DICOM_EVEN))) {
            double n = floor(extent / least + 0.5);
            *pitch_mm = extent / n;
            if (worst_place(placing, *pitch_mm) > DICOM_EVEN)
                return error_set(
                    err, ERROR_UNSUPPORTED,
                    "%s: its frames lie on planes that are not even: %zu places, the nearest %g mm apart over %g mm",
                    placing->where, n_places, least, extent);
        }
        *n_planes = floor(extent / *pitch_mm + 0.5) + 1;
        if (!(*n_planes + 2 * MARGIN <= VOLUME_MAX_SIDE && *n_planes <= 8.0 * (double)n_places + 64))
            return error_set(err, ERROR_LIMIT,
                             "%s: frames at %zu places, %g mm apart: %.0f planes, of which most would be empty",
                             placing->where, n_places, *pitch_mm, *n_planes);
    }
    report_pitch(placing, n_places, *pitch_mm, report);
    return true;
}

/* Finds the vector from plane to plane. Planes need not be stacked along their normal (tilted gantry), but on a
 * straight line. */
static bool find_step(const struct placing *placing, double pitch_mm, struct vec3 *step, struct error *err)
{
    const struct dicom_slice *slices = placing->slices;
    size_t n = placing->n_slices;
    double extent = slices[n - 1].along_mm - slices[0].along_mm, worst = 0;
    struct vec3 per_mm =
        extent < DICOM_SAME_PLACE_MM
            ? placing->axes[2]
            : vec3_scale(vec3_sub(slices[n - 1].position_lps_mm, slices[0].position_lps_mm), 1 / extent);
    for (size_t i = 0; i < n; i++) {
        struct vec3 expected =
            vec3_add(slices[0].position_lps_mm, vec3_scale(per_mm, slices[i].along_mm - slices[0].along_mm));
        worst = fmax(worst, vec3_length(vec3_sub(slices[i].position_lps_mm, expected)));
    }
    double most = MOST_SHIFT * fmin(placing->first.spacing_mm[0], placing->first.spacing_mm[1]);
    if (worst > most)
        return error_set(err, ERROR_UNSUPPORTED,
                         "%s: its frames do not lie on a straight line: one is %.3g mm beside it", placing->where,
                         worst);
    *step = vec3_scale(per_mm, pitch_mm);
    return true;
}

/* Assigns each frame its plane: the first position is plane MARGIN; n_planes lie between the two margins. */
static bool place_frames(struct placing *placing, double pitch_mm, double n_planes, struct error *err)
{
    for (size_t i = 0; i < placing->n_slices; i++) {
        double along_mm = placing->slices[i].along_mm - placing->slices[0].along_mm;
        double plane = n_planes > 1 ? floor(along_mm / pitch_mm + 0.5) : 0;
        if (!(plane >= 0 && plane < n_planes))
            return error_set(err, ERROR_FORMAT,
                             "%s: frame %u of %u lies %g mm behind the first: plane %.0f, expected 0 to %.0f",
                             placing->where, placing->slices[i].frame + 1, placing->grid->n_frames, along_mm, plane,
                             n_planes - 1);
        placing->grid->frames[placing->slices[i].frame].plane = (uint32_t)plane + MARGIN;
    }
    return true;
}

static bool make_grid(struct placing *placing, struct report *report, struct error *err)
{
    struct seg_grid *grid = placing->grid;
    double pitch_mm, n_planes;
    struct vec3 step;
    qsort(placing->slices, placing->n_slices, sizeof *placing->slices, by_place);
    if (!find_pitch(placing, &pitch_mm, &n_planes, report, err) || !find_step(placing, pitch_mm, &step, err))
        return false;
    uint32_t size[3] = { grid->columns, grid->rows, (uint32_t)n_planes + 2 * MARGIN };
    if ((uint64_t)size[0] * size[1] * size[2] > DICOM_SEG_MAX_VOXELS)
        return error_set(err, ERROR_LIMIT, "%s: %u x %u x %u voxels; at most %llu are read", placing->where, size[0],
                         size[1], size[2], (unsigned long long)DICOM_SEG_MAX_VOXELS);
    if (!place_frames(placing, pitch_mm, n_planes, err))
        return false;
    const double *spacing_mm = placing->first.spacing_mm;
    struct affine map = { { vec3_scale(placing->axes[0], spacing_mm[1]), vec3_scale(placing->axes[1], spacing_mm[0]),
                            step },
                          vec3_sub(placing->slices[0].position_lps_mm, vec3_scale(step, MARGIN)) };
    if (grid_init(&grid->grid, size, &map, err))
        return true;
    error_prefix(err, "%s: ", placing->where);
    return false;
}

bool seg_grid_find(struct seg_grid *grid, const struct dicom_item *root, const char *where, struct report *report,
                   struct error *err)
{
    struct placing placing = { .grid = grid, .where = where };
    grid->frames = mem_array(grid->n_frames, sizeof *grid->frames, UINT32_MAX, err);
    placing.slices = grid->frames ? mem_array(grid->n_frames, sizeof *placing.slices, UINT32_MAX, err) : NULL;
    bool is_found = placing.slices && find_frames(&placing, root, report, err) && make_grid(&placing, report, err);
    free(placing.slices);
    return is_found;
}
