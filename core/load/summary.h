#pragma once
/* Summarises what a plan folder holds, from names and headers alone, for the list of plans. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct plan_summary {
    char name[128];
    char note[512];
    bool is_phantom;
    bool has_plan_file; /* has a plan.json, so it is meant to be a plan */
    bool is_readable;
    char reason[240];   /* why is_readable is false */
    char parts[16][64]; /* "CT", "3 regions", "4 dose components", "1 beam", ... */
    size_t n_parts;
    /* the treatment plan and the patient that are shown first; "": the files name none */
    char patient[48];                      /* masked */
    char patient_id[130];                  /* never shown: what a person types is compared with it */
    char label[65], date[9], approval[17]; /* as struct treatment_plan */
    size_t n_patients, n_treatment_plans;
    uint64_t n_bytes; /* of all files that the parts name */
};
/* Never fails: a folder that cannot be read has is_readable false and a reason. */
void plan_summarize(const char *folder, struct plan_summary *summary);
