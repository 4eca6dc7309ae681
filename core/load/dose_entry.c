/* Applies an entry of plan.json's "doses" to a dose of the plan. */
#include "core/load/dose_entry.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

void plan_dose_units(struct dose *dose, const struct plan_file_dose *entry, bool is_sera, struct report *report)
{
    const char *path = entry->components[0].path;
    snprintf(dose->unit, sizeof dose->unit, "%s", is_sera ? "cGy" : entry->unit);
    snprintf(dose->per, sizeof dose->per, "%s", is_sera && !entry->per[0] ? "unit of the source" : entry->per);
    if (!dose->unit[0])
        report_add(report, REPORT_WARNING, "dose.no-unit", path, "The plan does not say the unit of the dose \"%s\".",
                   dose->id);
    if (is_sera && entry->unit[0] && strcmp(entry->unit, dose->unit) != 0)
        report_add(report, REPORT_WARNING, "dose.unit-differs", path,
                   "The plan says that the dose \"%s\" is in %s; a file of SERA is in cGy, and that was used.",
                   dose->id, entry->unit);
    if (!entry->per[0])
        report_add(
            report, REPORT_NOTE, "dose.no-per", path,
            is_sera
                ? "The dose \"%s\" is for one unit of the source, as its source file normalises it; neither the plan nor the "
                  "file says what that unit is, for instance 250 kW-min."
                : "The plan does not say what the dose \"%s\" is per: a fraction, a minute, the whole treatment.",
            dose->id);
}

void plan_dose_frame(struct dose *dose, const struct plan_file_dose *entry, const char *where, struct report *report)
{
    if (!entry->has_frame)
        return;
    dose->frame = dose->has_frame && dose->frame > entry->frame ? dose->frame : entry->frame;
    dose->has_frame = true;
    if (entry->frame == DOSE_FRAME_DIFFERS)
        report_add(
            report, REPORT_WARNING, "dose.frame-differs", where,
            "The plan says that the dose \"%s\" is in another frame of reference than the image; it may be shifted against it.",
            dose->id);
}

static void add(struct dose *dose, struct dose_component component, const char *path, struct report *report)
{
    assert(dose->n_components < DOSE_N_QUANTITIES); /* a dose has each quantity once */
    dose->components[dose->n_components++] = component;
    if (component.values->low < 0)
        report_add(report, REPORT_WARNING, "dose.negative", path, "The smallest value is %g.", component.values->low);
}

void plan_add_component(struct dose *dose, const struct plan_file_dose *entry, size_t component, struct volume *values,
                        struct report *report)
{
    const struct plan_file_component *from = &entry->components[component];
    dose->reference[from->quantity] = from->reference;
    add(dose,
        (struct dose_component){ .quantity = from->quantity,
                                 .is_per_ppm = from->is_per_ppm,
                                 .has_boron_ppm = from->has_boron_ppm,
                                 .boron_ppm = from->boron_ppm,
                                 .values = values },
        from->path, report);
}

static bool is_named(const struct plan_file_dose *entry, enum dose_quantity quantity)
{
    bool is_there = false;
    for (size_t i = 0; i < entry->n_components; i++)
        is_there |= entry->components[i].quantity == quantity;
    return is_there;
}

void plan_add_sera(struct dose *dose, const struct plan_file_dose *entry, size_t component, struct sera_doses *doses,
                   struct report *report)
{
    const struct plan_file_component *from = &entry->components[component];
    bool is_any = false;
    for (size_t i = 0; i < doses->n_components; i++) {
        struct dose_component *held = &doses->components[i];
        bool is_named_here =
            from->quantity == held->quantity || (from->quantity == DOSE_TOTAL && !is_named(entry, held->quantity));
        if (!is_named_here || dose->n_components >= DOSE_N_QUANTITIES)
            continue;
        bool is_given = from->reference > 0 && from->quantity == held->quantity;
        dose->reference[held->quantity] = is_given ? from->reference : doses->reference[held->quantity];
        add(dose, *held, from->path, report);
        held->values = NULL;
        is_any = true;
    }
    if (!is_any)
        report_add(report, REPORT_WARNING, "dose.no-quantity", from->path, "The file holds no %s of the dose \"%s\".",
                   dose_quantity_word(from->quantity), dose->id);
    if (doses->mask && !dose->mask) {
        dose->mask = doses->mask;
        doses->mask = NULL;
    }
}
