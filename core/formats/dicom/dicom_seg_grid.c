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
enum { LEAST_GAP = 8 }; /* planes without a frame that part two boxes; more where there would be too many boxes */
#define FAR_APART 2.5   /* in slice thicknesses: frames are single slices of things far apart */
#define MOST_SHIFT 0.5  /* in pixels: how far a plane may lie beside the straight line through the planes */

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
        bool is_far = least > FAR_APART * first->thickness_mm && first->thickness_mm > 0 &&
                      worst_place(placing, first->thickness_mm) <= DICOM_EVEN;
        bool is_given = first->between_mm > 0 && worst_place(placing, first->between_mm) <= DICOM_EVEN &&
                        first->between_mm <= least * (1 + DICOM_EVEN);
        if (!is_given && is_far) {
            *pitch_mm = first->thickness_mm;
        } else if (!is_given) {
            double n = floor(extent / least + 0.5);
            *pitch_mm = extent / n;
            if (worst_place(placing, *pitch_mm) > DICOM_EVEN)
                return error_set(
                    err, ERROR_UNSUPPORTED,
                    "%s: its frames lie on planes that are not even: %zu places, the nearest %g mm apart over %g mm",
                    placing->where, n_places, least, extent);
        }
        *n_planes = floor(extent / *pitch_mm + 0.5) + 1;
        if (!(*n_planes + 2 * MARGIN <= VOLUME_MAX_SIDE))
            return error_set(err, ERROR_LIMIT,
                             "%s: frames at %zu places, %g mm apart: %.0f planes; at most %d are read", placing->where,
                             n_places, *pitch_mm, *n_planes, VOLUME_MAX_SIDE - 2 * MARGIN);
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

/* ---- boxes ------------------------------------------------------------------------------------------------------ */

/* The planes of one segment. */
struct extent {
    int64_t segment;
    uint32_t low_k, end_k, box;
};

static int by_segment(const void *a, const void *b)
{
    const struct extent *one = a, *other = b;
    return one->segment < other->segment ? -1 : one->segment > other->segment;
}

static int by_plane(const void *a, const void *b)
{
    const struct extent *one = a, *other = b;
    return one->low_k < other->low_k ? -1 : one->low_k > other->low_k;
}

/* One extent per segment, sorted by segment. Returns how many. */
static size_t find_extents(const struct seg_grid *grid, struct extent *extents)
{
    size_t n = 0, n_segments = 0;
    for (uint32_t f = 0; f < grid->n_frames; f++) {
        const struct seg_frame *frame = &grid->frames[f];
        if (frame->is_used)
            extents[n++] = (struct extent){ frame->segment, frame->plane, frame->plane + 1, 0 };
    }
    if (n > 0)
        qsort(extents, n, sizeof *extents, by_segment);
    for (size_t i = 0; i < n; i++) {
        struct extent *last = n_segments > 0 ? &extents[n_segments - 1] : NULL;
        if (!last || last->segment != extents[i].segment) {
            extents[n_segments++] = extents[i];
            continue;
        }
        last->low_k = extents[i].low_k < last->low_k ? extents[i].low_k : last->low_k;
        last->end_k = extents[i].end_k > last->end_k ? extents[i].end_k : last->end_k;
    }
    return n_segments;
}

/* Numbers the boxes of extents sorted by plane; a gap of gap planes or more begins a new one. Returns how many. */
static size_t number_boxes(struct extent *extents, size_t n, uint32_t gap)
{
    uint32_t end_k = 0;
    size_t n_boxes = 0;
    for (size_t i = 0; i < n; i++) {
        n_boxes += n_boxes == 0 || extents[i].low_k >= end_k + gap;
        end_k = extents[i].end_k > end_k ? extents[i].end_k : end_k;
        extents[i].box = (uint32_t)n_boxes - 1;
    }
    return n_boxes;
}

static bool make_box(struct seg_box *box, const struct grid *whole, struct error *err)
{
    box->low_k -= MARGIN; /* every frame lies MARGIN or more inside */
    box->end_k += MARGIN;
    uint32_t size[3] = { whole->size[0], whole->size[1], box->end_k - box->low_k };
    struct affine map = whole->lps_mm_from_ijk;
    map.origin = vec3_add(map.origin, vec3_scale(map.columns[2], box->low_k));
    return grid_init(&box->grid, size, &map, err);
}

bool seg_grid_find_boxes(struct seg_grid *grid, struct error *err)
{
    struct extent *extents = mem_array(grid->n_frames, sizeof *extents, UINT32_MAX, err);
    if (!extents)
        return false;
    size_t n = find_extents(grid, extents);
    if (n > 0)
        qsort(extents, n, sizeof *extents, by_plane);
    grid->n_boxes = SEG_MAX_BOXES + 1;
    for (uint32_t gap = LEAST_GAP; grid->n_boxes > SEG_MAX_BOXES; gap *= 2)
        grid->n_boxes = number_boxes(extents, n, gap);
    for (size_t i = 0; i < grid->n_boxes; i++)
        grid->boxes[i] = (struct seg_box){ .low_k = UINT32_MAX };
    for (size_t i = 0; i < n; i++) {
        struct seg_box *box = &grid->boxes[extents[i].box];
        box->low_k = extents[i].low_k < box->low_k ? extents[i].low_k : box->low_k;
        box->end_k = extents[i].end_k > box->end_k ? extents[i].end_k : box->end_k;
    }
    if (n > 0)
        qsort(extents, n, sizeof *extents, by_segment);
    for (uint32_t f = 0; f < grid->n_frames; f++) {
        const struct extent wanted = { .segment = grid->frames[f].segment };
        if (grid->frames[f].is_used)
            grid->frames[f].box =
                ((const struct extent *)bsearch(&wanted, extents, n, sizeof *extents, by_segment))->box;
    }
    free(extents);
    bool is_made = true;
    for (size_t i = 0; is_made && i < grid->n_boxes; i++)
        is_made = make_box(&grid->boxes[i], &grid->grid, err);
    return is_made;
}
