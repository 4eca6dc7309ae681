/* Reads all listed files of a plan in several threads. */
#include "core/load/read_all.h"

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/load/read_part.h"
#include "core/load/reader_table.h"

static void order_readings(struct loading *loading)
{
    loading->order = mem_new((loading->n_readings + 1) * sizeof *loading->order);
    for (size_t i = 0; i < loading->n_readings; i++) {
        size_t at = i;
        for (; at > 0 && loading->readings[loading->order[at - 1]].bytes < loading->readings[i].bytes; at--)
            loading->order[at] = loading->order[at - 1];
        loading->order[at] = i;
    }
}

/* Reports the failed readings; the rest is shown without them. */
static void leave_out_failed(struct loading *loading)
{
    for (size_t i = 0; i < loading->n_readings; i++) {
        struct part_reading *reading = &loading->readings[i];
        if (reading->is_failed)
            loading_leave_out(loading, reading->reader == &part_dicom ? "dicom.unreadable" : "part.unreadable",
                              reading->path, &reading->err);
    }
}

/* The name shown for a reading: the series of a DICOM image, else the path. */
static const char *name_of(const struct loading *loading, const struct part_reading *reading)
{
    if (reading->kind == PART_KIND_IMAGE && reading->reader == &part_dicom &&
        loading->file->images[reading->index].name[0])
        return loading->file->images[reading->index].name;
    return reading->path;
}

static void work(void *context, int part, int n_parts)
{
    (void)n_parts;
    struct loading *loading = context;
    for (;;) {
        size_t turn = atomic_fetch_add(&loading->next, 1);
        if (turn >= loading->n_readings || loading_is_cancelled(loading))
            return;
        size_t at = loading->order[turn];
        struct part_reading *reading = &loading->readings[at];
        /* Once a fault ends loading only earlier parts matter: the error of the first in the plan's order is returned.
         */
        if (at > atomic_load(&loading->first_failed))
            continue;
        if (part == 0)
            loading_phase(loading, "reading", name_of(loading, reading), 5, 80);
        size_t n_lacked = error_n_memory();
        reading->is_failed = !plan_read_part(loading, reading);
        /* an element that found none counts as absent, and so does a file beside this one without descriptors */
        if (error_n_memory() != n_lacked && (!reading->is_failed || reading->err.code != ERROR_MEMORY))
            reading->is_failed = !error_set(&reading->err, ERROR_MEMORY,
                                            "%s: no memory, or too many open files, to read all of it", reading->path);
        if (reading->is_failed && !loading_may_leave_out(&reading->err)) {
            size_t before = atomic_load(&loading->first_failed);
            while (at < before && !atomic_compare_exchange_weak(&loading->first_failed, &before, at)) {
            }
        }
        loading_work(loading, reading->bytes - reading->bytes_counted);
    }
}

bool plan_read_parts(struct loading *loading, struct error *err)
{
    order_readings(loading);
    atomic_init(&loading->next, 0);
    atomic_init(&loading->first_failed, SIZE_MAX);
    loading_begin(loading, loading->n_bytes);
    int n_threads = parallel_cores();
    if ((size_t)n_threads > loading->n_readings)
        n_threads = (int)loading->n_readings;
    parallel_run(n_threads, work, loading);
    if (loading_is_cancelled(loading))
        return error_set(err, ERROR_CANCELLED, "loading was cancelled");
    size_t failed = atomic_load(&loading->first_failed);
    if (failed != SIZE_MAX) {
        if (err)
            *err = loading->readings[failed].err;
        return false;
    }
    leave_out_failed(loading);
    for (size_t i = 0; i < loading->n_readings; i++)
        report_move(&loading->plan->report, &loading->readings[i].report);
    return true;
}
