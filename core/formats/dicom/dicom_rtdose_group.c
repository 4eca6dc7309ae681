/* Groups RT Dose objects into doses: which objects are components of one dose, and the names of doses. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/formats/dicom/dicom_rtdose.h"
#include "core/formats/text.h"

struct grouping {
    struct rtdose *objects;
    size_t n_objects;
    rtdose_beam_name beam_name;
    void *context;
    const char *where;
    struct dose *doses;
    size_t *from; /* NULL, or of each dose the index of its first object */
    size_t n_doses, most;
    struct report *report;
};

static const char *where_of(const struct grouping *grouping, const struct rtdose *object)
{
    return object->where ? object->where : grouping->where;
}

static bool agree(const struct rtdose *a, const struct rtdose *b)
{
    return strcmp(a->type, b->type) == 0 && strcmp(a->summation, b->summation) == 0 &&
           strcmp(a->units, b->units) == 0 && strcmp(a->plan_uid, b->plan_uid) == 0 &&
           strcmp(a->frame_uid, b->frame_uid) == 0 && a->n_beams == b->n_beams &&
           memcmp(a->beams, b->beams, a->n_beams * sizeof *a->beams) == 0;
}

/* Words join on one grid only; stated components may have several. */
static bool may_be_joined(const struct rtdose *a, const struct rtdose *b)
{
    return agree(a, b) && ((a->is_stated && b->is_stated) || grid_is_same(&a->values->grid, &b->values->grid));
}

/* Components that only BNCT has; photon and neutron doses may be of two treatments. */
static bool is_of_bnct(enum dose_quantity quantity)
{
    return quantity == DOSE_BORON || quantity == DOSE_NITROGEN;
}

/* True if the other is another component by its words. */
static bool is_other_component(const struct rtdose *object, const struct rtdose *other)
{
    return other != object && other->values && other->is_component && other->quantity != object->quantity &&
           other->quantity != DOSE_TOTAL && object->quantity != DOSE_TOTAL;
}

/* A component suggested by words only counts if another object has a different one, and boron or nitrogen is among
 * them: "photons" in a plan's description is no gamma component, and "photon plan" beside "neutron boost" no dose of
 * BNCT. */
static bool is_component(const struct grouping *grouping, const struct rtdose *object)
{
    if (!object->is_component || object->is_stated)
        return object->is_component;
    bool has_other = false, has_bnct = is_of_bnct(object->quantity);
    for (size_t i = 0; i < grouping->n_objects; i++) {
        const struct rtdose *other = &grouping->objects[i];
        if (!is_other_component(object, other) || !may_be_joined(object, other))
            continue;
        has_other = true;
        has_bnct |= is_of_bnct(other->quantity);
    }
    return has_other && has_bnct;
}

/* Reports the first two objects whose words are of two components, but which were not joined. Before any is consumed.
 */
static void report_not_joined(const struct grouping *grouping, const bool *is_given)
{
    for (size_t i = 0; i < grouping->n_objects; i++)
        for (size_t o = i + 1; o < grouping->n_objects; o++) {
            const struct rtdose *a = &grouping->objects[i], *b = &grouping->objects[o];
            if (!a->values || !a->is_component || !is_other_component(a, b) || !agree(a, b) ||
                (is_given[i] && is_given[o] && may_be_joined(a, b)))
                continue;
            report_add(
                grouping->report, REPORT_WARNING, "dose.words-not-joined", where_of(grouping, a),
                "\"%.60s\" and \"%.60s\" sound like %s and %s of one dose, but %s: each is a dose of its own. If they are "
                "one, name them as \"components\" in a plan.json.",
                a->description, b->description, dose_quantity_word(a->quantity), dose_quantity_word(b->quantity),
                may_be_joined(a, b) ? "nothing but these words says so" : "they lie on different grids");
            return;
        }
}

static const char *unit_of(const struct rtdose *object)
{
    return strcmp(object->units, "GY") == 0 ? "Gy" : strcmp(object->units, "RELATIVE") == 0 ? "relative" : "";
}

static const char *per_of(const struct rtdose *object)
{
    static const char *const words[][2] = { { "PLAN", "plan" },
                                            { "MULTI_PLAN", "several plans" },
                                            { "PLAN_OVERVIEW", "plan overview" },
                                            { "FRACTION", "fraction" },
                                            { "BEAM", "beam" },
                                            { "BRACHY", "brachytherapy setup" },
                                            { "FRACTION_SESSION", "fraction session" },
                                            { "BEAM_SESSION", "beam session" },
                                            { "BRACHY_SESSION", "brachytherapy session" },
                                            { "CONTROL_POINT", "control point" },
                                            { "RECORD", "treatment record" } };
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        if (strcmp(object->summation, words[i][0]) == 0)
            return words[i][1];
    return "";
}

/* Copies text, truncated at a whole character. */
static void put_text(char *out, size_t size, const char *text)
{
    size_t n = strlen(text);
    if (n >= size) {
        n = size - 1;
        while (n > 0 && ((unsigned char)text[n] & 0xc0) == 0x80)
            n--;
    }
    memcpy(out, text, n);
    out[n] = 0;
}

static bool is_taken(const struct grouping *grouping, const char *name)
{
    for (size_t i = 0; i < grouping->n_doses; i++)
        if (strcmp(grouping->doses[i].id, name) == 0)
            return true;
    return false;
}

/* Names a dose by description or comment, for the dose of a beam also by the beam; a number makes it unique. */
static void name_dose(const struct grouping *grouping, const struct rtdose *object, char id[64])
{
    char base[200], name[300], numbered[64];
    const char *text = object->description[0] && !(object->is_stated && strncmp(object->description, "BNCT:", 5) == 0)
                           ? object->description
                       : object->comment[0] && !object->is_stated ? object->comment
                       : object->is_stated                        ? "BNCT"
                                                                  : "Dose";
    put_text(base, sizeof base, text);
    put_text(name, sizeof name, base);
    const char *beam =
        object->n_beams == 1 && grouping->beam_name ? grouping->beam_name(grouping->context, object->beams[0]) : NULL;
    if (object->n_beams == 1 && strncmp(object->summation, "BEAM", 4) == 0) {
        if (beam)
            snprintf(name, sizeof name, "%.40s, %s", base, beam);
        else
            snprintf(name, sizeof name, "%.40s, beam %lld", base, (long long)object->beams[0]);
    }
    char clean[300];
    text_clean(name, clean, sizeof clean);
    put_text(numbered, sizeof numbered - 8, clean);
    put_text(id, 64, numbered);
    for (int number = 2; is_taken(grouping, id); number++)
        snprintf(id, 64, "%s (%d)", numbered, number);
}

static struct dose *new_dose(struct grouping *grouping, const struct rtdose *object)
{
    if (grouping->n_doses >= grouping->most) {
        report_add(grouping->report, REPORT_WARNING, "dose.left-out", where_of(grouping, object),
                   "More than %zu doses; \"%s\" is left out.", grouping->most, object->description);
        return NULL;
    }
    struct dose *dose = &grouping->doses[grouping->n_doses];
    *dose = (struct dose){ 0 };
    name_dose(grouping, object, dose->id);
    if (grouping->from)
        grouping->from[grouping->n_doses] = (size_t)(object - grouping->objects);
    snprintf(dose->unit, sizeof dose->unit, "%s", unit_of(object));
    snprintf(dose->per, sizeof dose->per, "%s", per_of(object));
    grouping->n_doses++;
    if (!dose->unit[0])
        report_add(grouping->report, REPORT_WARNING, "dose.no-unit", where_of(grouping, object),
                   "\"%s\": the dose's units are \"%s\".", dose->id, object->units);
    if (!dose->per[0])
        report_add(grouping->report, REPORT_NOTE, "dose.no-per", where_of(grouping, object),
                   "\"%s\": the file does not say what was summed.", dose->id);
    if (strcmp(object->type, "PHYSICAL") != 0 && strcmp(object->type, "EFFECTIVE") != 0)
        report_add(grouping->report, REPORT_WARNING, "dose.type", where_of(grouping, object),
                   "\"%s\" is of type \"%s\": it may not be a dose but a difference of two.", dose->id, object->type);
    return dose;
}

static void add_component(struct dose *dose, struct rtdose *object, enum dose_quantity quantity)
{
    struct dose_component *component = &dose->components[dose->n_components++];
    *component = (struct dose_component){ .quantity = quantity, .values = object->values };
    object->values = NULL;
    if (object->has_frame) { /* the frame check that came out worst among its components */
        dose->frame = dose->has_frame && dose->frame > object->frame ? dose->frame : object->frame;
        dose->has_frame = true;
    }
    if ((quantity == DOSE_TOTAL || quantity == DOSE_WEIGHTED_TOTAL) && object->ppm > 0) {
        component->has_boron_ppm = true;
        component->boron_ppm = object->ppm;
    }
    if ((quantity == DOSE_BORON || quantity == DOSE_BLOOD_BORON) && object->ppm > 0) {
        component->is_per_ppm = true;
        component->values->slope /= object->ppm;
        component->values->offset /= object->ppm;
        component->values->low /= object->ppm;
        component->values->high /= object->ppm;
    }
}

static bool has_quantity(const struct dose *dose, enum dose_quantity quantity)
{
    for (size_t i = 0; i < dose->n_components; i++)
        if (dose->components[i].quantity == quantity)
            return true;
    return false;
}

/* Makes one dose from an object and all objects that agree with it. is_given: which objects were components before any
 * was consumed. */
static void add_components(struct grouping *grouping, size_t first, const bool *is_given)
{
    struct rtdose *object = &grouping->objects[first];
    const struct rtdose like = *object; /* a copy: its values move into the dose */
    struct dose *dose = new_dose(grouping, object);
    if (!dose)
        return;
    char words[200] = "";
    for (size_t i = first; i < grouping->n_objects; i++) {
        struct rtdose *other = &grouping->objects[i];
        if (!other->values || !is_given[i] || !may_be_joined(&like, other) || has_quantity(dose, other->quantity))
            continue;
        size_t n = strlen(words);
        snprintf(words + n, sizeof words - n, "%s%s", n ? ", " : "", dose_quantity_word(other->quantity));
        if (other->quantity == DOSE_BORON && !(other->ppm > 0))
            report_add(grouping->report, REPORT_WARNING, "dose.no-ppm", where_of(grouping, other),
                       "\"%s\": nothing says for how much boron-10 the boron dose holds; it is shown as it is.",
                       dose->id);
        if (other->quantity == DOSE_BORON && other->ppm > 0 && other->ppm != 1)
            report_add(grouping->report, REPORT_NOTE, "dose.per-ppm", where_of(grouping, other),
                       "\"%s\": the boron dose holds for %g ppm and was divided by that.", dose->id, other->ppm);
        add_component(dose, other, other->quantity);
    }
    report_add(
        grouping->report, REPORT_NOTE, "dose.components", where_of(grouping, &like),
        "\"%s\" is put together from %zu objects by their %s: %s. A plan.json that names each as a dose keeps them "
        "apart.",
        dose->id, dose->n_components, like.is_stated ? "descriptions" : "descriptions' words", words);
}

static void add_alone(struct grouping *grouping, struct rtdose *object)
{
    struct dose *dose = new_dose(grouping, object);
    if (!dose)
        return;
    add_component(dose, object, strcmp(object->type, "EFFECTIVE") == 0 ? DOSE_WEIGHTED_TOTAL : DOSE_TOTAL);
    for (size_t i = 0; i < object->n_stated; i++)
        dose->stated[i] = object->stated[i];
    dose->n_stated = object->n_stated;
}

static void leave_out_zeros(struct grouping *grouping)
{
    for (size_t i = 0; i < grouping->n_objects; i++) {
        struct rtdose *object = &grouping->objects[i];
        if (!object->values || !object->is_all_zero)
            continue;
        report_add(grouping->report, REPORT_WARNING, "dose.all-zero", where_of(grouping, object),
                   "A dose (\"%s\", %s of %zu beams) is 0 everywhere and is not listed.", object->description,
                   object->summation, object->n_beams);
        rtdose_finish(object);
    }
}

static void report_beams(const struct grouping *grouping, size_t n_beam_doses, bool has_plan_dose)
{
    if (n_beam_doses > 1 && !has_plan_dose)
        report_add(grouping->report, REPORT_NOTE, "dose.not-summed", grouping->where,
                   "%zu doses are of single beams and stand one beside the other; no file has their sum.",
                   n_beam_doses);
}

size_t rtdose_group(struct rtdose *objects, size_t n_objects, rtdose_beam_name beam_name, void *context,
                    const char *where, struct dose *doses, size_t *from, size_t most, struct report *report)
{
    struct grouping grouping = { objects, n_objects, beam_name, context, where, doses, from, 0, most, report };
    size_t n_beam_doses = 0;
    bool has_plan_dose = false;
    bool *is_given = mem_new(n_objects + 1);
    leave_out_zeros(&grouping);
    for (size_t i = 0; i < n_objects; i++) {
        is_given[i] = objects[i].values && is_component(&grouping, &objects[i]);
        n_beam_doses += objects[i].values && !is_given[i] && strcmp(objects[i].summation, "BEAM") == 0;
        has_plan_dose |= objects[i].values && strcmp(objects[i].summation, "PLAN") == 0;
    }
    report_not_joined(&grouping, is_given);
    for (size_t i = 0; i < n_objects; i++) {
        if (objects[i].values && is_given[i])
            add_components(&grouping, i, is_given);
        else if (objects[i].values)
            add_alone(&grouping, &objects[i]);
        rtdose_finish(&objects[i]); /* an object that found no room */
    }
    report_beams(&grouping, n_beam_doses, has_plan_dose);
    free(is_given);
    return grouping.n_doses;
}
