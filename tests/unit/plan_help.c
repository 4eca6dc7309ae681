/* Opening plans for tests, and asking for their parts. */
#include "tests/unit/plan_help.h"

#include "core/load/load.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"

static const struct report_line *line_of(const struct report *report, const char *code)
{
    for (size_t i = 0; i < report->n_lines; i++)
        if (strcmp(report->lines[i].code, code) == 0)
            return &report->lines[i];
    return NULL;
}

bool report_has(const struct report *report, const char *code)
{
    return line_of(report, code) != NULL;
}

const char *report_said(const struct report *report, const char *code)
{
    const struct report_line *line = line_of(report, code);
    return line ? line->sentence : "";
}

struct plan *plan_of_folder(const char *folder, struct error *err)
{
    *err = (struct error){ 0 };
    return plan_load(folder, "p", NULL, err);
}

struct plan *plan_of_data(const char *name)
{
    char path[512];
    struct error err;
    if (!data_path(name, path, sizeof path))
        return NULL;
    struct plan *plan = plan_of_folder(path, &err);
    assert_string_equal(err.text, "");
    assert_non_null(plan);
    return plan;
}

const struct region *region_of(const struct plan *plan, const char *id)
{
    const struct region *region = region_find(&plan->regions, id);
    if (!region)
        fail_msg("no region %s", id);
    return region;
}

const char *parent_of(const struct plan *plan, const char *id)
{
    int parent = region_of(plan, id)->parent;
    return parent < 0 ? "" : plan->regions.regions[parent].id;
}
