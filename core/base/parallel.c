/* Starting and joining threads for one call. */
#define _GNU_SOURCE
#include "core/base/parallel.h"

#include <pthread.h>
#include <sched.h>
#include <stdbool.h>

enum { MAX_PARTS = 64 };

struct part {
    void (*run)(void *context, int part, int n_parts);
    void *context;
    int part, n_parts;
};

static void *part_main(void *argument)
{
    struct part *part = argument;
    part->run(part->context, part->part, part->n_parts);
    return NULL;
}

void parallel_run(int n_parts, void (*run)(void *context, int part, int n_parts), void *context)
{
    pthread_t threads[MAX_PARTS];
    struct part parts[MAX_PARTS];
    bool started[MAX_PARTS] = { false };
    if (n_parts < 1)
        n_parts = 1;
    if (n_parts > MAX_PARTS)
        n_parts = MAX_PARTS;
    for (int i = 1; i < n_parts; i++) {
        parts[i] = (struct part){ run, context, i, n_parts };
        started[i] = pthread_create(&threads[i], NULL, part_main, &parts[i]) == 0;
    }
    run(context, 0, n_parts);
    for (int i = 1; i < n_parts; i++) {
        if (started[i])
            pthread_join(threads[i], NULL);
        else
            run(context, i, n_parts);
    }
}

int parallel_cores(void)
{
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) != 0)
        return 1;
    int n = CPU_COUNT(&set);
    return n < 1 ? 1 : n > MAX_PARTS ? MAX_PARTS : n;
}
