#pragma once
/* Everything noticed while loading, in order: shown in the page and the API. */
#include <stddef.h>

#include "core/base/error.h"

enum report_severity { REPORT_NOTE, REPORT_WARNING, REPORT_ERROR };
enum { REPORT_MAX = 500 }; /* further lines are counted, not kept */

struct report_line {
    enum report_severity severity;
    char code[48]; /* stable, "image.size-differs" */
    char sentence[400];
    char where[200]; /* file relative to the plan folder, and the place in it; "" when it is about the whole plan */
};

struct report {
    struct report_line *lines;
    size_t n_lines, n_dropped;
};

/* code must be in core/report/report_codes.h; report may be NULL. */
void report_add(struct report *report, enum report_severity severity, const char *code, const char *where,
                const char *format, ...) PRINTF_LIKE(5, 6);
/* Appends all lines of from and empties it. */
void report_move(struct report *to, struct report *from);
bool report_code_is_known(const char *code);
void report_finish(struct report *report);
const char *report_severity_word(enum report_severity severity); /* "note", "warning", "error" */
