/* Adds DICOM doses (RTDOSE) to a plan. */
#include "core/load/assemble_dicom_doses.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/formats/text.h"
#include "core/load/dicom_parts.h"
#include "core/load/dose_entry.h"
#include "core/load/origins.h"
#include "core/load/plan_ids.h"

static const struct rtplan *plan_of(const struct loading *loading, const char *uid)
{
    for (size_t i = 0; uid[0] && i < loading->n_readings; i++)
        if (loading->readings[i].rtplan && strcmp(loading->readings[i].rtplan->uid, uid) == 0)
            return loading->readings[i].rtplan;
    return NULL;
}

static void check_frame(const struct loading *loading, struct part_reading *reading, struct report *report)
{
    const struct dicom_stack *first = NULL;
    for (size_t i = 0; i < loading->plan->n_images; i++) {
        const struct dicom_stack *stack = loading_stack_of(loading, i);
        first = first ? first : stack;
        if (stack && reading->rtdose.frame_uid[0] &&
            strcmp(stack->frame_of_reference, reading->rtdose.frame_uid) == 0) {
            reading->rtdose.has_frame = true;
            reading->rtdose.frame = DOSE_FRAME_SAME;
            return;
        }
    }
    if (first)
        rtdose_check_frame(&reading->rtdose, first->frame_of_reference, reading->path, report);
}

/* Names the regions of stored histograms, by the structure set that the dose refers to, else by the only one. Drops
 * those that no region has the number of. */
static void name_stated(const struct loading *loading, const char *structs_uid, struct dose *dose)
{
    const struct rtstruct *structs = NULL;
    size_t n_structs = 0, n = 0;
    for (size_t i = 0; i < loading->n_readings; i++) {
        const struct rtstruct *other = loading->readings[i].structs;
        if (!other)
            continue;
        n_structs++;
        structs = !structs || (structs_uid[0] && strcmp(other->uid, structs_uid) == 0) ? other : structs;
    }
    if (structs && n_structs > 1 && strcmp(structs->uid, structs_uid) != 0)
        structs = NULL;
    for (size_t i = 0; structs && i < dose->n_stated; i++)
        for (size_t r = 0; r < structs->n_rois; r++)
            if (structs->rois[r].number == dose->stated[i].number) {
                struct dose_stated stated = dose->stated[i];
                memcpy(stated.region, structs->rois[r].name, sizeof stated.region);
                dose->stated[n++] = stated;
                break;
            }
    dose->n_stated = n;
}

/* objects: consumed; origins: of each object */
static void add_group(struct loading *loading, struct rtdose *objects, const struct part_origin *origins, size_t n,
                      const struct plan_file_dose *entry, const char *where)
{
    struct plan *plan = loading->plan;
    size_t from[PLAN_MAX_DOSES];
    struct dose *doses = mem_new(PLAN_MAX_DOSES * sizeof *doses);
    union { /* rtdose_group takes a non-const context; rtplan_beam_name only reads it */
        const struct rtplan *plan;
        void *context;
    } of = { plan_of(loading, objects[0].plan_uid) };
    size_t n_doses = rtdose_group(objects, n, of.plan ? rtplan_beam_name : NULL, of.context, where, doses, from,
                                  PLAN_MAX_DOSES, &plan->report);
    for (size_t i = 0; i < n_doses; i++) {
        const char *others[PLAN_MAX_DOSES], *file = objects[from[i]].where;
        char name[64];
        if (!plan_has_room_for_dose(plan, doses[i].id, file)) {
            dose_finish(&doses[i]);
            continue;
        }
        for (size_t d = 0; d < plan->n_doses; d++)
            others[d] = plan->doses[d].id;
        memcpy(name, doses[i].id, sizeof name);
        struct dose *dose = &plan->doses[plan->n_doses];
        *dose = doses[i];
        plan->dose_origins[plan->n_doses] = origins[from[i]];
        if (entry)
            origin_state(&plan->dose_origins[plan->n_doses], entry);
        memcpy(dose->name, name, sizeof dose->name);
        name_stated(loading, objects[from[i]].structs_uid, dose);
        if (entry)
            plan_dose_frame(dose, entry, file, &plan->report);
        plan_make_id(dose->id, entry && entry->id[0] && i == 0 ? entry->id : name, where, others, plan->n_doses++);
        if (entry && entry->unit[0])
            memcpy(dose->unit, entry->unit, sizeof dose->unit);
        if (entry && entry->per[0])
            memcpy(dose->per, entry->per, sizeof dose->per);
        if (!dose->unit[0])
            report_add(&plan->report, REPORT_WARNING, "dose.no-unit", file,
                       "The file does not say the unit of the dose \"%s\".", dose->name);
    }
    free(doses);
}

void plan_dicom_add_doses(struct loading *loading, size_t index, const struct plan_file_dose *entry)
{
    struct rtdose *objects = mem_new(PLAN_DICOM_MAX_DOSES * sizeof *objects);
    struct part_origin *origins = mem_new(PLAN_DICOM_MAX_DOSES * sizeof *origins);
    bool *is_taken = mem_new(loading->n_readings + 1);
    for (size_t first = 0; first < loading->n_readings; first++) { /* doses of a patient's treatment plan go together */
        const char *where = "";
        size_t n = 0;
        for (size_t i = first; i < loading->n_readings && n < PLAN_DICOM_MAX_DOSES; i++) {
            struct part_reading *reading = &loading->readings[i];
            if (reading->kind != PART_KIND_DOSE || reading->index != index || !reading->rtdose.values || is_taken[i])
                continue;
            origins[n] = origin_of_reading(loading, reading);
            if (n > 0 && (origins[n].patient != origins[0].patient ||
                          strcmp(reading->rtdose.plan_uid, objects[0].plan_uid) != 0))
                continue;
            check_frame(loading, reading, &loading->plan->report);
            where = n == 0 ? reading->path : where;
            objects[n] = reading->rtdose;
            objects[n++].where = reading->path;
            reading->rtdose.values = NULL;
            reading->rtdose.stated = NULL;
            is_taken[i] = true;
        }
        if (n > 0)
            add_group(loading, objects, origins, n, entry, where);
    }
    free(objects);
    free(origins);
    free(is_taken);
}

void plan_dicom_add_component(struct loading *loading, struct dose *dose, struct part_reading *reading)
{
    struct volume *values = reading->rtdose.values;
    reading->rtdose.values = NULL;
    if (!dose->unit[0] && text_equal(reading->rtdose.units, "GY"))
        snprintf(dose->unit, sizeof dose->unit, "Gy");
    check_frame(loading, reading, &loading->plan->report);
    if (reading->rtdose.has_frame) {
        dose->frame = dose->has_frame && dose->frame > reading->rtdose.frame ? dose->frame : reading->rtdose.frame;
        dose->has_frame = true;
    }
    plan_add_component(dose, &loading->file->doses[reading->index], reading->component, values, &loading->plan->report);
}
