/* Prints patients and treatment plans. */
#include "server/cli/info_origins.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/plan/identity.h"
#include "server/cli/text.h"

static void print_date(const char *text)
{
    if (strlen(text) == 8 && strspn(text, "0123456789") == 8)
        printf("%.4s-%.2s-%.2s", text, text + 4, text + 6);
    else
        text_print(stdout, text, 0);
}

static void print_patient(const struct plan_patient *patient, bool is_full)
{
    char masked[IDENTITY_MASK_SIZE];
    identity_mask(patient, masked);
    printf("  ");
    text_print(stdout, is_full ? patient->name : masked, 0);
    if (is_full && *patient->id) {
        printf("  id ");
        text_print(stdout, patient->id, 0);
    }
    if (is_full && *patient->issuer) {
        printf(" of ");
        text_print(stdout, patient->issuer, 0);
    }
    if (is_full && *patient->birth_date) {
        printf("  born ");
        print_date(patient->birth_date);
    }
    printf("%s\n", patient->has_conflict ? "  (another name or birth date is there under this ID)" : "");
}

static void print_treatment_plan(const struct plan *plan, size_t index)
{
    const struct treatment_plan *treatment = &plan->treatment_plans[index];
    printf("  ");
    text_print(stdout, *treatment->label ? treatment->label : "(without a label)", 0);
    printf("  ");
    text_print(stdout, *treatment->approval ? treatment->approval : "approval not stated", 0);
    if (*treatment->date) {
        printf("  of ");
        print_date(treatment->date);
    }
    if (treatment->n_fractions > 0)
        printf("  %lld fractions", (long long)treatment->n_fractions);
    if (isfinite(treatment->prescription_gy))
        printf("  %.4g Gy prescribed", treatment->prescription_gy);
    bool is_marked = plan->n_treatment_plans > 1 && plan_shown_treatment_plan(plan) == (int)index;
    printf("%s\n", is_marked ? "  (shown first)" : "");
}

void info_print_origins(const struct plan *plan, bool is_full)
{
    if (plan->n_patients > 0)
        printf("\nPatient%s\n", plan->n_patients == 1 ? "" : "s");
    for (size_t i = 0; i < plan->n_patients; i++)
        print_patient(&plan->patients[i], is_full);
    if (plan->n_treatment_plans > 0)
        printf("\nTreatment plan%s\n", plan->n_treatment_plans == 1 ? "" : "s");
    for (size_t i = 0; i < plan->n_treatment_plans; i++)
        print_treatment_plan(plan, i);
}
