#pragma once
/* Fork-join parallelism: work split over threads that are joined before the call returns. */

/* Calls run(context, part, n_parts) once for each part in [0, n_parts), part 0 on the calling thread. n_parts is
 * limited to 1..64. Parts whose thread cannot be started run on the calling thread. Thread: any. */
void parallel_run(int n_parts, void (*run)(void *context, int part, int n_parts), void *context);

/* CPUs in this process's affinity mask, limited to 1..64. */
int parallel_cores(void);
