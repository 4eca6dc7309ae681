/* The irradiation time of a record: until each limit is reached, the first of them, and what targets have then. */
#include <math.h>
#include <string.h>

#include "server/paper/blocks.h"
#include "server/wire/json.h"

static double number_of(const cJSON *object, const char *name)
{
    return json_number(object, name, NAN);
}

static const char *text_of(const cJSON *object, const char *name)
{
    const char *text = json_text(object, name);
    return text ? text : "";
}

/* A figure, or its bounds: of a part of the region nothing is known. */
static cJSON *between(const cJSON *row, const char *name, const char *least_name, const char *most_name)
{
    char a[PAPER_NUMBER], b[PAPER_NUMBER];
    const double value = number_of(row, name), least = number_of(row, least_name), most = number_of(row, most_name);
    if (isfinite(value))
        return written(written_number(value, a));
    if (isfinite(least) && isfinite(most))
        return written_format("%s to %s", written_number(least, a), written_number(most, b));
    if (isfinite(least))
        return written_format("\xe2\x89\xa5 %s", written_number(least, a));
    return isfinite(most) ? written_format("\xe2\x89\xa4 %s", written_number(most, a)) : written("\xe2\x80\x93");
}

static cJSON *limit_words(const cJSON *limit)
{
    char value[PAPER_NUMBER];
    return written_format("%.40s %s %s %.40s", text_of(limit, "metric"),
                          strcmp(text_of(limit, "side"), "at-least") == 0 ? "\xe2\x89\xa5" : "\xe2\x89\xa4",
                          written_number(number_of(limit, "limit"), value), text_of(limit, "unit"));
}

/* ---- the sentence ------------------------------------------------------------------------------------------------- */

static void add_end(struct paper *paper, const cJSON *irradiation)
{
    char units[PAPER_NUMBER], minutes[PAPER_NUMBER];
    const bool is_time = strncmp(text_of(irradiation, "output"), "min", 3) == 0, /* the minutes stand there already */
        has_minutes = !is_time && isfinite(number_of(irradiation, "minutes"));
    if (!json_text(irradiation, "first")) {
        block_text(paper, written_format("No known limit ends the irradiation. %.300s", text_of(irradiation, "reason")),
                   "warn");
        return;
    }
    block_text(paper,
               written_format("The first limit is reached after %s %.90s%s%s%s.",
                              written_number(number_of(irradiation, "units"), units), text_of(irradiation, "output"),
                              has_minutes ? ", " : "",
                              has_minutes ? written_number(number_of(irradiation, "minutes"), minutes) : "",
                              has_minutes ? " min" : ""),
               "");
    if (!json_flag(irradiation, "is_certain", false))
        block_text(paper, written("A limit that is not known may come before it."), "warn");
}

/* ---- tables ------------------------------------------------------------------------------------------------------- */

static void add_limits(struct paper *paper, const cJSON *irradiation)
{
    static const struct paper_column columns[] = {
        { "Region", 20, 'l' }, { "Limit", 26, 'l' }, { "Reached after", 18, 'r' }, { "min", 10, 'r' }, { "", 26, 'l' }
    };
    const cJSON *limit;
    char minutes[PAPER_NUMBER];
    cJSON *table = block_table(paper, columns, 5);
    cJSON_ArrayForEach(limit, cJSON_GetObjectItemCaseSensitive(irradiation, "limits"))
    {
        const bool is_first = json_flag(limit, "is_first", false);
        cJSON *row = table_row(table);
        row_add(row, written(region_name(paper, text_of(limit, "region"))), is_first ? "bold" : "");
        row_add(row, limit_words(limit), "");
        row_add(row,
                json_flag(limit, "is_never", false) ? written("never")
                                                    : between(limit, "units", "units_least", "units_most"),
                "");
        row_add(row, written(written_number(number_of(limit, "minutes"), minutes)), "");
        row_add(row, is_first ? written("first") : written(text_of(limit, "reason")), is_first ? "warn" : "");
    }
    table_end(paper, table, "No limits were set.");
}

static void add_fields(struct paper *paper, const cJSON *irradiation)
{
    static const struct paper_column columns[] = {
        { "Field", 40, 'l' }, { "Share", 15, 'r' }, { "Output", 15, 'r' }, { "min", 15, 'r' }, { "ppm", 15, 'r' }
    };
    static const char *const names[] = { "share", "units", "minutes", "blood_ppm" };
    const cJSON *field;
    cJSON *table = block_table(paper, columns, 5);
    cJSON_ArrayForEach(field, cJSON_GetObjectItemCaseSensitive(irradiation, "fields"))
    {
        char number[PAPER_NUMBER];
        cJSON *row = table_row(table);
        row_add(row, written(text_of(field, "dose")), "");
        for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
            row_add(row, written(written_number(number_of(field, names[i]), number)), "");
    }
    table_end(paper, table, "");
}

static void add_targets(struct paper *paper, const cJSON *irradiation)
{
    static const struct paper_column columns[] = {
        { "Target then", 40, 'l' }, { "D95 %", 20, 'r' }, { "Mean", 20, 'r' }, { "Min", 20, 'r' }
    };
    const cJSON *target;
    cJSON *table = block_table(paper, columns, 4);
    cJSON_ArrayForEach(target, cJSON_GetObjectItemCaseSensitive(irradiation, "targets"))
    {
        cJSON *row = table_row(table);
        row_add(row,
                written_format("%.200s, %.30s", region_name(paper, text_of(target, "region")), text_of(target, "unit")),
                "");
        row_add(row, between(target, "d95", "d95_least", "d95_most"), "");
        row_add(row, between(target, "mean", "mean_least", "mean_most"), "");
        row_add(row, between(target, "min", "min_least", "min_most"), "");
    }
    table_end(paper, table, "The plan has no target.");
}

void irradiation_add(struct paper *paper)
{
    const cJSON *irradiation = cJSON_GetObjectItemCaseSensitive(paper->kept, "irradiation"),
                *fields = cJSON_GetObjectItemCaseSensitive(irradiation, "fields"), *field;
    bool is_measured = false;
    char ppm[PAPER_NUMBER];
    if (!cJSON_GetArraySize(cJSON_GetObjectItemCaseSensitive(irradiation, "limits")))
        return;
    cJSON_ArrayForEach(field, fields) is_measured = is_measured || json_flag(field, "is_measured", false);
    block_heading(paper, "Irradiation time", is_measured ? "with the boron measured in blood" : "with the boron shown");
    add_end(paper, irradiation);
    add_limits(paper, irradiation);
    if (cJSON_GetArraySize(fields) > 1)
        add_fields(paper, irradiation);
    else
        block_text(paper,
                   written_format("Boron in blood: %s ppm, %s.",
                                  written_number(number_of(cJSON_GetArrayItem(fields, 0), "blood_ppm"), ppm),
                                  is_measured ? "measured" : "as the dose is shown"),
                   "");
    if (json_text(irradiation, "first"))
        add_targets(paper, irradiation);
}
