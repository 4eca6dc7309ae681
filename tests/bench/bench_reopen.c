/* Opening a plan for the first time and again from the cache, in one process each time, files in the system's cache:
 * SERA's head, a CT of 200 slices of 512 x 512, and the same with 12 regions as contours and a dose. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/load/cache.h"
#include "core/load/load.h"
#include "core/plan/plan.h"

enum { REPEATS = 5 };

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

/* Median ms of opening, and the last plan; NULL after saying why. */
static struct plan *open_often(const char *folder, const char *cache, struct plan_sources **sources, double *ms)
{
    double all[REPEATS];
    struct plan *plan = NULL;
    for (int i = 0; i < REPEATS; i++) {
        struct error err = { 0 };
        plan_destroy(plan);
        plan_sources_destroy(*sources);
        int64_t began_us = clock_now_us();
        plan = plan_load(folder, "p", &(struct plan_load_options){ .cache_folder = cache, .sources = sources }, &err);
        all[i] = (double)(clock_now_us() - began_us) / 1e3;
        if (!plan) {
            fprintf(stderr, "bench_reopen: %s: %s\n", folder, err.text);
            return NULL;
        }
    }
    qsort(all, REPEATS, sizeof all[0], compare);
    *ms = all[REPEATS / 2];
    return plan;
}

static int measure(const char *what, const char *folder)
{
    char cache[] = "/tmp/beamroom-bench-XXXXXX", file[64];
    struct error err = { 0 };
    struct stat about;
    double first_ms, again_ms;
    struct plan_sources *sources = NULL;
    if (access(folder, R_OK) != 0)
        return 0; /* not on this machine */
    if (!mkdtemp(cache))
        return 1;
    snprintf(file, sizeof file, "%s/%s", cache, PLAN_CACHE_NAME);
    struct plan *plan = open_often(folder, cache, &sources, &first_ms);
    int64_t began_us = clock_now_us();
    bool is_kept = plan && plan_cache_store(plan, sources, cache, &err);
    double store_ms = (double)(clock_now_us() - began_us) / 1e3;
    plan_destroy(plan);
    plan = is_kept && stat(file, &about) == 0 ? open_often(folder, cache, &sources, &again_ms) : NULL;
    bool is_good = plan && plan->is_from_cache;
    plan_destroy(plan);
    plan_sources_destroy(sources);
    unlink(file);
    rmdir(cache);
    if (!is_good)
        return 1;
    printf(
        "{\"name\":\"open again, %s\",\"value\":%.1f,\"unit\":\"ms\",\"peer\":\"the first time\",\"peer_value\":%.1f,\"ratio\":%.2f,"
        "\"note\":\"median of %d; written in %.0f ms, %.0f MiB\"}\n",
        what, again_ms, first_ms, first_ms / again_ms, REPEATS, store_ms, (double)about.st_size / 1048576);
    return 0;
}

int main(void)
{
    const char *data = getenv("BEAMROOM_DATA") ? getenv("BEAMROOM_DATA") : "../shared/data";
    char head[4096];
    snprintf(head, sizeof head, "%s/sera-head", data);
    return measure("SERA's head with doses and tracks", head) |
           measure("CT 512 x 512 x 200 as DICOM", "build/bench/dicom") |
           measure("CT, 12 regions, dose as DICOM", "build/bench/plans/rt");
}
