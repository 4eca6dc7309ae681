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

/* A line to write into; NULL: there is no report, or no room for a line of this severity. */
static struct report_line *new_line(struct report *report, enum report_severity severity)
{
    if (!report || (report->n_lines >= REPORT_MAX && !make_room(report, severity)))
        return NULL;
    if (!report->lines)
        report->lines = mem_new(REPORT_MAX * sizeof *report->lines);
    return &report->lines[report->n_lines++];
}

static void say(struct report_line *line, const char *format, va_list args)
{
    va_list again;
    va_copy(again, args);
    (void)vsnprintf(line->sentence, sizeof line->sentence, format, args);
    sentence_describe(&line->facts, format, again);
    va_end(again);
}

void report_add(struct report *report, enum report_severity severity, const char *code, const char *where,
                const char *format, ...)
{
    assert(report_code_is_known(code));
    struct report_line *line = new_line(report, severity);
    if (!line)
        return;
    line->severity = severity;
    snprintf(line->code, sizeof line->code, "%s", code);
    snprintf(line->where, sizeof line->where, "%s", where);
    va_list args;
    va_start(args, format);
    say(line, format, args);
    va_end(args);
}

void report_line_say(struct report_line *line, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    say(line, format, args);
    va_end(args);
}

void report_add_line(struct report *report, const struct report_line *line)
{
    assert(report_code_is_known(line->code));
    struct report_line *place = new_line(report, line->severity);
    if (place)
        *place = *line;
}

void report_move(struct report *to, struct report *from)
{
    for (size_t i = 0; i < from->n_lines; i++)
        report_add_line(to, &from->lines[i]);
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
