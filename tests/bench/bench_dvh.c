/* Dose-volume histograms of twelve regions on 512 x 512 x 200 univels in a dose of 2.5 mm, against numpy: the two take
 * turns on the same labels and dose, in one run, and the median of each counts. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/dose/dvh_metrics.h"
#include "tests/bench/peer.h"

enum { NX = 512, NY = 512, NZ = 200, N_REGIONS = 12, DX = 130, DY = 128, DZ = 124, REPEATS = 7, PEER_REPEATS = 3 };

static _Noreturn void die(const char *what, const struct error *err)
{
    fprintf(stderr, "bench_dvh: %s: %s\n", what, err ? err->text : "failed");
    exit(1);
}

/* A head with eleven bodies in it: shells, balls, a wavy border. 0 is outside. */
static uint8_t label_at(double x, double y, double z)
{
    static const double balls[8][4] = { { 36, -20, 24, 26 },  { 38, -22, 25, 13 }, { -32, -92, -22, 12 },
                                        { 32, -92, -22, 12 }, { -30, 0, 20, 20 },  { 0, 18, -60, 14 },
                                        { 0, -60, -80, 22 },  { -20, 40, 40, 16 } };
    double wave = 1 + 0.03 * sin(x / 5.5 + cos(z / 9)) * cos(y / 6.5),
           r = sqrt(x * x / (105 * 105) + y * y / (125 * 125) + z * z / (140 * 140)) * wave;
    if (r > 1)
        return 0;
    for (int b = 7; b >= 0; b--) {
        double u = x - balls[b][0], v = y - balls[b][1], w = z - balls[b][2];
        if (u * u + v * v + w * w < balls[b][3] * balls[b][3] * wave)
            return (uint8_t)(5 + b);
    }
    return r > 0.94 ? 1 : r > 0.86 ? 2 : r > 0.82 ? 3 : 4;
}

static struct volume *make(const uint32_t size[3], const struct affine *map, enum voxel_type type)
{
    struct error err = { 0 };
    struct grid grid;
    struct volume *volume = grid_init(&grid, size, map, &err) ? volume_create(&grid, type, &err) : NULL;
    if (!volume)
        die("volume", &err);
    for (uint32_t k = 0; k < size[2]; k++)
        for (uint32_t j = 0; j < size[1]; j++)
            for (uint32_t i = 0; i < size[0]; i++) {
                struct vec3 p = affine_point(map, vec3(i, j, k));
                size_t at = i + size[0] * (j + (size_t)size[1] * k);
                if (type == VOXEL_U8) {
                    ((uint8_t *)volume->voxels)[at] = label_at(p.x, p.y, p.z);
                } else {
                    double d = sqrt((p.x - 36) * (p.x - 36) + (p.y + 20) * (p.y + 20) + (p.z - 24) * (p.z - 24));
                    ((float *)volume->voxels)[at] =
                        (float)(62 / (1 + exp((d - 32) / 6)) + 8 * exp(-d / 60) + 0.2 * sin(p.x / 3) * cos(p.y / 4));
                }
            }
    if (type == VOXEL_F32)
        volume_measure(volume);
    return volume;
}

struct ours {
    double ms, mean[N_REGIONS], half[N_REGIONS]; /* mean and D50% */
};

static struct ours run_ours(const struct volume *labels, const struct volume *dose, int n_threads, bool is_general)
{
    struct dvh_sweep sweep = {
        .labels = labels, .rows = &dose, .n_rows = 1, .n_threads = n_threads, .is_general = is_general
    };
    struct dvh_label wanted[N_REGIONS];
    struct dvh dvhs[N_REGIONS];
    struct ours ours;
    struct error err = { 0 };
    for (int r = 0; r < N_REGIONS; r++)
        wanted[r] = (struct dvh_label){ (uint16_t)(r + 1), 1 };
    int64_t began_us = clock_now_us();
    if (!dvh_sweep(&sweep, wanted, N_REGIONS, dvhs, &err))
        die("histograms", &err);
    ours.ms = (double)(clock_now_us() - began_us) / 1e3;
    for (int r = 0; r < N_REGIONS; r++) {
        ours.mean[r] = dvh_metric_value(&dvhs[r], &(struct dvh_metric){ DVH_MEAN, 0 });
        ours.half[r] = dvh_metric_value(&dvhs[r], &(struct dvh_metric){ DVH_DOSE_PERCENT, 50 });
        dvh_finish(&dvhs[r]);
    }
    return ours;
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

/* Their times, and whether their figures are ours. */
static double ask_peer(struct peer *peer, const struct ours *ours)
{
    char line[1024];
    if (!peer_ask(peer, "\n", line, sizeof line))
        die("the numpy side", NULL);
    char *at = line;
    double ms = strtod(at, &at);
    for (int r = 0; r < N_REGIONS; r++) {
        double mean = strtod(at, &at), half = strtod(at, &at);
        if (!(fabs(mean - ours->mean[r]) <= 1e-4 * mean) || !(fabs(half - ours->half[r]) <= 1e-3 * half)) {
            fprintf(stderr, "bench_dvh: region %d: mean %.6g, D50%% %.6g; numpy %.6g, %.6g\n", r + 1, ours->mean[r],
                    ours->half[r], mean, half);
            exit(1);
        }
    }
    return ms;
}

int main(void)
{
    const struct affine fine = { { { 0.6, 0, 0 }, { 0, 0.6, 0 }, { 0, 0, 1.5 } }, { -153.3, -153.3, -149.25 } },
                        coarse = { { { 2.5, 0, 0 }, { 0, 2.5, 0 }, { 0, 0, 2.5 } }, { -160.1, -158.2, -153.4 } };
    struct volume *labels = make((const uint32_t[3]){ NX, NY, NZ }, &fine, VOXEL_U8),
                  *dose = make((const uint32_t[3]){ DX, DY, DZ }, &coarse, VOXEL_F32);
    char label_path[PEER_PATH_SIZE], dose_path[PEER_PATH_SIZE], line[128];
    struct peer peer;
    if (!peer_write_file(label_path, labels->voxels, grid_n_voxels(&labels->grid)) ||
        !peer_write_file(dose_path, dose->voxels, grid_n_voxels(&dose->grid) * sizeof(float)))
        die("temporary file", NULL);
    const char *arguments[] = { peer_python(), "tests/bench/numpy_dvh.py", label_path, dose_path, NULL };
    bool has_peer = peer_start(&peer, arguments, line, sizeof line) && line[0];
    line[strcspn(line, "\n")] = 0;
    static const char *const ways[] = { "2 threads", "1 thread", "oblique way, 2 threads" };
    enum { N_WAYS = sizeof ways / sizeof *ways };
    double ms[N_WAYS][REPEATS], theirs[PEER_REPEATS], numpy_ms = 0;
    for (int repeat = -1; repeat < REPEATS; repeat++) /* the first warms up and does not count */
        for (int way = 0; way < N_WAYS; way++) {
            struct ours ours = run_ours(labels, dose, way == 1 ? 1 : 2, way == 2);
            ms[way][repeat < 0 ? 0 : repeat] = ours.ms;
            if (has_peer && way == 0 && repeat < PEER_REPEATS)
                theirs[repeat < 0 ? 0 : repeat] = ask_peer(&peer, &ours);
        }
    if (has_peer)
        numpy_ms = median(theirs, PEER_REPEATS);
    for (int way = 0; way < N_WAYS; way++) {
        double value = median(ms[way], REPEATS);
        printf("{\"name\":\"histograms of 12 regions of 512 x 512 x 200, %s\",\"value\":%.1f,\"unit\":\"ms\"",
               ways[way], value);
        if (has_peer)
            printf(",\"peer\":\"%s\",\"peer_value\":%.1f,\"ratio\":%.2f", line, numpy_ms, numpy_ms / value);
        printf(",\"note\":\"least %.1f%s\"}\n", ms[way][0],
               way == 0 ? "; at most 100 ms and at least x20 asked for" : "");
    }
    if (!has_peer)
        fprintf(stderr, "bench_dvh: no numpy here: our times only\n");
    (void)peer_end(&peer);
    unlink(label_path);
    unlink(dose_path);
    volume_unref(labels);
    volume_unref(dose);
    return 0;
}
