/* Opening the demo plan (image, labels, four dose components, tracks; five packed volumes of 256 x 256 x 128 and less),
 * against nibabel unpacking the same volumes to arrays, in one run. Ours does more: names, tree, checks, bounds. */
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>

#include "core/base/clock.h"
#include "core/load/load.h"
#include "core/plan/plan.h"
#include "tests/bench/peer.h"

enum { REPEATS = 9 };

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

/* Median time the script takes for one load, as it says itself; 0 when it cannot run here. */
static double nibabel_ms(const char *folder)
{
    char line[64];
    return peer_run_ms((const char *const[]){ peer_python(), "tests/bench/nibabel_load.py", folder, NULL }, line,
                       sizeof line) < 0
               ? 0
               : strtod(line, NULL);
}

int main(void)
{
    const char *plans = getenv("BEAMROOM_DEMO") ? getenv("BEAMROOM_DEMO") : "build/demo/plans";
    char folder[4096];
    snprintf(folder, sizeof folder, "%s/phantom", plans);
    double ms[REPEATS];
    for (int i = 0; i < REPEATS; i++) {
        struct error err = { 0 };
        int64_t began = clock_now_us();
        struct plan *plan = plan_load(folder, "phantom", NULL, &err);
        ms[i] = (double)(clock_now_us() - began) / 1e3;
        if (!plan) {
            fprintf(stderr, "bench_load: %s\n", err.text);
            return 1;
        }
        plan_destroy(plan);
    }
    qsort(ms, REPEATS, sizeof ms[0], compare);
    double ours = ms[REPEATS / 2], theirs = nibabel_ms(folder);
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);

    printf("{\"name\":\"open the demo plan\",\"value\":%.2f,\"unit\":\"ms\"", ours);
    if (theirs > 0)
        printf(",\"peer\":\"nibabel, the same volumes\",\"peer_value\":%.2f,\"ratio\":%.3f", theirs, theirs / ours);
    printf(",\"note\":\"median of %d, files in the cache\"}\n", REPEATS);
    printf("{\"name\":\"memory to open the demo plan, peak\",\"value\":%.1f,\"unit\":\"MiB\"}\n",
           (double)usage.ru_maxrss / 1024);
    return 0;
}
