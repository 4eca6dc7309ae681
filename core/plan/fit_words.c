/* Sentences about pairs of parts, with their codes and values: fit_words.h. */
#include "core/plan/fit_words.h"

#include <stdarg.h>
#include <stdio.h>

#include "core/plan/fit_facts.h"

static void name_of(const struct plan *plan, struct fit_part part, char text[FIT_WHY_SIZE / 3])
{
    const size_t size = FIT_WHY_SIZE / 3;
    switch (part.kind) {
    case FIT_IMAGE: {
        const struct plan_image *image = &plan->images[part.index];
        snprintf(text, size, "%s", image->name[0] ? image->name : image->id);
        break;
    }
    case FIT_DOSE: {
        const struct dose *dose = &plan->doses[part.index];
        snprintf(text, size, "Dose “%s”", dose->name[0] ? dose->name : dose->id);
        break;
    }
    case FIT_BEAM: {
        const struct beam *beam = &plan->beams[part.index];
        snprintf(text, size, "Beam “%s”", beam->name[0] ? beam->name : beam->id);
        break;
    }
    case FIT_REGIONS: {
        const char *path = part.index ? plan->region_origins[part.index - 1].path : "";
        if (path[0])
            snprintf(text, size, "Regions of “%.100s”", path);
        else
            snprintf(text, size, "Regions");
        break;
    }
    case FIT_TRACKS:
    case FIT_N_KINDS: snprintf(text, size, "Tracks"); break;
    }
}

/* A sentence that is being written. */
struct saying {
    char text[FIT_WHY_SIZE / 2];
    struct sentence_facts facts;
};

static void PRINTF_LIKE(4, 5) say(char *text, size_t size, struct sentence_facts *facts, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    (void)vsnprintf(text, size, format, args);
    va_end(args);
    va_start(args, format);
    sentence_describe(facts, format, args);
    va_end(args);
}
#define SAY(saying, ...) say((saying)->text, sizeof(saying)->text, &(saying)->facts, __VA_ARGS__)

static void say_frame(enum fit_kind kind, struct saying *fact)
{
    switch (kind) {
    case FIT_DOSE: SAY(fact, "it was computed in another frame of reference"); break;
    case FIT_BEAM: SAY(fact, "it was planned in another frame of reference"); break;
    case FIT_REGIONS: SAY(fact, "they were drawn in another frame of reference"); break;
    case FIT_TRACKS: SAY(fact, "they were computed in another frame of reference"); break;
    case FIT_IMAGE:
    case FIT_N_KINDS: SAY(fact, "it was taken in another frame of reference"); break;
    }
}

static void say_plans(const struct plan *plan, struct fit_part thing, struct fit_part with, struct saying *fact)
{
    const struct part_origin *origins[2] = { fit_origin_of(plan, thing), fit_origin_of(plan, with) };
    const struct treatment_plan *of[2] = { fit_treatment_plan_of(plan, origins[0]),
                                           fit_treatment_plan_of(plan, origins[1]) };
    const char *labels[2];
    for (int i = 0; i < 2; i++)
        labels[i] = of[i] ? of[i]->label[0] ? of[i]->label : of[i]->name : "";
    if (thing.kind == FIT_REGIONS)
        SAY(fact, "they are of another structure set than the one that plan %.65s refers to", labels[1]);
    else
        SAY(fact, "it belongs to plan %.65s; shown is %.65s", labels[0][0] ? labels[0] : "that is not here",
            labels[1][0] ? labels[1] : "a plan that is not here");
}

static void say_units(const struct dose *a, const struct dose *b, struct saying *fact)
{
    double factor;
    if (!a->unit[0])
        SAY(fact, "it does not say its unit");
    else if (!b->unit[0])
        SAY(fact, "that one does not say its unit");
    else if (!fit_unit_factor(a->unit, b->unit, &factor))
        SAY(fact, "it is in %s, that one in %s", a->unit, b->unit);
    else if (fit_is_weighted_alone(a))
        SAY(fact, "it is weighted, that one physical");
    else
        SAY(fact, "it is physical, that one weighted");
}

static const char *per_words(const struct dose *dose)
{
    return dose->per[0] ? dose->per : "what it does not say";
}

static void say_apart(bool is_many, bool is_image, bool is_alone, struct saying *fact, struct saying *may)
{
    if (is_alone)
        SAY(fact, "its grid does not meet the regions");
    else if (is_many)
        SAY(fact, is_image ? "they do not meet the image" : "they do not meet it");
    else
        SAY(fact, is_image ? "its grid does not meet the image" : "its grid does not meet it");
    SAY(may,
        is_many ? " They may be another patient's, or a phantom's." : " It may be another patient's, or a phantom's.");
}

static void say_shifted(bool is_many, bool is_image, struct saying *may)
{
    if (is_many)
        SAY(may, is_image ? " They may be shifted against this image, or be another patient's."
                          : " They may be shifted against it, or be another patient's.");
    else
        SAY(may, is_image ? " It may be shifted against this image, or be another patient's."
                          : " It may be shifted against it, or be another patient's.");
}

/* The fact, and what it may mean. */
static void say_fact(const struct plan *plan, struct fit_part thing, struct fit_part with, enum fit_relation relation,
                     struct saying *fact, struct saying *may)
{
    bool is_many = thing.kind == FIT_REGIONS || thing.kind == FIT_TRACKS, is_image = with.kind == FIT_IMAGE;
    switch (relation) {
    case FIT_SAME: SAY(fact, "both are in one frame of reference"); break;
    case FIT_REGISTERED: SAY(fact, "a registration of this folder joins their frames of reference"); break;
    case FIT_UNSTATED: SAY(fact, "the files do not say whether they share a frame of reference"); break;
    case FIT_ABSENT:
        SAY(fact, fit_origin_of(plan, thing)->plan_uid[0] && plan->n_treatment_plans > 0
                      ? "it refers to a plan that is not in this folder"
                      : "it refers to a structure set that is not in this folder");
        break;
    case FIT_PER:
        SAY(fact, "it is per %.64s, that one per %.64s", per_words(&plan->doses[thing.index]),
            per_words(&plan->doses[with.index]));
        break;
    case FIT_UNIT: say_units(&plan->doses[thing.index], &plan->doses[with.index], fact); break;
    case FIT_PLAN: say_plans(plan, thing, with, fact); break;
    case FIT_APART:
        say_apart(is_many, is_image, thing.kind == with.kind && thing.index == with.index, fact, may);
        break;
    case FIT_FRAME:
        say_frame(thing.kind, fact);
        say_shifted(is_many, is_image, may);
        break;
    case FIT_PATIENT:
    case FIT_N_RELATIONS:
        if (fit_is_of_other(plan, thing) || !fit_is_of_other(plan, with))
            SAY(fact, is_many ? "they belong to another patient" : "it belongs to another patient");
        else
            SAY(fact, "that one belongs to another patient");
        break;
    }
}

enum verb { VERB_FITS, VERB_USED, VERB_NOT_USED, VERB_NEVER, VERB_BY_WORD };

static enum verb verb_of(enum fit_relation relation, bool is_by_word)
{
    if (is_by_word)
        return VERB_BY_WORD;
    return relation == FIT_SAME                                     ? VERB_FITS
           : relation == FIT_REGISTERED || relation == FIT_UNSTATED ? VERB_USED
           : relation == FIT_PATIENT || relation == FIT_N_RELATIONS ? VERB_NEVER
                                                                    : VERB_NOT_USED;
}

#define SAY_ALL(one, many, ...) \
    (is_many ? say(why, FIT_WHY_SIZE, facts, many, __VA_ARGS__) : say(why, FIT_WHY_SIZE, facts, one, __VA_ARGS__))

/* The sentence of a part without image. */
static void say_alone(enum verb verb, bool is_many, const char *name, const char *fact, const char *may,
                      char why[FIT_WHY_SIZE], struct sentence_facts *facts)
{
    switch (verb) {
    case VERB_FITS: SAY_ALL("%s fits: %s.%s", "%s fit: %s.%s", name, fact, may); break;
    case VERB_USED: SAY_ALL("%s is used: %s.%s", "%s are used: %s.%s", name, fact, may); break;
    case VERB_NOT_USED: SAY_ALL("%s is not used: %s.%s", "%s are not used: %s.%s", name, fact, may); break;
    case VERB_NEVER: SAY_ALL("%s is never used: %s.%s", "%s are never used: %s.%s", name, fact, may); break;
    case VERB_BY_WORD:
        SAY_ALL("%s is used though it does not fit: %s.%s", "%s are used though they do not fit: %s.%s", name, fact,
                may);
        break;
    }
}

static void say_pair(enum verb verb, bool is_many, char names[2][FIT_WHY_SIZE / 3], const char *fact, const char *may,
                     char why[FIT_WHY_SIZE], struct sentence_facts *facts)
{
    const char *thing = names[0], *with = names[1];
    switch (verb) {
    case VERB_FITS: SAY_ALL("%s fits %s: %s.%s", "%s fit %s: %s.%s", thing, with, fact, may); break;
    case VERB_USED: SAY_ALL("%s is used with %s: %s.%s", "%s are used with %s: %s.%s", thing, with, fact, may); break;
    case VERB_NOT_USED:
        SAY_ALL("%s is not used with %s: %s.%s", "%s are not used with %s: %s.%s", thing, with, fact, may);
        break;
    case VERB_NEVER:
        SAY_ALL("%s is never used with %s: %s.%s", "%s are never used with %s: %s.%s", thing, with, fact, may);
        break;
    case VERB_BY_WORD:
        SAY_ALL("%s is used with %s though it does not fit: %s.%s", "%s are used with %s though they do not fit: %s.%s",
                thing, with, fact, may);
        break;
    }
}

void fit_describe(const struct plan *plan, struct fit_part thing, struct fit_part with, enum fit_relation relation,
                  bool is_by_word, char why[FIT_WHY_SIZE], struct fit_words *words)
{
    char names[2][FIT_WHY_SIZE / 3];
    struct saying fact = { 0 }, may = { 0 };
    struct sentence_facts all = { 0 };
    bool is_many = thing.kind == FIT_REGIONS || thing.kind == FIT_TRACKS;
    enum verb verb = verb_of(relation, is_by_word);
    name_of(plan, thing, names[0]);
    name_of(plan, with, names[1]);
    say_fact(plan, thing, with, relation, &fact, &may);
    if (thing.kind == with.kind && thing.index == with.index)
        say_alone(verb, is_many, names[0], fact.text, may.text, why, &all);
    else
        say_pair(verb, is_many, names, fact.text, may.text, why, &all);
    if (words)
        *words = (struct fit_words){ all, fact.facts, may.facts };
}

void fit_sentence(const struct plan *plan, struct fit_part thing, struct fit_part with, enum fit_relation relation,
                  char why[FIT_WHY_SIZE])
{
    fit_describe(plan, thing, with, relation, false, why, NULL);
}

void fit_accepted_sentence(const struct plan *plan, struct fit_part thing, struct fit_part with,
                           enum fit_relation relation, char why[FIT_WHY_SIZE])
{
    fit_describe(plan, thing, with, relation, true, why, NULL);
}
