/* Fills in where the parts of a plan come from. */
#include "core/load/origins.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/load/dicom_parts.h"
#include "core/load/reader_table.h"

_Static_assert((int)DICOM_MAX_PATIENTS == (int)ORIGIN_MAX_PATIENTS, "every patient of the index has a place");
_Static_assert((int)FOLDER_NAME_SIZE == (int)sizeof((struct part_origin *)NULL)->path, "a path fits");
_Static_assert((int)DICOM_UID_SIZE <= (int)ORIGIN_UID_SIZE, "a UID fits");

void origin_patient(const struct dicom_patient *from, struct plan_patient *patient)
{
    _Static_assert(sizeof patient->id == sizeof from->id && sizeof patient->issuer == sizeof from->issuer &&
                       sizeof patient->name == sizeof from->name && sizeof patient->sex == sizeof from->sex &&
                       sizeof patient->birth_date == sizeof from->birth_date,
                   "texts of a patient fit");
    memcpy(patient->id, from->id, sizeof patient->id);
    memcpy(patient->issuer, from->issuer, sizeof patient->issuer);
    memcpy(patient->name, from->name, sizeof patient->name);
    memcpy(patient->birth_date, from->birth_date, sizeof patient->birth_date);
    memcpy(patient->sex, from->sex, sizeof patient->sex);
    patient->has_conflict = from->has_conflict;
}

static void add_patients(struct plan *plan, const struct dicom_index *index)
{
    for (size_t i = 0; i < index->n_patients; i++)
        origin_patient(&index->patients[i], &plan->patients[plan->n_patients++]);
}

static int patient_of(const struct loading *loading, const char *path)
{
    const struct dicom_object *object = loading->parts.dicom ? dicom_index_at(loading->parts.dicom, path) : NULL;
    return object ? object->patient : -1;
}

static int treatment_plan_of(const struct plan *plan, const char *uid)
{
    for (size_t i = 0; uid[0] && i < plan->n_treatment_plans; i++)
        if (strcmp(plan->treatment_plans[i].uid, uid) == 0)
            return (int)i;
    return -1;
}

void origin_treatment_plan(const struct rtplan *from, int patient, struct treatment_plan *added)
{
    *added = (struct treatment_plan){ .n_fractions = from->n_fractions,
                                      .n_beams = from->n_treating,
                                      .prescription_gy = from->target_dose_gy,
                                      .patient = patient };
    snprintf(added->uid, sizeof added->uid, "%s", from->uid);
    snprintf(added->structs_uid, sizeof added->structs_uid, "%s", from->struct_uid);
    memcpy(added->label, from->label, sizeof added->label);
    memcpy(added->name, from->name, sizeof added->name);
    memcpy(added->date, from->date, sizeof added->date);
    memcpy(added->time, from->time, sizeof added->time);
    memcpy(added->approval, from->approval, sizeof added->approval);
    memcpy(added->review_date, from->review_date, sizeof added->review_date);
    memcpy(added->reviewer, from->reviewer, sizeof added->reviewer);
}

static void add_treatment_plan(struct loading *loading, const struct part_reading *reading)
{
    struct plan *plan = loading->plan;
    const struct rtplan *from = reading->rtplan;
    if (plan->n_treatment_plans == ORIGIN_MAX_TREATMENT_PLANS) {
        report_add(&plan->report, REPORT_WARNING, "plan.ignored-file", reading->path,
                   "More than %d treatment plans; what belongs to this one counts as of a plan that is not here.",
                   ORIGIN_MAX_TREATMENT_PLANS);
        return;
    }
    origin_treatment_plan(from, patient_of(loading, reading->path), &plan->treatment_plans[plan->n_treatment_plans++]);
}

void origins_begin(struct loading *loading)
{
    if (loading->parts.dicom)
        add_patients(loading->plan, loading->parts.dicom);
    for (size_t i = 0; i < loading->n_readings; i++)
        if (loading->readings[i].rtplan && !loading->readings[i].is_failed)
            add_treatment_plan(loading, &loading->readings[i]);
}

/* A plan without a frame of reference lies in that of the structure set that it refers to. */
static void frame_of_plan(const struct loading *loading, const struct rtplan *plan, struct part_origin *origin)
{
    const struct dicom_object *structs = dicom_index_find(loading->parts.dicom, plan->struct_uid);
    const char *frame = plan->frame_uid[0] ? plan->frame_uid : structs ? structs->frame_of_reference : "";
    snprintf(origin->frame_uid, sizeof origin->frame_uid, "%s", frame);
}

/* The place of a dose's only beam among those of its treatment plan, from 1; 0: it is of none or several, or unknown.
 */
static size_t beam_of_dose(const struct loading *loading, const struct rtdose *dose)
{
    if (strcmp(dose->summation, "BEAM") != 0 || dose->n_beams != 1 || !dose->plan_uid[0])
        return 0;
    for (size_t i = 0; i < loading->n_readings; i++) {
        const struct rtplan *plan = loading->readings[i].rtplan;
        for (size_t b = 0; plan && strcmp(plan->uid, dose->plan_uid) == 0 && b < plan->n_treating; b++)
            if (plan->treating[b] == dose->beams[0])
                return b + 1;
    }
    return 0;
}

static void origin_of_object(const struct loading *loading, const struct part_reading *reading,
                             const struct dicom_object *object, struct part_origin *origin)
{
    bool is_region = object->kind == DICOM_KIND_STRUCT || object->kind == DICOM_KIND_SEGMENTATION;
    origin->patient = object->patient;
    snprintf(origin->frame_uid, sizeof origin->frame_uid, "%s", object->frame_of_reference);
    snprintf(origin->study_uid, sizeof origin->study_uid, "%s", object->study);
    snprintf(origin->series_uid, sizeof origin->series_uid, "%s",
             is_region ? object->referenced_series : object->series);
    if (is_region)
        snprintf(origin->structs_uid, sizeof origin->structs_uid, "%s", object->sop_instance);
    if (reading->kind == PART_KIND_DOSE) {
        snprintf(origin->plan_uid, sizeof origin->plan_uid, "%s", reading->rtdose.plan_uid);
        snprintf(origin->structs_uid, sizeof origin->structs_uid, "%s", reading->rtdose.structs_uid);
        origin->beam = beam_of_dose(loading, &reading->rtdose);
    }
    if (reading->rtplan) {
        snprintf(origin->plan_uid, sizeof origin->plan_uid, "%s", reading->rtplan->uid);
        snprintf(origin->structs_uid, sizeof origin->structs_uid, "%s", reading->rtplan->struct_uid);
        frame_of_plan(loading, reading->rtplan, origin);
    }
    origin->treatment_plan = treatment_plan_of(loading->plan, origin->plan_uid);
}

struct part_origin origin_of_reading(const struct loading *loading, const struct part_reading *reading)
{
    struct part_origin origin = { .patient = -1, .treatment_plan = -1 };
    const struct dicom_index *index = loading->parts.dicom;
    const struct dicom_object *object = NULL;
    const char *path = reading->path;
    if (reading->reader == &part_dicom && index && reading->kind == PART_KIND_IMAGE)
        object = &index->objects[index->stacks[reading->stack].objects[0]];
    else if (reading->reader == &part_dicom && index)
        object = dicom_index_at(index, path);
    if (object) {
        origin_of_object(loading, reading, object, &origin);
        path = object->path;
    }
    if (reading->structs)
        snprintf(origin.set_label, sizeof origin.set_label, "%s", reading->structs->label);
    snprintf(origin.path, sizeof origin.path, "%s", path);
    return origin;
}

struct part_origin origin_of_roi(const struct loading *loading, const struct part_reading *reading,
                                 const char *frame_uid)
{
    struct part_origin origin = origin_of_reading(loading, reading);
    if (frame_uid[0])
        snprintf(origin.frame_uid, sizeof origin.frame_uid, "%s", frame_uid);
    return origin;
}

void origin_state(struct part_origin *origin, const struct plan_file_dose *entry)
{
    origin->is_stated_same = entry->has_frame && entry->frame == DOSE_FRAME_SAME;
    origin->is_stated_other = entry->has_frame && entry->frame == DOSE_FRAME_DIFFERS;
}

bool origins_add_regions(struct plan *plan, const struct part_origin *origin, size_t first, struct error *err)
{
    size_t n = plan->n_region_origins;
    const struct part_origin *last = n > 0 ? &plan->region_origins[n - 1] : NULL;
    bool is_new = !last || strcmp(last->path, origin->path) != 0 || strcmp(last->frame_uid, origin->frame_uid) != 0;
    if (first >= plan->regions.n_regions)
        return true;
    if (is_new) {
        struct part_origin *larger = realloc(plan->region_origins, (n + 1) * sizeof *larger);
        if (!larger)
            return error_set(err, ERROR_MEMORY, "no memory for the origins of %zu files of regions", n + 1);
        larger[n] = *origin;
        plan->region_origins = larger;
        plan->n_region_origins = n + 1;
    }
    for (size_t i = first; i < plan->regions.n_regions; i++)
        if (plan->regions.regions[i].origin == 0) /* at most one origin a region: REGION_MAX fits */
            plan->regions.regions[i].origin = (uint16_t)plan->n_region_origins;
    return true;
}

bool origin_join(struct part_origin *origin, const struct part_origin *other)
{
    if (origin->patient != other->patient)
        return false;
    if (strcmp(origin->frame_uid, other->frame_uid) != 0)
        origin->is_stated_other = true;
    return true;
}
