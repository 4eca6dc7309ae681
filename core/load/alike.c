/* Names and orders doses and beams. */
#include "core/load/alike.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/load/part_names.h"
#include "core/load/plan_ids.h"
#include "core/plan/beam_doses.h"
#include "core/plan/identity.h"

enum { NAME_SIZE = 65, MOST = PLAN_MAX_BEAMS };
_Static_assert((int)MOST >= (int)PLAN_MAX_DOSES, "a list of names holds all doses");

/* The parts of one kind: names are changed in place and then written back. */
struct alike {
    const struct plan *plan;
    const struct part_origin *origins;
    char names[MOST][NAME_SIZE];
    bool is_renamed[MOST];
    size_t n;
};

/* Copies text, cut at a whole character. */
static void put(char *out, size_t size, const char *text)
{
    size_t n = strlen(text);
    if (n >= size)
        for (n = size - 1; n > 0 && ((unsigned char)text[n] & 0xc0) == 0x80;)
            n--;
    memcpy(out, text, n);
    out[n] = 0;
}

static const struct treatment_plan *treatment_of(const struct alike *alike, size_t i)
{
    int index = alike->origins[i].treatment_plan;
    return index >= 0 ? &alike->plan->treatment_plans[index] : NULL;
}

static void label_name(const struct alike *alike, size_t i, const char *name, char *out, size_t size)
{
    const struct treatment_plan *treatment = treatment_of(alike, i);
    const char *label = treatment                       ? (treatment->label[0] ? treatment->label : treatment->name)
                        : alike->origins[i].plan_uid[0] ? "plan not here"
                                                        : "";
    snprintf(out, size, "%.40s%s%s", label, label[0] ? ", " : "", name);
}

static void date_name(const struct alike *alike, size_t i, const char *name, char *out, size_t size)
{
    const struct treatment_plan *treatment = treatment_of(alike, i);
    const char *date = treatment ? treatment->date : "";
    if (strlen(date) == 8)
        snprintf(out, size, "%.48s, %.4s-%.2s-%.2s", name, date, date + 4, date + 6);
    else
        snprintf(out, size, "%s", name);
}

static void file_name(const struct alike *alike, size_t i, const char *name, char *out, size_t size)
{
    snprintf(out, size, "%.32s, %s", name, part_base_name(alike->origins[i].path));
}

/* Changes every name that another part has, too. */
static void change(struct alike *alike, size_t room,
                   void (*make)(const struct alike *alike, size_t i, const char *name, char *out, size_t size))
{
    bool is_alike[MOST] = { false };
    for (size_t i = 0; i < alike->n; i++)
        for (size_t j = 0; j < alike->n; j++)
            is_alike[i] |= i != j && alike->names[i][0] && strcmp(alike->names[i], alike->names[j]) == 0;
    for (size_t i = 0; i < alike->n; i++) {
        char made[700];
        if (!is_alike[i])
            continue;
        make(alike, i, alike->names[i], made, sizeof made);
        put(alike->names[i], room, made);
        alike->is_renamed[i] = true;
    }
}

static void change_all(struct alike *alike, size_t room)
{
    change(alike, room, label_name);
    change(alike, room, date_name);
    change(alike, room, file_name);
}

void plan_name_alike_doses(struct plan *plan)
{
    struct alike *alike = mem_new(sizeof *alike);
    *alike = (struct alike){ .plan = plan, .origins = plan->dose_origins, .n = plan->n_doses };
    for (size_t d = 0; d < plan->n_doses; d++)
        put(alike->names[d], sizeof plan->doses[d].name, plan->doses[d].name);
    change_all(alike, sizeof plan->doses[0].name);
    for (size_t d = 0; d < plan->n_doses; d++) {
        const char *others[PLAN_MAX_DOSES];
        size_t n = 0;
        if (!alike->is_renamed[d])
            continue;
        for (size_t o = 0; o < plan->n_doses; o++)
            if (o != d)
                others[n++] = plan->doses[o].id;
        put(plan->doses[d].name, sizeof plan->doses[d].name, alike->names[d]);
        plan_make_id(plan->doses[d].id, alike->names[d], "dose", others, n);
    }
    free(alike);
}

void plan_name_alike_beams(struct plan *plan)
{
    struct alike *alike = mem_new(sizeof *alike);
    *alike = (struct alike){ .plan = plan, .origins = plan->beam_origins, .n = plan->n_beams };
    for (size_t b = 0; b < plan->n_beams; b++)
        put(alike->names[b], sizeof plan->beams[b].name, plan->beams[b].name);
    change_all(alike, sizeof plan->beams[0].name);
    for (size_t b = 0; b < plan->n_beams; b++) {
        const char *others[PLAN_MAX_BEAMS];
        size_t n = 0;
        if (!alike->is_renamed[b])
            continue;
        for (size_t o = 0; o < plan->n_beams; o++)
            if (o != b)
                others[n++] = plan->beams[o].id;
        put(plan->beams[b].name, sizeof plan->beams[b].name, alike->names[b]);
        plan_make_id(plan->beams[b].id, alike->names[b], "beam", others, n);
    }
    free(alike);
}

/* ---- order ------------------------------------------------------------------------------------------------------ */

static int plan_rank(const struct plan *plan, const struct part_origin *origin)
{
    if (origin->treatment_plan >= 0)
        return origin->treatment_plan == plan_shown_treatment_plan(plan) ? 0 : 2;
    return origin->plan_uid[0] ? 3 : 1;
}

static int sum_rank(const struct plan *plan, size_t index)
{
    /* at "every beam": doses of all beams of the plan, which add up to the plan's */
    static const char *const words[] = { "plan",     "several plans",    "plan overview", "every beam",
                                         "fraction", "fraction session", "beam" };
    const struct dose *dose = &plan->doses[index];
    size_t all[PLAN_MAX_DOSES];
    int rank = 0;
    if (plan->dose_origins[index].beam > 0 && strcmp(dose->per, "beam") == 0 &&
        plan_beam_doses(plan, plan->dose_origins[index].treatment_plan, all) > 0)
        return 3;
    while (rank < (int)(sizeof words / sizeof words[0]) && strcmp(dose->per, words[rank]) != 0)
        rank++;
    return rank;
}

/* True if dose a is shown before dose b. */
static bool is_before(const struct plan *plan, size_t a, size_t b)
{
    int shown = plan_shown_patient(plan);
    const struct part_origin *of_a = &plan->dose_origins[a], *of_b = &plan->dose_origins[b];
    int by_patient = (of_a->patient >= 0 && of_a->patient != shown) - (of_b->patient >= 0 && of_b->patient != shown);
    int by_plan = plan_rank(plan, of_a) - plan_rank(plan, of_b);
    int by_sum = sum_rank(plan, a) - sum_rank(plan, b);
    bool is_beam_before = of_a->beam > 0 && of_a->treatment_plan == of_b->treatment_plan && of_a->beam < of_b->beam;
    return by_patient ? by_patient < 0 : by_plan ? by_plan < 0 : by_sum ? by_sum < 0 : is_beam_before;
}

void plan_order_doses(struct plan *plan)
{
    struct dose *dose = mem_new(sizeof *dose);
    for (size_t i = 1; i < plan->n_doses; i++)
        for (size_t at = i; at > 0 && is_before(plan, at, at - 1); at--) {
            const struct part_origin origin = plan->dose_origins[at];
            *dose = plan->doses[at];
            plan->doses[at] = plan->doses[at - 1];
            plan->dose_origins[at] = plan->dose_origins[at - 1];
            plan->doses[at - 1] = *dose;
            plan->dose_origins[at - 1] = origin;
        }
    free(dose);
}
