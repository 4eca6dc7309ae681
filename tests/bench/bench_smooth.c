/* All twelve regions of a 512 x 512 x 200 volume of labels, smoothed, against vtkDiscreteFlyingEdges3D and
 * vtkWindowedSincPolyDataFilter: the two take turns on the same labels, in one run, and the median of each counts. Both start from the
 * labels. And vertex normals of a surface of 156 thousand polygons, as many as the thesis on Sera3d counts on its head. */
#include <math.h>
#include <spawn.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/base/parallel.h"
#include "core/region/mask.h"
#include "core/surface/surface.h"

enum { NX = 512, NY = 512, NZ = 200, N_REGIONS = 12, REPEATS = 5, NORMAL_REPEATS = 31 };

extern char **environ;

static _Noreturn void die(const char *what, const struct error *err)
{
    fprintf(stderr, "bench_smooth: %s: %s\n", what, err ? err->text : "failed");
    exit(1);
}

/* ---- labels: a head that is nested, with neighbours, small things and pieces apart ---------------------------------------- */

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
    static const struct ball skin = { 0, 0, 0, 105, 125, 140 }, skull = { 0, 0, 10, 92, 112, 118 }, inner = { 0, 0, 10, 84, 104, 110 };
    static const struct ball brain = { 0, 0, 12, 78, 97, 102 }, left = { -14, 0, 20, 9, 34, 22 }, right = { 14, 0, 20, 9, 34, 22 };
    static const struct ball target = { 36, -20, 24, 26, 22, 24 }, tumour = { 38, -22, 25, 14, 12, 15 }, eye = { -32, -92, -22, 12, 12, 12 };
    static const struct ball other_eye = { 32, -92, -22, 12, 12, 12 }, stem = { 0, 18, -60, 12, 14, 70 }, jaw = { 0, -70, -90, 50, 40, 18 };
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
        double u = fmod(x + 200, 34) - 17, v = fmod(y + 200, 41) - 20, w = fmod(z + 200, 37) - 18; /* lesions, each a piece of its own */
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

/* ---- VTK ------------------------------------------------------------------------------------------------------------------ */

struct peer {
    pid_t pid;
    FILE *to, *from;
    char name[128];
};

static bool peer_start(struct peer *peer, const struct volume *labels, char *path)
{
    int file = mkstemp(path), in[2], out[2];
    size_t n = grid_n_voxels(&labels->grid);
    FILE *copy = file < 0 ? NULL : fdopen(file, "w");
    if (!copy || fwrite(labels->voxels, 1, n, copy) != n || fclose(copy) != 0 || pipe(in) != 0 || pipe(out) != 0)
        die("temporary file or pipe", NULL);
    char *python = getenv("PYTHON") ? getenv("PYTHON") : (char[]){ "/usr/bin/python3" }, size[4][16];
    char *arguments[] = { python, "tests/bench/vtk_smooth.py", path, size[0], size[1], size[2], size[3], NULL };
    const int numbers[4] = { NX, NY, NZ, N_REGIONS };
    for (int i = 0; i < 4; i++)
        snprintf(size[i], sizeof size[i], "%d", numbers[i]);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, in[0], STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, out[1], STDOUT_FILENO);
    posix_spawn_file_actions_addclose(&actions, in[1]);
    posix_spawn_file_actions_addclose(&actions, out[0]);
    int failed = posix_spawnp(&peer->pid, python, &actions, NULL, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    close(in[0]);
    close(out[1]);
    peer->to = fdopen(in[1], "w");
    peer->from = fdopen(out[0], "r");
    char line[64], version[16];
    int n_threads;
    if (failed || !fgets(line, sizeof line, peer->from) || sscanf(line, "%15s %d", version, &n_threads) != 2)
        return false;
    snprintf(peer->name, sizeof peer->name, "VTK %s, discrete flying edges and windowed sinc, %d threads", version, n_threads);
    return true;
}

/* ---- ours ----------------------------------------------------------------------------------------------------------------- */

struct times { /* ms */
    double mask, smooth; /* smooth: from the labels on, masks included, to vertices with normals */
};

static double since_ms(int64_t *began_us)
{
    int64_t now_us = clock_now_us();
    double ms = (double)(now_us - *began_us) / 1e3;
    *began_us = now_us;
    return ms;
}

/* All regions at once: threads take one after the other, the largest first, each on its own, as a plan does when it is opened. */
struct task {
    const struct volume *labels;
    bool is_bare; /* without normals */
    struct mesh *meshes[N_REGIONS]; /* kept to the end, as a plan keeps them, and VTK does */
    struct times times[N_REGIONS];
    atomic_int next;
};

static void take_regions(void *context, int part, int n_parts)
{
    static const uint16_t by_size[N_REGIONS] = { 1, 2, 3, 4, 10, 12, 11, 6, 5, 7, 8, 9 };
    struct task *task = context;
    struct error err = { 0 };
    struct surface_options options = surface_defaults;
    options.n_threads = 1;
    options.without_normals = task->is_bare;
    (void)part;
    (void)n_parts;
    for (int at; (at = atomic_fetch_add(&task->next, 1)) < N_REGIONS;) {
        int64_t began_us = clock_now_us();
        struct mask *mask = mask_from_labels(task->labels, &by_size[at], 1, 1, &err);
        task->times[at].mask = since_ms(&began_us);
        struct mesh *mesh = mask ? surface_smooth(mask, &options, &err) : NULL;
        if (!mesh)
            die("surface", &err);
        task->meshes[at] = mesh;
        mask_destroy(mask);
    }
}

static struct times run_once(const struct volume *labels, int n_threads, bool is_bare, size_t *n_triangles)
{
    struct task task = { .labels = labels, .is_bare = is_bare };
    struct times times = { 0 };
    int64_t began_us = clock_now_us();
    atomic_init(&task.next, 0);
    parallel_run(n_threads, take_regions, &task);
    times.smooth = since_ms(&began_us);
    *n_triangles = 0;
    for (int r = 0; r < N_REGIONS; r++) {
        times.mask += task.times[r].mask;
        *n_triangles += task.meshes[r]->n_triangles;
    }
    for (int r = 0; r < N_REGIONS; r++)
        mesh_unref(task.meshes[r]);
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

static void bench_regions(const struct volume *labels, const struct peer *peer)
{
    /* as VTK does it; and with the normals that a picture needs */
    static const char *const ways[3] = { "without normals, 2 threads", "with vertex normals, 1 thread", "with vertex normals, 2 threads" };
    enum { N_WAYS = sizeof ways / sizeof *ways };
    double ours[N_WAYS][REPEATS], mask[N_WAYS][REPEATS], theirs[REPEATS], extract[REPEATS];
    size_t n_triangles = 0;
    for (int repeat = -1; repeat < REPEATS; repeat++) { /* the first warms up and does not count */
        int at = repeat < 0 ? 0 : repeat;
        for (int way = 0; way < N_WAYS; way++) {
            struct times times = run_once(labels, way == 1 ? 1 : 2, way == 0, &n_triangles);
            mask[way][at] = times.mask;
            ours[way][at] = times.smooth;
        }
        char line[128];
        double smooth_ms;
        size_t n_theirs;
        if (!peer)
            continue;
        fputs("\n", peer->to);
        fflush(peer->to);
        if (!fgets(line, sizeof line, peer->from) || sscanf(line, "%lf %lf %zu", &extract[at], &smooth_ms, &n_theirs) != 3)
            die("the VTK side", NULL);
        if (n_theirs != n_triangles)
            die("not the same number of triangles as VTK", NULL);
        theirs[at] = extract[at] + smooth_ms;
    }
    double vtk = peer ? median(theirs, REPEATS) : 0, vtk_extract = peer ? median(extract, REPEATS) : 0;
    for (int way = 0; way < N_WAYS; way++) {
        double ms = median(ours[way], REPEATS);
        printf("{\"name\":\"12 regions of 512 x 512 x 200, smooth, %s\",\"value\":%.1f,\"unit\":\"ms\"", ways[way], ms);
        if (peer)
            printf(",\"peer\":\"%s\",\"peer_value\":%.1f,\"ratio\":%.2f", peer->name, vtk, vtk / ms);
        printf(",\"note\":\"%zu triangles; masks %.1f of all threads' time%s", n_triangles, median(mask[way], REPEATS), way == 0 ? "; at least x5 asked for" : "");
        if (peer)
            printf("; theirs: flying edges %.1f of it", vtk_extract);
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
        printf("{\"name\":\"156 thousand polygons with vertex normals, %s\",\"value\":%.2f,\"unit\":\"ms\",\"note\":\"%zu triangles, 2 threads, from labels; "
               "%s\"}\n", surface_algorithm_word(algorithms[a]), median(ms, NORMAL_REPEATS), n,
               a ? "smoothed too" : "the thesis: 5300; at most 5.3 asked for");
    }
    volume_unref(labels);
}

int main(void)
{
    struct volume *labels = make_labels();
    struct peer peer = { 0 };
    char path[] = "/tmp/beamroom-bench-XXXXXX";
    bool has_peer = peer_start(&peer, labels, path);
    if (!has_peer)
        fprintf(stderr, "bench_smooth: no VTK for Python here: our times only\n");
    bench_regions(labels, has_peer ? &peer : NULL);
    bench_thesis();
    fclose(peer.to); /* the script ends at the end of its input */
    fclose(peer.from);
    if (peer.pid > 0)
        waitpid(peer.pid, NULL, 0);
    unlink(path);
    volume_unref(labels);
    return 0;
}
