/* Reports whose parts a plan holds. */
#include "core/load/origin_notes.h"

#include <stdio.h>
#include <string.h>

#include "core/plan/identity.h"

enum { MOST_NAMED = 6 }; /* patients in one line; further ones are counted */

/* Writes "A. V. …417, B. R. …9 and 2 more". has_conflict: of those with a conflict alone. Returns how many there are.
 */
static size_t list_patients(const struct plan *plan, bool has_conflict, char *out, size_t size)
{
    size_t n = 0, n_all = 0;
    out[0] = 0;
    for (size_t i = 0; i < plan->n_patients; i++)
        n_all += !has_conflict || plan->patients[i].has_conflict;
    for (size_t i = 0; i < plan->n_patients && n < MOST_NAMED; i++) {
        char masked[IDENTITY_MASK_SIZE];
        size_t at = strlen(out);
        if (has_conflict && !plan->patients[i].has_conflict)
            continue;
        identity_mask(&plan->patients[i], masked);
        const char *join = n == 0 ? "" : n + 1 == n_all ? " and " : ", ";
        snprintf(out + at, size - at, "%s%s", join, masked);
        n++;
    }
    size_t at = strlen(out);
    if (n < n_all)
        snprintf(out + at, size - at, " and %zu more", n_all - n);
    return n_all;
}

static size_t count_nameless(const struct part_origin *origins, size_t n)
{
    size_t n_nameless = 0;
    for (size_t i = 0; i < n; i++)
        n_nameless += origins[i].patient < 0;
    return n_nameless;
}

static bool are_masked_alike(const struct plan *plan)
{
    for (size_t i = 0; i < plan->n_patients; i++)
        for (size_t other = 0; other < i; other++) {
            char one[IDENTITY_MASK_SIZE], two[IDENTITY_MASK_SIZE];
            identity_mask(&plan->patients[i], one);
            identity_mask(&plan->patients[other], two);
            if (strcmp(one, two) == 0)
                return true;
        }
    return false;
}

static void note_patients(struct plan *plan, bool is_phantom)
{
    char names[MOST_NAMED * (IDENTITY_MASK_SIZE + 8)], shown[IDENTITY_MASK_SIZE] = "";
    size_t n_nameless = count_nameless(plan->image_origins, plan->n_images) +
                        count_nameless(plan->dose_origins, plan->n_doses) +
                        count_nameless(plan->beam_origins, plan->n_beams) +
                        count_nameless(plan->region_origins, plan->n_region_origins);
    int first = plan_shown_patient(plan);
    if (first >= 0)
        identity_mask(&plan->patients[first], shown);
    if (plan->n_patients > 1) {
        size_t n = list_patients(plan, false, names, sizeof names);
        report_add(&plan->report, REPORT_WARNING, "patient.several", "",
                   "This folder holds files of %zu patients: %s. Shown is %s; parts of the others are not used.%s", n,
                   names, shown,
                   are_masked_alike(plan) ? " Patients that are written alike here differ in ID, its issuer, name or "
                                            "birth date."
                                          : "");
    }
    if (list_patients(plan, true, names, sizeof names) > 0)
        report_add(&plan->report, REPORT_WARNING, "patient.conflict", "",
                   "Files with the same patient ID differ in name or birth date: %s. They count as of different "
                   "patients.",
                   names);
    if (plan->n_patients == 0 && !is_phantom)
        report_add(&plan->report, REPORT_NOTE, "patient.none", "", "No patient identity in these files.");
    else if (plan->n_patients > 0 && n_nameless > 0)
        report_add(&plan->report, REPORT_NOTE, "patient.none", "",
                   "%zu part%s of the plan name%s no patient; nothing says that they are of %s.", n_nameless,
                   n_nameless == 1 ? "" : "s", n_nameless == 1 ? "s" : "", shown);
}

static void note_absent_plans(struct plan *plan)
{
    for (size_t d = 0; d < plan->n_doses; d++)
        if (plan->dose_origins[d].plan_uid[0] && plan->dose_origins[d].treatment_plan < 0)
            report_add(&plan->report, REPORT_WARNING, "dose.plan-absent", plan->dose_origins[d].path,
                       "The dose \"%s\" refers to a treatment plan (RTPLAN) that is not in this folder.",
                       plan->doses[d].name);
}

static void note_absent_structs(struct plan *plan)
{
    for (size_t t = 0; t < plan->n_treatment_plans; t++) {
        const struct treatment_plan *treatment = &plan->treatment_plans[t];
        bool is_here = !treatment->structs_uid[0], has_others = false;
        for (size_t i = 0; i < plan->n_region_origins; i++) {
            const struct part_origin *origin = &plan->region_origins[i];
            is_here |= strcmp(origin->structs_uid, treatment->structs_uid) == 0;
            has_others |= origin->structs_uid[0] != 0;
        }
        if (!is_here)
            report_add(&plan->report, has_others ? REPORT_WARNING : REPORT_NOTE, "plan.structs-absent", "",
                       "The treatment plan \"%s\" refers to a structure set that is not in this folder%s.",
                       treatment->label,
                       has_others ? "; the regions here are of another one, and may not be those it was made for" : "");
    }
}

void plan_note_origins(struct loading *loading)
{
    note_patients(loading->plan, loading->file->is_phantom);
    note_absent_plans(loading->plan);
    note_absent_structs(loading->plan);
}
