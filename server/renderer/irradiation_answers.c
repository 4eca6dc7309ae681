/* Answers how long to irradiate until each limit of the scene is met. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/derive/dose_growth.h"
#include "core/derive/dose_histogram.h"
#include "core/dose/irradiation.h"
#include "core/region/target.h"
#include "server/renderer/answers.h"
#include "server/renderer/dose_answers.h"
#include "server/wire/json.h"
#include "server/wire/sentence_json.h"

struct given_field {
    const struct dose *dose;
    double share; /* of the output; all make 1 */
};

struct irradiation {
    const struct snapshot *snapshot;
    struct given_field fields[PLAN_MAX_DOSES];
    struct dose_given given[PLAN_MAX_DOSES];
    size_t n;
    struct source_output output; /* amount 1: its kind's unit */
    double minutes;              /* per unit of output; NAN */
    struct error why;            /* code 0: it can be computed */
};

/* ---- what is given ---------------------------------------------------------------------------------------------- */

static void add_field(struct irradiation *all, size_t dose, double share, bool is_measured, double ppm)
{
    all->fields[all->n] = (struct given_field){ &all->snapshot->plan->doses[dose], share };
    all->given[all->n++] = (struct dose_given){ .dose = dose, .blood_ppm = ppm, .is_measured = is_measured };
}

/* The fields of the scene in the order of the plan's doses, or the dose shown alone. */
static void find_fields(struct irradiation *all)
{
    const struct scene *scene = &all->snapshot->scene;
    const struct scene_irradiation *asked = &scene->irradiation;
    bool is_measured = asked->has_blood_ppm;
    double ppm = is_measured ? asked->blood_ppm : scene->dose.blood_ppm;
    for (size_t d = 0; d < all->snapshot->plan->n_doses; d++)
        for (size_t i = 0; i < asked->n_fields; i++) {
            const struct scene_irradiation_field *field = &asked->fields[i].value;
            if (strcmp(asked->fields[i].id, all->snapshot->plan->doses[d].id) == 0)
                add_field(all, d, field->share, is_measured || field->has_blood_ppm,
                          field->has_blood_ppm ? field->blood_ppm : ppm);
        }
    if (all->n == 0)
        add_field(all, (size_t)all->snapshot->dose, 1, is_measured, ppm);
}

/* Finds the common unit of output; with why: there is none. */
static void find_output(struct irradiation *all)
{
    char per[FIT_PER_SIZE];
    double sum = 0;
    for (size_t i = 0; i < all->n; i++)
        sum += all->fields[i].share;
    for (size_t i = 0; i < all->n && !all->why.code; i++) {
        struct source_output output;
        if (!source_output_parse(fit_per(all->fields[i].dose, per), &output))
            (void)error_set(&all->why, ERROR_NOT_FOUND,
                            "dose \"%s\" does not say what it is per, so no time follows from it",
                            all->fields[i].dose->id);
        else if (i > 0 && !source_outputs_add(&output, &all->output))
            (void)error_set(&all->why, ERROR_RANGE,
                            "dose \"%s\" is per %s, dose \"%s\" per %s: they have no output of the source in common",
                            all->fields[0].dose->id, all->output.words, all->fields[i].dose->id, output.words);
        else {
            all->fields[i].share /= sum;
            all->given[i].factor = all->fields[i].share / output.amount;
            all->output = output;
        }
    }
    all->output.amount = 1;
    const struct scene_irradiation *asked = &all->snapshot->scene.irradiation;
    static const enum source_rate_unit units[] = { [SCENE_SOURCE_RATE_UNIT_KW] = SOURCE_KILOWATT,
                                                   [SCENE_SOURCE_RATE_UNIT_MW] = SOURCE_MEGAWATT,
                                                   [SCENE_SOURCE_RATE_UNIT_MA] = SOURCE_MILLIAMPERE };
    all->minutes =
        all->why.code ? NAN : source_minutes(&all->output, asked->has_rate ? asked->rate : 0, units[asked->rate_unit]);
}

/* ---- one figure ------------------------------------------------------------------------------------------------- */

/* The unit and quantity of the figures of a region. */
struct counted {
    const struct irradiation *all;
    size_t region;
    struct dose_choice choice;  /* per one unit of output */
    struct dose_growth *growth; /* of an isoeffective dose, which is not in proportion to the output; else NULL */
    bool is_borrowed;           /* growth */
};

static void counted_finish(struct counted *counted)
{
    if (!counted->is_borrowed)
        dose_growth_destroy(counted->growth);
}

/* The figure of one limit, with the histogram that it is of. */
struct limit {
    const struct scene_constraint *constraint;
    const struct region *region;
    struct dvh_metric metric;
    struct counted counted;
    struct dvh dvh; /* at one unit of output */
    struct irradiation_reach reach;
    struct error why; /* code 0: reach is there */
    bool is_known;    /* the bounds of reach are one */
};

/* False with why: an isoeffective dose depends on how long the irradiation takes. */
static bool has_minutes(const struct irradiation *all, struct error *why)
{
    if (isfinite(all->minutes))
        return true;
    if (all->output.kind == SOURCE_COUNT)
        return error_set(why, ERROR_UNSUPPORTED,
                         "the isoeffective dose depends on how long the irradiation takes, and no time follows from a "
                         "dose per %s",
                         all->output.words);
    return error_set(
        why, ERROR_NOT_FOUND,
        "the isoeffective dose depends on how long the irradiation takes: the source's strength is needed, "
        "in a unit that fits %s",
        all->output.words);
}

/* Chooses a region's quantity, with the region's own weights or those of a tissue. */
static bool find_counted(const struct irradiation *all, const struct region *region, enum scene_dose_quantity quantity,
                         const char *tissue, struct counted *counted, struct error *why)
{
    const struct snapshot *snapshot = all->snapshot;
    const enum region_population population = scene_population(snapshot->plan, &snapshot->scene);
    counted->all = all;
    counted->region = (size_t)(region - snapshot->plan->regions.regions);
    if (all->why.code)
        return error_set(why, all->why.code, "%s", all->why.text);
    if (!dose_is_counted(snapshot, counted->region, why) ||
        !dose_choice_given(snapshot, all->given, all->n, quantity, tissue, &counted->choice, why))
        return false;
    if (quantity != SCENE_DOSE_QUANTITY_ISOEFFECTIVE)
        return true;
    if (has_minutes(all, why) && !counted->growth)
        counted->growth = dose_growth_create(snapshot->derived, &counted->choice, counted->region, population, why);
    return counted->growth != NULL;
}

/* The histogram at an output; of a dose in proportion to it that of one unit. */
static bool histogram_at(void *context, double output, struct dvh *dvh, struct error *err)
{
    const struct counted *counted = context;
    const struct snapshot *snapshot = counted->all->snapshot;
    if (counted->growth)
        return dose_growth_histogram(counted->growth, output, output * counted->all->minutes, dvh, err);
    return dose_histogram_get(snapshot->derived, &counted->choice, counted->region,
                              scene_population(snapshot->plan, &snapshot->scene), DOSE_BY_REGION, 1, dvh, err);
}

/* The bounds of a figure at an output. dvh: the histogram at one unit. NAN: they are not known. */
static void figure_at(struct counted *counted, const struct dvh *dvh, const struct dvh_metric *metric, double output,
                      double *least, double *most)
{
    struct dvh then = { 0 };
    *least = *most = NAN;
    if (!(dvh->n > 0) || !isfinite(output))
        return;
    if (!counted->growth) {
        irradiation_figure(dvh, metric, output, least, most);
        return;
    }
    if (histogram_at(counted, output, &then, NULL))
        dvh_metric_range(&then, metric, least, most);
    dvh_finish(&then);
}

static bool find_reach(struct limit *limit)
{
    const struct scene_constraint *constraint = limit->constraint;
    const bool is_at_most = constraint->side == SCENE_LIMIT_SIDE_AT_MOST;
    if (!histogram_at(&limit->counted, 1, &limit->dvh, &limit->why))
        return false;
    return limit->counted.growth ? irradiation_reach_growing(histogram_at, &limit->counted, &limit->metric, is_at_most,
                                                             constraint->limit, &limit->reach, &limit->why)
                                 : irradiation_reach_of(&limit->dvh, &limit->metric, is_at_most, constraint->limit,
                                                        &limit->reach, &limit->why);
}

/* The growth of an earlier limit of this region and tissue; NULL: there is none. */
static struct dose_growth *growth_among(const struct limit *limits, size_t n, const struct scene_constraint *constraint)
{
    for (size_t i = 0; i < n; i++)
        if (limits[i].counted.growth && constraint->quantity == SCENE_DOSE_QUANTITY_ISOEFFECTIVE &&
            strcmp(limits[i].constraint->region, constraint->region) == 0 &&
            strcmp(limits[i].constraint->tissue, constraint->tissue) == 0)
            return limits[i].counted.growth;
    return NULL;
}

/* Finds limits[n], after those before it. */
static void find_limit(const struct irradiation *all, const struct scene_constraint *constraint, struct limit *limits,
                       size_t n)
{
    struct limit *limit = &limits[n];
    *limit = (struct limit){ .constraint = constraint,
                             .region = region_find(&all->snapshot->plan->regions, constraint->region) };
    limit->counted.growth = growth_among(limits, n, constraint);
    limit->counted.is_borrowed = limit->counted.growth != NULL;
    bool has_reach =
        (limit->region || error_set(&limit->why, ERROR_NOT_FOUND, "no region is chosen")) &&
        dvh_metric_parse(constraint->metric, &limit->metric, &limit->why) &&
        find_counted(all, limit->region, constraint->quantity, constraint->tissue, &limit->counted, &limit->why) &&
        find_reach(limit);
    if (!has_reach)
        limit->reach = (struct irradiation_reach){ NAN, NAN };
    limit->is_known = has_reach && limit->reach.least == limit->reach.most;
    if (has_reach && !limit->is_known)
        (void)error_set(&limit->why, ERROR_NOT_FOUND, "%.3g %% of the region have no dose",
                        100 * limit->dvh.n_missing / (limit->dvh.n + limit->dvh.n_missing));
}

/* The limit at most that is met for the shortest time; -1: none is known. *is_certain: no other may come before it. */
static int first_limit(const struct limit *limits, size_t n, bool *is_certain)
{
    int first = -1;
    for (size_t i = 0; i < n; i++)
        if (limits[i].constraint->side == SCENE_LIMIT_SIDE_AT_MOST && limits[i].is_known &&
            isfinite(limits[i].reach.least) && (first < 0 || limits[i].reach.least < limits[first].reach.least))
            first = (int)i;
    *is_certain = first >= 0;
    for (size_t i = 0; first >= 0 && i < n; i++)
        if (limits[i].constraint->side == SCENE_LIMIT_SIDE_AT_MOST && !limits[i].is_known &&
            !(limits[i].reach.least >= limits[first].reach.least))
            *is_certain = false;
    return first;
}

/* ---- the answer ------------------------------------------------------------------------------------------------- */

static void add_fields(cJSON *json, const struct irradiation *all, double output)
{
    cJSON *list = cJSON_AddArrayToObject(json, "fields");
    for (size_t i = 0; i < all->n; i++) {
        cJSON *row = cJSON_CreateObject();
        double units = output * all->fields[i].share;
        cJSON_AddStringToObject(row, "dose", all->fields[i].dose->id);
        cJSON_AddStringToObject(row, "per", all->fields[i].dose->per);
        json_add_finite(row, "share", all->fields[i].share);
        json_add_finite(row, "blood_ppm", all->given[i].blood_ppm);
        cJSON_AddBoolToObject(row, "is_measured", all->given[i].is_measured);
        json_add_finite(row, "units", units);
        json_add_finite(row, "minutes", units * all->minutes);
        cJSON_AddItemToArray(list, row);
    }
}

static void add_range(cJSON *json, const char *const names[3], double least, double most)
{
    json_add_finite(json, names[0], least == most ? least : NAN);
    json_add_finite(json, names[1], least);
    json_add_finite(json, names[2], most);
}

static void add_limit(cJSON *list, const struct irradiation *all, const char *id, struct limit *limit, bool is_first,
                      double output)
{
    static const char *const units[] = { "units", "units_least", "units_most" },
                             *values[] = { "value", "least", "most" };
    const struct scene_constraint *constraint = limit->constraint;
    cJSON *row = cJSON_CreateObject();
    char unit[DOSE_UNIT_SIZE] = "";
    double least, most;
    figure_at(&limit->counted, &limit->dvh, &limit->metric, output, &least, &most);
    cJSON_AddStringToObject(row, "id", id);
    cJSON_AddStringToObject(row, "region", constraint->region);
    cJSON_AddBoolToObject(row, "is_target", limit->region && region_is_target(limit->region));
    cJSON_AddStringToObject(row, "quantity", dose_quantity_scene_word(constraint->quantity));
    cJSON_AddStringToObject(row, "metric", constraint->metric);
    cJSON_AddStringToObject(row, "side", scene_limit_side_words.words[constraint->side]);
    json_add_finite(row, "limit", constraint->limit);
    dose_add_population(row, all->snapshot, &limit->counted.choice, constraint->tissue,
                        scene_population(all->snapshot->plan, &all->snapshot->scene));
    if (limit->counted.choice.n_parts > 0)
        dose_shown_unit(&all->snapshot->plan->doses[limit->counted.choice.unit_of], limit->counted.choice.shown,
                        limit->counted.choice.quantity, unit);
    cJSON_AddStringToObject(row, "unit", dose_metric_unit(&limit->metric, unit));
    add_range(row, units, limit->reach.least, limit->reach.most);
    cJSON_AddBoolToObject(row, "is_never", isinf(limit->reach.least) && isinf(limit->reach.most));
    json_add_finite(row, "minutes", limit->is_known ? limit->reach.least * all->minutes : NAN);
    cJSON_AddBoolToObject(row, "is_first", is_first);
    reason_add_json(row, "reason", limit->why.code ? limit->why.text : NULL);
    add_range(row, values, least, most);
    cJSON_AddItemToArray(list, row);
}

/* Mean, least dose and D95 % of each target at an output. */
static void add_targets(cJSON *json, const struct irradiation *all, enum scene_dose_quantity quantity, double output)
{
    static const struct {
        const char *names[3];
        struct dvh_metric metric;
    } figures[] = { { { "d95", "d95_least", "d95_most" }, { DVH_DOSE_PERCENT, 95 } },
                    { { "mean", "mean_least", "mean_most" }, { DVH_MEAN, 0 } },
                    { { "min", "min_least", "min_most" }, { DVH_MIN, 0 } } };
    const struct region_set *set = &all->snapshot->plan->regions;
    cJSON *list = cJSON_AddArrayToObject(json, "targets");
    for (size_t r = 0; r < set->n_regions; r++) {
        if (!region_is_target(&set->regions[r]) || set->regions[r].n_voxels == 0)
            continue;
        struct counted counted = { .choice = { .n_parts = 0 } };
        const struct dose_choice *choice = &counted.choice;
        struct dvh dvh = { 0 };
        struct error why = { 0 };
        char unit[DOSE_UNIT_SIZE] = "";
        bool is_known =
            find_counted(all, &set->regions[r], quantity, "", &counted, &why) && histogram_at(&counted, 1, &dvh, &why);
        cJSON *row = cJSON_CreateObject();
        cJSON_AddStringToObject(row, "region", set->regions[r].id);
        cJSON_AddStringToObject(row, "quantity", dose_quantity_scene_word(quantity));
        dose_add_population(row, all->snapshot, choice, "",
                            scene_population(all->snapshot->plan, &all->snapshot->scene));
        if (choice->n_parts > 0)
            dose_shown_unit(&all->snapshot->plan->doses[choice->unit_of], choice->shown, choice->quantity, unit);
        cJSON_AddStringToObject(row, "unit", unit);
        struct dvh then = { 0 }; /* at the output, of a dose that is not in proportion to it */
        const bool is_grown =
            is_known && counted.growth && dvh.n > 0 && isfinite(output) && histogram_at(&counted, output, &then, NULL);
        for (size_t f = 0; f < sizeof figures / sizeof *figures; f++) {
            double least = NAN, most = NAN;
            if (is_grown)
                dvh_metric_range(&then, &figures[f].metric, &least, &most);
            else if (is_known && !counted.growth)
                figure_at(&counted, &dvh, &figures[f].metric, output, &least, &most);
            add_range(row, figures[f].names, least, most);
        }
        dvh_finish(&then);
        reason_add_json(row, "reason", why.code ? why.text : NULL);
        cJSON_AddItemToArray(list, row);
        dvh_finish(&dvh);
        counted_finish(&counted);
    }
}

static bool add_limits(cJSON *json, const struct irradiation *all, struct error *err)
{
    const struct scene *scene = &all->snapshot->scene;
    struct limit *limits = mem_array(scene->n_constraints + 1, sizeof *limits, UINT64_MAX, err);
    bool is_certain;
    if (!limits)
        return false;
    for (size_t i = 0; i < scene->n_constraints; i++)
        find_limit(all, &scene->constraints[i].value, limits, i);
    int first = first_limit(limits, scene->n_constraints, &is_certain);
    double output = first >= 0 ? limits[first].reach.least : NAN;
    json_add_text(json, "first", first >= 0 ? scene->constraints[first].id : NULL);
    cJSON_AddBoolToObject(json, "is_certain", is_certain);
    json_add_finite(json, "units", output);
    json_add_finite(json, "minutes", output * all->minutes);
    add_fields(json, all, output);
    cJSON *list = cJSON_AddArrayToObject(json, "limits");
    for (size_t i = 0; i < scene->n_constraints; i++)
        add_limit(list, all, scene->constraints[i].id, &limits[i], (int)i == first, output);
    for (size_t i = 0; i < scene->n_constraints; i++) {
        dvh_finish(&limits[i].dvh);
        counted_finish(&limits[i].counted);
    }
    add_targets(json, all, first >= 0 ? limits[first].constraint->quantity : SCENE_DOSE_QUANTITY_WEIGHTED, output);
    free(limits);
    return true;
}

/* Answers {output, rate, rate_unit, minutes_per_unit, reason, weights, first, is_certain, units, minutes, fields,
 * limits, targets, method} */
cJSON *answer_irradiation(struct question *question, struct derive *derived, struct problem *problem)
{
    const struct snapshot *snapshot = question->snapshot;
    const struct scene_irradiation *asked = &snapshot->scene.irradiation;
    struct irradiation all = { .snapshot = snapshot };
    struct error err = { 0 };
    (void)derived;
    if (!dose_is_there(snapshot, problem))
        return NULL;
    find_fields(&all);
    find_output(&all);
    cJSON *json = cJSON_CreateObject();
    json_add_text(json, "output", all.why.code ? NULL : all.output.words);
    json_add_finite(json, "rate", asked->has_rate ? asked->rate : NAN);
    cJSON_AddStringToObject(json, "rate_unit", scene_source_rate_unit_words.words[asked->rate_unit]);
    json_add_finite(json, "minutes_per_unit", all.minutes);
    reason_add_json(json, "reason", all.why.code ? all.why.text : NULL);
    dose_add_weights(json, snapshot);
    if (!add_limits(json, &all, &err)) {
        cJSON_Delete(json);
        (void)problem_from_error(problem, &err);
        return NULL;
    }
    cJSON_AddStringToObject(json, "method",
                            "Each dose as its file has it, per unit of the source's output, times its share; boron as "
                            "measured in blood. Doses grow in proportion to the output, so a limit of a dose is "
                            "reached at limit / figure, and one of a volume V_d at d / D_v. Univels of the population, "
                            "each with the dose at its centre and the weights of its region, or those chosen in the "
                            "limit. An isoeffective dose is not in proportion: it is computed at each output from the "
                            "components, with repair during the time to it, the fields as one irradiation at a "
                            "constant rate without pauses (Gonzalez and Santa Cruz 2012), and the output is found to "
                            "0.01 %. The factor and the sum that the dose is shown with change nothing.");
    return json;
}
