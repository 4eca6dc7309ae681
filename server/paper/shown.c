/* Parts of the plan that the record shows. */
#include <string.h>

#include "server/paper/blocks.h"
#include "server/wire/json.h"

/* The part of a list of the kept plan with this id; NULL: it has none. */
const cJSON *paper_part_of(const struct paper *paper, const char *list, const char *id)
{
    const cJSON *part;
    cJSON_ArrayForEach(part, cJSON_GetObjectItemCaseSensitive(paper->plan, list))
    {
        const char *of = json_text(part, "id");
        if (id && of && strcmp(of, id) == 0)
            return part;
    }
    return NULL;
}

const cJSON *paper_shown_dose(const struct paper *paper)
{
    return paper_part_of(paper, "doses", json_text(cJSON_GetObjectItemCaseSensitive(paper->kept, "dose"), "id"));
}

const char *region_name(const struct paper *paper, const char *id)
{
    const cJSON *region;
    cJSON_ArrayForEach(region, cJSON_GetObjectItemCaseSensitive(paper->plan, "regions"))
    {
        const char *own = json_text(region, "id"), *name = json_text(region, "name");
        if (own && strcmp(own, id) == 0)
            return name && name[0] ? name : id;
    }
    return id;
}

static bool is_number(const cJSON *item, double number)
{
    const double own = json_number(item, "statement_ms", 0);
    return !(own < number) && !(own > number);
}

bool paper_is_of_same(const struct paper *paper, const cJSON *item)
{
    const cJSON *body = cJSON_GetObjectItemCaseSensitive(paper->source->item, "body");
    const char *own = json_text(item, "plan_revision"), *printed = json_text(body, "plan_revision");
    return strcmp(own ? own : "", printed ? printed : "") == 0 && is_number(item, json_number(body, "statement_ms", 0));
}

/* Chosen as the page does (web/js/room/identity.js): by the shown dose, else as the plan's document says. */
const cJSON *paper_treatment(const struct paper *paper)
{
    const cJSON *list = cJSON_GetObjectItemCaseSensitive(paper->plan, "treatment_plans");
    const double of_dose = json_number(paper_shown_dose(paper), "plan", -1);
    const cJSON *found = of_dose >= 0 && of_dose < 1e6 ? cJSON_GetArrayItem(list, (int)of_dose) : NULL;
    return found ? found : cJSON_GetArrayItem(list, (int)json_number(paper->plan, "shown_plan", 0));
}
