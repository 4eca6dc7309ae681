/* Lays the slices of a stack out on an even grid, and interpolates where slices are uneven or missing. */
#include "core/formats/dicom/dicom_slices.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/formats/dicom/dicom_stacks.h"

static int by_place(const void *a, const void *b)
{
    const struct dicom_slice *left = a, *right = b;
    if (left->along_mm != right->along_mm)
        return left->along_mm < right->along_mm ? -1 : 1;
    return left->frame < right->frame ? -1 : left->frame > right->frame;
}

size_t dicom_slices_sort(struct dicom_slice *slices, size_t n, size_t *n_repeated)
{
    if (n > 1)
        qsort(slices, n, sizeof *slices, by_place);
    size_t kept = n > 0;
    for (size_t i = 1; i < n; i++)
        if (slices[i].along_mm - slices[kept - 1].along_mm >= DICOM_SAME_PLACE_MM)
            slices[kept++] = slices[i];
    *n_repeated = n - kept;
    return kept;
}

static int by_value(const void *a, const void *b)
{
    double left = *(const double *)a, right = *(const double *)b;
    return left < right ? -1 : left > right;
}

/* The smallest usual distance: the first quartile of all distances. It ignores a few slices that are closer than usual;
 * in a stack of thin and thick slices it is the distance of the thin ones. */
static double usual_distance(const struct dicom_slice *slices, size_t n, double *least, double *most, struct error *err)
{
    double *distances = mem_array(n - 1, sizeof *distances, UINT32_MAX, err);
    if (!distances)
        return 0;
    for (size_t i = 0; i + 1 < n; i++)
        distances[i] = slices[i + 1].along_mm - slices[i].along_mm;
    qsort(distances, n - 1, sizeof *distances, by_value);
    *least = distances[0];
    *most = distances[n - 2];
    double usual = distances[(n - 2) / 4];
    free(distances);
    return usual;
}

/* Largest distance of a slice from its even position, as a share of the pitch. */
static double worst_unevenness(const struct dicom_slice *slices, size_t n, double pitch_mm)
{
    double worst = 0;
    for (size_t i = 0; i < n; i++)
        worst = fmax(worst, fabs((slices[i].along_mm - slices[0].along_mm) / pitch_mm - (double)i));
    return worst;
}

/* Largest distance of a slice's first pixel from the straight line between those of the outermost slices. */
static double worst_shift_mm(const struct dicom_slice *slices, size_t n, struct vec3 per_mm)
{
    double worst = 0;
    for (size_t i = 0; i < n; i++) {
        struct vec3 expected =
            vec3_add(slices[0].position_lps_mm, vec3_scale(per_mm, slices[i].along_mm - slices[0].along_mm));
        worst = fmax(worst, vec3_length(vec3_sub(slices[i].position_lps_mm, expected)));
    }
    return worst;
}

/* Sets each plane from the slices around it. Counts planes without a slice, and slices between planes. */
static void interpolate(const struct dicom_slice *slices, size_t n, double pitch_mm, struct dicom_slice_layout *layout,
                        size_t *n_made, size_t *n_between)
{
    uint32_t n_planes = layout->grid.size[2];
    size_t below = 0;
    *n_made = 0;
    for (uint32_t k = 0; k < n_planes; k++) {
        double along = slices[0].along_mm + k * pitch_mm;
        while (below + 2 < n && slices[below + 1].along_mm <= along)
            below++;
        size_t above = below + 1 < n ? below + 1 : below;
        double to_below = fabs(along - slices[below].along_mm), to_above = fabs(along - slices[above].along_mm);
        struct dicom_plane_source *plane = &layout->planes[k];
        if (fmin(to_below, to_above) <= DICOM_EVEN * pitch_mm) {
            uint32_t nearest = (uint32_t)(to_below <= to_above ? below : above);
            *plane = (struct dicom_plane_source){ nearest, nearest, 0 };
        } else {
            double gap = slices[above].along_mm - slices[below].along_mm;
            *plane = (struct dicom_plane_source){ (uint32_t)below, (uint32_t)above,
                                                  fmin(1, fmax(0, (along - slices[below].along_mm) / gap)) };
            ++*n_made;
        }
    }
    *n_between = 0;
    for (size_t i = 0; i < n; i++) {
        double place = (slices[i].along_mm - slices[0].along_mm) / pitch_mm;
        *n_between += fabs(place - floor(place + 0.5)) > DICOM_EVEN;
    }
}

/* Lists where slices are missing, for the report: "at 12.0, 14.0, ... mm". */
static void list_gaps(const struct dicom_slice_layout *layout, const struct dicom_slice *slices, double pitch_mm,
                      char *out, size_t size)
{
    size_t n = 0, at = 0;
    for (uint32_t k = 0; k < layout->grid.size[2]; k++) {
        if (layout->planes[k].a == layout->planes[k].b)
            continue;
        if (n++ == 8) {
            snprintf(out + at, size - at, ", ...");
            return;
        }
        at += (size_t)snprintf(out + at, size - at, "%s%.2f", n > 1 ? ", " : "", slices[0].along_mm + k * pitch_mm);
    }
}

/* Lays out slices that are uneven, or some missing: even planes at the smallest usual distance. */
static bool lay_out_uneven(const struct dicom_slice *slices, size_t n, const char *where, double *pitch_mm,
                           struct dicom_slice_layout *layout, struct report *report, struct error *err)
{
    double least = 0, most = 0, usual = usual_distance(slices, n, &least, &most, err);
    if (usual <= 0)
        return false;
    double extent = slices[n - 1].along_mm - slices[0].along_mm;
    double n_planes = floor(extent / usual + 0.5) + 1;
    if (n_planes > VOLUME_MAX_SIDE || n_planes > 8.0 * (double)n + 64)
        return error_set(err, ERROR_LIMIT, "%s: %zu slices between %g and %g mm apart: even slices would be %.0f",
                         where, n, least, most, n_planes);
    layout->grid.size[2] = (uint32_t)n_planes;
    *pitch_mm = extent / (n_planes - 1);
    layout->planes = mem_array(layout->grid.size[2], sizeof *layout->planes, UINT32_MAX, err);
    if (!layout->planes)
        return false;
    size_t n_made, n_between;
    interpolate(slices, n, *pitch_mm, layout, &n_made, &n_between);
    if (n_between == 0 && n_made == 0) {
        report_add(
            report, REPORT_NOTE, "image.locations-uneven", where,
            "%zu slices lie between %.4g and %.4g mm apart; none is missing, and they were placed %.4g mm apart.", n,
            least, most, *pitch_mm);
    } else if (n_between == 0) {
        char gaps[120] = "";
        list_gaps(layout, slices, *pitch_mm, gaps, sizeof gaps);
        report_add(report, REPORT_WARNING, "image.slices-missing", where,
                   "%zu slices %.4g mm apart, but %zu between them are missing, at %s mm "
                   "along their normal; they were interpolated.",
                   n, *pitch_mm, n_made, gaps);
    } else {
        report_add(report, REPORT_WARNING, "image.slices-resampled", where,
                   "%zu slices between %.4g and %.4g mm apart were interpolated to %u, "
                   "%.4g mm apart; %u kept their values.",
                   n, least, most, layout->grid.size[2], *pitch_mm, layout->grid.size[2] - (uint32_t)n_made);
    }
    return true;
}

static void report_stacking(const struct dicom_slice *slices, size_t n, const struct dicom_plane *plane,
                            struct vec3 normal, double pitch_mm, struct vec3 per_mm, const char *where,
                            struct report *report)
{
    double angle_deg = acos(fmin(1, vec3_dot(vec3_normalize(per_mm), normal))) * 180 / MATH_PI;
    if (angle_deg > 0.1)
        report_add(report, REPORT_NOTE, "image.gantry-tilt", where,
                   "Slices are stacked %.2f degrees off their normal (gantry tilt); the image "
                   "is kept sheared, as taken.",
                   angle_deg);
    double shift_mm = worst_shift_mm(slices, n, per_mm);
    if (shift_mm > 0.1 * fmin(plane->spacing_mm[0], plane->spacing_mm[1]))
        report_add(report, REPORT_WARNING, "image.slices-shifted", where,
                   "Slices are shifted sideways by up to %.2g mm against a straight line; "
                   "they were placed on it.",
                   shift_mm);
    if (plane->thickness_mm > 0 && fabs(plane->thickness_mm - pitch_mm) > 0.05 * pitch_mm)
        report_add(report, REPORT_NOTE, "image.thickness-differs", where, "Slices are %.4g mm apart and %.4g mm thick.",
                   pitch_mm, plane->thickness_mm);
}

static bool lay_out_many(const struct dicom_slice *slices, size_t n, const struct dicom_plane *plane,
                         struct vec3 normal, const char *where, struct vec3 *step, struct dicom_slice_layout *layout,
                         struct report *report, struct error *err)
{
    double extent = slices[n - 1].along_mm - slices[0].along_mm;
    struct vec3 per_mm = vec3_scale(vec3_sub(slices[n - 1].position_lps_mm, slices[0].position_lps_mm), 1 / extent);
    double shift_mm = worst_shift_mm(slices, n, per_mm);
    if (shift_mm > fmax(plane->spacing_mm[0], plane->spacing_mm[1]))
        return error_set(err, ERROR_UNSUPPORTED,
                         "%s: its slices do not lie on a straight line: one is %.3g mm beside it", where, shift_mm);
    double pitch_mm = extent / (double)(n - 1);
    double unevenness = worst_unevenness(slices, n, pitch_mm);
    layout->grid.size[2] = (uint32_t)n;
    layout->is_exact = unevenness <= DICOM_EVEN;
    if (layout->is_exact && unevenness > 1e-3)
        report_add(report, REPORT_NOTE, "image.locations-uneven", where,
                   "Slices are up to %.2g mm off even places %.4g mm apart.", unevenness * pitch_mm, pitch_mm);
    if (!layout->is_exact && !lay_out_uneven(slices, n, where, &pitch_mm, layout, report, err))
        return false;
    report_stacking(slices, n, plane, normal, pitch_mm, per_mm, where, report);
    *step = vec3_scale(per_mm, pitch_mm);
    return true;
}

bool dicom_slices_lay_out(const struct dicom_slice *slices, size_t n, const struct dicom_plane *plane,
                          const char *where, struct dicom_slice_layout *layout, struct report *report,
                          struct error *err)
{
    *layout = (struct dicom_slice_layout){ .grid.size = { plane->columns, plane->rows, 1 }, .is_exact = true };
    struct vec3 axes[3], step;
    double off;
    if (!dicom_axes(plane->row, plane->column, axes, &off))
        return error_set(err, ERROR_FORMAT,
                         "%s: the directions of its rows and columns (0020,0037) do not span a plane", where);
    if (off > 1e-3)
        report_add(report, REPORT_WARNING, "geometry.cosines", where,
                   "The directions of rows and columns (0020,0037) are off by %.2g; they were "
                   "made perpendicular.",
                   off);
    if (n == 1) {
        double thickness_mm = plane->thickness_mm > 0 ? plane->thickness_mm : 1;
        report_add(report, REPORT_WARNING, "image.single-slice", where,
                   "The image has one slice; its thickness is %s %g mm.",
                   plane->thickness_mm > 0 ? "given as" : "not given and taken as", thickness_mm);
        step = vec3_scale(axes[2], thickness_mm);
    } else if (!lay_out_many(slices, n, plane, axes[2], where, &step, layout, report, err)) {
        return false;
    }
    struct affine lps_mm_from_ijk = { { vec3_scale(axes[0], plane->spacing_mm[1]),
                                        vec3_scale(axes[1], plane->spacing_mm[0]), step },
                                      slices[0].position_lps_mm };
    uint32_t size[3] = { layout->grid.size[0], layout->grid.size[1], layout->grid.size[2] };
    if (!grid_init(&layout->grid, size, &lps_mm_from_ijk, err)) {
        error_prefix(err, "%s: ", where);
        free(layout->planes);
        layout->planes = NULL;
        return false;
    }
    return true;
}
