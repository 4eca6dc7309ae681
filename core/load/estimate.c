/* Estimates the memory that loading a plan will take, from headers alone. */
#include "core/load/estimate.h"

#include <stdlib.h>

#include "core/base/parallel.h"

static struct part_need need_of(const struct loading *loading, const struct part_reading *reading)
{
    enum raw_use use = reading->kind == PART_KIND_DOSE_MASK ? RAW_MASK : RAW_IMAGE;
    if (reading->kind == PART_KIND_REGION && reading->index < loading->file->n_regions)
        use = loading->file->regions[reading->index].name[0] ? RAW_MASK : RAW_LABELS;
    if (reading->reader->estimate)
        return reading->reader->estimate(loading, reading, use);
    return (struct part_need){ 4 * reading->bytes, reading->bytes }; /* a compressed image of 8 bits */
}

uint64_t plan_estimate(const struct loading *loading, const struct part_reading **largest)
{
    uint64_t kept = 0, most = 0, *work = calloc(loading->n_readings + 1, sizeof *work);
    size_t n_threads = (size_t)parallel_cores(), n_work = 0;
    *largest = NULL;
    for (size_t i = 0; work && i < loading->n_readings; i++) {
        struct part_need need = need_of(loading, &loading->readings[i]);
        size_t at = n_work++; /* sorted, largest first */
        for (; at > 0 && work[at - 1] < need.work; at--)
            work[at] = work[at - 1];
        work[at] = need.work;
        kept += need.kept;
        if (need.kept + need.work >= most) {
            most = need.kept + need.work;
            *largest = &loading->readings[i];
        }
    }
    for (size_t i = 0; work && i < n_work && i < n_threads; i++)
        kept += work[i];
    free(work);
    return kept;
}

bool plan_check_estimate(const struct loading *loading, struct error *err)
{
    const struct part_reading *largest;
    if (loading->max_bytes == 0)
        return true;
    uint64_t bytes = plan_estimate(loading, &largest);
    if (bytes <= loading->max_bytes || !largest)
        return true;
    struct part_need need = need_of(loading, largest);
    return error_set(
        err, ERROR_LIMIT,
        "reading the plan would take about %.0f MiB of memory, and %.0f MiB are allowed; the largest part is %s with %.0f "
        "MiB",
        (double)bytes / 1048576, (double)loading->max_bytes / 1048576, largest->path,
        (double)(need.kept + need.work) / 1048576);
}
