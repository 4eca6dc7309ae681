/* Applies what a person has stated of whom a plan is of. */
#include "core/plan/statement.h"

#include <string.h>

#include "core/plan/identity.h"
#include "core/plan/plan.h"
#include "core/plan/plan_bounds.h"

const char *statement_kind_word(enum statement_kind kind)
{
    return kind == STATEMENT_ONE_PERSON ? "one-person" : kind == STATEMENT_IDENTITY ? "identity" : "";
}

const char *statement_state_word(enum statement_state state)
{
    return state == STATEMENT_USED       ? "used"
           : state == STATEMENT_OUTDATED ? "outdated"
           : state == STATEMENT_UNREAD   ? "unread"
                                         : "contradicted";
}

static void set_patient(int *patient, int shown)
{
    if (*patient >= 0)
        *patient = shown;
}

static void set_all(struct part_origin *origins, size_t n, int shown)
{
    for (size_t i = 0; i < n; i++)
        set_patient(&origins[i].patient, shown);
}

/* Lines that say that the patients count as several say that they count as one. */
static void say_one_person(struct report *report, const struct plan_statement *statement)
{
    for (size_t i = 0; i < report->n_lines; i++) {
        struct report_line *line = &report->lines[i];
        if (strcmp(line->code, "patient.several") == 0)
            report_line_say(line, "This folder's files name several patients. %s has stated that they are one person.",
                            statement->by);
        else if (strcmp(line->code, "patient.conflict") == 0)
            report_line_say(line,
                            "Files with the same patient ID differ in name or birth date. %s has stated that they are "
                            "of one person.",
                            statement->by);
    }
}

static void make_one_person(struct plan *plan, const struct plan_statement *statement)
{
    const int shown = plan_shown_patient(plan);
    set_all(plan->image_origins, plan->n_images, shown);
    set_all(plan->dose_origins, plan->n_doses, shown);
    set_all(plan->beam_origins, plan->n_beams, shown);
    set_all(plan->region_origins, plan->n_region_origins, shown);
    set_all(&plan->tracks_origin, 1, shown);
    for (size_t i = 0; i < plan->n_treatment_plans; i++)
        set_patient(&plan->treatment_plans[i].patient, shown);
    for (size_t i = 0; i < plan->n_registrations; i++)
        set_patient(&plan->registrations[i].patient, shown);
    say_one_person(&plan->report, statement);
    plan_measure_bounds(plan); /* the parts that were another patient's belong to it */
}

static bool is_named_alike(const struct plan_patient *a, const struct plan_patient *b)
{
    return strcmp(a->id, b->id) == 0 && strcmp(a->name, b->name) == 0 &&
           (!a->birth_date[0] || !b->birth_date[0] || strcmp(a->birth_date, b->birth_date) == 0);
}

/* True if a patient of the files is the one that was stated, or the files name nobody. */
static bool agrees(const struct plan *plan, const struct plan_patient *stated)
{
    for (size_t i = 0; i < plan->n_patients; i++)
        if (is_named_alike(&plan->patients[i], stated))
            return true;
    return plan->n_patients == 0;
}

void plan_state(struct plan *plan, const struct plan_statement *statement, enum statement_files files)
{
    const bool is_identity = statement->kind == STATEMENT_IDENTITY, is_current = files == STATEMENT_SAME_FILES;
    plan->statement = *statement;
    plan->statement.state = STATEMENT_OUTDATED;
    if (is_identity && !agrees(plan, &statement->patient)) {
        plan->statement.state = STATEMENT_CONTRADICTED;
        report_add(&plan->report, REPORT_ERROR, "patient.stated-differs", "",
                   "The files name another patient than %s has stated. The files count.", statement->by);
    } else if (files == STATEMENT_FILES_UNREAD) {
        plan->statement.state = STATEMENT_UNREAD;
        report_add(&plan->report, REPORT_WARNING, "patient.statement-unread", "",
                   "Whether these are the files of which %s has stated whose they are could not be found out, as they "
                   "could not be read a second time. The statement does not count until they are.",
                   statement->by);
    } else if (is_current && !is_identity && plan->n_patients > 1) {
        plan->statement.state = STATEMENT_USED;
        make_one_person(plan, statement);
    } else if (is_current && is_identity && plan->n_patients == 0 && !plan->is_phantom) {
        plan->statement.state = STATEMENT_USED;
        plan->patients[plan->n_patients++] = statement->patient;
        report_add(&plan->report, REPORT_NOTE, "patient.stated", "",
                   "The files name no patient. %s has stated whose they are.", statement->by);
    }
}
