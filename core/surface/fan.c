/* The neighbour fan (see shape_parts.h). First the fan of each voxel is found. Then each voxel collects, from its own
 * fan and its neighbours', the triangles whose lowest corner it is; they are kept as a bit set, so that a triangle of
 * several fans is kept once. */
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/surface/shape_border.h"
#include "core/surface/shape_make.h"
#include "core/surface/shape_parts.h"

enum { AROUND = 27, MIDDLE = 13, AFTER = 13, MAX_FAN = 26, MAX_VOXELS = 5000000 };

struct fan {
    uint8_t from[MAX_FAN], to[MAX_FAN]; /* the two neighbours of each triangle, 0..26 as in shape_border_around */
    uint8_t n;
};

struct fan_job {
    const struct shape_border *border;
    struct fan *fans;           /* [border->n] */
    struct vec3 offset[AROUND]; /* vector to each neighbour, mm */
    uint32_t near[AROUND];      /* bit b: neighbours a and b are neighbours of each other */
    uint32_t *first; /* [border->n] first triangle with this voxel as lowest corner; counts before the running totals */
    /* [border->n] triangles with this voxel as lowest corner: bit b - 14 of with[a - 14] for neighbours a < b.
     * Neighbours are numbered in voxel sequence, so those after a voxel are 14 to 26. */
    uint16_t (*with)[AFTER];
    struct mesh *mesh;
};

static int step_of(int neighbour, int axis)
{
    static const int weight[3] = { 1, 3, 9 };
    return neighbour / weight[axis] % 3 - 1;
}

static bool are_neighbours(int a, int b)
{
    for (int axis = 0; axis < 3; axis++)
        if (abs(step_of(a, axis) - step_of(b, axis)) > 1)
            return false;
    return true;
}

/* ---- one voxel's fan -------------------------------------------------------------------------------------------- */

/* Axis of the fan where the border has no outward normal: the grid axis along which the voxel has the fewest
 * neighbours. */
static struct vec3 thin_axis(const struct fan_job *job, uint32_t around)
{
    int best = 0, fewest = AROUND;
    for (int axis = 0; axis < 3; axis++) {
        int n = 0;
        for (int at = 0; at < AROUND; at++)
            n += (around >> at & 1) && step_of(at, axis) != 0;
        if (n < fewest) {
            fewest = n;
            best = axis;
        }
    }
    const struct vec3 *columns = job->border->mask->lps_mm_from_ijk.columns;
    return vec3_normalize(vec3_cross(columns[(best + 1) % 3], columns[(best + 2) % 3]));
}

/* A monotonic replacement for the angle, counter-clockwise from right, in units of FULL_TURN per turn; cheaper than
 * atan2. Differences up to ROUNDING count as the same angle (neighbours above each other). */
enum { FULL_TURN = 1 << 16, ROUNDING = 2 };

static int32_t turn_of(struct vec3 offset, struct vec3 right_way, struct vec3 up_way)
{
    double right = vec3_dot(offset, right_way), up = vec3_dot(offset, up_way), sum = fabs(right) + fabs(up);
    double part = sum > 1e-5 * vec3_length(offset) ? right / sum : 1; /* directly above: any angle will do */
    up = part < 1 ? up : 0;
    double quarters = up >= 0 ? 1 - part : 3 + part;
    int32_t turn = (int32_t)(quarters * (FULL_TURN / 4) + 0.5);
    return turn < FULL_TURN - ROUNDING ? turn : 0;
}

/* Direction of angle 0: the first neighbour that is not directly above or below along the normal. */
static struct vec3 first_way(const struct fan_job *job, uint32_t around, struct vec3 normal)
{
    for (int at = 0; at < AROUND; at++) {
        struct vec3 offset = job->offset[at], flat = vec3_sub(offset, vec3_scale(normal, vec3_dot(offset, normal)));
        if (at != MIDDLE && (around >> at & 1) && vec3_length(flat) > 1e-3 * vec3_length(offset))
            return vec3_normalize(flat);
    }
    return vec3(0, 0, 0);
}

/* Sorts the neighbours that are border voxels by angle around the normal; equal angles by number. */
static int order_around(const struct fan_job *job, uint32_t around, struct vec3 normal, uint8_t order[MAX_FAN],
                        int32_t turns[MAX_FAN])
{
    struct vec3 right = first_way(job, around, normal), up = vec3_cross(normal, right);
    int n = 0;
    for (int at = 0; at < AROUND; at++) {
        if (at == MIDDLE || !(around >> at & 1))
            continue;
        int32_t turn = turn_of(job->offset[at], right, up);
        int hole = n++;
        for (; hole > 0 && turns[hole - 1] > turn + ROUNDING; hole--) {
            turns[hole] = turns[hole - 1];
            order[hole] = order[hole - 1];
        }
        turns[hole] = turn;
        order[hole] = (uint8_t)at;
    }
    return n;
}

static void make_fan(const struct fan_job *job, size_t number, struct fan *fan)
{
    const struct shape_border *border = job->border;
    const uint16_t *ijk = border->ijk + 3 * number;
    const float *n = border->normals + 3 * number;
    struct vec3 normal = vec3((double)n[0], (double)n[1], (double)n[2]);
    uint32_t around = shape_border_around(border->border, ijk[0], ijk[1], ijk[2]);
    uint8_t order[MAX_FAN];
    int32_t turns[MAX_FAN];
    int count = order_around(job, around, vec3_length(normal) > 0 ? normal : thin_axis(job, around), order, turns);
    fan->n = 0;
    for (int at = 0; at < count; at++) {
        int next = (at + 1) % count, from = order[at], to = order[next];
        int32_t gap = turns[next] - turns[at] + (next == 0 ? FULL_TURN : 0);
        if (gap > FULL_TURN / 2 + ROUNDING || !(job->near[from] >> to & 1)) /* at the edge of a sheet the fan is open */
            continue;
        fan->from[fan->n] = (uint8_t)from;
        fan->to[fan->n++] = (uint8_t)to;
    }
}

static void fan_part(void *context, int part, int n_parts)
{
    struct fan_job *job = context;
    size_t end = job->border->n * (size_t)(part + 1) / (size_t)n_parts;
    for (size_t at = job->border->n * (size_t)part / (size_t)n_parts; at < end; at++)
        make_fan(job, at, &job->fans[at]);
}

/* ---- triangles of all fans -------------------------------------------------------------------------------------- */

/* Adds the triangle with neighbours a and b. */
static void add_triangle(uint16_t with[AFTER], int a, int b)
{
    int low = a < b ? a : b, high = a < b ? b : a;
    with[low - MIDDLE - 1] |= (uint16_t)(1 << (high - MIDDLE - 1));
}

static size_t number_of(const struct shape_border *border, const uint16_t *ijk, int neighbour)
{
    return shape_border_number(border, ijk[0] + step_of(neighbour, 0), ijk[1] + step_of(neighbour, 1),
                               ijk[2] + step_of(neighbour, 2));
}

/* Collects triangles from the voxel's own fan and from the fans of the neighbours after it. */
static void gather(const struct fan_job *job, size_t number, uint16_t with[AFTER])
{
    const struct shape_border *border = job->border;
    const uint16_t *ijk = border->ijk + 3 * number;
    const struct fan *own = &job->fans[number];
    uint32_t around = shape_border_around(border->border, ijk[0], ijk[1], ijk[2]);
    for (int t = 0; t < own->n; t++)
        if (own->from[t] > MIDDLE && own->to[t] > MIDDLE)
            add_triangle(with, own->from[t], own->to[t]);
    for (uint32_t left = around >> (MIDDLE + 1) << (MIDDLE + 1); left; left &= left - 1) {
        int other = __builtin_ctz(left), me = AROUND - 1 - other; /* me: this voxel, as a neighbour of the other */
        const struct fan *fan = &job->fans[number_of(border, ijk, other)];
        for (int t = 0; t < fan->n; t++) {
            if (fan->from[t] != me && fan->to[t] != me)
                continue;
            /* the third corner, as a neighbour of this voxel */
            int third = (fan->from[t] == me ? fan->to[t] : fan->from[t]) + other - MIDDLE;
            if (third > MIDDLE)
                add_triangle(with, other, third);
        }
    }
}

static void count_part(void *context, int part, int n_parts)
{
    struct fan_job *job = context;
    size_t end = job->border->n * (size_t)(part + 1) / (size_t)n_parts;
    for (size_t at = job->border->n * (size_t)part / (size_t)n_parts; at < end; at++) {
        gather(job, at, job->with[at]);
        for (int a = 0; a < AFTER; a++)
            job->first[at] += (uint32_t)__builtin_popcount(job->with[at][a]);
    }
}

static struct vec3 load(const float *at)
{
    return vec3((double)at[0], (double)at[1], (double)at[2]);
}

static struct vec3 centre_of(const struct shape_border *border, uint32_t number)
{
    const uint16_t *ijk = border->ijk + 3 * (size_t)number;
    return affine_point(&border->mask->lps_mm_from_ijk, vec3(ijk[0], ijk[1], ijk[2]));
}

static void write_triangle(const struct shape_border *border, const uint32_t v[3], uint32_t *out)
{
    struct vec3 facing = vec3(0, 0, 0), corner[3];
    for (int c = 0; c < 3; c++) {
        corner[c] = centre_of(border, v[c]);
        facing = vec3_add(facing, load(border->normals + 3 * (size_t)v[c]));
    }
    struct vec3 normal = vec3_cross(vec3_sub(corner[1], corner[0]), vec3_sub(corner[2], corner[0]));
    bool swap = vec3_dot(normal, facing) < 0;
    out[0] = v[0];
    out[1] = v[swap ? 2 : 1];
    out[2] = v[swap ? 1 : 2];
}

static void write_part(void *context, int part, int n_parts)
{
    struct fan_job *job = context;
    size_t end = job->border->n * (size_t)(part + 1) / (size_t)n_parts;
    for (size_t at = job->border->n * (size_t)part / (size_t)n_parts; at < end; at++) {
        const uint16_t *ijk = job->border->ijk + 3 * at, *with = job->with[at];
        uint32_t number[AFTER] = { 0 }; /* numbers of the neighbours that are corners */
        uint16_t corners = 0;
        struct vec3 p = centre_of(job->border, (uint32_t)at);
        uint32_t *out = job->mesh->indices + 3 * (size_t)job->first[at];
        job->mesh->positions_lps_mm[3 * at] = (float)p.x;
        job->mesh->positions_lps_mm[3 * at + 1] = (float)p.y;
        job->mesh->positions_lps_mm[3 * at + 2] = (float)p.z;
        for (int a = 0; a < AFTER; a++)
            corners = (uint16_t)(corners | with[a] | (with[a] != 0) << a);
        for (uint32_t left = corners; left; left &= left - 1)
            number[__builtin_ctz(left)] = (uint32_t)number_of(job->border, ijk, __builtin_ctz(left) + MIDDLE + 1);
        for (int a = 0; a < AFTER; a++)
            for (uint32_t left = with[a]; left; left &= left - 1, out += 3)
                write_triangle(job->border, (uint32_t[3]){ (uint32_t)at, number[a], number[__builtin_ctz(left)] }, out);
    }
}

static bool make_mesh(struct fan_job *job, int n_threads, struct error *err)
{
    size_t n = job->border->n;
    uint64_t total = 0;
    job->first = mem_array(n, sizeof *job->first, UINT64_MAX, err);
    job->with = job->first ? mem_array(n, sizeof *job->with, UINT64_MAX, err) : NULL;
    if (!job->with)
        return false;
    parallel_run(n_threads, count_part, job);
    for (size_t at = 0; at < n; at++) {
        uint32_t count = job->first[at];
        job->first[at] = (uint32_t)total;
        total += count;
    }
    if (total > SHAPE_MAX_TRIANGLES)
        return error_set(err, ERROR_LIMIT, "fans of %llu triangles: at most %d are allowed", (unsigned long long)total,
                         SHAPE_MAX_TRIANGLES);
    job->mesh = mesh_create(n, (size_t)total, err);
    if (!job->mesh)
        return false;
    parallel_run(n_threads, write_part, job);
    mesh_measure_bounds(job->mesh);
    return true;
}

struct mesh *shape_fan(const struct mask *mask, int n_threads, struct error *err)
{
    struct shape_border *border = shape_border_create(mask, MAX_VOXELS, n_threads, err);
    struct fan_job job = { .border = border };
    job.fans = border ? mem_large_array(border->n, sizeof *job.fans, UINT64_MAX, err) : NULL;
    if (job.fans) {
        for (int at = 0; at < AROUND; at++) {
            job.offset[at] =
                affine_vector(&mask->lps_mm_from_ijk, vec3(step_of(at, 0), step_of(at, 1), step_of(at, 2)));
            for (int other = 0; other < AROUND; other++)
                job.near[at] |= (uint32_t)are_neighbours(at, other) << other;
        }
        parallel_run(n_threads, fan_part, &job);
        (void)make_mesh(&job, n_threads, err);
    }
    free(job.first);
    free(job.with);
    free(job.fans);
    shape_border_destroy(border);
    return job.mesh;
}
