/* All twelve regions of a 512 x 512 x 200 volume of labels, smoothed, against vtkDiscreteFlyingEdges3D and
 * vtkWindowedSincPolyDataFilter: the two take turns on the same labels, in one run, and the median of each counts. Both
 * start from the labels. And vertex normals of a surface of 156 thousand polygons, as many as the thesis on Sera3d
 * counts on its head. */
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/base/parallel.h"
#include "core/region/mask_sweep.h"
#include "core/surface/surface.h"
#include "tests/bench/peer.h"

enum { NX = 512, NY = 512, NZ = 200, N_REGIONS = 12, REPEATS = 5, NORMAL_REPEATS = 31 };

static _Noreturn void die(const char *what, const struct error *err)
{
    fprintf(stderr, "bench_smooth: %s: %s\n", what, err ? err->text : "failed");
    exit(1);
}

/* ---- labels: a head that is nested, with neighbours, small things and pieces apart ------------------------------ */

struct ball {
    double x, y, z, rx, ry, rz; /* mm */
};

static bool is_within(const struct ball *ball, double x, double y, double z, double swell)
{
    double u = (x - ball->x) / ball->rx, v = (y - ball->y) / ball->ry, w = (z - ball->z) / ball->rz;
    return u * u + v * v + w * w < swell;
}

static uint8_t label_at(double x, double y, double z)
{
    static const struct ball skin = { 0, 0, 0, 105, 125, 140 }, skull = { 0, 0, 10, 92, 112, 118 },
                             inner = { 0, 0, 10, 84, 104, 110 };
    static const struct ball brain = { 0, 0, 12, 78, 97, 102 }, left = { -14, 0, 20, 9, 34, 22 },
                             right = { 14, 0, 20, 9, 34, 22 };
    static const struct ball target = { 36, -20, 24, 26, 22, 24 }, tumour = { 38, -22, 25, 14, 12, 15 },
                             eye = { -32, -92, -22, 12, 12, 12 };
    static const struct ball other_eye = { 32, -92, -22, 12, 12, 12 }, stem = { 0, 18, -60, 12, 14, 70 },
                             jaw = { 0, -70, -90, 50, 40, 18 };
    /* folds: what is wavy in nature is so by a few per cent here */
    double wave = 1 + 0.05 * sin(x / 5.5 + cos(z / 9)) * cos(y / 6.5) + 0.035 * sin(z / 4.5 + y / 11);
    if (!is_within(&skin, x, y, z, 1 + (wave - 1) * 0.3))
        return 0;
    if (is_within(&eye, x, y, z, 1))
        return 8;
    if (is_within(&other_eye, x, y, z, 1))
        return 9;
    if (is_within(&stem, x, y, z, wave))
        return 10;
    if (is_within(&brain, x, y, z, wave)) {
        if (is_within(&tumour, x, y, z, wave * wave))
            return 7;
        if (is_within(&target, x, y, z, wave * wave))
            return 6;
        if (is_within(&left, x, y, z, wave) || is_within(&right, x, y, z, wave))
            return 5;
        double u = fmod(x + 200, 34) - 17, v = fmod(y + 200, 41) - 20,
               w = fmod(z + 200, 37) - 18; /* lesions, each a piece of its own */
        return u * u + v * v + w * w < 9 ? 12 : 4;
    }
    if (is_within(&inner, x, y, z, wave))
        return 3;
    if (is_within(&skull, x, y, z, wave))
        return 2;
    return is_within(&jaw, x, y, z, wave) ? 11 : 1;
}

static struct volume *make_labels(void)
{
    struct error err = { 0 };
    struct affine map = { { { 0.6, 0, 0 }, { 0, 0.6, 0 }, { 0, 0, 1.5 } }, { -0.3 * NX, -0.3 * NY, -0.75 * NZ } };
    struct grid grid;
    if (!grid_init(&grid, (const uint32_t[3]){ NX, NY, NZ }, &map, &err))
        die("grid", &err);
    struct volume *labels = volume_create(&grid, VOXEL_U8, &err);
    if (!labels)
        die("labels", &err);
    uint8_t *voxel = labels->voxels;
    for (uint32_t k = 0; k < NZ; k++)
        for (uint32_t j = 0; j < NY; j++)
            for (uint32_t i = 0; i < NX; i++)
                *voxel++ = label_at(map.origin.x + 0.6 * i, map.origin.y + 0.6 * j, map.origin.z + 1.5 * k);
    return labels;
}

/* ---- VTK -------------------------------------------------------------------------------------------------------- */

struct vtk {
    struct peer peer;
    char path[PEER_PATH_SIZE], name[128];
};

static bool vtk_start(struct vtk *vtk, const struct volume *labels)
{
    char size[4][16], line[64], version[16];
    const int numbers[4] = { NX, NY, NZ, N_REGIONS };
    int n_threads;
    if (!peer_write_file(vtk->path, labels->voxels, grid_n_voxels(&labels->grid)))
        die("temporary file", NULL);
    for (int i = 0; i < 4; i++)
        snprintf(size[i], sizeof size[i], "%d", numbers[i]);
    const char *arguments[] = {
        peer_python(), "tests/bench/vtk_smooth.py", vtk->path, size[0], size[1], size[2], size[3], NULL
    };
    if (!peer_start(&vtk->peer, arguments, line, sizeof line) || sscanf(line, "%15s %d", version, &n_threads) != 2)
        return false;
    snprintf(vtk->name, sizeof vtk->name, "VTK %s, discrete flying edges and windowed sinc, %d threads", version,
             n_threads);
    return true;
}

struct vtk_times { /* ms */
    double extract, smooth;
    double processor; /* of all threads */
};

static struct vtk_times vtk_run(struct vtk *vtk, size_t n_triangles)
{
    char line[128];
    struct vtk_times times;
    size_t n_theirs;
    if (!peer_ask(&vtk->peer, "\n", line, sizeof line) ||
        sscanf(line, "%lf %lf %lf %zu", &times.extract, &times.smooth, &times.processor, &n_theirs) != 4)
        die("the VTK side", NULL);
    if (n_theirs != n_triangles)
        die("not the same number of triangles as VTK", NULL);
    return times;
}

/* ---- ours ------------------------------------------------------------------------------------------------------- */

struct times {           /* ms */
    double mask, smooth; /* smooth: from the labels on, masks included, to vertices with normals */
    double processor;    /* of all threads */
};

static double since_ms(int64_t *began_us)
{
    int64_t now_us = clock_now_us();
    double ms = (double)(now_us - *began_us) / 1e3;
    *began_us = now_us;
    return ms;
}

static double processor_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec * 1e3 + (double)now.tv_nsec / 1e6;
}

/* All regions at once: their masks from one sweep, then threads take one after the other, the largest first, each on
 * its own, as a plan does when it is opened. */
struct task {
    struct mask *masks[N_REGIONS];
    bool is_bare;                   /* without normals */
    struct mesh *meshes[N_REGIONS]; /* kept to the end, as a plan keeps them, and VTK does */
    atomic_int next;
};

static void take_regions(void *context, int part, int n_parts)
{
    struct task *task = context;
    struct error err = { 0 };
    struct surface_options options = surface_defaults;
    options.n_threads = 1;
    options.without_normals = task->is_bare;
    (void)part;
    (void)n_parts;
    for (int at; (at = atomic_fetch_add(&task->next, 1)) < N_REGIONS;) {
        task->meshes[at] = surface_smooth(task->masks[at], &options, &err);
        if (!task->meshes[at])
            die("surface", &err);
        mask_destroy(task->masks[at]);
    }
}

static struct times run_once(struct volume *labels, int n_threads, bool is_bare, size_t *n_triangles)
{
    static const uint16_t by_size[N_REGIONS] = { 1, 2, 3, 4, 10, 12, 11, 6, 5, 7, 8, 9 };
    struct region regions[N_REGIONS];
    struct mask_wish wishes[N_REGIONS];
    for (size_t r = 0; r < N_REGIONS; r++) {
        regions[r] = (struct region){ .parent = -1, .label = by_size[r] };
        wishes[r] = (struct mask_wish){ r, false };
    }
    const struct region_set set = { .layers = { labels }, .n_layers = 1, .regions = regions, .n_regions = N_REGIONS };
    struct task task = { .is_bare = is_bare };
    struct times times = { .processor = processor_ms() };
    struct error err = { 0 };
    int64_t began_us = clock_now_us();
    if (!mask_sweep(&set, wishes, N_REGIONS, n_threads, task.masks, &err))
        die("masks", &err);
    times.mask = since_ms(&began_us);
    atomic_init(&task.next, 0);
    parallel_run(n_threads, take_regions, &task);
    times.smooth = times.mask + since_ms(&began_us);
    times.processor = processor_ms() - times.processor;
    *n_triangles = 0;
    for (int r = 0; r < N_REGIONS; r++) {
        *n_triangles += task.meshes[r]->n_triangles;
        mesh_unref(task.meshes[r]);
    }
    return times;
}

static int compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *values, size_t n)
{
    qsort(values, n, sizeof *values, compare_doubles);
    return values[n / 2];
}

static void bench_regions(struct volume *labels, struct vtk *vtk)
{
    /* as VTK does it; and with the normals that a picture needs */
    static const char *const ways[3] = { "without normals, 2 threads", "with vertex normals, 1 thread",
                                         "with vertex normals, 2 threads" };
    enum { N_WAYS = sizeof ways / sizeof *ways };
    double ours[N_WAYS][REPEATS], mask[N_WAYS][REPEATS], processor[N_WAYS][REPEATS];
    double theirs[REPEATS], their_extract[REPEATS], their_processor[REPEATS];
    size_t n_triangles = 0;
    for (int repeat = -1; repeat < REPEATS; repeat++) { /* the first warms up and does not count */
        int at = repeat < 0 ? 0 : repeat;
        for (int way = 0; way < N_WAYS; way++) {
            struct times times = run_once(labels, way == 1 ? 1 : 2, way == 0, &n_triangles);
            mask[way][at] = times.mask;
            ours[way][at] = times.smooth;
            processor[way][at] = times.processor;
        }
        if (!vtk)
            continue;
        struct vtk_times times = vtk_run(vtk, n_triangles);
        theirs[at] = times.extract + times.smooth;
        their_extract[at] = times.extract;
        their_processor[at] = times.processor;
    }
    double vtk_ms = vtk ? median(theirs, REPEATS) : 0, vtk_extract = vtk ? median(their_extract, REPEATS) : 0;
    double vtk_processor = vtk ? median(their_processor, REPEATS) : 0;
    for (int way = 0; way < N_WAYS; way++) {
        double ms = median(ours[way], REPEATS), busy = median(processor[way], REPEATS);
        printf("{\"name\":\"12 regions of 512 x 512 x 200, smooth, %s\",\"value\":%.1f,\"unit\":\"ms\"", ways[way], ms);
        if (vtk)
            printf(",\"peer\":\"%s\",\"peer_value\":%.1f,\"ratio\":%.2f", vtk->name, vtk_ms, vtk_ms / ms);
        printf(",\"note\":\"%zu triangles; masks %.1f of it%s; processor time %.0f", n_triangles,
               median(mask[way], REPEATS), way == 0 ? "; at least x5 asked for" : "", busy);
        if (vtk)
            printf(", theirs %.0f, x%.2f; theirs: flying edges %.1f of it", vtk_processor, vtk_processor / busy,
                   vtk_extract);
        printf("\"}\n");
    }
    fflush(stdout);
}

/* A ball whose surface has as many polygons as the thesis' head: labels to triangles with vertex normals. */
static void bench_thesis(void)
{
    struct error err = { 0 };
    struct grid grid;
    struct affine map = { { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, { 0, 0, 0 } };
    enum { SIDE = 144 };
    if (!grid_init(&grid, (const uint32_t[3]){ SIDE, SIDE, SIDE }, &map, &err))
        die("grid", &err);
    struct volume *labels = volume_create(&grid, VOXEL_U8, &err);
    if (!labels)
        die("labels", &err);
    uint8_t *voxel = labels->voxels;
    for (int at = 0; at < SIDE * SIDE * SIDE; at++) {
        double x = at % SIDE - 71.5, y = at / SIDE % SIDE - 71.5, z = at / (SIDE * SIDE) - 71.5;
        *voxel++ = x * x + y * y + z * z < 64.4 * 64.4;
    }
    struct surface_options options = surface_defaults;
    options.n_threads = 2;
    static const enum surface_algorithm algorithms[] = { SURFACE_MARCHING_CUBES, SURFACE_SMOOTH };
    for (int a = 0; a < 2; a++) {
        double ms[NORMAL_REPEATS];
        size_t n = 0;
        for (int repeat = 0; repeat < NORMAL_REPEATS; repeat++) {
            int64_t began_us = clock_now_us();
            struct mask *mask = mask_from_labels(labels, (const uint16_t[]){ 1 }, 1, 2, &err);
            struct mesh *mesh = mask ? surface_make(algorithms[a], mask, &options, &err) : NULL;
            if (!mesh || (!mesh->normals && !mesh_make_normals(mesh, 2, &err)))
                die("surface", &err);
            ms[repeat] = since_ms(&began_us);
            n = mesh->n_triangles;
            mesh_unref(mesh);
            mask_destroy(mask);
        }
        printf(
            "{\"name\":\"156 thousand polygons with vertex normals, %s\",\"value\":%.2f,\"unit\":\"ms\",\"note\":\"%zu triangles, 2 threads, from labels; "
            "%s\"}\n",
            surface_algorithm_word(algorithms[a]), median(ms, NORMAL_REPEATS), n,
            a ? "smoothed too" : "the thesis: 5300; at most 5.3 asked for");
    }
    volume_unref(labels);
}

int main(void)
{
    struct volume *labels = make_labels();
    struct vtk vtk;
    bool has_vtk = vtk_start(&vtk, labels);
    if (!has_vtk)
        fprintf(stderr, "bench_smooth: no VTK for Python here: our times only\n");
    bench_regions(labels, has_vtk ? &vtk : NULL);
    bench_thesis();
    (void)peer_end(&vtk.peer);
    unlink(vtk.path);
    volume_unref(labels);
    return 0;
}
