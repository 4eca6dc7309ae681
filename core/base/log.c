/* Formatting a log line and writing it to standard error with one write(2). */
#include "core/base/log.h"

#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const char *program_name = "beamroom";
static enum log_level least_level = LOG_INFO;

void log_start(const char *program, enum log_level least)
{
    program_name = program;
    least_level = least;
}

void log_line(enum log_level level, const char *format, ...)
{
    static const char *const words[] = { "debug", "info", "warning", "error" };
    if (level < least_level)
        return;
    struct timespec now;
    struct tm utc;
    clock_gettime(CLOCK_REALTIME, &now);
    gmtime_r(&now.tv_sec, &utc);
    char line[1024];
    size_t used = strftime(line, sizeof line, "%Y-%m-%dT%H:%M:%S", &utc);
    int head =
        snprintf(line + used, sizeof line - used, ".%03ldZ %s %s: ", now.tv_nsec / 1000000, program_name, words[level]);
    if (head > 0)
        used += (size_t)head;
    va_list args;
    va_start(args, format);
    int n = vsnprintf(line + used, sizeof line - used - 1, format, args);
    va_end(args);
    if (n > 0)
        used = strnlen(line, sizeof line - 2);
    for (size_t i = 0; i < used; i++)
        if ((unsigned char)line[i] < 0x20)
            line[i] = ' '; /* control characters in foreign text must not forge a second line */
    line[used++] = '\n';
    if (write(STDERR_FILENO, line, used) < 0)
        return;
}
