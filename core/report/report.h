#pragma once
/* The report of what was noticed while loading a plan: lines with severity, code, sentence and place, in the order they
 * were noticed. The page and the API show it. Not for several threads at once. */
#include <stddef.h>

#include "core/base/error.h"
#include "core/sentence/sentence.h"

enum report_severity { REPORT_NOTE, REPORT_WARNING, REPORT_ERROR };
enum { REPORT_MAX = 500 }; /* lines beyond are counted in n_dropped, not kept */

struct report_line {
    enum report_severity severity;
    char code[48]; /* one of report_codes.h, "image.slices-differ"; stable, so programs may go by it */
    char sentence[400];
    char where[200]; /* the file, relative to the plan's folder; "" for the plan as a whole */
    struct sentence_facts facts;
};

struct report {
    struct report_line *lines;
    size_t n_lines, n_dropped;
};

/* Adds a line; in a full report it takes the place of the last one of less severity, if there is one. code must be in
 * report_codes.h; does nothing when report is NULL. */
void report_add(struct report *report, enum report_severity severity, const char *code, const char *where,
                const char *format, ...) PRINTF_LIKE(5, 6);
/* Puts another sentence into a line. */
void report_line_say(struct report_line *line, const char *format, ...) PRINTF_LIKE(2, 3);
/* Appends a line as it was written before. */
void report_add_line(struct report *report, const struct report_line *line);
/* Appends all lines of from to to, and empties from. */
void report_move(struct report *to, struct report *from);
bool report_code_is_known(const char *code);
void report_finish(struct report *report);
const char *report_severity_word(enum report_severity severity); /* "note", "warning", "error" */
