/* Failures as lines on standard error. */
#include "server/cli/exit_code.h"

#include <stdarg.h>
#include <stdio.h>

#include "server/cli/text.h"

int command_usage_error(const char *name, const char *format, ...)
{
    fprintf(stderr, "beamroom %s: ", name);
    va_list args;
    va_start(args, format);
    vfprintf(stderr, format, args);
    va_end(args);
    fprintf(stderr, "; see beamroom %s --help\n", name);
    return EXIT_USAGE;
}

int command_refused(const char *name, const struct error *err)
{
    fprintf(stderr, "beamroom %s: ", name);
    text_print(stderr, err->text, 0);
    fputc('\n', stderr);
    return EXIT_REFUSED;
}
