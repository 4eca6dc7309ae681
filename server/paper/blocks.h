#pragma once
/* Blocks of a paper, and text as it stands there. Internal to server/paper. */
#include "server/paper/paper.h"

enum {
    PAPER_MAX_TEXT = 20000, /* characters of one text; what is longer ends in an ellipsis */
    PAPER_NUMBER = 32,
    PAPER_TIME = 128,
    PAPER_PLACE = 96,
    PAPER_MAX_CURVES = 24 /* of a histogram */
};

struct paper {
    cJSON *json, *blocks;
    const struct paper_source *source;
    const cJSON *record, *kept, *scene, *plan; /* of the body; NULL: there is none */
    int offset_min;                            /* of the times on it: those of the decision */
    char zone[24];
};

/* ---- text --------------------------------------------------------------------------------------------------------- */

/* A string of JSON with the text made visible: control characters as spaces but for line breaks, characters that do not
 * show as tags. NULL is "". */
cJSON *written(const char *text);
cJSON *written_format(const char *format, ...) __attribute__((format(printf, 1, 2)));
/* Three digits that count; "-" for NaN. */
const char *written_number(double value, char text[PAPER_NUMBER]);
/* "L 24.9, P 38.1, S 67.0 mm" of a point in LPS; "" for none. */
const char *written_place(const cJSON *point, char text[PAPER_PLACE]);
/* "27 Nov 2026, 14:36" in the zone of the paper. */
const char *written_time(const struct paper *paper, double ms, char text[PAPER_TIME]);
/* "14:36:02 EET (UTC+2)" behind it. */
const char *written_exact(double ms, int offset_min, const char *zone, char text[PAPER_TIME]);
/* "Dr Ann Keller (ann)", in quotation marks without sign-in: a member's, by the fields of an item or a stay. */
cJSON *written_person(const cJSON *row, const char *name_field, const char *user_field);

/* ---- blocks ------------------------------------------------------------------------------------------------------- */

void block_heading(struct paper *paper, const char *text, const char *note);
void block_text(struct paper *paper, cJSON *text, const char *style); /* takes text; style: "", pale, warn, small */
void block_page(struct paper *paper);
/* columns: {words, percent of the width, 'l' or 'r'}; the rows are added to what comes back. */
struct paper_column {
    const char *words;
    int percent;
    char side;
};
cJSON *block_table(struct paper *paper, const struct paper_column *columns, size_t n);
cJSON *table_row(cJSON *table);
void row_add(cJSON *row, cJSON *text, const char *style); /* takes text; style: "", bold, ok, warn, err, code */
/* A table without rows becomes this sentence. */
void table_end(struct paper *paper, cJSON *table, const char *without);

/* ---- parts -------------------------------------------------------------------------------------------------------- */

void front_add(struct paper *paper);
void irradiation_add(struct paper *paper);
void parts_add(struct paper *paper);
/* The part of a list of the kept plan with this id; NULL: there is none. */
const cJSON *paper_part_of(const struct paper *paper, const char *list, const char *id);
const cJSON *paper_shown_dose(const struct paper *paper); /* NULL: there is none */
const cJSON *paper_treatment(const struct paper *paper);  /* the shown treatment plan; NULL: there is none */
/* Whether an item of the record was written of the files and the patient that the printed item was. */
bool paper_is_of_same(const struct paper *paper, const cJSON *item);
const char *region_name(const struct paper *paper, const char *id);
