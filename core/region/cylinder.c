/* Counts univels in a cylinder or a prism, row by row: where a row is inside a cylinder follows from a quadratic
 * equation, a prism from where the row crosses the edges of its polygons. */
#include "core/region/cylinder.h"

#include <assert.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/region/label_rows.h"

#define ON_WALL_VOXELS 1e-9 /* along a row: a centre on the wall is inside, whatever rounding does */
enum { ROWS_OF_A_PART = 4096 };
enum { MAX_CROSSINGS = REGION_PRISM_MAX_POINTS }; /* of a row with the edges of a prism: one an edge */

struct counting {
    const struct region_set *set;
    struct vec3 from_lps_mm, direction;
    double radius_mm;
    const struct region_prism *prism;    /* NULL: the cylinder of this radius */
    size_t n_labels;                     /* above every label of a region */
    struct region_in_cylinder *found;    /* [n_parts][n_regions] */
    struct region_in_cylinder *of_label; /* [n_parts][n_labels], of the layer being counted */
};

/* The box of univels of a layer's regions, inclusive. False: they have none. */
static bool layer_box(const struct region_set *set, size_t layer, uint32_t low[3], uint32_t high[3])
{
    bool has_any = false;
    for (size_t r = 0; r < set->n_regions; r++) {
        const struct region *region = &set->regions[r];
        if (region->layer != layer || region->n_voxels == 0)
            continue;
        for (int axis = 0; axis < 3; axis++) {
            low[axis] = has_any && low[axis] < region->low_ijk[axis] ? low[axis] : region->low_ijk[axis];
            high[axis] = has_any && high[axis] > region->high_ijk[axis] ? high[axis] : region->high_ijk[axis];
        }
        has_any = true;
    }
    return has_any;
}

static struct vec3 across(struct vec3 p, struct vec3 direction)
{
    return vec3_sub(p, vec3_scale(direction, vec3_dot(p, direction)));
}

/* Narrows *low..*high to the indices of a row inside: a i^2 + 2 b i + c <= 0. False: none. */
static bool clip_row(double a, double b, double c, int64_t *low, int64_t *high)
{
    double root = b * b - a * c;
    if (!(a > 0) || root < 0)
        return c <= 0 && !(a > 0);
    *low = (int64_t)fmax((double)*low, ceil((-b - sqrt(root)) / a - ON_WALL_VOXELS));
    *high = (int64_t)fmin((double)*high, floor((-b + sqrt(root)) / a + ON_WALL_VOXELS));
    return *low <= *high;
}

/* Counts the runs of a row from low to high, inclusive. along: of index 0; step: from one index to the next. */
static void count_row(const struct volume *volume, size_t row, int64_t low, int64_t high, double along, double step,
                      struct region_in_cylinder *of_label, size_t n_labels)
{
    bool is_wide = volume->type == VOXEL_U16;
    const uint8_t *bytes = (const uint8_t *)volume->voxels + row * volume->grid.size[0] * voxel_size(volume->type);
    uint32_t end, i = (uint32_t)low, n = (uint32_t)high + 1;
    for (; i < n; i = end) {
        size_t label = is_wide ? ((const uint16_t *)(const void *)bytes)[i] : bytes[i];
        end = label_row_end(volume->type, bytes, i, n);
        if (label == 0 || label >= n_labels)
            continue;
        of_label[label].n_voxels += end - i;
        of_label[label].first_along_mm =
            fmin(of_label[label].first_along_mm, along + step * (double)(step < 0 ? end - 1 : i));
    }
}

/* ---- rows and polygons ------------------------------------------------------------------------------------------ */

static double cross2(const double a[2], const double b[2])
{
    return a[0] * b[1] - a[1] * b[0];
}

/* Places along a row, in indices, where it crosses edges of the prism, in order: inside from each even one to the next.
 * start: of index 0 across the line; step: from one index to the next. */
static int row_crossings(const struct region_prism *prism, const double start[2], const double step[2],
                         double places[MAX_CROSSINGS])
{
    double squared = step[0] * step[0] + step[1] * step[1];
    int n = 0;
    for (size_t polygon = 0, first = 0; polygon < prism->n_polygons; first = prism->ends[polygon++])
        for (size_t i = first, last = prism->ends[polygon]; i < last; i++) {
            const float *p = prism->points_mm[i], *q = prism->points_mm[i + 1 < last ? i + 1 : first];
            double a[2] = { (double)p[0] - start[0], (double)p[1] - start[1] },
                   b[2] = { (double)q[0] - start[0], (double)q[1] - start[1] };
            double side_a = cross2(step, a), side_b = cross2(step, b);
            if ((side_a > 0) == (side_b > 0))
                continue;
            double t = side_a / (side_a - side_b);
            double place = ((a[0] + t * (b[0] - a[0])) * step[0] + (a[1] + t * (b[1] - a[1])) * step[1]) / squared;
            int at = n++;
            for (; at > 0 && places[at - 1] > place; at--)
                places[at] = places[at - 1];
            places[at] = place;
        }
    return n;
}

/* Counts a row in the prism. across: like start and step of row_crossings. along: of index 0; along_step. */
static void count_prism_row(const struct counting *counting, const struct volume *volume, size_t row,
                            const int64_t ends[2], const double start[2], const double step[2], double along,
                            double along_step, struct region_in_cylinder *of_label)
{
    double places[MAX_CROSSINGS];
    bool is_along = step[0] * step[0] + step[1] * step[1] < 1e-20; /* mm2: the whole row is at one place */
    const double right[2] = { 1, 0 };
    int n = row_crossings(counting->prism, start, is_along ? right : step, places);
    int64_t next = ends[0];
    for (int i = 0; i + 1 < n; i += 2) {
        if (is_along) {
            if (!(places[i] <= ON_WALL_VOXELS && places[i + 1] >= -ON_WALL_VOXELS))
                continue;
            places[i] = (double)ends[0];
            places[i + 1] = (double)ends[1];
        }
        int64_t low = (int64_t)fmax((double)next, ceil(places[i] - ON_WALL_VOXELS)),
                high = (int64_t)fmin((double)ends[1], floor(places[i + 1] + ON_WALL_VOXELS));
        if (low > high)
            continue;
        count_row(volume, row, low, high, along, along_step, of_label, counting->n_labels);
        next = high + 1;
    }
}

static void count_layer(const struct counting *counting, size_t layer, int part, int n_parts,
                        struct region_in_cylinder *of_label)
{
    const struct volume *volume = counting->set->layers[layer];
    const struct affine *map = &volume->grid.lps_mm_from_ijk;
    const struct vec3 d = counting->direction, row_across = across(map->columns[0], d);
    const double along_step = vec3_dot(map->columns[0], d), radius = counting->radius_mm;
    /* a row that runs along the line, but for rounding, is inside or outside as a whole */
    bool is_along = vec3_length(row_across) < 1e-12 * vec3_length(map->columns[0]);
    double a = is_along ? 0 : vec3_dot(row_across, row_across);
    const struct region_prism *prism = counting->prism;
    const double prism_step[2] = { prism ? vec3_dot(map->columns[0], prism->x_lps) : 0,
                                   prism ? vec3_dot(map->columns[0], prism->y_lps) : 0 };
    uint32_t low[3], high[3];
    if (!layer_box(counting->set, layer, low, high))
        return;
    for (uint32_t k = low[2] + (uint32_t)part; k <= high[2]; k += (uint32_t)n_parts)
        for (uint32_t j = low[1]; j <= high[1]; j++) {
            struct vec3 p = vec3_sub(affine_point(map, vec3(0, j, k)), counting->from_lps_mm), q = across(p, d);
            int64_t first = low[0], last = high[0];
            size_t row = (size_t)k * volume->grid.size[1] + j;
            if (prism) {
                const double start[2] = { vec3_dot(p, prism->x_lps), vec3_dot(p, prism->y_lps) };
                count_prism_row(counting, volume, row, (int64_t[]){ first, last }, start, prism_step, vec3_dot(p, d),
                                along_step, of_label);
                continue;
            }
            double c = vec3_dot(q, q) - radius * radius * (is_along ? 1 + 1e-12 : 1);
            if (clip_row(a, vec3_dot(q, row_across), c, &first, &last))
                count_row(volume, row, first, last, vec3_dot(p, d), along_step, of_label, counting->n_labels);
        }
}

static void count_part(void *context, int part, int n_parts)
{
    const struct counting *counting = context;
    const struct region_set *set = counting->set;
    struct region_in_cylinder *of_label = counting->of_label + (size_t)part * counting->n_labels,
                              *found = counting->found + (size_t)part * set->n_regions;
    for (size_t layer = 0; layer < set->n_layers; layer++) {
        for (size_t label = 0; label < counting->n_labels; label++)
            of_label[label] = (struct region_in_cylinder){ 0, INFINITY };
        count_layer(counting, layer, part, n_parts, of_label);
        for (size_t r = 0; r < set->n_regions; r++)
            if (set->regions[r].layer == layer)
                found[r] = of_label[set->regions[r].label];
    }
}

static int number_of_parts(const struct region_set *set)
{
    uint64_t rows = 0;
    for (size_t layer = 0; layer < set->n_layers; layer++)
        rows += (uint64_t)set->layers[layer]->grid.size[1] * set->layers[layer]->grid.size[2];
    uint64_t parts = rows / ROWS_OF_A_PART + 1, cores = (uint64_t)parallel_cores();
    return (int)(parts < cores ? parts : cores);
}

static bool count(struct counting counting, struct region_in_cylinder *found, struct error *err)
{
    const struct region_set *set = counting.set;
    counting.n_labels = 1;
    for (size_t r = 0; r < set->n_regions; r++)
        if (set->regions[r].label >= counting.n_labels)
            counting.n_labels = (size_t)set->regions[r].label + 1;
    size_t n_parts = (size_t)number_of_parts(set);
    counting.found = mem_array(n_parts * set->n_regions + 1, sizeof *counting.found, UINT64_MAX, err);
    counting.of_label = mem_array(n_parts * counting.n_labels, sizeof *counting.of_label, UINT64_MAX, err);
    bool is_good = counting.found && counting.of_label;
    if (is_good) {
        parallel_run((int)n_parts, count_part, &counting);
        for (size_t r = 0; r < set->n_regions; r++) {
            found[r] = counting.found[r];
            for (size_t part = 1; part < n_parts; part++) {
                const struct region_in_cylinder *of_part = &counting.found[part * set->n_regions + r];
                found[r].n_voxels += of_part->n_voxels;
                found[r].first_along_mm = fmin(found[r].first_along_mm, of_part->first_along_mm);
            }
        }
    }
    free(counting.of_label);
    free(counting.found);
    return is_good;
}

bool regions_in_cylinder(const struct region_set *set, struct vec3 from_lps_mm, struct vec3 direction, double radius_mm,
                         struct region_in_cylinder *found, struct error *err)
{
    return count((struct counting){ .set = set,
                                    .from_lps_mm = from_lps_mm,
                                    .direction = direction,
                                    .radius_mm = radius_mm },
                 found, err);
}

bool regions_in_prism(const struct region_set *set, struct vec3 from_lps_mm, struct vec3 direction,
                      const struct region_prism *prism, struct region_in_cylinder *found, struct error *err)
{
    assert(prism->n_polygons == 0 || prism->ends[prism->n_polygons - 1] <= REGION_PRISM_MAX_POINTS);
    return count((struct counting){ .set = set, .from_lps_mm = from_lps_mm, .direction = direction, .prism = prism },
                 found, err);
}
