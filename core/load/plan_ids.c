/* Makes ids for the parts that are added to a plan, and checks the limit on its doses. */
#include "core/load/plan_ids.h"

#include <stdio.h>
#include <string.h>

#include "core/load/part_names.h"
#include "core/load/reader_table.h"

void plan_make_id(char id[64], const char *given, const char *path, const char *const *others, size_t n_others)
{
    const struct region_set none = { 0 };
    const char *base = part_base_name(path);
    char stem[128];
    int length = part_stem_length(base);
    snprintf(stem, sizeof stem, "%.*s", length < 100 ? length : 100, base);
    region_make_id(&none, given[0] ? given : stem, id);
    size_t n = strlen(id);
    bool is_taken = true;
    for (int number = 1; is_taken; number++) {
        if (number > 1)
            snprintf(id + n, 64 - n, "-%d", number);
        is_taken = false;
        for (size_t i = 0; i < n_others; i++)
            is_taken |= strcmp(others[i], id) == 0;
    }
}

bool plan_has_room_for_dose(struct plan *plan, const char *id, const char *where)
{
    if (plan->n_doses < PLAN_MAX_DOSES)
        return true;
    report_add(&plan->report, REPORT_WARNING, "plan.ignored-file", where, "More than %d doses; \"%s\" was left out.",
               PLAN_MAX_DOSES, id);
    return false;
}
