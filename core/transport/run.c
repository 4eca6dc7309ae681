/* Stopping a simulation, and how far it is. */
#include "core/transport/run.h"

#include <math.h>

bool run_is_asked_to_stop(const struct transport_run *run)
{
    return run->input.cancel && atomic_load(run->input.cancel);
}

bool run_pause(struct transport_run *run, bool is_caller, uint64_t n_done)
{
    if (run_is_asked_to_stop(run))
        atomic_store(&run->is_cancelled, true);
    if (atomic_load(&run->is_cancelled))
        return true;
    uint64_t done = atomic_fetch_add(&run->n_done, n_done) + n_done;
    if (is_caller && run->input.progress)
        run->input.progress(run->input.context, fmin(1, (double)done / (double)run->n_step));
    return false;
}
