/* The front of a record: decision, basis, limits, histogram, what does not fit, draft, signatures. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/paper/blocks.h"

static const cJSON *get(const cJSON *object, const char *name)
{
    return cJSON_GetObjectItemCaseSensitive(object, name);
}

static const char *text_of(const cJSON *object, const char *name)
{
    const char *text = json_text(object, name);
    return text ? text : "";
}

/* NaN for null. */
static double number_of(const cJSON *object, const char *name)
{
    return json_number(object, name, NAN);
}

static const char *word_of(const char *const (*words)[2], size_t n, const char *id)
{
    for (size_t i = 0; i < n; i++)
        if (strcmp(words[i][0], id) == 0)
            return words[i][1];
    return id;
}

/* ---- decision ----------------------------------------------------------------------------------------------------- */

static const char *decision_word(const cJSON *item)
{
    static const char *const words[][2] = { { "accept", "Accept" },
                                            { "accept-with-changes", "Accept with changes" },
                                            { "reject", "Reject" },
                                            { "defer", "Defer" } };
    return word_of(words, sizeof words / sizeof words[0], text_of(get(item, "body"), "decision"));
}

static void add_later(struct paper *paper, const cJSON *item)
{
    char time[PAPER_TIME];
    const bool corrects = strcmp(text_of(get(item, "body"), "corrects"), paper->source->id) == 0;
    block_text(paper,
               written_format("%s: %s, %s, by %.300s (%.63s).",
                              corrects ? "Corrected by a later decision"
                                       : "Later another decision was written in this room",
                              decision_word(item), written_time(paper, number_of(item, "created_ms"), time),
                              text_of(item, "author_name"), text_of(item, "id")),
               "warn");
}

/* The meeting in which it was decided. */
static void add_meeting(struct paper *paper)
{
    const cJSON *meeting = get(paper->record, "meeting");
    if (text_of(meeting, "name")[0] && !json_flag(meeting, "is_over", false))
        block_text(paper,
                   written_format("In the meeting \xe2\x80\x9c%.320s\xe2\x80\x9d (%.63s), case %.0f of %.0f.",
                                  text_of(meeting, "name"), text_of(meeting, "id"), json_number(meeting, "n", 0),
                                  json_number(meeting, "of", 0)),
                   "pale");
}

static void add_decision(struct paper *paper)
{
    static const struct paper_column columns[] = { { "Decision", 24, 'l' },
                                                   { "In words", 46, 'l' },
                                                   { "By", 30, 'l' } };
    const cJSON *item = paper->source->item, *body = get(item, "body"), *later;
    char time[PAPER_TIME];
    block_heading(paper, "Decision", "");
    cJSON *row = table_row(block_table(paper, columns, 3)),
          *person = written_person(item, "author_name", "author_user");
    row_add(row, written(decision_word(item)), "bold");
    row_add(row, written(json_flag(item, "erased", false) ? "the words were erased" : text_of(body, "text")), "");
    row_add(row,
            written_format("%.400s, %.20s, %s", cJSON_GetStringValue(person), text_of(body, "role"),
                           written_time(paper, number_of(item, "created_ms"), time)),
            "");
    cJSON_Delete(person);
    add_meeting(paper);
    if (text_of(body, "corrects")[0])
        block_text(paper, written_format("It corrects the decision %.63s.", text_of(body, "corrects")), "pale");
    cJSON_ArrayForEach(later, paper->source->decisions)
    {
        add_later(paper, later);
    }
}

/* True where the plan and its scene have what a part of the record is made from: without a dose, say, there is no
 * histogram to miss. */
static bool was_to_keep(const struct paper *paper, const char *what)
{
    static const char *const of_dose[] = { "dose", "dvh", "limits", "irradiation" };
    const bool has_limits = cJSON_GetArraySize(get(paper->scene, "constraints")) > 0;
    if (!text_of(paper->plan, "id")[0]) /* the plan was closed: nobody knows */
        return true;
    if (strcmp(what, "beam") == 0)
        return cJSON_GetArraySize(get(paper->plan, "beams")) > 0 ||
               json_flag(get(get(paper->scene, "beam"), "draft"), "enabled", false);
    if (strcmp(what, "limits") == 0 && has_limits)
        return true;
    for (size_t i = 0; i < sizeof of_dose / sizeof of_dose[0]; i++)
        if (strcmp(what, of_dose[i]) == 0)
            return cJSON_GetArraySize(get(paper->plan, "doses")) > 0;
    return true;
}

/* Adds what could not be had when it was decided. */
static void add_missing(struct paper *paper)
{
    static const char *const words[][2] = { { "dvh", "dose-volume histogram" },
                                            { "fits", "which parts fit each other" },
                                            { "irradiation", "irradiation time" } };
    const cJSON *missing;
    if (!paper->kept) {
        block_text(
            paper,
            written(get(paper->source->body, "erased")
                        ? "What was kept with this decision was erased."
                        : "No pictures, limits and histogram were kept with this decision: an earlier version of the "
                          "program wrote it, or the plan had not been shown in the room."),
            "warn");
        return;
    }
    cJSON_ArrayForEach(missing, get(paper->kept, "missing"))
    {
        const char *what = text_of(missing, "what");
        if (was_to_keep(paper, what))
            block_text(paper,
                       written_format("Not kept with this decision: %.40s (%.300s).",
                                      word_of(words, sizeof words / sizeof words[0], what), text_of(missing, "why")),
                       "warn");
    }
}

/* ---- prescription and basis --------------------------------------------------------------------------------------- */

static cJSON *prescribed(const cJSON *treatment)
{
    const double gy = number_of(treatment, "prescription_gy");
    return isfinite(gy) ? written_format("%.4g Gy, of the plan's files", gy) : written("not stated in the files");
}

static cJSON *fields_of(const struct paper *paper, const cJSON *treatment)
{
    const int n_beams = cJSON_GetArraySize(get(paper->plan, "beams"));
    const double fractions = number_of(treatment, "fractions");
    if (isfinite(fractions))
        return written_format("%d %s, %.0f %s", n_beams, n_beams == 1 ? "field" : "fields", fractions,
                              fractions == 1 ? "fraction" : "fractions");
    return written_format("%d %s, fractions not stated", n_beams, n_beams == 1 ? "field" : "fields");
}

static cJSON *dose_shown(const struct paper *paper, const cJSON *dose)
{
    const char *name = text_of(dose, "name")[0] ? text_of(dose, "name") : text_of(dose, "id"),
               *per = text_of(dose, "per");
    (void)paper;
    if (!name[0])
        return written("no dose");
    return written_format("%.200s: %.40s in %.40s%s%.120s", name, text_of(dose, "quantity"), text_of(dose, "unit"),
                          per[0] ? " per " : "", per);
}

static void add_basis(struct paper *paper)
{
    static const struct paper_column columns[] = { { "Prescribed", 22, 'l' },
                                                   { "Fields, fractions", 22, 'l' },
                                                   { "Boron in blood", 18, 'l' },
                                                   { "Dose shown", 38, 'l' } };
    const cJSON *dose = get(paper->kept, "dose"), *style = get(paper->scene, "dose"),
                *reference = get(dose, "reference"), *treatment = paper_treatment(paper);
    char value[PAPER_NUMBER];
    if (!paper->kept)
        return;
    block_heading(paper, "Prescription and basis", "");
    cJSON *row = table_row(block_table(paper, columns, 4));
    row_add(row, prescribed(treatment), "");
    row_add(row, fields_of(paper, treatment), "");
    row_add(row,
            written_format("%.4g ppm, %.4g min", json_number(style, "blood_ppm", 0),
                           json_number(style, "irradiation_min", 0)),
            "");
    row_add(row, dose_shown(paper, dose), "");
    if (!dose)
        return;
    const char *tissue = text_of(dose, "tissue"), *weights = text_of(dose, "weights_name");
    block_text(paper,
               written_format("100 %% = %s %.40s, %.100s. Drawn with %s%.100s%s; weights: %.100s.",
                              written_number(number_of(reference, "value"), value), text_of(dose, "unit"),
                              text_of(reference, "words"), tissue[0] ? "the weights of " : "each region's own weights",
                              tissue[0] ? region_name(paper, tissue) : "", tissue[0] ? " everywhere" : "",
                              weights[0] ? weights : "of the plan's files"),
               "pale");
}

/* ---- limits ------------------------------------------------------------------------------------------------------- */

/* The weights of a region, where they are its own. */
static cJSON *weights_of(const struct paper *paper, const cJSON *limit)
{
    const cJSON *weights;
    const char *region = text_of(limit, "region"), *tissue = text_of(limit, "tissue");
    const char *whose = tissue[0] ? tissue : region;
    if (!strstr(text_of(limit, "basis"), "weights"))
        return written(text_of(limit, "basis")[0] ? text_of(limit, "basis") : "none");
    cJSON_ArrayForEach(weights, get(get(paper->kept, "limits"), "weights"))
    {
        if (strcmp(text_of(weights, "region"), whose) == 0)
            return written_format("%s%.80s: CBE %.3g, ratio %.3g", tissue[0] ? "of " : "own",
                                  tissue[0] ? region_name(paper, tissue) : "", number_of(weights, "cbe"),
                                  number_of(weights, "boron_ratio"));
    }
    return written_format("none for %.80s", region_name(paper, whose));
}

/* A figure, or the bounds between which it lies where a part of the region has no dose. */
static cJSON *value_of(double value, double least, double most)
{
    char a[PAPER_NUMBER], b[PAPER_NUMBER];
    if (isfinite(value))
        return written(written_number(value, a));
    if (isfinite(least) && isfinite(most))
        return written_format("%s to %s", written_number(least, a), written_number(most, b));
    if (isfinite(least))
        return written_format("\xe2\x89\xa5 %s", written_number(least, a));
    return isfinite(most) ? written_format("\xe2\x89\xa4 %s", written_number(most, a)) : written("\xe2\x80\x93");
}

/* Not met, then not known, then met. */
static int rank_of(const cJSON *limit)
{
    const cJSON *met = get(limit, "met");
    return cJSON_IsFalse(met) ? 0 : cJSON_IsTrue(met) ? 2 : 1;
}

static void add_limit(struct paper *paper, cJSON *table, const cJSON *limit)
{
    static const char *const states[] = { "\xc3\x97 not met", "? not known", "\xe2\x9c\x93 met" }, *const styles[] = {
        "err", "warn", "ok"
    };
    const int rank = rank_of(limit);
    cJSON *row = table_row(table);
    char value[PAPER_NUMBER];
    row_add(row, written(region_name(paper, text_of(limit, "region"))), "");
    row_add(row,
            written_format("%.40s %s %s %.40s", text_of(limit, "metric"),
                           strcmp(text_of(limit, "side"), "at-least") == 0 ? "\xe2\x89\xa5" : "\xe2\x89\xa4",
                           written_number(number_of(limit, "limit"), value), text_of(limit, "unit")),
            "");
    row_add(row, value_of(number_of(limit, "value"), number_of(limit, "least"), number_of(limit, "most")), "");
    row_add(row, weights_of(paper, limit), "");
    row_add(row,
            rank == 1 && text_of(limit, "reason")[0]
                ? written_format("%s: %.300s", states[rank], text_of(limit, "reason"))
                : written(states[rank]),
            styles[rank]);
}

static void add_limits(struct paper *paper)
{
    static const struct paper_column columns[] = {
        { "Region", 18, 'l' }, { "Limit", 24, 'l' }, { "Value", 12, 'r' }, { "Weights", 24, 'l' }, { "State", 22, 'l' }
    };
    const cJSON *limit, *limits = get(get(paper->kept, "limits"), "constraints");
    if (!get(paper->kept, "limits"))
        return;
    block_heading(paper, "Limits at the decision", "each with its region's own weights, or those its row names");
    cJSON *table = block_table(paper, columns, 5);
    for (int rank = 0; rank < 3; rank++)
        cJSON_ArrayForEach(limit, limits)
        {
            if (rank_of(limit) == rank)
                add_limit(paper, table, limit);
        }
    table_end(paper, table, "No limits were set.");
}

/* ---- histogram ---------------------------------------------------------------------------------------------------- */

/* Dark enough on white. */
static void add_color(cJSON *curve, const struct paper *paper, const char *id)
{
    const cJSON *region;
    unsigned rgb = 0x333333;
    char text[8];
    cJSON_ArrayForEach(region, get(paper->plan, "regions"))
    {
        if (strcmp(text_of(region, "id"), id) == 0 && text_of(region, "color")[0] == '#')
            rgb = (unsigned)strtoul(text_of(region, "color") + 1, NULL, 16) & 0xffffff;
    }
    double channels[3], light = 0;
    static const double shares[3] = { 0.2126, 0.7152, 0.0722 };
    for (int i = 0; i < 3; i++) {
        channels[i] = (rgb >> (16 - 8 * i) & 0xff) / 255.0;
        light += shares[i] * channels[i];
    }
    const double factor = light > 0.4 ? 0.4 / light : 1;
    (void)snprintf(text, sizeof text, "#%02x%02x%02x", (unsigned)(255 * channels[0] * factor),
                   (unsigned)(255 * channels[1] * factor), (unsigned)(255 * channels[2] * factor));
    cJSON_AddStringToObject(curve, "color", text);
}

/* The cumulative histogram in % of the whole region, at the lower ends of its bins. */
static void add_curve(struct paper *paper, cJSON *list, const cJSON *from, int number)
{
    const cJSON *counts = get(from, "counts_cm3"), *count;
    const int n = cJSON_GetArraySize(counts);
    const double volume = number_of(from, "volume_cm3");
    double *share = n > 0 && n <= 4096 && volume > 0 ? malloc((size_t)n * sizeof *share) : NULL, sum = 0;
    int i = 0;
    if (!share)
        return;
    cJSON_ArrayForEach(count, counts)
    {
        share[i++] = 100 * count->valuedouble / volume;
    }
    for (i = n - 1; i >= 0; i--)
        sum = share[i] = sum + share[i];
    for (i = 0; i < n; i++)
        share[i] = round(share[i] * 100) / 100;
    cJSON *curve = cJSON_CreateObject();
    json_add(curve, "name", written(region_name(paper, text_of(from, "region"))));
    add_color(curve, paper, text_of(from, "region"));
    cJSON_AddNumberToObject(curve, "dash", number % 6);
    cJSON_AddNumberToObject(curve, "from", number_of(from, "bin_from"));
    cJSON_AddNumberToObject(curve, "width", number_of(from, "bin_width"));
    json_add(curve, "percent", cJSON_CreateDoubleArray(share, n));
    cJSON_AddNumberToObject(curve, "missing_percent",
                            json_flag(from, "is_partial", false) ? 100 * number_of(from, "missing_cm3") / volume : 0);
    json_append(list, curve);
    free(share);
}

static void add_chart(struct paper *paper, const cJSON *dvh, const cJSON *first)
{
    cJSON *chart = cJSON_CreateObject(), *curves = cJSON_CreateArray();
    const cJSON *curve;
    int n = 0;
    const char *per = text_of(dvh, "per"), *population = strcmp(text_of(first, "population"), "whole") == 0
                                                             ? "whole region"
                                                             : "own univels, without regions inside";
    cJSON_AddStringToObject(chart, "type", "chart");
    json_add(chart, "x",
             written_format("%.40s%s%.120s, %.40s, %.100s", text_of(first, "unit"), per[0] ? " per " : "", per,
                            text_of(first, "quantity"), text_of(first, "basis")));
    json_add(chart, "y", written_format("%% of each region's whole volume \xc2\xb7 %s", population));
    cJSON_ArrayForEach(curve, get(dvh, "curves"))
    {
        if (n < PAPER_MAX_CURVES)
            add_curve(paper, curves, curve, n++);
    }
    json_add(chart, "curves", curves);
    json_append(paper->blocks, chart);
}

/* A figure of a curve, or its bounds. */
static cJSON *figure_of(const cJSON *curve, const char *name, bool is_metric)
{
    const cJSON *here = is_metric ? get(curve, "metrics") : curve, *least = get(curve, "least"),
                *most = get(curve, "most");
    return value_of(number_of(here, name), number_of(is_metric ? get(least, "metrics") : least, name),
                    number_of(is_metric ? get(most, "metrics") : most, name));
}

static void add_histogram(struct paper *paper)
{
    static const struct paper_column columns[] = { { "Region", 20, 'l' },  { "cm\xc2\xb3", 11, 'r' },
                                                   { "univels", 11, 'r' }, { "min", 11, 'r' },
                                                   { "mean", 12, 'r' },    { "max", 11, 'r' },
                                                   { "D95 %", 12, 'r' },   { "without dose", 12, 'r' } };
    const cJSON *dvh = get(paper->kept, "dvh"), *curves = get(dvh, "curves"), *curve;
    char value[PAPER_NUMBER];
    if (!dvh)
        return;
    block_heading(paper, "Dose-volume histogram at the decision", "");
    if (!cJSON_GetArraySize(curves)) {
        block_text(paper, written("No region with a dose was shown."), "pale");
        return;
    }
    add_chart(paper, dvh, cJSON_GetArrayItem(curves, 0));
    cJSON *table = block_table(paper, columns, 8);
    cJSON_ArrayForEach(curve, curves)
    {
        const double volume = number_of(curve, "volume_cm3"), without = number_of(curve, "missing_cm3");
        cJSON *row = table_row(table);
        row_add(row, written(region_name(paper, text_of(curve, "region"))), "");
        row_add(row, written_format("%.2f", volume), "");
        row_add(row, written_format("%.0f", number_of(curve, "n_univels")), "");
        row_add(row, figure_of(curve, "min", false), "");
        row_add(row, figure_of(curve, "mean", false), "");
        row_add(row, figure_of(curve, "max", false), "");
        row_add(row, figure_of(curve, "D95%", true), "");
        row_add(row,
                without > 0 ? written_format("%s %%", written_number(100 * without / volume, value))
                            : written("\xe2\x80\x93"),
                json_flag(curve, "is_partial", false) ? "warn" : "");
    }
    block_text(paper,
               written_format("Doses in %.40s%s%.120s.%s", text_of(cJSON_GetArrayItem(curves, 0), "unit"),
                              text_of(dvh, "per")[0] ? " per " : "", text_of(dvh, "per"),
                              cJSON_GetArraySize(curves) > PAPER_MAX_CURVES ? " The first 24 regions are drawn." : ""),
               "pale");
}

/* ---- parts that do not fit, draft --------------------------------------------------------------------------------- */

static void add_used(struct paper *paper)
{
    static const struct paper_column columns[] = {
        { "Part", 24, 'l' }, { "Fact", 32, 'l' }, { "In words", 24, 'l' }, { "By", 20, 'l' }
    };
    const cJSON *item;
    char time[PAPER_TIME];
    if (!cJSON_GetArraySize(get(paper->record, "acceptances"))) {
        block_text(paper, written("Parts used though they do not fit: none."), "");
        return;
    }
    block_heading(paper, "Parts used though they do not fit", "");
    cJSON *table = block_table(paper, columns, 4);
    cJSON_ArrayForEach(item, get(paper->record, "acceptances"))
    {
        cJSON *row = table_row(table), *person = written_person(item, "author_name", "author_user");
        row_add(row,
                written_format("%.80s with %.80s%s", text_of(item, "thing"), text_of(item, "with"),
                               json_flag(item, "counts", true) ? "" : " (void: other files)"),
                "warn");
        row_add(row, written(text_of(item, "fact")), "");
        row_add(row, written_format("%.40s: %.800s", text_of(item, "reason"), text_of(item, "words")), "");
        row_add(row,
                written_format("%.400s, %s", cJSON_GetStringValue(person),
                               written_time(paper, number_of(item, "created_ms"), time)),
                "");
        cJSON_Delete(person);
    }
}

static void add_draft_row(cJSON *table, const char *name, cJSON *value)
{
    cJSON *row = table_row(table);
    row_add(row, written(name), "");
    row_add(row, value, "");
}

static void add_draft(struct paper *paper)
{
    static const struct paper_column columns[] = { { "Of the draft", 40, 'l' }, { "Value", 60, 'l' } };
    const cJSON *beam = get(paper->kept, "beam"), *sera = get(beam, "sera");
    char place[PAPER_PLACE], value[PAPER_NUMBER], other[PAPER_NUMBER];
    if (!beam)
        return;
    if (!json_flag(beam, "is_draft", false)) {
        block_text(paper, written("No draft beam stood at the decision."), "");
        return;
    }
    block_heading(paper, "Draft beam", "");
    block_text(paper,
               written_format("A draft beam stood at the decision%s%.100s: no dose belongs to it.",
                              text_of(beam, "beam")[0] ? ", in place of beam " : "", text_of(beam, "beam")),
               "warn");
    cJSON *table = block_table(paper, columns, 2);
    add_draft_row(table, "Source end", written(written_place(get(beam, "entry_lps_mm"), place)));
    add_draft_row(table, "Target", written(written_place(get(beam, "target_lps_mm"), place)));
    add_draft_row(table, "Length, aperture",
                  written_format("%s mm, %s mm", written_number(number_of(beam, "length_mm"), value),
                                 written_number(number_of(beam, "aperture_mm"), other)));
    add_draft_row(table, "Gap to the skin, depth of the target",
                  written_format("%s mm, %s mm", written_number(number_of(beam, "gap_mm"), value),
                                 written_number(number_of(beam, "depth_mm"), other)));
    add_draft_row(table, "SERA: phi, theta",
                  written_format("%s deg, %s deg", written_number(number_of(sera, "phi_deg"), value),
                                 written_number(number_of(sera, "theta_deg"), other)));
}

/* ---- signatures --------------------------------------------------------------------------------------------------- */

static void add_signature(struct paper *paper, cJSON *table, const cJSON *item, const cJSON *body, bool is_before)
{
    static const char *const words[][2] = { { "reviewed", "Reviewed" },
                                            { "approved", "Approved" },
                                            { "seen", "Seen" } };
    char time[PAPER_TIME], proved[PAPER_TIME];
    const bool is_user = json_flag(body, "signed_in", false);
    cJSON *row = table_row(table);
    row_add(row,
            is_user ? written_format("%.200s (%.80s)", text_of(body, "name"), text_of(body, "user"))
                    : written_format("\xe2\x80\x9c%.200s\xe2\x80\x9d", text_of(body, "name")),
            "");
    row_add(row, written(word_of(words, 3, text_of(body, "meaning"))), "");
    row_add(row,
            written_format("%s%s", written_time(paper, number_of(item, "created_ms"), time),
                           is_before ? ", before this decision" : ""),
            "");
    row_add(row,
            is_user ? written_format("proved by sign-in, %s", written_time(paper, number_of(body, "proved_ms"), proved))
                    : written("not signed in"),
            "");
}

static void add_signatures(struct paper *paper)
{
    static const struct paper_column columns[] = {
        { "Person", 32, 'l' }, { "Meaning", 14, 'l' }, { "At", 26, 'l' }, { "Confirmed", 28, 'l' }
    };
    const cJSON *item;
    block_heading(paper, "Signatures", "");
    cJSON *table = block_table(paper, columns, 4);
    cJSON_ArrayForEach(item, get(paper->record, "signatures"))
    {
        if (paper_is_of_same(paper, item))
            add_signature(paper, table, item, item, true);
    }
    cJSON_ArrayForEach(item, paper->source->signatures)
    {
        add_signature(paper, table, item, get(item, "body"), false);
    }
    table_end(paper, table, "Nobody has signed.");
    block_text(paper, written("These lines are not electronic signatures in the legal sense."), "pale");
}

void front_add(struct paper *paper)
{
    const char *revision = text_of(get(paper->source->item, "body"), "plan_revision");
    add_decision(paper);
    add_missing(paper);
    add_basis(paper);
    add_limits(paper);
    irradiation_add(paper);
    add_histogram(paper);
    add_used(paper);
    add_draft(paper);
    add_signatures(paper);
    block_text(
        paper,
        written_format(
            "Plan's files %.4s \xe2\x80\xa6 %s \xc2\xb7 record %.4s \xe2\x80\xa6 %s \xc2\xb7 all 64 digits on the last page",
            revision, strlen(revision) == 64 ? revision + 60 : "", paper->source->hash,
            strlen(paper->source->hash) == 64 ? paper->source->hash + 60 : ""),
        "pale");
}
