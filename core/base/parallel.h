#pragma once
/* Work split over a few threads that are joined before the call returns. */

/* Calls run(context, part, n_parts) once for each part in [0, n_parts), part 0 on the calling thread.
 * If the system gives no more threads, the remaining parts run on the calling thread. */
void parallel_run(int n_parts, void (*run)(void *context, int part, int n_parts), void *context);

/* Cores this process may use, at least 1, at most 64. */
int parallel_cores(void);
