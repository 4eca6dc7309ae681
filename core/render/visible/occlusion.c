/* Finds the horizon around each pixel of a still in the depths of the others, and darkens the pixel by it. */
#include "core/render/visible/occlusion.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"

/* PATTERNS: of points around a pixel, each turned against the others; neighbours in a square of PATTERN_SIDE have
 * different ones, and their results are averaged. */
enum { N_POINTS = 96, N_AZIMUTHS = 12, PATTERN_SIDE = 4, N_PATTERNS = PATTERN_SIDE * PATTERN_SIDE, ROWS = 16 };
/* A horizon lower than this (sine) is the surface's own: voxels and triangles are not smooth. */
static const float own_horizon = 0.12f;

struct point {
    float x, y, z; /* in patient space */
};

struct job {
    struct image *image;
    const float *depth;
    const struct camera *camera;
    float radius_mm;
    double px_per_mm_at_1; /* of a point: pixels per mm, times its w */
    struct point *places;  /* [n_pixels]; x is not a number where there is nothing */
    float *light;          /* [n_pixels] v; 1: not darkened */
    float pattern[N_PATTERNS][N_POINTS][2];
    void (*row)(const struct job *job, int y);
    atomic_int next;
};

static bool is_there(const struct point *p)
{
    return p->x == p->x;
}

static struct point minus(const struct point *a, const struct point *b)
{
    return (struct point){ a->x - b->x, a->y - b->y, a->z - b->z };
}

static float dot(const struct point *a, const struct point *b)
{
    return a->x * b->x + a->y * b->y + a->z * b->z;
}

static struct point cross(const struct point *a, const struct point *b)
{
    return (struct point){ a->y * b->z - a->z * b->y, a->z * b->x - a->x * b->z, a->x * b->y - a->y * b->x };
}

static struct point scaled(const struct point *a, float by)
{
    return (struct point){ a->x * by, a->y * by, a->z * by };
}

/* ---- passes over rows ------------------------------------------------------------------------------------------- */

static void place_row(const struct job *job, int y)
{
    const int width = job->image->width_px, height = job->image->height_px;
    for (int x = 0; x < width; x++) {
        size_t at = (size_t)y * (size_t)width + (size_t)x;
        float depth = fabsf(job->depth[at]);
        struct vec3 p =
            mat4_project(&job->camera->lps_mm_from_clip,
                         vec3(2 * (x + 0.5) / width - 1, 1 - 2 * (y + 0.5) / height, 2 * (double)depth - 1));
        job->places[at] =
            depth < 1 ? (struct point){ (float)p.x, (float)p.y, (float)p.z } : (struct point){ NAN, 0, 0 };
    }
}

/* The way from the pixel to its neighbour on the side where the surface goes on, along x or y. */
static bool find_tangent(const struct job *job, int x, int y, bool is_along_x, struct point *tangent)
{
    const int width = job->image->width_px, step = is_along_x ? 1 : width;
    const int at = y * width + x, last = is_along_x ? width - 1 : job->image->height_px - 1, i = is_along_x ? x : y;
    const struct point *here = &job->places[at];
    bool has[2] = { i > 0 && is_there(&job->places[at - step]), i < last && is_there(&job->places[at + step]) };
    struct point ways[2] = { { 0 } };
    if (has[0])
        ways[0] = minus(here, &job->places[at - step]);
    if (has[1])
        ways[1] = minus(&job->places[at + step], here);
    if (!has[0] && !has[1])
        return false;
    bool is_second = !has[0] || (has[1] && dot(&ways[1], &ways[1]) < dot(&ways[0], &ways[0]));
    *tangent = ways[is_second];
    return true;
}

/* Axes of the surface at a pixel: two in it, and its normal towards the viewer. */
static bool find_axes(const struct job *job, int x, int y, struct point axes[3])
{
    struct point right, down;
    if (!find_tangent(job, x, y, true, &right) || !find_tangent(job, x, y, false, &down))
        return false;
    struct point normal = cross(&down, &right);
    float size = sqrtf(dot(&normal, &normal)), along = sqrtf(dot(&right, &right));
    if (!(size > 0) || !(along > 0))
        return false;
    axes[2] = scaled(&normal, 1 / size);
    const struct camera *camera = job->camera;
    const struct point *p = &job->places[y * job->image->width_px + x];
    struct point towards = { (float)-camera->forward.x, (float)-camera->forward.y, (float)-camera->forward.z };
    if (!camera->is_parallel)
        towards = (struct point){ (float)camera->eye_lps_mm.x - p->x, (float)camera->eye_lps_mm.y - p->y,
                                  (float)camera->eye_lps_mm.z - p->z };
    if (dot(&axes[2], &towards) < 0)
        axes[2] = scaled(&axes[2], -1);
    axes[0] = scaled(&right, 1 / along);
    axes[1] = cross(&axes[2], &axes[0]);
    return true;
}

/* The part of the light that reaches a pixel. */
static float light_at(const struct job *job, int x, int y)
{
    const int width = job->image->width_px, height = job->image->height_px;
    const struct point *here = &job->places[y * width + x];
    struct point axes[3];
    if (!find_axes(job, x, y, axes))
        return 1;
    const double *m = job->camera->clip_from_lps_mm.m;
    double w = m[3] * (double)here->x + m[7] * (double)here->y + m[11] * (double)here->z + m[15];
    const float reach_px = (float)(job->px_per_mm_at_1 / w) * job->radius_mm;
    const float radius_squared = job->radius_mm * job->radius_mm;
    const float(*pattern)[2] = job->pattern[(y % PATTERN_SIDE) * PATTERN_SIDE + x % PATTERN_SIDE];
    float horizon[N_AZIMUTHS] = { 0 }; /* sine, squared */
    for (int i = 0; i < N_POINTS; i++) {
        int px = x + (int)lrintf(pattern[i][0] * reach_px), py = y + (int)lrintf(pattern[i][1] * reach_px);
        if (px < 0 || py < 0 || px >= width || py >= height)
            continue;
        const struct point *there = &job->places[py * width + px];
        struct point way = minus(there, here);
        float squared = dot(&way, &way), above = dot(&way, &axes[2]);
        if (!(squared < radius_squared) || !(above > 0) || above * above < own_horizon * own_horizon * squared)
            continue;
        float azimuth = atan2f(dot(&way, &axes[1]), dot(&way, &axes[0])) / 6.2831855f + 0.5f;
        int bin = (int)(azimuth * N_AZIMUTHS) % N_AZIMUTHS;
        horizon[bin] = fmaxf(horizon[bin], above * above / squared);
    }
    float sum = 0;
    for (int i = 0; i < N_AZIMUTHS; i++)
        sum += horizon[i];
    return 1 - sum / N_AZIMUTHS;
}

static void light_row(const struct job *job, int y)
{
    const int width = job->image->width_px;
    for (int x = 0; x < width; x++) {
        float depth = job->depth[y * width + x];
        job->light[y * width + x] = depth >= 0 && depth < 1 ? light_at(job, x, y) : 1;
    }
}

/* Averages over the neighbours with the other patterns, as far as they lie on the same surface. */
static void darken_row(const struct job *job, int y)
{
    const int width = job->image->width_px, height = job->image->height_px;
    for (int x = 0; x < width; x++) {
        const int at = y * width + x;
        const struct point *here = &job->places[at];
        if (!(job->depth[at] >= 0) || !(job->depth[at] < 1))
            continue;
        float sum = 0, most = job->radius_mm / 4;
        int n = 0;
        for (int dy = -PATTERN_SIDE / 2; dy < PATTERN_SIDE / 2; dy++)
            for (int dx = -PATTERN_SIDE / 2; dx < PATTERN_SIDE / 2; dx++) {
                int px = x + dx, py = y + dy, other = py * width + px;
                if (px < 0 || py < 0 || px >= width || py >= height || !(job->depth[other] >= 0))
                    continue;
                struct point way = minus(&job->places[other], here);
                if (!(dot(&way, &way) < most * most))
                    continue;
                sum += job->light[other];
                n++;
            }
        if (n == 0)
            continue;
        float factor = 1 - (1 - (float)OCCLUSION_DARKEST) * (1 - sum / (float)n);
        uint8_t *rgba = job->image->rgba + 4 * (size_t)at;
        for (int c = 0; c < 3; c++)
            rgba[c] = (uint8_t)lrintf((float)rgba[c] * factor);
    }
}

/* ---- all -------------------------------------------------------------------------------------------------------- */

static void run_rows(void *context, int part, int n_parts)
{
    struct job *job = context;
    (void)part, (void)n_parts;
    for (int first; (first = atomic_fetch_add(&job->next, ROWS)) < job->image->height_px;)
        for (int y = first; y < first + ROWS && y < job->image->height_px; y++)
            job->row(job, y);
}

static void run(struct job *job, void (*row)(const struct job *job, int y))
{
    job->row = row;
    atomic_store(&job->next, 0);
    parallel_run(parallel_cores(), run_rows, job);
}

/* Points of equal density on a disc (Vogel's spiral), turned by a different angle for each pattern. */
static void make_pattern(struct job *job)
{
    const double golden_angle = 2.399963229728653;
    for (int k = 0; k < N_PATTERNS; k++)
        for (int i = 0; i < N_POINTS; i++) {
            /* 7 and 16 have no common divisor: neighbours are turned far */
            double angle = i * golden_angle + 7 * k % N_PATTERNS * 2 * MATH_PI / N_PATTERNS;
            double r = sqrt((i + 0.5 + 0.5 * k / N_PATTERNS) / N_POINTS);
            job->pattern[k][i][0] = (float)(r * cos(angle));
            job->pattern[k][i][1] = (float)(r * sin(angle));
        }
}

bool occlusion_darken(struct image *image, const float *depth, const struct camera *camera, double radius_mm,
                      struct error *err)
{
    size_t n = (size_t)image->width_px * (size_t)image->height_px;
    struct job *job = mem_new(sizeof *job);
    *job = (struct job){ .image = image, .depth = depth, .camera = camera, .radius_mm = (float)radius_mm };
    job->places = mem_array(n, sizeof *job->places, UINT64_MAX, err);
    job->light = job->places ? mem_array(n, sizeof *job->light, UINT64_MAX, err) : NULL;
    bool is_good = job->light != NULL;
    if (is_good) {
        /* clip x changes by the length of the first row of the matrix for 1 mm to the right, over w */
        const double *m = camera->clip_from_lps_mm.m;
        job->px_per_mm_at_1 = vec3_length(vec3(m[0], m[4], m[8])) * image->width_px / 2;
        make_pattern(job);
        run(job, place_row);
        run(job, light_row);
        run(job, darken_row);
    }
    free(job->places);
    free(job->light);
    free(job);
    return is_good;
}
