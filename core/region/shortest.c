/* Finds the shortest way out of the patient: casts rays from outside towards a point, and leaves out those of which one
 * univel farther out than the best way is known. */
#include "core/region/shortest.h"

#include <stdlib.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"

/* Directions: the middles of a face's SIDE x SIDE cells of equal angle, on the six faces of a cube. */
enum { FACES = 6, COARSE_SIDE = 24, FINE_SIDE = 1024, REFINE = 16, REFINE_REACH = 24 };
_Static_assert(FINE_SIDE >= 900, "a face of 90 degrees in steps of at most SHORTEST_STEP_DEG");
#define EQUAL_MM 1e-6

/* A layer with regions, in its index space. */
struct layer_view {
    const struct volume *volume;
    bool *is_region; /* [n_labels] */
    size_t n_labels;
    uint64_t n_voxels;
    double low[3], high[3]; /* outer faces of the regions' box */
    double start[3];        /* the point */
};

struct search {
    struct layer_view *layers; /* the largest regions first: most rays are decided there */
    size_t n_layers;
    int side;
    double best_mm;      /* no way as long as this or longer is looked for */
    uint64_t best_index; /* of the direction; UINT64_MAX: none yet */
    double *tangents;    /* [side] */
    struct part_of_search {
        double depth_mm;
        uint64_t index;
    } * found; /* [n_parts] */
};

/* ---- layers ------------------------------------------------------------------------------------------------------ */
static void measure_layer(const struct region_set *set, size_t layer, struct layer_view *view)
{
    for (int axis = 0; axis < 3; axis++) {
        view->low[axis] = INFINITY;
        view->high[axis] = -INFINITY;
    }
    view->n_labels = 1;
    view->n_voxels = 0;
    for (size_t r = 0; r < set->n_regions; r++) {
        const struct region *region = &set->regions[r];
        if (region->layer != layer || region->n_voxels == 0)
            continue;
        view->n_voxels += region->n_voxels;
        view->n_labels = region->label >= view->n_labels ? (size_t)region->label + 1 : view->n_labels;
        for (int axis = 0; axis < 3; axis++) {
            view->low[axis] = fmin(view->low[axis], region->low_ijk[axis] - 0.5);
            view->high[axis] = fmax(view->high[axis], region->high_ijk[axis] + 0.5);
        }
    }
}

static int by_size(const void *left, const void *right)
{
    const struct layer_view *a = left, *b = right;
    return a->n_voxels == b->n_voxels  ? (a->volume > b->volume) - (a->volume < b->volume)
           : a->n_voxels < b->n_voxels ? 1
                                       : -1;
}

static bool view_layers(const struct region_set *set, struct vec3 point, struct search *search, struct error *err)
{
    search->layers = mem_array(set->n_layers + 1, sizeof *search->layers, UINT64_MAX, err);
    if (!search->layers)
        return false;
    for (size_t layer = 0; layer < set->n_layers; layer++) {
        struct layer_view *view = &search->layers[search->n_layers];
        measure_layer(set, layer, view);
        if (view->n_voxels == 0)
            continue;
        view->volume = set->layers[layer];
        view->is_region = mem_array(view->n_labels, sizeof *view->is_region, UINT64_MAX, err);
        if (!view->is_region)
            return false;
        search->n_layers++;
        for (size_t r = 0; r < set->n_regions; r++)
            if (set->regions[r].layer == layer && set->regions[r].n_voxels > 0)
                view->is_region[set->regions[r].label] = true;
        struct vec3 start = affine_point(&view->volume->grid.ijk_from_lps_mm, point);
        view->start[0] = start.x;
        view->start[1] = start.y;
        view->start[2] = start.z;
    }
    qsort(search->layers, search->n_layers, sizeof *search->layers, by_size);
    return search->n_layers > 0 || error_set(err, ERROR_NOT_FOUND, "no region has a univel");
}

static bool is_region_at(const struct layer_view *view, const int64_t at[3])
{
    const struct grid *grid = &view->volume->grid;
    size_t index = (size_t)at[0] + grid->size[0] * ((size_t)at[1] + (size_t)grid->size[1] * (size_t)at[2]);
    size_t label = view->volume->type == VOXEL_U16 ? ((const uint16_t *)view->volume->voxels)[index]
                                                   : ((const uint8_t *)view->volume->voxels)[index];
    return label < view->n_labels && view->is_region[label];
}

/* ---- one ray ----------------------------------------------------------------------------------------------------- */
/* A direction in each layer's index space. */
static void step_in(const struct layer_view *view, struct vec3 direction, double step[3])
{
    struct vec3 d = affine_vector(&view->volume->grid.ijk_from_lps_mm, direction);
    step[0] = d.x;
    step[1] = d.y;
    step[2] = d.z;
}

static bool has_region_at(const struct layer_view *view, const double step[3], double depth_mm)
{
    int64_t at[3];
    for (int axis = 0; axis < 3; axis++) {
        double p = view->start[axis] + depth_mm * step[axis];
        if (!(p > view->low[axis] && p < view->high[axis]))
            return false;
        at[axis] = (int64_t)(p + 0.5); /* p > -0.5 */
    }
    return is_region_at(view, at);
}

/* The greatest depth above least_mm at which the ray is in a region of the layer; least_mm if there is none. Walks from
 * univel to univel, from outside (J. Amanatides, A. Woo, A fast voxel traversal algorithm, Eurographics 1987). */
static double farthest_in(const struct layer_view *view, const double step[3], double least_mm)
{
    double near = least_mm, far = INFINITY, next[3], between[3];
    int64_t at[3], turn[3], last[3];
    for (int axis = 0; axis < 3; axis++) {
        double a = (view->low[axis] - view->start[axis]) / step[axis],
               b = (view->high[axis] - view->start[axis]) / step[axis];
        if (step[axis] != 0) {
            near = fmax(near, fmin(a, b));
            far = fmin(far, fmax(a, b));
        } else if (!(view->start[axis] > view->low[axis] && view->start[axis] < view->high[axis]))
            return least_mm;
    }
    if (!(near < far))
        return least_mm;
    for (int axis = 0; axis < 3; axis++) {
        double p = view->start[axis] + far * step[axis];
        int64_t low = (int64_t)(view->low[axis] + 0.5), high = (int64_t)(view->high[axis] - 0.5);
        turn[axis] = step[axis] > 0 ? -1 : 1; /* the walk runs against the direction */
        at[axis] = (int64_t)floor(p + 0.5);
        at[axis] = at[axis] < low ? low : at[axis] > high ? high : at[axis];
        last[axis] = turn[axis] > 0 ? high + 1 : low - 1;
        between[axis] = step[axis] != 0 ? 1 / fabs(step[axis]) : 0;
        /* the depth of the face that the walk crosses next */
        next[axis] = step[axis] != 0 ? ((double)at[axis] + 0.5 * (double)turn[axis] - view->start[axis]) / step[axis]
                                     : -INFINITY;
    }
    for (double depth = far; depth > near;) {
        if (is_region_at(view, at))
            return depth;
        int axis = next[0] >= next[1] ? (next[0] >= next[2] ? 0 : 2) : (next[1] >= next[2] ? 1 : 2);
        depth = fmin(depth, next[axis]);
        at[axis] += turn[axis];
        if (at[axis] == last[axis])
            break;
        next[axis] -= between[axis];
    }
    return least_mm;
}

/* The ray's depth if that is below most_mm. Else any larger number; then *blocked_mm is a depth at which the ray is in
 * a region of *blocking, which is tried first for the ray beside it. */
static double depth_of(const struct search *search, struct vec3 direction, double most_mm, size_t *blocking,
                       double *blocked_mm)
{
    double step[3], depth = 0;
    if (*blocked_mm > most_mm) {
        step_in(&search->layers[*blocking], direction, step);
        if (has_region_at(&search->layers[*blocking], step, *blocked_mm))
            return INFINITY;
    }
    for (size_t layer = 0; layer < search->n_layers; layer++) {
        const struct layer_view *view = &search->layers[layer];
        step_in(view, direction, step);
        if (isfinite(most_mm) && has_region_at(view, step, most_mm)) {
            *blocked_mm = 0;
            return INFINITY;
        }
    }
    for (size_t layer = 0; layer < search->n_layers; layer++) {
        const struct layer_view *view = &search->layers[layer];
        step_in(view, direction, step);
        depth = farthest_in(view, step, depth);
        if (!(depth < most_mm)) {
            double voxel = 1 / sqrt(step[0] * step[0] + step[1] * step[1] + step[2] * step[2]);
            *blocking = layer; /* a little inside, where the ray beside it is inside too */
            *blocked_mm = fmax(depth - 1.5 * voxel, most_mm + EQUAL_MM);
            return INFINITY;
        }
    }
    return depth;
}

/* ---- all of them ------------------------------------------------------------------------------------------------- */
static struct vec3 direction_in(size_t face, double u, double v)
{
    double sign = face & 1 ? -1 : 1;
    struct vec3 d = face / 2 == 0 ? vec3(sign, u, v) : face / 2 == 1 ? vec3(v, sign, u) : vec3(u, v, sign);
    return vec3_normalize(d);
}

static struct vec3 direction_of(const struct search *search, uint64_t index)
{
    size_t side = (size_t)search->side;
    return direction_in(index / (side * side), search->tangents[index % side], search->tangents[index / side % side]);
}

/* Takes a way that is shorter; of equal ones the one with the lower index. */
static void take(struct part_of_search *best, double depth_mm, uint64_t index)
{
    double a = floor(depth_mm / EQUAL_MM), b = floor(best->depth_mm / EQUAL_MM);
    if (a < b || (a == b && index < best->index))
        *best = (struct part_of_search){ depth_mm, index };
}

static void search_part(void *context, int part, int n_parts)
{
    const struct search *search = context;
    struct part_of_search *best = &search->found[part];
    uint64_t side = (uint64_t)search->side;
    size_t blocking = 0;
    *best = (struct part_of_search){ search->best_mm, search->best_index };
    for (uint64_t row = (uint64_t)part; row < FACES * side; row += (uint64_t)n_parts) {
        double blocked_mm = 0, v = search->tangents[row % side];
        for (uint64_t column = 0; column < side; column++) {
            double most_mm = best->depth_mm + 2 * EQUAL_MM;
            struct vec3 direction = direction_in(row / side, search->tangents[column], v);
            double depth_mm = depth_of(search, direction, most_mm, &blocking, &blocked_mm);
            if (depth_mm < most_mm)
                take(best, depth_mm, row * side + column);
        }
    }
}

/* Searches the middles of side x side cells a face for a way shorter than the best one. */
static bool search_directions(struct search *search, int side, struct vec3 *outwards, struct error *err)
{
    int n_parts = parallel_cores();
    struct part_of_search best = { search->best_mm, UINT64_MAX };
    search->side = side;
    search->best_index = UINT64_MAX;
    search->tangents = mem_array((size_t)side, sizeof *search->tangents, UINT64_MAX, err);
    search->found = mem_array((size_t)n_parts, sizeof *search->found, UINT64_MAX, err);
    bool is_good = search->tangents && search->found;
    if (is_good) {
        for (int i = 0; i < side; i++)
            search->tangents[i] = tan(((i + 0.5) / side - 0.5) * MATH_PI / 2);
        parallel_run(n_parts, search_part, search);
        for (int part = 0; part < n_parts; part++)
            if (search->found[part].index != UINT64_MAX)
                take(&best, search->found[part].depth_mm, search->found[part].index);
        if (best.index != UINT64_MAX) {
            search->best_mm = best.depth_mm;
            *outwards = direction_of(search, best.index);
        }
    }
    free(search->tangents);
    free(search->found);
    return is_good;
}

/* Looks around the best direction. */
static void refine(struct search *search, struct vec3 *outwards)
{
    const struct vec3 middle = *outwards;
    struct vec3 side = fabs(middle.x) < 0.6 ? vec3(1, 0, 0) : vec3(0, 1, 0);
    struct vec3 u = vec3_normalize(vec3_cross(middle, side)), v = vec3_cross(middle, u);
    double step = MATH_PI / 2 / FINE_SIDE / REFINE;
    size_t blocking = 0;
    for (int a = -REFINE_REACH; a <= REFINE_REACH; a++)
        for (int b = -REFINE_REACH; b <= REFINE_REACH; b++) {
            struct vec3 way =
                vec3_normalize(vec3_add(middle, vec3_add(vec3_scale(u, a * step), vec3_scale(v, b * step))));
            double blocked_mm = 0, depth = depth_of(search, way, search->best_mm - EQUAL_MM, &blocking, &blocked_mm);
            if (!(depth < search->best_mm - EQUAL_MM))
                continue;
            search->best_mm = depth;
            *outwards = way;
        }
}

bool regions_shortest_way(const struct region_set *set, struct vec3 point_lps_mm, struct shortest_way *way,
                          struct error *err)
{
    struct search search = { .best_mm = INFINITY };
    bool is_good = view_layers(set, point_lps_mm, &search, err) &&
                   search_directions(&search, COARSE_SIDE, &way->outwards, err) &&
                   (!(search.best_mm > 0) || search_directions(&search, FINE_SIDE, &way->outwards, err));
    if (is_good && search.best_mm > EQUAL_MM)
        refine(&search, &way->outwards);
    way->depth_mm = search.best_mm;
    for (size_t layer = 0; layer < search.n_layers; layer++)
        free(search.layers[layer].is_region);
    free(search.layers);
    return is_good;
}
