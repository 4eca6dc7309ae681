#pragma once
/* What a plan folder holds, from names and headers alone: for the list of plans. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct plan_summary {
    char name[128];
    char note[512];
    bool is_phantom;
    bool is_readable;
    char reason[240];   /* why not, when not readable */
    char parts[16][64]; /* "CT", "3 regions", "4 dose components", "1 beam", ... */
    size_t n_parts;
    uint64_t n_bytes; /* of the files named */
};
/* Never fails: what cannot be read is said in reason. */
void plan_summarize(const char *folder, struct plan_summary *summary);
