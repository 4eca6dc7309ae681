/* Creates the state of a plan that is being loaded, counts its references, and works out the progress. */
#include "core/load/loading.h"

#include <stdio.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/load/cache.h"

bool loading_is_cancelled(const struct loading *loading)
{
    return atomic_load(&loading->is_given_up);
}

void loading_phase(struct loading *loading, const char *what, const char *name, double low, double high)
{
    struct loading_phase *phase = mem_new(sizeof *phase);
    *phase = (struct loading_phase){ .low = low, .high = high };
    snprintf(phase->words, sizeof phase->words, "%s%s%.80s", what, name[0] ? " " : "", name);
    mailbox_put(loading->phases, phase);
}

void loading_begin(struct loading *loading, uint64_t work)
{
    atomic_store(&loading->work_done, 0);
    atomic_store(&loading->work, work);
}

void loading_work(struct loading *loading, uint64_t work)
{
    atomic_fetch_add(&loading->work_done, work);
}

static void finish_reading(struct part_reading *reading)
{
    volume_unref(reading->volume);
    sera_doses_finish(&reading->doses);
    if (reading->layers)
        nrrd_layers_finish(reading->layers);
    free(reading->layers);
    rtstruct_destroy(reading->structs);
    rtdose_finish(&reading->rtdose);
    rtplan_destroy(reading->rtplan);
    uvh_finish(&reading->uvh);
    label_names_finish(&reading->names);
    report_finish(&reading->report);
}

void loading_unref(struct loading *loading)
{
    if (atomic_fetch_sub(&loading->references, 1) > 1)
        return;
    for (size_t i = 0; i < loading->n_readings; i++)
        finish_reading(&loading->readings[i]);
    free(loading->readings);
    free(loading->order);
    plan_parts_finish(&loading->parts);
    plan_destroy(loading->plan);
    plan_sources_destroy(loading->sources);
    free(loading->cache_folder);
    folder_close(&loading->folder);
    mailbox_destroy(loading->phases);
    queue_destroy(loading->ended);
    free(loading);
}

struct loading *loading_create(const char *folder, const char *id, struct error *err)
{
    struct loading *loading = mem_new(sizeof *loading);
    if (!folder_open(&loading->folder, folder, err)) {
        free(loading);
        return NULL;
    }
    loading->phases = mailbox_create(free);
    loading->ended = queue_create(1, NULL);
    loading->plan = plan_create(id);
    atomic_init(&loading->references, 2);
    return loading;
}

bool loading_may_leave_out(const struct error *why)
{
    return why->code != ERROR_MEMORY && why->code != ERROR_CANCELLED;
}

void loading_leave_out(struct loading *loading, const char *code, const char *path, const struct error *why)
{
    report_add(&loading->plan->report, REPORT_ERROR, code, path, "Left out: %s", why->text);
    if (loading->n_left_out++ == 0)
        loading->first_left_out = *why;
}

const struct dicom_stack *loading_stack_of(const struct loading *loading, size_t image)
{
    int stack = loading->image_stacks[image];
    return stack < 0 ? NULL : &loading->parts.dicom->stacks[stack];
}
