/* Answers to questions about dose-volume histograms: curves and figures of regions, as JSON or CSV. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/derive/dose_histogram.h"
#include "core/dose/dvh_metrics.h"
#include "core/region/target.h"
#include "server/renderer/answers.h"
#include "server/renderer/dose_answers.h"
#include "server/wire/json.h"
#include "server/wire/sentence_json.h"

enum { MAX_BINS = 65536, MAX_METRICS = 16, WORD_SIZE = 32 }; /* bins of all curves of an answer */

struct asking {
    const struct packet_dvh *packet;
    const struct snapshot *snapshot;
    struct dose_scale scale;
    enum region_population population;
    size_t *regions, n_regions;
    struct dose_asked doses[2];
    size_t n_doses;
    char metrics[MAX_METRICS][WORD_SIZE];
    size_t n_metrics;
};

/* ---- what is asked for ------------------------------------------------------------------------------------------ */

/* The next word of a list between commas; false at its end. */
static bool next_word(const char **list, char *word, size_t size)
{
    size_t n = strcspn(*list, ",");
    if (!**list)
        return false;
    snprintf(word, size, "%.*s", (int)(n < size ? n : size - 1), *list);
    *list += n + ((*list)[n] == ',');
    return true;
}

static bool find_regions(struct asking *asking, struct problem *problem)
{
    const struct region_set *set = &asking->snapshot->plan->regions;
    const char *list = asking->packet->regions;
    char id[REGION_ID_SIZE + 1];
    asking->regions = mem_new((set->n_regions + 1) * sizeof *asking->regions);
    for (size_t r = 0; !list[0] && r < set->n_regions; r++)
        if (asking->snapshot->styles[r].visible && set->regions[r].n_voxels > 0)
            asking->regions[asking->n_regions++] = r;
    while (next_word(&list, id, sizeof id)) {
        const struct region *region = region_find(set, id);
        if (!region)
            return problem_set(problem, PROBLEM_NOT_FOUND, "/regions", "", "the plan has no region \"%.64s\"", id);
        size_t index = (size_t)(region - set->regions);
        bool is_listed = false;
        for (size_t i = 0; i < asking->n_regions; i++)
            is_listed |= asking->regions[i] == index;
        if (!is_listed)
            asking->regions[asking->n_regions++] = index;
    }
    return true;
}

static bool find_metrics(struct asking *asking, struct problem *problem)
{
    const char *list = asking->packet->metrics[0] ? asking->packet->metrics : "D98%,D95%,D50%,D2%,D0.03cc,HI";
    char word[WORD_SIZE];
    while (next_word(&list, word, sizeof word)) {
        struct dvh_metric metric;
        struct error err = { 0 };
        if (asking->n_metrics == MAX_METRICS)
            return problem_set(problem, PROBLEM_VALIDATION, "/metrics", "range", "more than %d figures", MAX_METRICS);
        if (!dvh_metric_parse(word, &metric, &err))
            return problem_set(problem, PROBLEM_VALIDATION, "/metrics", "format", "%s", err.text);
        snprintf(asking->metrics[asking->n_metrics++], WORD_SIZE, "%s", word);
    }
    return true;
}

static bool find_population(struct asking *asking, struct problem *problem)
{
    const char *word = asking->packet->descendants ? "whole" : asking->packet->population;
    if (!word[0]) {
        asking->population = scene_population(asking->snapshot->plan, &asking->snapshot->scene);
        return true;
    }
    return population_from_word(asking->snapshot->plan, word, &asking->population) ||
           problem_set(problem, PROBLEM_VALIDATION, "/population", "enum", "\"%.40s\" is not own, whole or usual",
                       word);
}

/* The doses that have curves: that of the scene, and the one it is compared with. */
static void find_doses(struct asking *asking, cJSON *json)
{
    const struct snapshot *snapshot = asking->snapshot;
    const struct scene_dose_style *style = &snapshot->scene.dose;
    cJSON *without = cJSON_AddArrayToObject(json, "without_curves");
    int doses[2] = { snapshot->dose, -1 };
    for (size_t d = 0; style->compare.id[0] && d < snapshot->plan->n_doses; d++)
        if (strcmp(snapshot->plan->doses[d].id, style->compare.id) == 0 && (int)d != snapshot->dose)
            doses[1] = (int)d;
    for (int i = 0; i < 2; i++) {
        struct error why = { 0 };
        if (doses[i] < 0)
            continue;
        if (dose_asked_of(snapshot, (size_t)doses[i], style->quantity, &asking->doses[asking->n_doses], &why)) {
            asking->n_doses++;
            continue;
        }
        cJSON *row = cJSON_CreateObject();
        cJSON_AddStringToObject(row, "dose", snapshot->plan->doses[doses[i]].id);
        reason_add_json(row, "reason", why.text);
        cJSON_AddItemToArray(without, row);
    }
}

static void add_method(cJSON *json, const struct asking *asking)
{
    char text[640], words[96];
    int per_side = (int)asking->packet->border;
    char border[128] = "";
    if (per_side > 1)
        snprintf(border, sizeof border, ", univels at a border in %d x %d x %d points", per_side, per_side, per_side);
    const char *basis = asking->n_doses ? dose_basis_words(asking->snapshot->plan, &asking->doses[0].choice,
                                                           asking->packet->tissue, words)
                                        : NULL;
    snprintf(text, sizeof text,
             "Regions: %s; the dose at a univel's centre%s, trilinear in the dose's own grid%s%s. 100 %% is the whole "
             "region. Univels without a value have no dose; from 0.1 %% of a region on its figures are "
             "bounds, for any dose there from 0 on. Figures: ICRU Report 83.",
             population_words(asking->population), border, basis ? "; " : "", basis ? basis : "");
    cJSON_AddStringToObject(json, "method", text);
}

/* ---- curves ----------------------------------------------------------------------------------------------------- */

/* Equal bins from `from` on that hold every value. */
struct curve {
    const struct region *region;
    const struct dose_asked *dose;
    struct dvh dvh;
    double from, width, *counts; /* in univels */
    size_t n;
};

static bool curve_init(struct curve *curve, const struct asking *asking, size_t region, const struct dose_asked *dose,
                       struct error *err)
{
    const struct snapshot *snapshot = asking->snapshot;
    *curve = (struct curve){ &snapshot->plan->regions.regions[region], dose, .n = (size_t)asking->packet->bins };
    if (!dose_histogram_get(snapshot->derived, &dose->choice, region, asking->population, DOSE_BY_REGION,
                            (int)asking->packet->border, &curve->dvh, err))
        return false;
    curve->from = fmin(curve->dvh.low, 0);
    double high = fmax(curve->dvh.high, 0);
    curve->width = high > curve->from ? (high - curve->from) / (double)curve->n : 1;
    curve->counts = mem_array(curve->n, sizeof *curve->counts, UINT64_MAX, err);
    if (!curve->counts)
        dvh_finish(&curve->dvh);
    else /* the last bin holds its upper edge, whatever rounding makes of it */
        dvh_counts(&curve->dvh, curve->from, curve->width * (1 + 1e-12), curve->n, curve->counts);
    return curve->counts != NULL;
}

static void curve_finish(struct curve *curve)
{
    dvh_finish(&curve->dvh);
    free(curve->counts);
}

/* body and target: each univel with the weights of its tissue, so that the covered part is one of the isodose. */
static void add_conformity(cJSON *json, const struct asking *asking, const struct dvh *target, const struct dvh *body)
{
    const struct scene_dose_style *style = &asking->snapshot->scene.dose;
    cJSON *list = cJSON_AddArrayToObject(json, "conformity");
    double cm3 = target->univel_cm3;
    for (size_t i = 0; i < style->n_levels; i++) {
        double value = dose_level_value(&asking->scale, style->levels[i].value.unit, style->levels[i].value.value);
        if (!isfinite(value))
            continue;
        struct dvh_conformity found =
            dvh_conformity((target->n + target->n_missing) * cm3, dvh_univels_from(body, value) * body->univel_cm3,
                           dvh_univels_from(target, value) * cm3);
        if (dvh_is_partial(target))
            found.covered_cm3 = found.paddick = NAN;
        cJSON *row = cJSON_CreateObject();
        cJSON_AddStringToObject(row, "level", style->levels[i].id);
        json_add_finite(row, "value", value);
        json_add_finite(row, "isodose_cm3", found.isodose_cm3);
        json_add_finite(row, "covered_cm3", found.covered_cm3);
        json_add_finite(row, "paddick", found.paddick);
        json_add_finite(row, "rtog", found.rtog);
        cJSON_AddItemToArray(list, row);
    }
}

/* The figures that the dose's file states of the region, in the curve's quantity; null where it states none. */
static cJSON *stated_object(const struct asking *asking, const struct curve *curve)
{
    const struct dose *dose = &asking->snapshot->plan->doses[curve->dose->dose];
    const struct dose_choice *choice = &curve->dose->choice;
    const struct dose *in = &asking->snapshot->plan->doses[choice->unit_of];
    bool is_same = choice->shown == DOSE_SHOWN_QUANTITY && choice->n_parts == 1 && dose->n_components == 1 &&
                   choice->quantity == dose->components[0].quantity;
    double unit = 1; /* the curve is in the unit of the dose shown */
    is_same &= dose == in || fit_unit_factor(dose->unit, in->unit, &unit);
    const struct plan *plan = asking->snapshot->plan;
    struct fit_part region = fit_part_of_region(plan, (size_t)(curve->region - plan->regions.regions));
    struct fit fit = fit_of(plan, region, (struct fit_part){ FIT_DOSE, curve->dose->dose });
    is_same &= !(fit.reasons & (1U << FIT_PLAN | 1U << FIT_PATIENT)); /* names are those of its own structure set */
    for (size_t i = 0; is_same && i < dose->n_stated; i++) {
        const struct dose_stated *stated = &dose->stated[i];
        if (strcmp(stated->region, curve->region->name) != 0)
            continue;
        cJSON *json = cJSON_CreateObject();
        double factor = choice->parts[0].factor * unit, mean = curve->dvh.n > 0 ? curve->dvh.sum / curve->dvh.n : NAN;
        json_add_finite(json, "min", stated->low * factor);
        json_add_finite(json, "mean", stated->mean * factor);
        json_add_finite(json, "max", stated->high * factor);
        json_add_finite(json, "volume_cm3", stated->volume_cm3);
        json_add_finite(json, "mean_difference_percent", 100 * (mean / (stated->mean * factor) - 1));
        return json;
    }
    return cJSON_CreateNull();
}

static const struct {
    const char *name;
    enum dvh_metric_kind kind;
} plain_figures[] = { { "min", DVH_MIN }, { "mean", DVH_MEAN }, { "max", DVH_MAX } };
enum { N_PLAIN = sizeof plain_figures / sizeof *plain_figures };

/* A figure where the univels without a value cannot change it, and both of its bounds. */
static void add_figure(cJSON *value, cJSON *least, cJSON *most, const char *name, const struct dvh *dvh,
                       const struct dvh_metric *metric)
{
    double low, high;
    dvh_metric_range(dvh, metric, &low, &high);
    json_add_finite(value, name, low == high ? low : NAN);
    json_add_finite(least, name, low);
    json_add_finite(most, name, high);
}

/* {min, mean, max, metrics, least: {min, mean, max, metrics}, most} */
static void add_figures(cJSON *json, const struct asking *asking, const struct dvh *dvh)
{
    cJSON *least = cJSON_CreateObject(), *most = cJSON_CreateObject();
    for (size_t i = 0; i < N_PLAIN; i++)
        add_figure(json, least, most, plain_figures[i].name, dvh, &(struct dvh_metric){ plain_figures[i].kind, 0 });
    cJSON *of[3] = { cJSON_AddObjectToObject(json, "metrics"), cJSON_AddObjectToObject(least, "metrics"),
                     cJSON_AddObjectToObject(most, "metrics") };
    for (size_t i = 0; i < asking->n_metrics; i++) {
        struct dvh_metric metric;
        if (dvh_metric_parse(asking->metrics[i], &metric, NULL))
            add_figure(of[0], of[1], of[2], asking->metrics[i], dvh, &metric);
    }
    cJSON_AddItemToObject(json, "least", least);
    cJSON_AddItemToObject(json, "most", most);
}

/* The conformity of a target; nothing of other regions. */
static bool add_target(cJSON *json, const struct asking *asking, const struct curve *curve, const struct dvh *body,
                       struct error *err)
{
    struct dvh target;
    if (!body || !region_is_target(curve->region))
        return true;
    size_t region = (size_t)(curve->region - asking->snapshot->plan->regions.regions);
    if (!dose_histogram_get(asking->snapshot->derived, &curve->dose->choice, region, asking->population, DOSE_BY_TISSUE,
                            1, &target, err))
        return false;
    add_conformity(json, asking, &target, body);
    dvh_finish(&target);
    return true;
}

static cJSON *curve_object(const struct asking *asking, const struct curve *curve, const struct dvh *body,
                           struct error *err)
{
    const struct dvh *dvh = &curve->dvh;
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "region", curve->region->id);
    cJSON_AddStringToObject(json, "dose", asking->snapshot->plan->doses[curve->dose->dose].id);
    cJSON_AddStringToObject(json, "quantity", dose_quantity_scene_word(asking->snapshot->scene.dose.quantity));
    cJSON_AddStringToObject(json, "unit", curve->dose->unit);
    dose_add_population(json, asking->snapshot, &curve->dose->choice, asking->packet->tissue, asking->population);
    json_add_finite(json, "n_univels", dvh->n + dvh->n_missing);
    json_add_finite(json, "volume_cm3", (dvh->n + dvh->n_missing) * dvh->univel_cm3);
    json_add_finite(json, "missing_cm3", dvh->n_missing * dvh->univel_cm3);
    cJSON_AddBoolToObject(json, "is_partial", dvh_is_partial(dvh));
    add_figures(json, asking, dvh);
    cJSON_AddItemToObject(json, "stated", stated_object(asking, curve));
    if (!add_target(json, asking, curve, body, err)) {
        cJSON_Delete(json);
        return NULL;
    }
    json_add_finite(json, "bin_from", curve->from);
    json_add_finite(json, "bin_width", curve->width);
    cJSON *counts = cJSON_AddArrayToObject(json, "counts_cm3");
    for (size_t i = 0; i < curve->n; i++)
        cJSON_AddItemToArray(counts, cJSON_CreateNumber(curve->counts[i] * dvh->univel_cm3));
    return json;
}

/* False with a row of without_curves: the region is not used, or has no weights. */
static bool has_curve(cJSON *json, const struct asking *asking, const struct dose_asked *dose, size_t region)
{
    const struct plan *plan = asking->snapshot->plan;
    const struct scene_fits *fits = &asking->snapshot->fits;
    struct error why = { 0 };
    if (!fit_is_used(region_use(fits, region))) {
        char sentence[FIT_WHY_SIZE];
        fit_use_sentence(fits, fit_part_of_region(plan, region), region_use(fits, region), sentence);
        (void)error_set(&why, ERROR_STATE, "%s", sentence);
    } else if (dose_row_of_region(&plan->regions, &dose->choice, region, &why) != DOSE_NO_ROW)
        return true;
    cJSON *row = json ? cJSON_CreateObject() : NULL;
    if (row) {
        cJSON_AddStringToObject(row, "dose", plan->doses[dose->dose].id);
        cJSON_AddStringToObject(row, "region", plan->regions.regions[region].id);
        reason_add_json(row, "reason", why.text);
        cJSON_AddItemToArray(cJSON_GetObjectItemCaseSensitive(json, "without_curves"), row);
    }
    return false;
}

static bool add_curves(cJSON *json, const struct asking *asking, struct error *err)
{
    cJSON *curves = cJSON_AddArrayToObject(json, "curves");
    struct dvh body = { 0 };
    size_t layer = 0;
    bool has_body = asking->n_doses > 0 && asking->snapshot->dose == (int)asking->doses[0].dose &&
                    asking->scale.reference > 0 &&
                    dose_histogram_of_body(asking->snapshot->derived, &asking->doses[0].choice, &body, &layer, NULL);
    bool is_good = true;
    for (size_t d = 0; is_good && d < asking->n_doses; d++)
        for (size_t r = 0; is_good && r < asking->n_regions; r++) {
            struct curve curve;
            if (!has_curve(json, asking, &asking->doses[d], asking->regions[r]))
                continue;
            if (!(is_good = curve_init(&curve, asking, asking->regions[r], &asking->doses[d], err)))
                break;
            cJSON *object = curve_object(asking, &curve, d == 0 && has_body ? &body : NULL, err);
            if (!(is_good = object != NULL) || !cJSON_AddItemToArray(curves, object))
                cJSON_Delete(object);
            curve_finish(&curve);
        }
    cJSON_AddItemToObject(json, "body_cm3",
                          has_body ? cJSON_CreateNumber((body.n + body.n_missing) * body.univel_cm3)
                                   : cJSON_CreateNull());
    dvh_finish(&body);
    return is_good;
}

/* ---- CSV -------------------------------------------------------------------------------------------------------- */

struct text {
    FILE *file;
    char *bytes;
    size_t n;
};

/* In quotes where a name has what would end a field. */
static void put_field(FILE *file, const char *text)
{
    bool is_quoted = strpbrk(text, ",\"\r\n") != NULL;
    const char *guard = strchr("=+-@", text[0]) && text[0] ? "'" : ""; /* a spreadsheet takes it for a formula */
    if (is_quoted)
        fputc('"', file);
    fputs(guard, file);
    for (; *text; text++) {
        if (*text == '"')
            fputc('"', file);
        fputc(*text, file);
    }
    if (is_quoted)
        fputc('"', file);
}

static void put_curve(FILE *file, const struct asking *asking, const struct curve *curve)
{
    const char *tissue = asking->packet->tissue;
    double cm3 = curve->dvh.univel_cm3, missing = curve->dvh.n_missing, all = curve->dvh.n + missing,
           above = curve->dvh.n;
    char words[96];
    const char *basis = dose_basis_words(asking->snapshot->plan, &curve->dose->choice, tissue, words);
    for (size_t i = 0; i < curve->n; i++) {
        put_field(file, asking->snapshot->plan->doses[curve->dose->dose].id);
        fputc(',', file);
        put_field(file, curve->region->id);
        fputc(',', file);
        put_field(file, curve->region->name);
        fprintf(file, ",%s,", dose_quantity_scene_word(asking->snapshot->scene.dose.quantity));
        put_field(file, curve->dose->unit);
        fprintf(file, ",%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%s,", curve->from + curve->width * (double)i,
                curve->from + curve->width * (double)(i + 1), curve->counts[i] * cm3, above * cm3,
                all > 0 ? 100 * above / all : 0, all > 0 ? 100 * (above + missing) / all : 0, missing * cm3,
                asking->population == POPULATION_OWN ? "own" : "whole");
        put_field(file, basis ? basis : "");
        fputs("\r\n", file);
        above = fmax(above - curve->counts[i], 0);
    }
}

/* A line for each bin: dose, region, region name, quantity, unit, from, to, cm3 within, cm3 and percent of the whole
 * region known to be from `from` on, the percent that are at most, cm3 without a value, population, basis. */
static cJSON *csv_of(const struct asking *asking, struct error *err)
{
    struct text text = { 0 };
    bool is_good = (text.file = open_memstream(&text.bytes, &text.n)) != NULL;
    if (!is_good)
        (void)error_set(err, ERROR_MEMORY, "no memory for the table");
    else
        fputs("dose,region,region_name,quantity,unit,from,to,volume_cm3,volume_from_cm3,volume_from_percent,"
              "volume_from_percent_most,missing_cm3,population,basis\r\n",
              text.file);
    for (size_t d = 0; is_good && d < asking->n_doses; d++)
        for (size_t r = 0; is_good && r < asking->n_regions; r++) {
            struct curve curve;
            if (!has_curve(NULL, asking, &asking->doses[d], asking->regions[r]))
                continue;
            if (!(is_good = curve_init(&curve, asking, asking->regions[r], &asking->doses[d], err)))
                break;
            put_curve(text.file, asking, &curve);
            curve_finish(&curve);
        }
    if (text.file && fclose(text.file) != 0 && is_good)
        is_good = error_set(err, ERROR_MEMORY, "no memory for the table");
    cJSON *json = is_good ? cJSON_CreateObject() : NULL;
    if (json)
        cJSON_AddStringToObject(json, ANSWER_CSV, text.bytes);
    free(text.bytes);
    return json;
}

/* ---- the answer ------------------------------------------------------------------------------------------------- */

static cJSON *answer(struct asking *asking, struct problem *problem)
{
    const char *format = asking->packet->format;
    bool is_csv = strcmp(format, "csv") == 0;
    struct error err = { 0 };
    if (format[0] && !is_csv && strcmp(format, "json") != 0) {
        (void)problem_set(problem, PROBLEM_VALIDATION, "/format", "enum", "\"%.40s\" is not json or csv", format);
        return NULL;
    }
    if (!find_regions(asking, problem) || !find_metrics(asking, problem) || !find_population(asking, problem))
        return NULL;
    cJSON *json = cJSON_CreateObject();
    find_doses(asking, json);
    if (asking->n_regions * asking->n_doses * (size_t)asking->packet->bins > MAX_BINS) {
        (void)problem_set(problem, PROBLEM_VALIDATION, "/bins", "range", "more than %d bins in all: %zu regions",
                          MAX_BINS, asking->n_regions);
        cJSON_Delete(json);
        return NULL;
    }
    (void)dose_scale_of(asking->snapshot, &asking->scale);
    dose_add_basis(json, asking->snapshot, &asking->scale);
    dose_add_weights(json, asking->snapshot);
    add_method(json, asking);
    cJSON *table = NULL;
    bool is_good = is_csv ? (table = csv_of(asking, &err)) != NULL : add_curves(json, asking, &err);
    dose_scale_finish(&asking->scale);
    if (is_good && !is_csv)
        return json;
    if (!is_good)
        (void)problem_from_error(problem, &err);
    cJSON_Delete(json);
    return table;
}

/* Answers the dose's basis and {method, without_curves: [{dose, region, reason}], body_cm3, curves: [{region, dose,
 * quantity, unit, basis, population, n_univels, volume_cm3, missing_cm3, is_partial, min, mean, max, metrics: {WORD:
 * value}, least: {min, mean, max, metrics}, most, stated, conformity: [{level, value, isodose_cm3, covered_cm3,
 * paddick, rtog}], bin_from, bin_width, counts_cm3}]}; or a table of the curves as text/csv */
cJSON *answer_dvh(struct question *question, struct derive *derived, struct problem *problem)
{
    struct asking asking = { .packet = &question->packet.dvh };
    (void)derived;
    if (!dose_is_there(question->snapshot, problem))
        return NULL;
    struct snapshot *snapshot =
        dose_snapshot_in(question->snapshot, question->packet.dvh.quantity, question->packet.dvh.tissue, problem);
    asking.snapshot = snapshot;
    cJSON *json = snapshot ? answer(&asking, problem) : NULL;
    free(asking.regions);
    free(snapshot);
    return json;
}
