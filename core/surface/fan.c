/* The neighbour fan (see shape_parts.h). Fans are found by threads, each for its own voxels; then every triangle goes to its corner
 * with the lowest number, where equal ones are found among the few that a voxel can have. */
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/surface/shape_border.h"
#include "core/surface/shape_make.h"
#include "core/surface/shape_parts.h"

enum { AROUND = 27, MIDDLE = 13, MAX_FAN = 26, MAX_VOXELS = 5000000, MAX_ALL = 60000000 };

struct fan {
    uint8_t from[MAX_FAN], to[MAX_FAN]; /* of each triangle the two neighbours, 0..26 as in shape_border_around */
    uint8_t n;
};

struct job {
    const struct shape_border *border;
    struct fan *fans;           /* [border->n] */
    struct vec3 offset[AROUND]; /* to each neighbour, mm */
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

/* ---- one voxel's fan ------------------------------------------------------------------------------------------------------ */

/* What the fan turns around when no side is more outward than another: the grid's axis along which it has the fewest neighbours. */
static struct vec3 thin_axis(const struct job *job, uint32_t around)
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

/* Grows with the angle from right, counter-clockwise, by half a turn to the direction opposite: what an angle is needed for here,
 * without its cost. What differs by no more than ROUNDING is the same angle: neighbours that stand one above the other. */
enum { FULL_TURN = 1 << 16, ROUNDING = 2 };

static int32_t turn_of(struct vec3 offset, struct vec3 right_way, struct vec3 up_way)
{
    double right = vec3_dot(offset, right_way), up = vec3_dot(offset, up_way), sum = fabs(right) + fabs(up);
    double part = sum > 1e-5 * vec3_length(offset) ? right / sum : 1; /* straight above: as good as any */
    up = part < 1 ? up : 0;
    double quarters = up >= 0 ? 1 - part : 3 + part;
    int32_t turn = (int32_t)(quarters * (FULL_TURN / 4) + 0.5);
    return turn < FULL_TURN - ROUNDING ? turn : 0;
}

/* Where angles are counted from: the first neighbour that does not lie straight above or below. */
static struct vec3 first_way(const struct job *job, uint32_t around, struct vec3 normal)
{
    for (int at = 0; at < AROUND; at++) {
        struct vec3 offset = job->offset[at], flat = vec3_sub(offset, vec3_scale(normal, vec3_dot(offset, normal)));
        if (at != MIDDLE && (around >> at & 1) && vec3_length(flat) > 1e-3 * vec3_length(offset))
            return vec3_normalize(flat);
    }
    return vec3(0, 0, 0);
}

/* Neighbours that are border voxels, by their angle around the normal; equal angles by their number. */
static int order_around(const struct job *job, uint32_t around, struct vec3 normal, uint8_t order[MAX_FAN], int32_t turns[MAX_FAN])
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

static void make_fan(const struct job *job, size_t number, struct fan *fan)
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
        if (gap > FULL_TURN / 2 + ROUNDING || !are_neighbours(from, to)) /* at the edge of a sheet the fan is open */
            continue;
        fan->from[fan->n] = (uint8_t)from;
        fan->to[fan->n++] = (uint8_t)to;
    }
}

static void fan_part(void *context, int part, int n_parts)
{
    struct job *job = context;
    size_t end = job->border->n * (size_t)(part + 1) / (size_t)n_parts;
    for (size_t at = job->border->n * (size_t)part / (size_t)n_parts; at < end; at++)
        make_fan(job, at, &job->fans[at]);
}

/* ---- all of them ---------------------------------------------------------------------------------------------------------- */

struct triangles {
    uint32_t *first;    /* [n + 1] of each voxel, those whose lowest corner it is */
    uint32_t (*ends)[2]; /* the two other corners, ascending */
};

static size_t neighbour_number(const struct shape_border *border, size_t number, int neighbour)
{
    const uint16_t *ijk = border->ijk + 3 * number;
    return shape_border_number(border, ijk[0] + step_of(neighbour, 0), ijk[1] + step_of(neighbour, 1), ijk[2] + step_of(neighbour, 2));
}

static void sort_three(uint32_t v[3])
{
    for (int a = 0; a < 2; a++)
        for (int b = 0; b < 2 - a; b++)
            if (v[b] > v[b + 1]) {
                uint32_t swap = v[b];
                v[b] = v[b + 1];
                v[b + 1] = swap;
            }
}

/* Every triangle of every fan: counted with its lowest corner, or put there. */
static void deal_out(const struct job *job, struct triangles *all, bool is_counting)
{
    const struct shape_border *border = job->border;
    for (size_t at = 0; at < border->n; at++) {
        const struct fan *fan = &job->fans[at];
        size_t numbers[AROUND];
        uint32_t known = 0;
        for (int t = 0; t < 2 * fan->n; t++) {
            int neighbour = t % 2 ? fan->to[t / 2] : fan->from[t / 2];
            if (!(known >> neighbour & 1))
                numbers[neighbour] = neighbour_number(border, at, neighbour);
            known |= (uint32_t)1 << neighbour;
        }
        for (int t = 0; t < fan->n; t++) {
            uint32_t v[3] = { (uint32_t)at, (uint32_t)numbers[fan->from[t]], (uint32_t)numbers[fan->to[t]] };
            sort_three(v);
            if (is_counting) {
                all->first[v[0] + 2]++;
                continue;
            }
            uint32_t place = all->first[v[0] + 1]++;
            all->ends[place][0] = v[1];
            all->ends[place][1] = v[2];
        }
    }
}

/* Sorted, each once; returns how many. */
static uint32_t keep_once(uint32_t (*ends)[2], uint32_t n)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < n; i++) {
        uint32_t a = ends[i][0], b = ends[i][1], hole = kept;
        while (hole > 0 && (ends[hole - 1][0] > a || (ends[hole - 1][0] == a && ends[hole - 1][1] > b)))
            hole--;
        if (hole > 0 && ends[hole - 1][0] == a && ends[hole - 1][1] == b)
            continue;
        for (uint32_t move = kept++; move > hole; move--) {
            ends[move][0] = ends[move - 1][0];
            ends[move][1] = ends[move - 1][1];
        }
        ends[hole][0] = a;
        ends[hole][1] = b;
    }
    return kept;
}

static struct vec3 load(const float *at)
{
    return vec3((double)at[0], (double)at[1], (double)at[2]);
}

static void write_mesh(const struct job *job, const struct triangles *all, const uint32_t *kept, struct mesh *mesh)
{
    const struct shape_border *border = job->border;
    for (size_t at = 0; at < border->n; at++) {
        const uint16_t *ijk = border->ijk + 3 * at;
        struct vec3 p = affine_point(&border->mask->lps_mm_from_ijk, vec3(ijk[0], ijk[1], ijk[2]));
        mesh->positions_lps_mm[3 * at] = (float)p.x;
        mesh->positions_lps_mm[3 * at + 1] = (float)p.y;
        mesh->positions_lps_mm[3 * at + 2] = (float)p.z;
    }
    uint32_t *out = mesh->indices;
    for (uint32_t at = 0; at < border->n; at++)
        for (uint32_t t = all->first[at]; t < all->first[at] + kept[at]; t++) {
            uint32_t v[3] = { at, all->ends[t][0], all->ends[t][1] };
            struct vec3 facing = vec3(0, 0, 0), corner[3];
            for (int c = 0; c < 3; c++) {
                corner[c] = load(mesh->positions_lps_mm + 3 * (size_t)v[c]);
                facing = vec3_add(facing, load(border->normals + 3 * (size_t)v[c]));
            }
            struct vec3 normal = vec3_cross(vec3_sub(corner[1], corner[0]), vec3_sub(corner[2], corner[0]));
            bool swap = vec3_dot(normal, facing) < 0;
            *out++ = v[0];
            *out++ = v[swap ? 2 : 1];
            *out++ = v[swap ? 1 : 2];
        }
}

static struct mesh *join(const struct job *job, struct error *err)
{
    size_t n = job->border->n;
    uint64_t n_all = 0, n_kept = 0;
    for (size_t at = 0; at < n; at++)
        n_all += job->fans[at].n;
    if (n_all > MAX_ALL) {
        error_set(err, ERROR_LIMIT, "fans of %llu triangles, some of them in several: at most %d are allowed", (unsigned long long)n_all,
                  MAX_ALL);
        return NULL;
    }
    struct mesh *mesh = NULL;
    struct triangles all = { .first = mem_array(n + 2, sizeof *all.first, UINT64_MAX, err) };
    all.ends = all.first ? mem_array((size_t)n_all, sizeof *all.ends, UINT64_MAX, err) : NULL;
    uint32_t *kept = all.ends ? mem_array(n, sizeof *kept, UINT64_MAX, err) : NULL;
    if (kept) {
        deal_out(job, &all, true);
        for (size_t at = 0; at < n; at++)
            all.first[at + 2] += all.first[at + 1];
        deal_out(job, &all, false);
        for (size_t at = 0; at < n; at++) {
            kept[at] = keep_once(all.ends + all.first[at], all.first[at + 1] - all.first[at]);
            n_kept += kept[at];
        }
        if (n_kept > SHAPE_MAX_TRIANGLES)
            error_set(err, ERROR_LIMIT, "fans of %llu triangles: at most %d are allowed", (unsigned long long)n_kept, SHAPE_MAX_TRIANGLES);
        else
            mesh = mesh_create(n, (size_t)n_kept, err);
    }
    if (mesh) {
        write_mesh(job, &all, kept, mesh);
        mesh_measure_bounds(mesh);
    }
    free(kept);
    free(all.ends);
    free(all.first);
    return mesh;
}

struct mesh *shape_fan(const struct mask *mask, int n_threads, struct error *err)
{
    struct shape_border *border = shape_border_create(mask, MAX_VOXELS, n_threads, err);
    struct job job = { .border = border };
    struct mesh *mesh = NULL;
    job.fans = border ? mem_large_array(border->n, sizeof *job.fans, UINT64_MAX, err) : NULL;
    if (job.fans) {
        for (int at = 0; at < AROUND; at++)
            job.offset[at] = affine_vector(&mask->lps_mm_from_ijk, vec3(step_of(at, 0), step_of(at, 1), step_of(at, 2)));
        parallel_run(n_threads, fan_part, &job);
        mesh = join(&job, err);
    }
    free(job.fans);
    shape_border_destroy(border);
    return mesh;
}
