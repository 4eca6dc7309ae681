/* The report of what was noticed while loading a plan. */
#include "core/report/report.h"

#include <assert.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/report/report_codes.h"

bool report_code_is_known(const char *code)
{
#define KNOWN(known, meaning, remedy) \
    if (strcmp(code, known) == 0) \
        return true;
    REPORT_CODES(KNOWN)
#undef KNOWN
    return false;
}

/* Makes room in a full report by removing the last line of the least severity, if that is below severity. */
static bool make_room(struct report *report, enum report_severity severity)
{
    size_t at = SIZE_MAX;
    for (size_t i = 0; i < report->n_lines; i++)
        if (report->lines[i].severity < severity &&
            (at == SIZE_MAX || report->lines[i].severity <= report->lines[at].severity))
            at = i;
    report->n_dropped++;
    if (at == SIZE_MAX)
        return false;
    report->n_lines--;
    memmove(&report->lines[at], &report->lines[at + 1], (report->n_lines - at) * sizeof *report->lines);
    return true;
}

void report_add(struct report *report, enum report_severity severity, const char *code, const char *where,
                const char *format, ...)
{
    assert(report_code_is_known(code));
    if (!report)
        return;
    if (report->n_lines >= REPORT_MAX && !make_room(report, severity))
        return;
    if (!report->lines)
        report->lines = mem_new(REPORT_MAX * sizeof *report->lines);
    struct report_line *line = &report->lines[report->n_lines++];
    line->severity = severity;
    snprintf(line->code, sizeof line->code, "%s", code);
    snprintf(line->where, sizeof line->where, "%s", where);
    va_list args;
    va_start(args, format);
    vsnprintf(line->sentence, sizeof line->sentence, format, args);
    va_end(args);
}

void report_move(struct report *to, struct report *from)
{
    for (size_t i = 0; i < from->n_lines; i++) {
        const struct report_line *line = &from->lines[i];
        report_add(to, line->severity, line->code, line->where, "%s", line->sentence);
    }
    to->n_dropped += from->n_dropped;
    report_finish(from);
}

void report_finish(struct report *report)
{
    free(report->lines);
    *report = (struct report){ 0 };
}

const char *report_severity_word(enum report_severity severity)
{
    switch (severity) {
    case REPORT_NOTE: return "note";
    case REPORT_WARNING: return "warning";
    case REPORT_ERROR: return "error";
    }
    return "note";
}
